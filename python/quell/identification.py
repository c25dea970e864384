"""Modes of a recording."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from . import _quell
from ._result import MORE, Reported, bold, build, figure, frame, in_lines, paragraph, table
from .model import Model
from .modes import Mode
from .recording import Recording

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

__all__ = ["Estimate", "Identification", "RecommendedShaper", "identify"]


@dataclass(frozen=True)
class Estimate:
    """
    What one method says of the first mode.

    Parameters
    ----------
    method : str
        The estimator, or the reference that works off-line.
    online : bool
        Whether it works sample by sample.
    frequency_hz : float
        Natural frequency, Hz; NaN where it told none.
    frequency_std_hz : float
        One standard deviation, Hz; NaN where it is not known.
    damping_ratio : float
        Damping ratio.
    damping_std : float
        One standard deviation of it.
    from_s : float
        Start of the samples that it used, s.
    until_s : float
        Their end, s.
    """

    method: str
    online: bool
    frequency_hz: float
    frequency_std_hz: float
    damping_ratio: float
    damping_std: float
    from_s: float
    until_s: float


@dataclass(frozen=True)
class RecommendedShaper:
    """
    The shaper that is recommended for what vibrates alone.

    Parameters
    ----------
    shaper : str
        Its name.
    delay_s : float
        Delay that it adds, s.
    residual_vibration_95 : float
        Vibration that it leaves within two standard deviations, as a share of the unshaped.
    """

    shaper: str
    delay_s: float
    residual_vibration_95: float


@dataclass(frozen=True, eq=False)
class Identification(Reported):
    """
    The modes of a recording.

    Parameters
    ----------
    document : dict
        All of it, as `to_dict` gives it.
    text : str
        The same as text, as the command line prints it.
    html : str
        The report: a page of HTML that needs no other file.
    name : str
        Name of the recording.
    excitation : {"known_input", "decay", "sweep", "work"}
        The motor side's motion as known input; else how what vibrates alone was excited.
    modes : tuple of Mode
        The modes with their standard deviations, the strongest first.
    estimates : tuple of Estimate
        What each method says, where the input is known.
    recommended : RecommendedShaper or None
        The shaper for what vibrates alone.
    remarks : tuple of str
        What the reader should know.
    firmware : str or None
        The lines for a printer's firmware, where it is a printer's.
    model : Model or None
        A `flexible_joint` with the first mode.
    """

    name: str
    excitation: Literal["known_input", "decay", "sweep", "work"]
    modes: tuple[Mode, ...]
    estimates: tuple[Estimate, ...]
    recommended: RecommendedShaper | None
    remarks: tuple[str, ...]
    firmware: str | None
    model: Model | None = field(repr=False)

    def __repr__(self) -> str:
        lines = [
            f"{figure(one.frequency_hz, one.frequency_std_hz)} Hz, damping ratio {figure(one.damping_ratio, one.damping_std)}"
            for one in self.modes
        ]
        if self.recommended:
            lines.append(f"recommended shaper: {self.recommended.shaper}, which adds {self.recommended.delay_s:.3g} s")
        lines += [f"remark: {remark}" for remark in self.remarks[:MOST_REMARKS]]
        return in_lines(f"Identification({self.name!r}, {self.excitation})", lines, MORE)

    def to_pandas(self) -> pandas.DataFrame:
        """
        Give the modes as a data frame.

        Returns
        -------
        pandas.DataFrame
            Columns `frequency_hz`, `frequency_std_hz`, `damping_ratio` and `damping_std`.
        """
        return frame([vars(mode) for mode in self.modes], COLUMNS)

    def _repr_html_(self) -> str:
        rows = [[getattr(mode, column) for column in COLUMNS] for mode in self.modes]
        remarks = "".join(paragraph(remark) for remark in self.remarks)
        return bold(self.name) + table(COLUMNS, rows) + remarks

    def plot(self, ax: Axes | None = None) -> Axes:
        """
        Draw frequency and damping ratio of the modes with two standard deviations.

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
        for mode in self.modes:
            x, y = mode.frequency_hz, mode.damping_ratio
            axes.errorbar(x, y, 2.0 * mode.damping_std, 2.0 * mode.frequency_std_hz, fmt="o", capsize=3)
        axes.set_xlabel("natural frequency / Hz")
        axes.set_ylabel("damping ratio")
        return axes


# Of those that a terminal shows.
MOST_REMARKS = 3
COLUMNS = ["frequency_hz", "frequency_std_hz", "damping_ratio", "damping_std"]


def identify(
    recording: Recording, model: Model | None = None, *, registration: str = "arc"
) -> Identification:
    """
    Identify the modes of a recording.

    A recording with `motor_position` and one of `deformation`, `link_position` or `tip_position` is identified with
    the motor side's motion as known input; any other as what vibrates alone: an accelerometer, or a free decay.

    Parameters
    ----------
    recording : Recording
        The recording.
    model : Model, optional
        A `flexible_joint`, as it is believed; a tip sensor in a frame of its own needs its lever arm.
    registration : {"arc", "icp"}, default "arc"
        How the frame of a tip sensor is learned.

    Returns
    -------
    Identification
        The modes.

    Raises
    ------
    IdentificationError
        Where no mode is found, or a channel is bad.
    """
    inner = recording._inner
    believed = model._inner if model else None
    files = [(recording.file or Path(), inner)]
    told, text, html, toml = _quell.identify(files, believed, registration)
    document = json.loads(told)
    alone = document["recordings"][0] if "recordings" in document else None
    source = alone or document
    modes = alone["modes"] if alone else _driven_modes(document)
    recommended = source.get("recommended")
    return Identification(
        document=document,
        text=text,
        html=html,
        name=source["name"],
        excitation=source.get("excitation", "known_input"),
        modes=tuple(_mode(mode) for mode in modes),
        estimates=() if alone else _estimates(document),
        recommended=build(RecommendedShaper, recommended) if alone and recommended else None,
        remarks=tuple(source["remarks"]),
        firmware=document.get("lines"),
        model=Model.from_toml(toml, "identified model") if toml else None,
    )


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)


def _mode(document: Mapping[str, Any]) -> Mode:
    return Mode(*(_number(document[name]) for name in ("frequency_hz", "damping_ratio", *COLUMNS[1::2])))


def _driven_modes(document: Mapping[str, Any]) -> list[Any]:
    """The mode that is recommended, or the two."""
    best = document["recommended"]
    return best["modes"] if best else []


def _estimates(document: Mapping[str, Any]) -> tuple[Estimate, ...]:
    def one(line: Mapping[str, Any], method: str, online: bool) -> Estimate:
        names = [*COLUMNS, "from_s", "until_s"]
        return Estimate(method, online, **{name: _number(line[name]) for name in names})

    online = [one(line, line["estimator"], True) for line in document["estimates"]]
    return (*online, *(one(line, line["method"], False) for line in document["offline"]))
