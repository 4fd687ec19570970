#!/bin/bash
# The image of deploy/Containerfile without a container engine: a root file system of the same Debian release, made by
# debootstrap, in which the instructions of the second stage are carried out with the programs built here. A small study then
# runs in it by chroot, as the user of the image, and is compared with the same study outside, byte by byte.
#   tests/examples/real/rootfs.sh [FOLDER OF THE PROGRAMS]
# Needs root, debootstrap and a Debian mirror; two minutes. Exit code 77 if something is missing. ROOTFS names a tree made before
# by debootstrap, which is copied.
set -euo pipefail
top=$(realpath "$(dirname "$0")/../../..")
programs=$(realpath "${1:-$top/target/release}")
: "${MIRROR:=http://deb.debian.org/debian}" "${ROOTFS:=}"

skip() {
    echo "not run: $*" >&2
    exit 77
}
[ "$(id -u)" -eq 0 ] || skip "chroot needs root"
type -P debootstrap >/dev/null || [ -n "$ROOTFS" ] || skip "debootstrap is not installed"

work=$(mktemp -d)
chmod 755 "$work"
root=$work/root
started=()
finish() {
    for process in "${started[@]}"; do
        kill "$process" 2>/dev/null || true
        wait "$process" 2>/dev/null || true
    done
    rm -rf "$work"
}
trap finish EXIT
fail() {
    echo "failed: $*" >&2
    tail -n 20 "$work"/*.log >&2 || true
    exit 1
}

# The second stage, one instruction a line.
stage=$(sed -e ':a' -e '/\\$/N; s/\\\n//; ta' "$top/deploy/Containerfile" | awk '/^FROM/ { n++ } n == 2')
release=$(sed -nE 's/^FROM .*debian:([a-z]+)-slim$/\1/p' <<<"$stage")
[ -n "$release" ] || fail "the base image of the second stage is not debian:RELEASE-slim"
if [ -n "$ROOTFS" ]; then
    cp -a "$ROOTFS" "$root"
else
    debootstrap --variant=minbase "$release" "$root" "$MIRROR" >"$work/debootstrap.log" 2>&1 || fail "debootstrap"
fi

user=root folder=/
while read -r instruction arguments; do
    case $instruction in
    FROM | VOLUME | CMD | "") ;;
    RUN) chroot "$root" /bin/sh -euc "$arguments" || fail "RUN $arguments" ;;
    COPY)
        read -ra words <<<"${arguments#--from=build }"
        target=$root${words[-1]}
        for source in "${words[@]:0:${#words[@]}-1}"; do
            # As the first stage leaves them in /source.
            local=${source/#\/source\/target\/release/$programs}
            install -D "${local/#\/source/$top}" "${target%/}$([[ $target == */ ]] && echo "/${source##*/}")"
        done
        ;;
    USER) user=$arguments ;;
    WORKDIR) folder=$arguments ;;
    *) fail "the Containerfile has a new instruction: $instruction" ;;
    esac
done <<<"$stage"

# What a container engine gives every container: /dev/null and its like, and a loopback network (here that of the machine).
for device in "null 1 3" "zero 1 5" "urandom 1 9"; do
    read -r name major minor <<<"$device"
    [ -e "$root/dev/$name" ] || mknod -m 666 "$root/dev/$name" c "$major" "$minor"
done
in_image() {
    # shellcheck disable=SC2016 # expanded in the image
    chroot --userspec="$user:$user" "$root" /bin/sh -euc 'cd "$1"; shift; exec "$@"' sh "$folder" "$@"
}
in_image coordinator --version
in_image worker --version
[ "$(in_image id -u)" -ne 0 ] || fail "the image runs as root"
! in_image touch /usr/local/bin/file 2>/dev/null || fail "its user can write outside of $folder"

# The services of the Compose file: a coordinator that listens, and a worker.
sed -e 's/^initial = .*/initial = 16/' -e 's/^max_evaluations = .*/max_evaluations = 24/' \
    "$top/common/scenes/four-bar.toml" >"$work/scene.toml"
install -m 644 "$work/scene.toml" "$root$folder/scene.toml"
in_image coordinator run --scene scene.toml --out study --workers 0 >"$work/coordinator.log" 2>&1 &
started+=($!)
coordinator=$!
endpoint=
for _ in $(seq 300); do
    endpoint=$(sed -nE 's/^waiting for workers: worker --connect ([^ ]+).*/\1/p' "$work/coordinator.log")
    [ -n "$endpoint" ] && break
    sleep 0.1
done
[ -n "$endpoint" ] || fail "the coordinator does not listen"
in_image worker --connect "$endpoint" >"$work/worker.log" 2>&1 &
started+=($!)
worker=$!
wait "$coordinator" || fail "the coordinator"
wait "$worker" || fail "the worker"
started=()

"$programs/coordinator" run --quiet --scene "$work/scene.toml" --out "$work/alone" --workers 1 >/dev/null 2>"$work/alone.log" ||
    fail "the study outside"
cmp "$root$folder/study/reliability.csv" "$work/alone/reliability.csv" || fail "another answer"
owner=$(stat --format %U:%u "$root$folder/study/campaign.db")
echo "ok: a study in Debian $release as user $user ($owner for the machine), $(du -sh --apparent-size "$root" | cut -f 1)"
