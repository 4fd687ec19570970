#!/bin/bash
# Starts a worker on each HOST by ssh, for a coordinator on this machine that listens on loopback alone:
#   coordinator run --workers 0 --listen tcp/127.0.0.1:7447
#   deploy/ssh-workers.sh 7447 host-1 host-2 user@host-3
# The line goes through ssh, which encrypts it and knows who is there: neither certificates nor an open port are needed.
# WORKER names the program on the hosts (default: worker), OPTIONS what else it is told, e.g. OPTIONS="--slots 8".
# REMOTE_PORT is the port on the hosts that leads here, if the same one is taken there; SSH is the ssh to use.
# Ctrl-C, or the end of the study, ends all of them: at the end of its input each host tells its worker to hand in.
set -euo pipefail
if [ $# -lt 2 ] || ! [[ $1 =~ ^[0-9]+$ ]] || [ "$1" -lt 1 ] || [ "$1" -gt 65535 ]; then
    echo "usage: ssh-workers.sh PORT HOST..." >&2
    exit 2
fi
port=$1
shift
: "${WORKER:=worker}" "${OPTIONS:=}" "${SSH:=ssh}" "${REMOTE_PORT:=$port}"

# On the host: the worker beside a reader of the line from here; whichever ends first ends the other.
remote="exec 3<&0
$WORKER --connect tcp/127.0.0.1:$REMOTE_PORT $OPTIONS </dev/null 3<&- & worker=\$!
{ cat <&3; kill -TERM \$worker; } >/dev/null 2>&1 & reader=\$!
wait \$worker; code=\$?; kill \$reader 2>/dev/null; exit \$code"

lines=$(mktemp -d)
trap 'rm -rf "$lines"' EXIT
workers=()
keepers=()
for host in "$@"; do
    # Standard input of each ssh is a pipe that this shell alone holds open.
    mkfifo "$lines/$host"
    (
        # A line that another ssh holds open too would not end.
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
    # A signal ends the wait, not the worker, which is on its way home.
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
