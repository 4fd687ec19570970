#!/bin/bash
# Hingewise against solve_ivp(LSODA) with a numba right-hand side, on one life of a one-joint slider-crank. Prints the
# tables of coordinator/doc/validation/lsoda*.csv. Needs Python 3.11 with venv, the Rust toolchain and, once, a package index of Python.
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd ../../.. && pwd)
environment=${LSODA_ENVIRONMENT:-$root/target/lsoda-environment}
if [ ! -x "$environment/bin/python" ]; then
    python3 -m venv "$environment"
    "$environment/bin/pip" install --quiet numpy scipy numba >&2
fi
# One thread each.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
export PYTHONDONTWRITEBYTECODE=1 NUMBA_CACHE_DIR="$environment/compiled"
"$environment/bin/python" -c 'import numba, numpy, platform, scipy; print(
    f"Python {platform.python_version()}, SciPy {scipy.__version__}, numba {numba.__version__}, NumPy {numpy.__version__}\n")'
(cd "$root" && cargo build --quiet --release -p worker --example lsoda_hingewise)
exec "$environment/bin/python" compare.py "${CARGO_TARGET_DIR:-$root/target}/release/examples/lsoda_hingewise"
