#!/bin/bash
# The router zenohd between coordinator and workers: builds it if it is not installed (about ten minutes), then runs the tests
# that need it (tests/tests/router.rs) and the long fault of two killed routers.
#   tests/examples/real/zenohd.sh
# ZENOHD names another program than the one on PATH.
set -euo pipefail
cd "$(dirname "$0")/../../.."
version=1.10.2

: "${ZENOHD:=$(type -P zenohd || true)}"
if [ -z "$ZENOHD" ]; then
    root=${CARGO_TARGET_DIR:-$PWD/target}/zenohd
    cargo install zenohd --version "$version" --locked --root "$root"
    ZENOHD=$root/bin/zenohd
fi
export ZENOHD
printed=$("$ZENOHD" --version | tail -n 1)
echo "$printed"
[[ $printed == *v$version* ]] || echo "warning: the programs use Zenoh $version"

# Built first: the time limits of the tests would include it.
cargo build --release --workspace --bins --example faults
cargo test --release --workspace --no-run --test router
cargo test --release --workspace --test router -- --nocapture
"${CARGO_TARGET_DIR:-$PWD/target}/release/examples/faults" routers
