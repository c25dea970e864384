"""The package as a whole: types, docstrings, examples in them, notebooks."""

from __future__ import annotations

import doctest
import importlib
import importlib.util
import inspect
import os
import pkgutil
import subprocess
import sys
from pathlib import Path

import jupytext
import nbclient
import nbformat
import pytest
import quell
from numpydoc.validate import validate

FOLDER = Path(__file__).parents[1]
NOTEBOOKS = sorted((FOLDER / "notebooks").glob("*.py"))
# Not asked for: a verb in the infinitive that pydocstyle guesses at, sections that not every function needs, a blank
# line before the summary; and of a class or a property, what its parameters say already.
LEFT = {"GL01", "GL02", "GL03", "ES01", "SA01", "EX01", "SA04", "RT03", "RT02"}


WITH_MUJOCO = importlib.util.find_spec("mujoco") is not None


def public() -> list[str]:
    names = []
    modules = [quell, importlib.import_module("quell.mujoco")] if WITH_MUJOCO else [quell]
    for module, name in ((module, name) for module in modules for name in module.__all__):
        thing = getattr(module, name)
        if callable(thing):
            names.append(f"{module.__name__}.{name}")
        if inspect.isclass(thing):
            own = [key for key, value in vars(thing).items() if not key.startswith("_") and callable(value)]
            names += [f"{module.__name__}.{name}.{key}" for key in own if inspect.getdoc(getattr(thing, key))]
    return names


def test_docstrings_are_numpydocs() -> None:
    wrong = [
        f"{name}: {code} {words}"
        for name in public()
        for code, words in validate(name)["errors"]
        if code not in LEFT
    ]
    assert not wrong, "\n".join(wrong)


def test_the_examples_in_docstrings_run() -> None:
    left = {"__main__"} if WITH_MUJOCO else {"__main__", "mujoco"}
    modules = [importlib.import_module(f"quell.{one.name}") for one in pkgutil.iter_modules(quell.__path__) if one.name not in left]
    results = [doctest.testmod(module) for module in modules if not module.__name__.endswith("_quell")]
    assert sum(result.failed for result in results) == 0 < sum(result.attempted for result in results)


def test_the_types_are_strict() -> None:
    command = [sys.executable, "-m", "pyright", "--project", str(FOLDER), "--pythonpath", sys.executable]
    checked = subprocess.run(command, capture_output=True, text=True)
    if "error" not in checked.stdout and "0 errors" not in checked.stdout:
        pytest.skip(f"pyright cannot be had: {checked.stderr[-300:]}")
    assert checked.returncode == 0, checked.stdout
    # And all that a user sees has a type; those of others are their own.
    command = [sys.executable, "-m", "pyright", "--verifytypes", "quell", "--ignoreexternal"]
    beside = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    verified = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "PATH": beside})
    assert "completeness score: 100%" in verified.stdout, verified.stdout


def test_without_mujoco_a_sentence_says_what_to_install() -> None:
    lines = "import sys; sys.modules['mujoco'] = None\nimport quell\ntry: import quell.mujoco\nexcept ImportError as e: print(e)"
    told = subprocess.run([sys.executable, "-c", lines], capture_output=True, text=True)
    assert "pip install" in told.stdout, told.stderr


@pytest.mark.parametrize("script", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_its_script_and_runs(script: Path, tmp_path: Path) -> None:
    if "quell.mujoco" in script.read_text() and not WITH_MUJOCO:
        pytest.skip("MuJoCo is not installed: the notebook is skipped")
    made = jupytext.read(script)
    file = script.with_suffix(".ipynb")
    # Cells have names by chance, which say nothing.
    for number, cell in enumerate(made.cells):
        cell["id"] = f"cell-{number}"
    text = nbformat.writes(made) + "\n"
    if os.environ.get("QUELL_UPDATE"):
        file.write_text(text)
    assert file.read_text() == text, f"{file} is stale: QUELL_UPDATE=1 writes it"
    client = nbclient.NotebookClient(made, timeout=None, resources={"metadata": {"path": str(tmp_path)}})
    client.execute()
