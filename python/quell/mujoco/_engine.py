"""MuJoCo, and models in whatever form they are given."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from ..errors import ModelError

__all__ = ["model_of", "mujoco", "spec_of"]


def _engine() -> Any:
    try:
        return importlib.import_module("mujoco")
    except ModuleNotFoundError as error:
        message = "quell.mujoco needs MuJoCo: pip install 'mujoco>=4' (or 'quell[mujoco]')"
        raise ImportError(message, name=error.name) from error


# The stubs of MuJoCo are not complete, and a checker may not have them.
mujoco: Any = _engine()


def spec_of(mjcf: Any) -> Any:
    """A specification that may be changed, of a file, a text or another specification."""
    try:
        if isinstance(mjcf, mujoco.MjSpec):
            return mjcf.copy()
        if isinstance(mjcf, Path) or (isinstance(mjcf, str) and "<" not in mjcf):
            return mujoco.MjSpec.from_file(str(mjcf))
        if isinstance(mjcf, str):
            return mujoco.MjSpec.from_string(mjcf)
    except ValueError as error:
        raise ModelError(f"MuJoCo cannot read the model: {error}") from error
    message = f"an MJCF is a path, its text or a mujoco.MjSpec, and not {type(mjcf).__name__}"
    if isinstance(mjcf, mujoco.MjModel):
        message = "a compiled mujoco.MjModel has no MJCF to patch: give the file, its text or a mujoco.MjSpec"
    raise ModelError(message)


def model_of(mjcf: Any) -> Any:
    """A compiled model."""
    if isinstance(mjcf, mujoco.MjModel):
        return mjcf
    try:
        return spec_of(mjcf).compile()
    except ValueError as error:
        raise ModelError(f"MuJoCo cannot compile the model: {error}") from error
