#!/bin/bash
# Functions of the scripts here that run studies by a batch system; $work is the script's folder, with its logs.
set -euo pipefail
: "${work:?}"

fail() {
    echo "failed: $*" >&2
    tail -n 10 "$work"/*.log "$work"/job/*.log >&2 || true
    exit 1
}

# Waits until a command succeeds, at most so many seconds.
within() {
    local end=$((SECONDS + $1))
    shift
    until "$@" >/dev/null 2>&1; do
        ((SECONDS < end)) || fail "still not true: $*"
        sleep 0.2
    done
}

free_port() {
    local port
    while port=$((20000 + RANDOM % 10000)) && (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do :; done
    echo "$port"
}

# The study in folder $1 has a result.
has_first_result() {
    [ -n "$(python3 -c 'import sqlite3, sys
print(sqlite3.connect(f"file:{sys.argv[1]}/campaign.db?mode=ro", uri=True).execute("select 1 from evaluation limit 1").fetchone() or "")' "$1")" ]
}

# Two studies have the same curves and samples, but for worker, wall time, time of the end and level, the last columns of the samples.
have_same_bytes() {
    local file columns
    for file in reliability.csv samples.csv; do
        columns='s/$//'
        [ "$file" = samples.csv ] && columns='s/(,[^,]*){4}$//'
        cmp <(sed -E "$columns" "$1/$file") <(sed -E "$columns" "$2/$file") || fail "$file differs"
    done
}
