"""The filter at the tick of a controller."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _quell
from ._arrays import columns_of
from ._result import build
from .errors import ShaperError
from .modes import Mode, given
from .shaping import Shaper

if TYPE_CHECKING:
    from .motion import Limits

__all__ = ["AdaptiveFilter", "Retuned", "Setpoint"]

# Ticks that a filter holds at most: 1.2 GB.
MOST_TICKS = 10_000_000


class Setpoint(NamedTuple):
    """
    Position, velocity and acceleration at one tick.

    Parameters
    ----------
    position : float
        Position, rad or m.
    velocity : float
        Velocity, rad/s or m/s.
    acceleration : float
        Acceleration, rad/s^2 or m/s^2.
    """

    position: float
    velocity: float
    acceleration: float


@dataclass(frozen=True)
class Retuned:
    """
    What came of a change of the shaper in motion.

    Parameters
    ----------
    outcome : {"installed", "corrected", "refused"}
        At rest the shaper is in force at once; in motion the command goes on with a correction; or nothing was
        changed.
    reason : str
        Why it was refused.
    cross_fade_s : float
        Length of the cross-fade from one shaper to the other, s.
    correction_s : float
        Length of the correction, s.
    until_rest_s : float
        From now to the end of the whole command, s.
    peak_over_limit : float
        Largest velocity, acceleration or jerk from now on over its limit.
    """

    outcome: Literal["installed", "corrected", "refused"]
    reason: str = ""
    cross_fade_s: float = 0.0
    correction_s: float = 0.0
    until_rest_s: float = 0.0
    peak_over_limit: float = 0.0


class AdaptiveFilter:
    """
    A shaper at the tick of a controller, which can be changed in motion.

    It starts at rest at position 0 and changes nothing until a shaper is installed.

    Parameters
    ----------
    rate : float
        Ticks a second, Hz.
    longest_train : float, default 2
        The longest shaper that it can take, s.
    horizon : float, default 20
        The past that it remembers, and the future that a change can look ahead, s: at least the longest move
        with its shaper.

    Examples
    --------
    >>> import quell
    >>> filter = quell.AdaptiveFilter(rate=250)
    >>> filter.install(quell.Shaper("zv", (8.0, 0.05), rate=250))
    >>> filter.step(1.0).position < 1.0
    True
    """

    def __init__(self, rate: float, *, longest_train: float = 2.0, horizon: float = 20.0) -> None:
        for name, value in [("rate", rate), ("longest_train", longest_train), ("horizon", horizon)]:
            if not (math.isfinite(value) and value > 0.0):
                raise ShaperError(f"{name}: {value} is not a finite number above 0")
            if value * (1.0 if name == "rate" else rate) > MOST_TICKS:
                raise ShaperError(f"{name}: {value} at {rate} Hz is more than {MOST_TICKS} ticks")
        ticks = [math.ceil(seconds * rate) for seconds in (longest_train, horizon)]
        self._rate = float(rate)
        self._inner = _quell.AdaptiveFilter(self._rate, *ticks)

    def __repr__(self) -> str:
        return f"AdaptiveFilter(rate={self._rate:g})"

    def step(self, position: float, velocity: float = 0.0, acceleration: float = 0.0) -> Setpoint:
        """
        Make one tick.

        Parameters
        ----------
        position : float
            Planned position.
        velocity : float, default 0
            Planned velocity.
        acceleration : float, default 0
            Planned acceleration.

        Returns
        -------
        Setpoint
            What is to be sent.

        Raises
        ------
        ShaperError
            Where a value is not finite; the filter stays as it was.
        """
        for name, value in (("position", position), ("velocity", velocity), ("acceleration", acceleration)):
            if not math.isfinite(value):
                raise ShaperError(f"{name}: {value} is not a finite number")
        return Setpoint(*self._inner.step(position, velocity, acceleration))

    def apply(
        self,
        position: ArrayLike,
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """
        Make a tick for each element of arrays.

        Parameters
        ----------
        position : array_like
            Planned positions, shape (n,).
        velocity : array_like, optional
            Planned velocities, shape (n,); 0 by default.
        acceleration : array_like, optional
            Planned accelerations, shape (n,); 0 by default.

        Returns
        -------
        ndarray
            Positions, velocities and accelerations to be sent, shape (n, 3).

        Raises
        ------
        ShaperError
            Where a value is not finite.
        """
        planned = _planned(position, velocity, acceleration)
        return np.stack(self._inner.apply(planned), axis=1)

    def install(self, shaper: Shaper) -> None:
        """
        Install a shaper, which takes effect as soon as the command is at rest.

        Parameters
        ----------
        shaper : Shaper
            The shaper, designed for the same rate.

        Raises
        ------
        ShaperError
            Where it is for another rate, or too long.
        """
        self._inner.install(shaper._inner)

    def retune(
        self,
        shaper: Shaper,
        limits: Limits,
        position: ArrayLike,
        velocity: ArrayLike,
        acceleration: ArrayLike,
        *,
        dead_band: float = 0.01,
        resolution: float = 0.0,
    ) -> Retuned:
        """
        Go over to another shaper in motion, and take away what the wrong one has left.

        Parameters
        ----------
        shaper : Shaper
            The new shaper; its modes, 1 to 3, are those whose vibration is cancelled.
        limits : Limits
            Limits that nothing sent exceeds.
        position : array_like
            Planned positions of the rest of the move, from the next tick on, shape (n,).
        velocity : array_like
            Planned velocities, shape (n,).
        acceleration : array_like
            Planned accelerations, shape (n,).
        dead_band : float, default 0.01
            Gain below which nothing is changed, as a share of the vibration of the planned command.
        resolution : float, default 0
            Amplitude of a vibration that cannot be told from none, in the unit of the position.

        Returns
        -------
        Retuned
            What came of it.

        Raises
        ------
        ShaperError
            Where a value is not finite.
        """
        planned = _planned(position, velocity, acceleration)
        ends = (limits.velocity, limits.acceleration, limits.jerk)
        inner = shaper._inner
        judged = (dead_band, resolution)
        told = self._inner.retune(inner, given(shaper.modes), ends, planned, judged)
        return build(Retuned, json.loads(told))

    def reset(self, position: float = 0.0) -> None:
        """
        Put it to rest.

        Parameters
        ----------
        position : float, default 0
            Where.
        """
        self._inner.reset(position)

    @property
    def is_settled(self) -> bool:
        """Whether what is sent is constant."""
        return self._inner.is_settled

    def residual(self, mode: Mode | tuple[float, float]) -> tuple[float, float] | None:
        """
        Tell the vibration that is left of a mode now.

        Parameters
        ----------
        mode : Mode or (float, float)
            Frequency, Hz, and damping ratio.

        Returns
        -------
        tuple of float or None
            Amplitude left by what was sent, and by what was planned, in the unit of the position; None where the
            start of the move is forgotten.
        """
        hertz, damping, _, _ = given(mode)[0]
        return self._inner.residual(hertz, damping)


def _planned(
    position: ArrayLike, velocity: ArrayLike | None, acceleration: ArrayLike | None
) -> list[NDArray[np.float64]]:
    """Three arrays of one length."""
    columns = columns_of("position", np.asarray(position, dtype=np.float64).reshape(-1))
    for name, values in [("velocity", velocity), ("acceleration", acceleration)]:
        if values is None:
            columns.append(np.zeros_like(columns[0]))
            continue
        columns += columns_of(name, np.asarray(values, dtype=np.float64).reshape(-1))
        if len(columns[-1]) != len(columns[0]):
            raise ShaperError(f"{name}: {len(columns[-1])} values, and {len(columns[0])} positions")
    return columns
