"""Jerk-limited moves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _quell
from ._result import table
from .errors import PlanError

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

__all__ = ["Limits", "Trajectory", "plan"]


@dataclass(frozen=True)
class Limits:
    """
    Limits of an axis.

    Parameters
    ----------
    velocity : float
        Largest velocity, rad/s or m/s.
    acceleration : float
        Largest acceleration, rad/s^2 or m/s^2.
    jerk : float
        Largest jerk, rad/s^3 or m/s^3.
    """

    velocity: float
    acceleration: float
    jerk: float


@dataclass(frozen=True, eq=False)
class Trajectory:
    """
    A planned move at the ticks of a controller.

    Parameters
    ----------
    duration : float
        From start to end, s.
    rate : float
        Ticks a second, Hz.
    position : ndarray
        Positions, shape (n,), or (n, axes); the last is the target.
    velocity : ndarray
        Velocities.
    acceleration : ndarray
        Accelerations.
    """

    duration: float
    rate: float
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]

    @property
    def time(self) -> NDArray[np.float64]:
        """Stamps, s, shape (n,)."""
        return np.arange(len(self.position)) / self.rate

    def to_dict(self) -> dict[str, Any]:
        """
        Give the move as plain numbers and lists.

        Returns
        -------
        dict
            Keys `duration_s`, `rate_hz`, `position`, `velocity` and `acceleration`.
        """
        return {
            "duration_s": self.duration,
            "rate_hz": self.rate,
            "position": self.position.tolist(),
            "velocity": self.velocity.tolist(),
            "acceleration": self.acceleration.tolist(),
        }

    def to_pandas(self) -> pandas.DataFrame:
        """
        Give the move as a data frame.

        Returns
        -------
        pandas.DataFrame
            Index `time_s`; columns `position`, `velocity` and `acceleration`, with `_1` and so on behind where
            there are several axes.
        """
        import pandas

        columns: dict[str, Any] = {}
        for name in ("position", "velocity", "acceleration"):
            values = getattr(self, name)
            if values.ndim == 1:
                columns[name] = values
            else:
                columns |= {f"{name}_{k + 1}": values[:, k] for k in range(values.shape[1])}
        index: Any = pandas.Index(self.time, name="time_s")
        return pandas.DataFrame(columns, index=index)

    def plot(self) -> Figure:
        """
        Draw position, velocity and acceleration over time.

        Returns
        -------
        matplotlib.figure.Figure
            Three axes.
        """
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots(3, 1, sharex=True, figsize=(8, 6), layout="constrained")
        for axis, name in zip(axes, ("position", "velocity", "acceleration")):
            axis.plot(self.time, getattr(self, name))
            axis.set_ylabel(name)
        axes[-1].set_xlabel("time / s")
        return figure

    def __repr__(self) -> str:
        return f"Trajectory({self.duration:.4f} s, {len(self.position)} samples at {self.rate:g} Hz)"

    def _repr_html_(self) -> str:
        peaks = [float(np.abs(one).max()) for one in (self.velocity, self.acceleration)]
        return table(["duration / s", "largest velocity", "largest acceleration"], [[self.duration, *peaks]])


def plan(
    start: ArrayLike,
    target: ArrayLike,
    limits: Union[Limits, Sequence[Limits]],
    *,
    rate: float,
    start_velocity: ArrayLike = 0.0,
    start_acceleration: ArrayLike = 0.0,
    target_velocity: ArrayLike = 0.0,
) -> Trajectory:
    """
    Plan the quickest jerk-limited move, all axes arriving together.

    Parameters
    ----------
    start : array_like
        Where the axes are: a number, or 1 to 7 of them.
    target : array_like
        Where they go.
    limits : Limits or sequence of Limits
        Limits of all axes, or of each.
    rate : float
        Ticks a second, Hz.
    start_velocity : array_like, default 0
        Velocities at the start.
    start_acceleration : array_like, default 0
        Accelerations at the start.
    target_velocity : array_like, default 0
        Velocities at the target.

    Returns
    -------
    Trajectory
        The move; arrays of shape (n,) where start and target are numbers, else (n, axes).

    Raises
    ------
    PlanError
        With the axis and the bad value.

    Examples
    --------
    >>> import quell
    >>> move = quell.plan(0.0, 1.0, quell.Limits(2.0, 8.0, 60.0), rate=250)
    >>> float(move.position[-1])
    1.0
    """
    if not (math.isfinite(rate) and rate > 0.0):
        raise PlanError(f"a rate of {rate} Hz is not a finite number above 0")
    given = [start, target, start_velocity, start_acceleration, target_velocity]
    try:
        arrays = np.broadcast_arrays(*(np.asarray(one, dtype=np.float64) for one in given))
    except ValueError as error:
        raise PlanError(f"start, target and velocities have not one shape: {error}") from error
    is_number = arrays[0].ndim == 0
    if arrays[0].ndim > 1:
        raise PlanError(f"start and target of shape {arrays[0].shape}; they are numbers or lists of them")
    p, q, v, a, w = (one.reshape(-1).tolist() for one in arrays)
    each = [limits] * len(p) if isinstance(limits, Limits) else list(limits)
    ends = [(one.velocity, one.acceleration, one.jerk) for one in each]
    to = [(position, velocity, 0.0) for position, velocity in zip(q, w)]
    duration, axes = _quell.plan(list(zip(p, v, a)), to, ends, float(rate))
    parts = [np.stack([axis[k] for axis in axes], axis=1) for k in range(3)]
    position, velocity, acceleration = (part[:, 0] if is_number else part for part in parts)
    return Trajectory(duration, float(rate), position, velocity, acceleration)
