#!/bin/bash
# Cost of a task without its work, in one run: this farm (`overhead`), Dask and HyperQueue, each with a scheduler and one worker.
# The latter two come from PyPI into a virtual environment. Needs python3 and, at the first run, the network.
set -euo pipefail
cd "$(dirname "$0")/../../.."
target=$(realpath "${CARGO_TARGET_DIR:-target}")
environment=$target/peers
if ! "$environment/bin/python" -c 'import distributed, hyperqueue' 2>/dev/null; then
    python3 -m venv "$environment"
    "$environment/bin/pip" install -q distributed==2026.8.0 hyperqueue==0.27.0
fi
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
cargo run --release -p tests --example overhead "$folder"
"$environment/bin/python" tests/examples/peers/overhead.py
