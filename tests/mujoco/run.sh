#!/bin/sh
# Generates concealed cases with MuJoCo: run.sh OUT [--cases 60] [--seed 1]; or run.sh --check.
# Sets up a virtual environment beside this script (or in QUELL_MUJOCO_VENV); exits 77 (skipped) where it cannot.
here=$(cd "${0%/*}" && pwd)
venv=${QUELL_MUJOCO_VENV:-$here/.venv}
skip() { echo "skipped: $1" >&2; exit 77; }

command -v python3 >/dev/null 2>&1 || skip "no python3 on this machine"
if ! "$venv/bin/python" -c "import mujoco, numpy, scipy" >/dev/null 2>&1; then
    python3 -m venv "$venv" >/dev/null 2>&1 || skip "python3 cannot make a virtual environment in $venv"
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check -r "$here/requirements.txt" >"$venv/pip.log" 2>&1 ||
        skip "the packages of requirements.txt cannot be installed (see $venv/pip.log)"
    "$venv/bin/python" -c "import mujoco, numpy, scipy" >/dev/null 2>&1 || skip "mujoco does not load on this machine"
fi
# One thread: the matrices are tiny.
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
[ "$1" = "--check" ] && exec "$venv/bin/python" "$here/check.py"
exec "$venv/bin/python" "$here/generate.py" "$@"
