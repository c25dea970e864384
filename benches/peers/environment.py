"""One thread for everybody, and a virtual environment that holds the peers."""

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

SKIPPED = 77               # what a test runner takes for "skipped"
HERE = Path(__file__).resolve().parent
ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS")}


def skip(why):
    """Ends the run with a word."""
    print(f"skipped: {why}", file=sys.stderr)
    sys.exit(SKIPPED)


def enter():
    """Goes on in an interpreter that has the peers, made where there is none, with one thread a library."""
    there = all(importlib.util.find_spec(name) for name in ("numpy", "scipy", "pysindy", "sysidentpy"))
    if there and ONE_THREAD.items() <= os.environ.items():
        return
    if os.environ.get("QUELL_PEERS_ENTERED"):
        skip("the packages of requirements.txt do not load")
    python = sys.executable if there else made()
    os.execve(python, [python, *sys.argv], {**os.environ, **ONE_THREAD, "QUELL_PEERS_ENTERED": "1"})


def made():
    """The interpreter of the virtual environment, set up on the first run."""
    root = HERE.parent.parent / "target" / "peers"
    venv = Path(os.environ.get("QUELL_PEERS_VENV", root))
    python = venv / "bin" / "python"
    requirements = HERE / "requirements.txt"
    mark = venv / "installed"
    if mark.exists() and mark.read_text() == requirements.read_text():
        return str(python)
    steps = [
        ([sys.executable, "-m", "venv", str(venv)], f"python3 cannot make a virtual environment in {venv}"),
        ([str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r", str(requirements)],
         "the packages of requirements.txt cannot be installed"),
    ]
    for command, why in steps:
        if subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode != 0:
            skip(why)
    mark.write_text(requirements.read_text())
    return str(python)
