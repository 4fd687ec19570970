#!/bin/bash
# A study under a real Slurm: munge, controller and node of Debian's packages run on this machine, on loopback, and the
# scripts of deploy/slurm are submitted as their users submit them.
#   tests/examples/real/slurm.sh [FOLDER OF THE PROGRAMS]
# The study takes at least three worker jobs of 60 s, one after the other. A further worker is killed without a signal, and
# another one hangs until Slurm ends it at its time limit. The job of the coordinator reaches its time limit, is requeued and
# resumes. At the end, curves and samples are compared with those of a local study, byte by byte. About ten minutes on two idle
# cores. Needs no root, systemd or cgroups. Exit code 77 if Slurm is not installed.
set -euo pipefail
top=$(realpath "$(dirname "$0")/../../..")
programs=$(realpath "${1:-$top/target/release}")
# Evaluations of the study, and the most worker jobs it may take.
: "${EVALUATIONS:=500}" "${WORKER_JOBS:=30}"

for need in slurmctld slurmd sbatch squeue scontrol scancel munged openssl python3; do
    if ! PATH=$PATH:/usr/sbin type -P "$need" >/dev/null; then
        echo "not run: $need is not installed (Debian: slurmctld slurmd slurm-client munge openssl python3)" >&2
        exit 77
    fi
done
PATH=$programs:$PATH:/usr/sbin
coordinator --version
slurmctld -V

work=$(mktemp -d)
chmod 711 "$work"
started=()
finish() {
    # Jobs first: the node ends them; then the daemons, in reverse order.
    squeue --noheader --format %A 2>/dev/null | sort -u | xargs --no-run-if-empty scancel || true
    sleep 2
    for ((k = ${#started[@]} - 1; k >= 0; k--)); do
        kill "${started[k]}" 2>/dev/null || true
        wait "${started[k]}" 2>/dev/null || true
    done
    if [ -n "${KEEP:-}" ]; then echo "kept: $work"; else rm -rf "$work"; fi
}
trap finish EXIT

# shellcheck source=/dev/null
. "$top/tests/examples/real/checks.sh"

# Munge: authenticates the messages of Slurm.
dd if=/dev/urandom of="$work/munge.key" bs=128 count=1 status=none
chmod 400 "$work/munge.key"
munged --foreground --socket="$work/munge.socket" --key-file="$work/munge.key" --pid-file="$work/munge.pid" \
    --log-file="$work/munged.log" --seed-file="$work/munge.seed" 2>"$work/munged.err.log" &
started+=($!)
within 20 test -S "$work/munge.socket"

# The node declares more cores and memory than this machine may have, so that the #SBATCH lines of the scripts hold unchanged.
host=$(hostname -s)
cat >"$work/slurm.conf" <<CONF
ClusterName=trial
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$work/munge.socket,cred_expire=10
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc=$work/jobs.txt
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=sched_interval=5,bf_interval=5
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=5
NodeName=$host NodeAddr=127.0.0.1 CPUs=64 RealMemory=65536 State=UNKNOWN
PartitionName=trial Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf
mkdir "$work/state" "$work/spool"
slurmctld -D -f "$SLURM_CONF" 2>"$work/slurmctld.err.log" &
started+=($!)
slurmd -D -f "$SLURM_CONF" 2>"$work/slurmd.err.log" &
started+=($!)
within 60 scontrol ping
node_is_idle() { [[ $(sinfo --noheader --format %t) == idle ]]; }
within 60 node_is_idle

# What a user has: programs on PATH, and certificates and Zenoh configurations as deploy's README makes them.
export HOME=$work/home
config=$HOME/.config/hingewise
mkdir -p "$config" "$work/job"
"$top/deploy/certificates.sh" "$work/tls" worker:cluster coordinator >/dev/null
sed "s#/etc/hingewise/tls#$work/tls/coordinator#" "$top/deploy/zenoh-tls.json5" >"$config/zenoh-coordinator.json5"
sed -e "s#/etc/hingewise/tls#$work/tls/cluster#" -e 's/verify_name_on_connect: true/verify_name_on_connect: false/' \
    "$top/deploy/zenoh-tls.json5" >"$config/zenoh-worker.json5"
cd "$work/job"
sed -e "s/^initial = .*/initial = $EVALUATIONS/" -e "s/^max_evaluations = .*/max_evaluations = $EVALUATIONS/" \
    "$top/common/scenes/four-bar.toml" >scene.toml
export SCENE=scene.toml STUDY=$PWD/study OPTIONS="--accuracy reference"
PORT=$(free_port)
export PORT

began=$SECONDS
# Times of the jobs are given here; everything else is as in the scripts, except for the cores of a worker.
sbatch --export=ALL --time=4 "$top/deploy/slurm/coordinator.sbatch"
within 120 test -s "$STUDY.endpoint"
# Slurm sends the signal up to half a minute early, so in jobs of one minute there is none: workers leave by their walltime.
worker=(sbatch --parsable --export=ALL --cpus-per-task=1 --time=1 --signal=B:TERM@0)
worker_jobs=$("${worker[@]}" --array="1-$WORKER_JOBS%1" "$top/deploy/slurm/workers.sbatch")

# One worker is killed in mid-task; another one is stopped and hangs. By their processes: `scancel --signal=KILL` would end the
# job with a SIGTERM before.
has_begun() { grep -q "initial design" hingewise-coordinator-*.log; }
within 180 has_begun
for signal in KILL STOP; do
    job=$("${worker[@]}" --job-name="$signal" "$top/deploy/slurm/workers.sbatch")
    is_connected() { grep -q "connected to the coordinator" "$signal-$job"_*.log; }
    within 180 is_connected
    sleep 2
    scontrol listpids "$job" | awk -v job="$job" '$2 == job && $1 > 0 { print $1 }' | xargs kill "-$signal"
    is_lost() { grep -q "worker slurm-$job was lost" hingewise-coordinator-*.log; }
    within 30 is_lost
    echo "worker job $job got SIG$signal after $((SECONDS - began)) s: its evaluations are requeued"
done

has_ended() { test -s "$STUDY/summary.json"; }
while ! has_ended; do
    [ -n "$(squeue --noheader --states=all --job "$worker_jobs" --format %A 2>/dev/null)" ] || fail "no worker jobs are left"
    ((SECONDS - began < 60 * (WORKER_JOBS + 10))) || fail "the study does not end"
    sleep 2
done
within 60 test ! -e "$STUDY.endpoint"
scancel "$worker_jobs" 2>/dev/null || true
no_jobs() { [ -z "$(squeue --noheader)" ]; }
within 120 no_jobs
echo "study of $EVALUATIONS evaluations under Slurm: $((SECONDS - began)) s"
echo "jobs, by name and state of their end:"
sed -E 's/^JobId=([0-9]+).* Name=([^ ]+) JobState=([A-Z]+).* TimeLimit=([0-9]+) .*/\2 \3/' "$work/jobs.txt" | sort | uniq -c

echo "evaluations by worker:"
workers=$(python3 -c 'import json, sys
for worker in json.load(open(sys.argv[1]))["workers"]: print(worker["name"], worker["evaluations"])' "$STUDY/summary.json")
echo "$workers"

jobs_of_workers=$(grep -oE "^slurm-${worker_jobs}_[0-9]+" <<<"$workers" | sort -u | wc -l)
((jobs_of_workers >= 3)) || fail "only $jobs_of_workers worker jobs took part: set EVALUATIONS higher"
grep -q "evaluations are done already" hingewise-coordinator-*.log || fail "the coordinator's job was not requeued"
grep -q "Name=STOP JobState=TIMEOUT" "$work/jobs.txt" || fail "Slurm did not end the hanging worker"

coordinator run scene.toml --quiet --accuracy reference --out alone --workers auto >/dev/null
have_same_bytes "$STUDY" alone
echo "ok: $jobs_of_workers worker jobs and the requeued coordinator give the bytes of a local study"
