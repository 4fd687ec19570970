#!/bin/bash
# Cost of a task in Dask without its work: a virtual environment with `distributed` from PyPI, a scheduler and one worker in
# separate processes, an empty function. Needs python3 and the network at the first run.
set -euo pipefail
cd "$(dirname "$0")"
environment=${CARGO_TARGET_DIR:-../../../target}/dask
if ! "$environment/bin/python" -c 'import distributed' 2>/dev/null; then
    python3 -m venv "$environment"
    "$environment/bin/pip" install -q distributed==2025.7.0
fi
"$environment/bin/python" overhead.py
