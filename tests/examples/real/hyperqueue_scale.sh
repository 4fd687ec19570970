#!/bin/bash
# Workers asked for by `coordinator run --scale hyperqueue` of a real HyperQueue: a server and two of its workers run on this machine.
# From zero workers: time to the first result, number of jobs, all jobs cancelled in the middle, no job left after the study, and the
# bits of a local study.
#   tests/examples/real/hyperqueue_scale.sh [FOLDER OF THE PROGRAMS]
# A few minutes. Exit code 77 if `hq` is not installed (https://github.com/It4innovations/hyperqueue).
set -euo pipefail
top=$(realpath "$(dirname "$0")/../../..")
programs=$(realpath "${1:-$top/target/release}")
: "${EVALUATIONS:=100}" "${MOST:=2}"

for need in hq python3; do
    if ! type -P "$need" >/dev/null; then
        echo "not run: $need is not installed" >&2
        exit 77
    fi
done
PATH=$programs:$PATH
coordinator --version
hq --version

work=$(mktemp -d)
export HQ_SERVER_DIR=$work/server
started=()
finish() {
    [ -z "${study:-}" ] || kill "$study" 2>/dev/null || true
    hq server stop >/dev/null 2>&1 || true
    for process in "${started[@]}"; do
        kill "$process" 2>/dev/null || true
        wait "$process" 2>/dev/null || true
    done
    if [ -n "${KEEP:-}" ]; then echo "kept: $work"; else rm -rf "$work"; fi
}
trap finish EXIT

# shellcheck source=/dev/null
. "$top/tests/examples/real/checks.sh"

cd "$work"
hq server start --host 127.0.0.1 >server.log 2>&1 &
started+=($!)
within 20 hq server info
for number in 1 2; do
    hq worker start --cpus 2 --heartbeat 2s >"worker$number.log" 2>&1 &
    started+=($!)
done
has_two_workers() { (($(hq worker list --output-mode quiet | wc -l) == 2)); }
within 20 has_two_workers
sed -e "s/^initial = .*/initial = $EVALUATIONS/" -e "s/^max_evaluations = .*/max_evaluations = $EVALUATIONS/" \
    "$top/common/scenes/four-bar.toml" >scene.toml

jobs_now() { hq job list --filter waiting,running --output-mode quiet; }

began=$SECONDS
coordinator run scene.toml --levels reference --out scaled --workers 0 --scale hyperqueue --most "$MOST" \
    --idle 10s -v >scaled.out 2>scaled.log &
study=$!
within 120 has_first_result scaled
echo "first result after $((SECONDS - began)) s, from zero workers"
most_seen=0
while kill -0 "$study" 2>/dev/null; do
    now=$(jobs_now | wc -l)
    ((now > most_seen)) && most_seen=$now
    if [ -z "${cancelled:-}" ] && ((SECONDS - began > 10)); then
        cancelled=$now
        jobs_now | cut -d' ' -f1 | xargs --no-run-if-empty -n1 hq job cancel >/dev/null
        echo "all $cancelled jobs cancelled after $((SECONDS - began)) s"
    fi
    sleep 0.5
done
wait "$study" || fail "the study ended with an error: $(tail -n 3 scaled.log)"
ended=$SECONDS
echo "study of $EVALUATIONS evaluations: $((ended - began)) s"
no_job_is_left() { [ -z "$(jobs_now)" ]; }
within 60 no_job_is_left
echo "no job left $((SECONDS - ended)) s after the end; at most $most_seen jobs at once"
((most_seen <= MOST)) || fail "$most_seen jobs at once"
[ -n "${cancelled:-}" ] || fail "the study ended before its jobs were cancelled: set EVALUATIONS higher"
hq job summary --output-mode quiet

coordinator run scene.toml --quiet --levels reference --out alone --workers auto >/dev/null
have_same_bytes scaled alone
echo "ok: the bytes of a local study"
