"""Simulated robots."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _quell
from ._arrays import columns_of
from ._result import table
from .errors import SimulationError
from .model import Model
from .modes import Mode
from .recording import Recording

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

__all__ = ["SimulatedMove", "simulate_robot"]


@dataclass(frozen=True, eq=False)
class SimulatedMove:
    """
    A robot's joint that followed a command.

    Parameters
    ----------
    recording : Recording
        What its sensors saw: command, encoder and tip, each on its own clock, with their noise.
    model : Model
        What is believed of the joint: a `flexible_joint` with its first mode, without the payload.
    modes : tuple of Mode
        The true modes, with the payload.
    time : ndarray
        Ticks of the command, s, shape (n,).
    tip_deformation : ndarray
        True deformation at the tip, m, shape (n,).
    """

    recording: Recording
    model: Model
    modes: tuple[Mode, ...]
    time: NDArray[np.float64]
    tip_deformation: NDArray[np.float64]

    def __repr__(self) -> str:
        peak = 1e3 * float(np.abs(self.tip_deformation).max())
        return f"SimulatedMove({float(self.time[-1]):.4g} s, largest deformation at the tip {peak:.4g} mm, {self.recording!r})"

    def to_dict(self) -> dict[str, Any]:
        """
        Give the true modes and deformation as plain numbers and lists.

        Returns
        -------
        dict
            Keys `modes`, `time_s` and `tip_deformation_m`.
        """
        return {
            "modes": [[mode.frequency_hz, mode.damping_ratio] for mode in self.modes],
            "time_s": self.time.tolist(),
            "tip_deformation_m": self.tip_deformation.tolist(),
        }

    def to_pandas(self) -> pandas.DataFrame:
        """
        Give the true deformation as a data frame.

        Returns
        -------
        pandas.DataFrame
            Index `time_s`; column `tip_deformation_m`.
        """
        import pandas

        index: Any = pandas.Index(self.time, name="time_s")
        return pandas.DataFrame({"tip_deformation_m": self.tip_deformation}, index=index)

    def _repr_html_(self) -> str:
        peak = 1e3 * float(np.abs(self.tip_deformation).max())
        return table(["duration / s", "largest deformation at the tip / mm"], [[float(self.time[-1]), peak]])

    def plot(self, ax: Axes | None = None) -> Axes:
        """
        Draw the true deformation at the tip over time.

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
        axes.plot(self.time, 1e3 * self.tip_deformation)
        axes.set_xlabel("time / s")
        axes.set_ylabel("deformation at the tip / mm")
        return axes


def simulate_robot(
    position: ArrayLike,
    *,
    rate: float,
    velocity: ArrayLike | None = None,
    robot: str | Path | None = None,
    joint: int | None = None,
    payload: float = 0.0,
    noise_std: float | None = None,
    seed: int = 1,
) -> SimulatedMove:
    """
    Simulate a robot's joint that follows a command, from rest at its first position.

    Parameters
    ----------
    position : array_like
        Commanded positions, rad, shape (n,).
    rate : float
        Ticks a second, Hz.
    velocity : array_like, optional
        Commanded velocities for the servo's feed-forward, rad/s, shape (n,).
    robot : str or Path, optional
        The robot's description; the embedded arm by default.
    joint : int, optional
        The joint, counted from 1; the one that the description moves by default.
    payload : float, default 0
        Load at the tip, kg.
    noise_std : float, optional
        Noise of the sensor at the tip, m; the description's by default.
    seed : int, default 1
        Seed of that noise.

    Returns
    -------
    SimulatedMove
        What the sensors saw, and the truth.

    Raises
    ------
    SimulationError
        Where the robot, the joint or the command is refused.

    Examples
    --------
    >>> import numpy as np, quell
    >>> moved = quell.simulate_robot(np.zeros(100), rate=250)
    >>> float(abs(moved.tip_deformation).max())
    0.0
    """
    if not (np.isfinite(rate) and rate > 0.0):
        raise SimulationError(f"a rate of {rate} Hz is not a finite number above 0")
    arrays = [position] if velocity is None else [position, velocity]
    given = [np.asarray(one, dtype=np.float64).reshape(-1) for one in arrays]
    names = ("position", "velocity")
    columns = [columns_of(name, one, SimulationError)[0] for name, one in zip(names, given)]
    if len(columns[0]) != len(columns[-1]):
        raise SimulationError(f"velocity: {len(columns[-1])} values, and {len(columns[0])} positions")
    command = (columns[0], columns[1] if len(columns) > 1 else None)
    inner, model, modes, tip = _quell.simulate_robot(robot, joint, command, float(rate), (payload, noise_std, seed))
    true = tuple(Mode(hertz, damping) for hertz, damping in modes)
    time = np.arange(len(tip)) / rate
    return SimulatedMove(Recording(inner), Model._of(model), true, time, tip)
