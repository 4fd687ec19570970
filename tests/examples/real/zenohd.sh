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

# Without --no-run first, the time limits of the tests would include the build.
cargo test --release -p tests -p coordinator -p worker --no-run
cargo test --release -p tests --test router -- --nocapture
cargo build --release -p tests
cargo run --release -p tests --example faults -- routers
