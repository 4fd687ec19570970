#!/bin/bash
# Starts a worker on each HOST over ssh, for a coordinator on this machine that listens on loopback:
#   coordinator run --workers 0 --listen tcp/127.0.0.1:7447
#   deploy/ssh-workers.sh 7447 host-1 host-2 user@host-3
# ssh encrypts the connection and authenticates both sides: neither certificates nor an open port are needed.
# WORKER is the program on the hosts (default: worker), OPTIONS its further options, e.g. OPTIONS="--slots 8".
# REMOTE_PORT is the forwarded port on the hosts, if PORT is in use there; SSH is the ssh program.
# Ctrl-C, or the end of the study, stops all workers: at the end of its standard input each host stops its worker.
set -euo pipefail
if [ $# -lt 2 ] || ! [[ $1 =~ ^[0-9]+$ ]] || [ "$1" -lt 1 ] || [ "$1" -gt 65535 ]; then
    echo "usage: ssh-workers.sh PORT HOST..." >&2
    exit 2
fi
port=$1
shift
: "${WORKER:=worker}" "${OPTIONS:=}" "${SSH:=ssh}" "${REMOTE_PORT:=$port}"

# On the host: the worker, and a reader of standard input; the end of either one stops the other.
remote="exec 3<&0
$WORKER --connect tcp/127.0.0.1:$REMOTE_PORT $OPTIONS </dev/null 3<&- & worker=\$!
{ cat <&3; kill -TERM \$worker; } >/dev/null 2>&1 & reader=\$!
wait \$worker; code=\$?; kill \$reader 2>/dev/null; exit \$code"

lines=$(mktemp -d)
trap 'rm -rf "$lines"' EXIT
workers=()
keepers=()
for host in "$@"; do
    # Standard input of each ssh is a pipe held open by this shell only.
    mkfifo "$lines/$host"
    (
        # A pipe also held open by another ssh would not end.
        for keeper in "${keepers[@]}"; do exec {keeper}>&-; done
        exec "$SSH" -T -o BatchMode=yes -o ExitOnForwardFailure=yes -o ServerAliveInterval=15 \
            -R "127.0.0.1:$REMOTE_PORT:127.0.0.1:$port" "$host" "$remote" <"$lines/$host"
    ) &
    workers+=($!)
    exec {keeper}>"$lines/$host"
    keepers+=("$keeper")
done
# shellcheck disable=SC2317 # the trap below calls it
stop() {
    for keeper in "${keepers[@]}"; do
        exec {keeper}>&-
    done
    keepers=()
}
trap stop INT TERM
failed=0
for k in "${!workers[@]}"; do
    code=0
    wait "${workers[$k]}" || code=$?
    # A signal ends the wait, not the worker, which is still stopping.
    if [ "$code" -eq 130 ] || [ "$code" -eq 143 ]; then
        code=0
        wait "${workers[$k]}" || code=$?
    fi
    if [ "$code" -ne 0 ]; then
        host=$((k + 1))
        echo "ssh-workers.sh: ${!host}: exit code $code" >&2
        failed=1
    fi
done
exit "$failed"
