"""Shapers, and commands through them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _quell
from ._arrays import columns_of
from ._result import bold, frame, table
from .errors import ShaperError
from .modes import Mode, ModesLike, given

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

__all__ = ["Shaper", "shape", "shapers"]


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
    modes : Mode, (float, float), sequence of these, or Identification
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
    modes : Mode, (float, float), sequence of these, or Identification
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
