#!/bin/bash
# The units of deploy/ under a systemd of their own: Debian with systemd, made by debootstrap, is booted by systemd-nspawn with a
# loopback network only. The programs are installed as deploy/README.md says. In the container a study is started by its unit,
# interrupted and resumed; its worker is killed and restarted by systemd. A second study uses a program that its scene names, which
# the worker's unit offers, with a licence. Both answers are compared with those of the same studies outside, byte by byte.
#   tests/examples/real/systemd.sh [FOLDER OF THE PROGRAMS]
# Needs root, debootstrap, systemd-nspawn (Debian: systemd-container) and a Debian mirror; three minutes. Exit code 77 if
# something is missing. ROOTFS names a tree with systemd made before by debootstrap, which is copied.
set -euo pipefail
top=$(realpath "$(dirname "$0")/../../..")
programs=$(realpath "${1:-$top/target/release}")
: "${MIRROR:=http://deb.debian.org/debian}" "${RELEASE:=bookworm}" "${ROOTFS:=}"

skip() {
    echo "not run: $*" >&2
    exit 77
}
[ "$(id -u)" -eq 0 ] || skip "systemd-nspawn needs root"
type -P systemd-nspawn >/dev/null || skip "systemd-nspawn is not installed"
type -P debootstrap >/dev/null || [ -n "$ROOTFS" ] || skip "debootstrap is not installed"

work=$(mktemp -d)
root=$work/root
container=
finish() {
    if [ -n "$container" ]; then
        kill "$container" 2>/dev/null || true
        wait "$container" 2>/dev/null || true
    fi
    rm -rf "$work"
}
trap finish EXIT
fail() {
    echo "failed: $*" >&2
    tail -n 40 "$work"/*.log "$root"/trial.log >&2 || true
    exit 1
}

if [ -n "$ROOTFS" ]; then
    cp -a "$ROOTFS" "$root"
else
    debootstrap --variant=minbase --include=systemd,systemd-sysv,dbus "$RELEASE" "$root" "$MIRROR" >"$work/debootstrap.log" 2>&1 ||
        fail "debootstrap"
fi

# The steps of deploy/README.md, with this root.
"$top/deploy/certificates.sh" "$work/tls" 127.0.0.1 >/dev/null
chroot "$root" useradd --system --no-create-home --shell /usr/sbin/nologin hingewise
group=$(chroot "$root" id -g hingewise)
install -D -t "$root/opt/hingewise/bin" "$programs/coordinator" "$programs/worker"
install -D -m 644 -t "$root/opt/hingewise/share" "$top/README.md"
install -D -m 644 -t "$root/etc/hingewise" "$top/deploy/zenoh-tls.json5"
install -d -m 750 -g "$group" "$root/etc/hingewise/tls"
install -m 640 -g "$group" -t "$root/etc/hingewise/tls" "$work"/tls/127.0.0.1/*.pem
install -m 644 -t "$root/etc/systemd/system" "$top"/deploy/hingewise-{coordinator,worker}.service
systemctl --quiet --root="$root" enable hingewise-coordinator hingewise-worker

sed -e 's/^initial = .*/initial = 100/' -e 's/^max_evaluations = .*/max_evaluations = 100/' \
    "$top/common/scenes/four-bar.toml" >"$work/trial.toml"
# A program of a scene's own: a beam, by awk, with an input file.
cat >"$work/beam.toml" <<'SCENE'
scene = { name = "beam", title = "Beam" }
simulator = { program = ["awk", "-f", "beam.awk", "beam.txt"], templates = ["beam.txt"], files = ["beam.awk"], results = "results.out" }
outputs = [{ name = "deflection", unit = "mm" }]
limit_states = [{ name = "bent", output = "deflection", threshold = 8.5 }]
variables = [
  { name = "load", mean = "500 N", std = "10 %" },
  { name = "height", mean = "40 mm", std = "0.2 mm" },
]
study = { population = 2000, initial = 12, max_evaluations = 24 }
SCENE
printf '%s\n' 'load {load}' 'height {height}' >"$work/beam.txt"
cat >"$work/beam.awk" <<'AWK'
{ x[$1] = $2 }
END {
    inertia = 0.02 * x["height"] * x["height"] * x["height"] / 12
    printf "%.17g\n", 1000 * x["load"] / (3 * 206e9 * inertia) >"results.out"
}
AWK
install -m 644 -t "$root/etc/hingewise" "$work/trial.toml" "$work"/beam.*
printf '%s\n' SCENE=/etc/hingewise/trial.toml STUDY=trial LISTEN=tls/127.0.0.1:7447 >"$root/etc/hingewise/coordinator.env"
echo COORDINATOR=tls/127.0.0.1:7447 >"$root/etc/hingewise/worker.env"

# What happens in the container.
cat >"$root/trial.sh" <<'TRIAL'
#!/bin/bash
set -euo pipefail
trap 'journalctl --no-pager --lines 60 >/journal.log; systemctl poweroff --force' EXIT
study=/var/lib/hingewise/trial
within() {
    local end=$((SECONDS + $1))
    shift
    until "$@" >/dev/null 2>&1; do
        ((SECONDS < end)) || { echo "still not true: $*"; exit 1; }
        sleep 0.2
    done
}
value() { systemctl show --property "$2" --value "hingewise-$1"; }
is_active() { systemctl is-active --quiet "hingewise-$1"; }
logged() { journalctl --no-pager --unit "hingewise-$1" | grep -q "$2"; }

within 60 is_active coordinator
within 60 is_active worker
within 60 logged worker "connected to the coordinator"
for name in coordinator worker; do
    process=$(value "$name" MainPID)
    echo "$name: $(stat --format 'user %U' "/proc/$process"), $(grep -E 'NoNewPrivs|Seccomp:|CapBnd' "/proc/$process/status" | tr -s '\t\n' ' ')"
    grep -q 'NoNewPrivs:[[:space:]]*1' "/proc/$process/status"
    grep -q 'Seccomp:[[:space:]]*2' "/proc/$process/status"
    systemd-analyze --no-pager security "hingewise-$name" | tail -n 1
done

within 120 test -s "$study/campaign.db"
sleep 2
systemctl restart hingewise-coordinator
within 60 logged coordinator "evaluations are done already"
within 60 logged worker "answers again\|connected to the coordinator"
echo "the coordinator was restarted, the study resumed: $(journalctl --no-pager --output cat --unit hingewise-coordinator | grep -m 1 'done already')"

before=$(value worker MainPID)
kill -KILL "$before"
is_another() { is_active worker && [ "$(value worker MainPID)" != "$before" ]; }
within 60 is_another
echo "the killed worker was started again"

within 600 test -s "$study/summary.json"
has_ended() { [ "$(value coordinator ActiveState)" = inactive ]; }
within 60 has_ended
echo "the study ended: $(value coordinator Result), exit code $(value coordinator ExecMainStatus)"
sleep 8
has_ended || { echo "a finished study was started again"; exit 1; }
within 30 is_active worker
systemctl stop hingewise-worker
echo "the worker was stopped: $(value worker Result), exit code $(value worker ExecMainStatus)"

printf '%s\n' SCENE=/etc/hingewise/beam.toml STUDY=beam LISTEN=tls/127.0.0.1:7447 'OPTIONS=--seed 3' LICENCES=1 >/etc/hingewise/coordinator.env
printf '%s\n' COORDINATOR=tls/127.0.0.1:7447 'WORKER_OPTIONS=--simulator /etc/hingewise/beam.toml --slots 2' >/etc/hingewise/worker.env
systemctl start hingewise-coordinator
tr '\0' ' ' <"/proc/$(value coordinator MainPID)/cmdline"
echo
systemctl start hingewise-worker
within 120 test -s /var/lib/hingewise/beam/summary.json
within 60 has_ended
logged worker "offering simulator beam"
echo "the study with a program of its own ended: $(value coordinator Result), exit code $(value coordinator ExecMainStatus)"
systemctl stop hingewise-worker
echo "ok"
TRIAL
cat >"$root/etc/systemd/system/trial.service" <<'UNIT'
[Unit]
After=multi-user.target
[Service]
Type=oneshot
ExecStart=/bin/bash /trial.sh
StandardOutput=file:/trial.log
StandardError=inherit
[Install]
WantedBy=default.target
UNIT
systemctl --quiet --root="$root" enable trial

systemd-nspawn --quiet --directory="$root" --boot --private-network --register=no --keep-unit --console=pipe \
    </dev/null >"$work/console.log" 2>&1 &
container=$!
for _ in $(seq 900); do
    kill -0 "$container" 2>/dev/null || break
    sleep 1
done
! kill -0 "$container" 2>/dev/null || fail "the container does not end"
container=
cat "$root/trial.log" || fail "the container did not start"
[ "$(tail -n 1 "$root/trial.log")" = ok ] || { cat "$root/journal.log" >&2; fail "see above"; }

"$programs/coordinator" run "$work/trial.toml" --quiet --out "$work/alone" --workers auto >/dev/null 2>"$work/alone.log" ||
    fail "the study outside"
"$programs/coordinator" run "$work/beam.toml" --quiet --seed 3 --out "$work/alone-beam" --workers 1 >/dev/null \
    2>>"$work/alone.log" || fail "the study of a program outside"
for study in trial beam; do
    alone=$work/alone
    [ "$study" = beam ] && alone=$work/alone-beam
    cmp "$root/var/lib/hingewise/$study/reliability.csv" "$alone/reliability.csv" || fail "another answer of $study"
done
echo "ok: both answers are those of the studies outside"
