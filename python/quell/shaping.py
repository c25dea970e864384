"""Shapers, and commands through them."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _quell
from ._arrays import columns_of
from ._result import Result, bold, build, frame, table
from .errors import ShaperError
from .modes import Mode, ModesLike, given

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

    from .motion import Limits

__all__ = [
    "AdaptiveFilter",
    "Recommendation",
    "Retuned",
    "Setpoint",
    "ShaperFigures",
    "Shaper",
    "recommend",
    "shape",
    "shapers",
]

# Ticks that a filter holds at most: 1.2 GB.
MOST_TICKS = 10_000_000


def shapers() -> dict[str, str]:
    """
    List the shapers.

    Returns
    -------
    dict of str to str
        What each does, by name.
    """
    return {name: summary for name, _, summary in _quell.shapers()}


class Shaper:
    """
    A train of impulses for one or more modes, on the grid of a controller.

    Parameters
    ----------
    name : str
        One of `quell.shapers()`.
    modes : Mode, (float, float) or sequence of these
        The modes: frequency, Hz, and damping ratio. `optimal` is solved for how well they are known.
    rate : float
        Rate of the controller, Hz.

    Raises
    ------
    ShaperError
        Where there is no such shaper, or it cannot be designed for a mode.

    Examples
    --------
    >>> import quell
    >>> zvd = quell.Shaper("zvd", (8.0, 0.05), rate=250)
    >>> round(float(zvd.taps[:, 1].sum()), 12)
    1.0
    """

    def __init__(self, name: str, modes: ModesLike, rate: float) -> None:
        if not (math.isfinite(rate) and rate > 0.0):
            raise ShaperError(f"a rate of {rate} Hz is not a finite number above 0")
        self._modes = [Mode(*numbers) for numbers in given(modes)]
        self._rate = float(rate)
        self._inner = _quell.Shaper(name, given(modes), self._rate)

    @property
    def name(self) -> str:
        """Its name in the table of shapers."""
        return self._inner.name

    @property
    def rate(self) -> float:
        """Rate of the controller, Hz."""
        return self._rate

    @property
    def modes(self) -> tuple[Mode, ...]:
        """The modes that it is for."""
        return tuple(self._modes)

    @property
    def impulses(self) -> NDArray[np.float64]:
        """Instants, s, and amplitudes of the exact impulses, shape (n, 2)."""
        return np.array(self._inner.impulses(), dtype=np.float64)

    @property
    def taps(self) -> NDArray[np.float64]:
        """Instants, s, and amplitudes on the controller's grid, shape (n, 2)."""
        taps = np.array(self._inner.taps(), dtype=np.float64)
        taps[:, 0] /= self._rate
        return taps

    @property
    def duration(self) -> float:
        """Delay that it adds to the end of a move, s."""
        return self._inner.duration

    @property
    def gain(self) -> float:
        """Sum of the amplitudes' magnitudes: 1 where no limit of a move can be exceeded by shaping."""
        return self._inner.gain

    def residual(self, frequency_hz: ArrayLike, damping_ratio: float | None = None) -> NDArray[np.float64]:
        """
        Tell how much vibration is left at frequencies, as a share of the unshaped.

        Parameters
        ----------
        frequency_hz : array_like
            Natural frequencies, Hz.
        damping_ratio : float, optional
            Damping ratio; that of the first mode by default.

        Returns
        -------
        ndarray
            Residual vibration of the taps, 0 to 1 and above, in the shape of the frequencies.
        """
        damping = self._modes[0].damping_ratio if damping_ratio is None else damping_ratio
        hertz = np.asarray(frequency_hz, dtype=np.float64)
        left = self._inner.residual(np.ascontiguousarray(hertz.reshape(-1)), damping)
        return left.reshape(hertz.shape)

    def band(self, tolerance: float = 0.05) -> tuple[float, float] | None:
        """
        Tell the band around the first mode within which little vibration is left.

        Parameters
        ----------
        tolerance : float, default 0.05
            Residual vibration that is little.

        Returns
        -------
        tuple of float or None
            From and to, Hz; None where it is more even at the mode.
        """
        first = self._modes[0]
        return self._inner.band(first.frequency_hz, first.damping_ratio, tolerance)

    def apply(self, command: ArrayLike) -> NDArray[np.float64]:
        """
        Shape a whole command, from rest at its first value until it has come to its end.

        A contiguous array of one axis, of 64-bit floats, is read where it is.

        Parameters
        ----------
        command : array_like
            Positions at the controller's rate, shape (n,), or (n, axes).

        Returns
        -------
        ndarray
            The shaped command, `duration * rate` samples longer at most.

        Raises
        ------
        ShaperError
            Where a value is not finite, or there is none.
        """
        array = np.asarray(command, dtype=np.float64)
        columns = columns_of("command", array)
        shaped = self._inner.apply(columns)
        return shaped[0] if array.ndim == 1 else np.stack(shaped, axis=1)

    def __repr__(self) -> str:
        modes = ", ".join(f"{m.frequency_hz:g} Hz, {m.damping_ratio:g}" for m in self._modes)
        return f"Shaper({self.name} for {modes}: {self.duration:.4f} s)"

    def _repr_html_(self) -> str:
        return bold(self.name) + table(["tap / s", "amplitude"], self.taps.tolist())

    def to_dict(self) -> dict[str, Any]:
        """
        Give name, rate, impulses and taps as a dictionary.

        Returns
        -------
        dict
            Plain numbers and lists.
        """
        return {
            "shaper": self.name,
            "rate_hz": self.rate,
            "modes": [[mode.frequency_hz, mode.damping_ratio] for mode in self._modes],
            "impulses": self.impulses.tolist(),
            "taps": self.taps.tolist(),
            "duration_s": self.duration,
            "gain": self.gain,
        }

    def to_pandas(self) -> pandas.DataFrame:
        """
        Give the taps as a data frame.

        Returns
        -------
        pandas.DataFrame
            Columns `time_s` and `amplitude`.
        """
        rows = [{"time_s": time, "amplitude": amplitude} for time, amplitude in self.taps]
        return frame(rows, ["time_s", "amplitude"])

    def plot(self, ax: Axes | None = None) -> Axes:
        """
        Draw the vibration that is left over the frequency.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; a new figure by default.

        Returns
        -------
        matplotlib.axes.Axes
            Where it was drawn.
        """
        import matplotlib.pyplot as plt

        axes = ax if ax is not None else plt.subplots()[1]
        lowest = min(mode.frequency_hz for mode in self._modes)
        highest = max(mode.frequency_hz for mode in self._modes)
        hertz = np.linspace(0.5 * lowest, 1.5 * highest, 400)
        axes.plot(hertz, 100.0 * self.residual(hertz), label=self.name)
        for mode in self._modes:
            axes.axvline(mode.frequency_hz, color="gray", linewidth=0.5)
        axes.set_xlabel("natural frequency / Hz")
        axes.set_ylabel("vibration left / %")
        axes.legend()
        return axes


def shape(
    command: ArrayLike, modes: ModesLike, *, rate: float, shaper: str = "zvd"
) -> NDArray[np.float64]:
    """
    Shape a whole command so that it leaves no vibration of the modes.

    Parameters
    ----------
    command : array_like
        Positions, shape (n,), or (n, axes); it starts at rest.
    modes : Mode, (float, float) or sequence of these
        The modes: frequency, Hz, and damping ratio.
    rate : float
        Samples a second, Hz.
    shaper : str, default "zvd"
        One of `quell.shapers()`.

    Returns
    -------
    ndarray
        The shaped command, longer by the shaper's duration.

    Raises
    ------
    ShaperError
        As `Shaper` and `Shaper.apply`.

    See Also
    --------
    Shaper : The train itself.
    recommend : Which shaper to take.

    Examples
    --------
    >>> import numpy as np, quell
    >>> shaped = quell.shape(np.ones(10), (8.0, 0.05), rate=250)
    >>> bool(np.all(shaped == 1.0))
    True
    """
    return Shaper(shaper, modes, rate).apply(command)


@dataclass(frozen=True)
class ShaperFigures:
    """
    A shaper's figures for modes that are known only so well.

    Parameters
    ----------
    shaper : str
        Its name.
    delay_s : float
        Delay that it adds, s.
    residual : float
        Vibration left at the estimate, as a share of the unshaped.
    residual_mean : float
        The mean over the uncertainty.
    residual_95 : float
        What 95 % of the uncertainty stays below.
    eligible : bool
        Whether it may be taken.
    """

    shaper: str
    delay_s: float
    residual: float
    residual_mean: float
    residual_95: float
    eligible: bool


@dataclass(frozen=True, eq=False)
class Recommendation(Result):
    """
    Which shaper to take.

    Parameters
    ----------
    document : dict
        All of it, as `to_dict` gives it.
    best : ShaperFigures
        The one to take.
    candidates : tuple of ShaperFigures
        All of them.
    """

    best: ShaperFigures
    candidates: tuple[ShaperFigures, ...]

    def to_pandas(self) -> pandas.DataFrame:
        """
        Give all shapers as a data frame.

        Returns
        -------
        pandas.DataFrame
            A row for each.
        """
        return frame(self.document["candidates"], list(self.document["best"]))

    def _repr_html_(self) -> str:
        rows = [list(one.values()) for one in self.document["candidates"]]
        return bold(self.best.shaper) + table(list(self.document["best"]), rows)


def recommend(
    modes: ModesLike,
    *,
    acceptable: float = 0.05,
    longest_delay: float = math.inf,
    allow_negative: bool = False,
) -> Recommendation:
    """
    Recommend a shaper for modes that are known only so well.

    It is the shortest that leaves no more than is acceptable for 95 % of the uncertainty; where none does, the
    one that leaves least.

    Parameters
    ----------
    modes : Mode, (float, float) or sequence of these
        The modes with their standard deviations.
    acceptable : float, default 0.05
        Residual vibration that is small enough, as a share of the unshaped.
    longest_delay : float, default inf
        The longest delay, s.
    allow_negative : bool, default False
        Whether negative impulses are allowed, which can exceed the limits of a move.

    Returns
    -------
    Recommendation
        The shaper, and the figures of all.

    Raises
    ------
    ShaperError
        Where none is short enough.
    """
    told = _quell.recommend(given(modes), longest_delay, acceptable, allow_negative)
    document = json.loads(told)
    for one in [document["best"], *document["candidates"]]:
        one.update({key: math.nan for key, value in one.items() if value is None})
    return build(Recommendation, document, document=document)


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
        self._inner = _quell.AdaptiveFilter(float(rate), *ticks)

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
        """
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
