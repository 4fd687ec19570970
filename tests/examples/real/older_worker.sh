#!/bin/bash
# A worker of an earlier commit, with the same protocol but another digest of the simulation, against this coordinator: it is refused by
# name and gets no evaluation, and `--mixed-builds` admits it and records its build with each of its results.
#   tests/examples/real/older_worker.sh [COMMIT]
# Without COMMIT it is the last one of which these sources differ. It is built in a worktree and a target directory of its own, in the
# profile PROFILE (release): Cargo takes two checkouts in one target directory for one. OLDER_WORKER names one that was built before. The
# programs of this commit are those in the target directory.
set -euo pipefail
cd "$(dirname "$0")/../../.."
: "${PROFILE:=release}" "${CARGO_TARGET_DIR:=$PWD/target}"
export CARGO_TARGET_DIR
folder=$PROFILE
[ "$PROFILE" = dev ] && folder=debug

work=$(mktemp -d)
started=()
finish() {
    for process in "${started[@]}"; do
        kill "$process" 2>/dev/null || true
        wait "$process" 2>/dev/null || true
    done
    git worktree remove --force "$work/sources" 2>/dev/null || true
    rm -rf "$work"
}
trap finish EXIT

# shellcheck source=/dev/null
. tests/examples/real/checks.sh

protocol() {
    sed -n 's/^pub const PROTOCOL_VERSION: u16 = \(.*\);/\1/p'
}

# What the digest of the simulation is made of, see worker/build.rs, differs from that of a commit.
differs() {
    git diff --name-only "$1" -- worker/src common/src Cargo.lock | grep -qv 'tests\.rs$'
}

older=${1:-}
if [ -z "$older" ]; then
    for older in $(git log --format=%H -100); do
        if differs "$older"; then break; fi
    done
fi
differs "$older" || fail "the simulation of $older has the same sources"
[ "$(git show "$older:common/src/wire/mod.rs" | protocol)" = "$(protocol <common/src/wire/mod.rs)" ] ||
    fail "$older has another version of the protocol"
[ -n "${OLDER_WORKER:-}" ] || git show -s --format='older worker: %h of %cd, %s' "$older"

if [ -n "${OLDER_WORKER:-}" ]; then
    cp "$OLDER_WORKER" "$work/older-worker"
else
    git worktree add --quiet --detach "$work/sources" "$older"
    (cd "$work/sources" && CARGO_TARGET_DIR=$work/target cargo build --quiet --profile "$PROFILE" -p worker --bin worker)
    cp "$work/target/$folder/worker" "$work/older-worker"
    rm -rf "$work/target"
fi
PATH=$CARGO_TARGET_DIR/$folder:$PATH

study() {
    local out=$1
    shift
    coordinator run four-bar --initial 8 --max-evaluations 16 --seed 3 --out "$work/$out" --workers 0 \
        --listen "tcp/127.0.0.1:$port" "$@" >/dev/null 2>"$work/$out.log" &
    coordinator_process=$!
    started+=("$coordinator_process")
    within 20 grep -q 'waiting for workers' "$work/$out.log"
}

# Number of results whose worker has such a name.
results() {
    python3 -c 'import sqlite3, sys
print(sqlite3.connect(f"file:{sys.argv[1]}/campaign.db?mode=ro", uri=True).execute("select count(*) from evaluation where worker glob ?", [sys.argv[2]]).fetchone()[0])' "$work/$1" "$2"
}

# Refused: named at the coordinator, no evaluation, and it leaves after its idle time.
port=$(free_port)
study refused
"$work/older-worker" --connect "tcp/127.0.0.1:$port" --name older --slots 1 --idle-timeout 3 2>"$work/older.log" &
older_process=$!
started+=("$older_process")
within 20 grep -q 'worker older gets no evaluations: its program is build' "$work/refused.log"
grep 'gets no evaluations' "$work/refused.log"
code=0
wait "$older_process" || code=$?
echo "the older worker left with exit code $code: $(tail -n 1 "$work/older.log")"
[ "$(results refused '*')" = 0 ] || fail 'the older worker has evaluated'

# The coordinator goes on with a worker of its own build.
worker --connect "tcp/127.0.0.1:$port" --name own --slots 1 2>"$work/own.log" &
started+=($!)
wait "$coordinator_process" || fail 'the study did not end'
[ "$(results refused 'own/*')" = "$(results refused '*')" ] || fail 'not all results are by the own worker'
echo "then $(results refused '*') evaluations by the worker of this build, exit code 0"

# Admitted and recorded.
port=$(free_port)
study mixed --mixed-builds
"$work/older-worker" --connect "tcp/127.0.0.1:$port" --name older --slots 1 2>"$work/mixed-older.log" &
started+=($!)
wait "$coordinator_process" || fail 'the mixed study did not end'
[ "$(results mixed 'older/* (build *)')" = "$(results mixed '*')" ] || fail 'a result has no build'
echo "with --mixed-builds $(results mixed '*') evaluations by the older worker, each with its build"
