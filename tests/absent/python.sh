#!/bin/sh
# Runs a Python script with the packages that it needs: python.sh REQUIREMENTS SCRIPT [ARGUMENTS]; without SCRIPT the
# packages are installed, no more. All are in one virtual environment: QUELL_PYTHON_VENV, or python/ in the folder of the
# build. Exits 77 (skipped) where they cannot be installed.
venv=${QUELL_PYTHON_VENV:-${CARGO_TARGET_DIR:-$(cd "${0%/*}/../.." && pwd)/target}/python}
skip() { echo "$1" >&2; exit 77; }

packages=$1
shift
[ -f "$packages" ] || { echo "there is no $packages" >&2; exit 2; }
command -v python3 >/dev/null 2>&1 || skip "there is no python3"
mkdir -p "$venv"
# Tests that run side by side install one after the other, where the system has the means.
if command -v flock >/dev/null 2>&1; then
    exec 9>"$venv.lock"
    flock 9
fi
# A list that was changed is installed again.
installed=$venv/$(cksum <"$packages" | tr ' ' -).installed
if [ ! -e "$installed" ]; then
    python3 -m venv "$venv" >/dev/null 2>&1 || skip "python3 cannot make a virtual environment in $venv"
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --retries 1 -r "$packages" \
        >"$venv/pip.log" 2>&1 || skip "the packages of $packages cannot be installed (see $venv/pip.log)"
    touch "$installed"
fi
exec 9>&-
[ "$#" -eq 0 ] && exit
# One of the packages looks for git when it is loaded, and has no need of it here. One thread: matrices are small.
export GIT_PYTHON_REFRESH=quiet OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
exec "$venv/bin/python" -B "$@"
