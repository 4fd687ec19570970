#!/bin/bash
# Hingewise's surrogate against scikit-learn's GaussianProcessRegressor on the same data. Prints the numbers of coordinator/doc/validation.md.
# Needs Python 3 with venv, the Rust toolchain and, once, a package index of Python.
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd ../../.. && pwd)
environment=${SCIKIT_ENVIRONMENT:-$root/target/scikit-environment}
if [ ! -x "$environment/bin/python" ]; then
    python3 -m venv "$environment"
    "$environment/bin/pip" install --quiet scikit-learn >&2
fi
export PYTHONDONTWRITEBYTECODE=1
(cd "$root" && cargo build --quiet --release -p coordinator --example surrogate_hingewise)
program=${CARGO_TARGET_DIR:-$root/target}/release/examples/surrogate_hingewise
"$environment/bin/python" compare.py "$program"
echo
echo "A million points in the cache, 11 variables, 72 checkpoints, 150 data:"
"$program" memory
