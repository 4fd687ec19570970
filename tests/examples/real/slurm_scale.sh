#!/bin/bash
# Workers asked for by `coordinator run --scale slurm` of a real Slurm with two nodes: munge, controller and two node daemons of Debian's
# packages run on this machine, on loopback. From zero workers: time to the first result, number of jobs, nodes back after the study, all jobs
# cancelled in the middle, and the bits of a local study.
#   tests/examples/real/slurm_scale.sh [FOLDER OF THE PROGRAMS]
# A few minutes. Needs no root, systemd or cgroups. Exit code 77 if Slurm is not installed.
set -euo pipefail
top=$(realpath "$(dirname "$0")/../../..")
programs=$(realpath "${1:-$top/target/release}")
: "${EVALUATIONS:=100}" "${MOST:=2}"

for need in slurmctld slurmd sbatch squeue scancel munged python3; do
    if ! PATH=$PATH:/usr/sbin type -P "$need" >/dev/null; then
        echo "not run: $need is not installed (Debian: slurmctld slurmd slurm-client munge python3)" >&2
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
    squeue --noheader --format %A 2>/dev/null | sort -u | xargs --no-run-if-empty scancel || true
    # Longer than KillWait: the node ends what does not end by itself.
    [ -z "${study:-}" ] || kill "$study" 2>/dev/null || true
    sleep 7
    for ((k = ${#started[@]} - 1; k >= 0; k--)); do
        kill "${started[k]}" 2>/dev/null || true
        wait "${started[k]}" 2>/dev/null || true
    done
    if [ -n "${KEEP:-}" ]; then echo "kept: $work"; else rm -rf "$work"; fi
}
trap finish EXIT

# shellcheck source=/dev/null
. "$top/tests/examples/real/checks.sh"

dd if=/dev/urandom of="$work/munge.key" bs=128 count=1 status=none
chmod 400 "$work/munge.key"
munged --foreground --socket="$work/munge.socket" --key-file="$work/munge.key" --pid-file="$work/munge.pid" \
    --log-file="$work/munged.log" --seed-file="$work/munge.seed" 2>"$work/munged.err.log" &
started+=($!)
within 20 test -S "$work/munge.socket"

host=$(hostname -s)
cat >"$work/slurm.conf" <<CONF
ClusterName=trial
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$work/munge.socket,cred_expire=10
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool-%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd-%n.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd-%n.log
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
SchedulerParameters=sched_interval=2,bf_interval=2
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=5
NodeName=node1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$(free_port) CPUs=16 RealMemory=16384 State=UNKNOWN
NodeName=node2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$(free_port) CPUs=16 RealMemory=16384 State=UNKNOWN
PartitionName=trial Nodes=node1,node2 Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf
mkdir "$work/state" "$work/spool-node1" "$work/spool-node2"
slurmctld -D -f "$SLURM_CONF" 2>"$work/slurmctld.err.log" &
started+=($!)
for node in node1 node2; do
    slurmd -D -N "$node" -f "$SLURM_CONF" 2>"$work/slurmd-$node.err.log" &
    started+=($!)
done
within 60 scontrol ping
nodes_are_idle() { [[ $(sinfo --noheader --Node --format %t | sort -u) == idle ]]; }
within 60 nodes_are_idle

export HOME=$work/home
mkdir -p "$HOME" "$work/job"
cd "$work/job"
sed -e "s/^initial = .*/initial = $EVALUATIONS/" -e "s/^max_evaluations = .*/max_evaluations = $EVALUATIONS/" \
    "$top/common/scenes/four-bar.toml" >scene.toml

most_seen=0
watch_jobs() {
    local now
    now=$(squeue --noheader --format %i | wc -l)
    ((now > most_seen)) && most_seen=$now
    true
}

began=$SECONDS
coordinator run scene.toml --levels reference --out scaled --workers 0 --scale slurm --most "$MOST" --idle 10s -v \
    >scaled.out 2>scaled.log &
study=$!
within 120 has_first_result scaled
echo "first result after $((SECONDS - began)) s, from zero workers"
while kill -0 "$study" 2>/dev/null; do
    watch_jobs
    if [ -z "${cancelled:-}" ] && ((SECONDS - began > 15)); then
        cancelled=$(squeue --noheader --format %i | wc -l)
        squeue --noheader --format %i | xargs --no-run-if-empty scancel
        echo "all $cancelled jobs cancelled after $((SECONDS - began)) s"
    fi
    sleep 0.5
done
wait "$study" || fail "the study ended with an error: $(tail -n 3 scaled.log)"
ended=$SECONDS
echo "study of $EVALUATIONS evaluations: $((ended - began)) s"
within 60 nodes_are_idle
echo "both nodes back $((SECONDS - ended)) s after the end; at most $most_seen jobs at once"
((most_seen <= MOST)) || fail "$most_seen jobs at once"
[ -n "${cancelled:-}" ] || fail "the study ended before its jobs were cancelled: set EVALUATIONS higher"
echo "jobs, by state of their end:"
sed -E 's/^JobId=([0-9]+).* JobState=([A-Z]+).*/\2/' "$work/jobs.txt" | sort | uniq -c

coordinator run scene.toml --quiet --levels reference --out alone --workers auto >/dev/null
have_same_bytes scaled alone
echo "ok: the bytes of a local study"
