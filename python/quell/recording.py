"""Recordings: what was measured, each channel on its own clock."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _quell, _variables
from ._samples import (
    TimeUnit,
    columns_of,
    of_one_length,
    plain,
    samples_of,
    seconds,
    stamps_of,
    usual_unit,
    without_missing,
)
from ._result import bold, table
from .errors import RecordingError

if TYPE_CHECKING:
    import pandas
    from matplotlib.figure import Figure

__all__ = ["Channel", "Recording", "roles", "units"]

Missing = Literal["raise", "drop"]
Values = Union["Channel", ArrayLike]
Columns = Union[str, "list[str]"]


@dataclass(frozen=True, eq=False)
class Channel:
    """
    One measured quantity on its own clock.

    Parameters
    ----------
    values : array_like
        Samples, shape (n,), or (n, 3) of a vector such as `tip_position`.
    time : array_like
        Stamps, s, strictly increasing, shape (n,).
    unit : str
        Unit of the values, one of `quell.units()`.
    role : str, optional
        What it measures; one of `quell.roles()`.
    """

    values: ArrayLike
    time: ArrayLike
    unit: str
    role: str = ""

    def __repr__(self) -> str:
        return f"Channel({self.role or 'no role'}, {self.unit}: {np.size(self.time)} samples)"

    @property
    def array(self) -> NDArray[np.float64]:
        """The values as an array."""
        return np.asarray(self.values, dtype=np.float64)

    @property
    def stamps(self) -> NDArray[np.float64]:
        """The stamps, s, as an array."""
        return seconds(self.time)


def roles() -> list[str]:
    """
    List the roles that a channel may have.

    Returns
    -------
    list of str
        Such as `motor_position`.
    """
    return [name for name, _, _ in _quell.roles()]


def units() -> list[str]:
    """
    List the units that a channel may have.

    Returns
    -------
    list of str
        The usual spelling of each.
    """
    return [names[0] for names, _ in _quell.units()]


class Recording:
    """
    Channels of one run of one machine, in SI.

    Made by `from_arrays`, `from_pandas` or `load`. It does not change; it can be pickled.

    Parameters
    ----------
    inner : object
        The compiled recording.
    file : Path, optional
        The file that it was read from.
    """

    def __init__(self, inner: _quell.Recording, file: Path | None = None) -> None:
        self._inner = inner
        self._file = file

    @classmethod
    def from_arrays(
        cls,
        channels: Mapping[str, Values],
        *,
        time: ArrayLike | None = None,
        time_unit: TimeUnit = "s",
        rate: float | None = None,
        units: Mapping[str, str] | None = None,
        name: str = "recording",
        payload: str | None = None,
        missing: Missing = "raise",
    ) -> Recording:
        """
        Make a recording of arrays.

        The samples are copied once, into SI.

        Parameters
        ----------
        channels : mapping of str to array_like or Channel
            Values by role. A `Channel` brings its own stamps and its own unit.
        time : array_like, optional
            Stamps of all arrays, strictly increasing; instants (`datetime64`) count from the first.
        time_unit : {"s", "ms", "us", "ns"}, default "s"
            Unit of stamps that are numbers.
        rate : float, optional
            Samples a second, Hz, of arrays of one length, instead of `time`; the first is at 0 s.
        units : mapping of str to str, optional
            Units by role. A role of one dimension, such as `torque`, is in SI without.
        name : str, default "recording"
            What reports call it.
        payload : str, optional
            What the machine carries; where it differs between recordings, so does the inertia.
        missing : {"raise", "drop"}, default "raise"
            What is done with samples that are NaN: an error, or the channel goes on without them.

        Returns
        -------
        Recording
            The recording.

        Raises
        ------
        RecordingError
            Where a role or unit is not known, or a sample or stamp is bad; it names channel and sample.

        Examples
        --------
        >>> import numpy as np, quell
        >>> t = np.arange(1000) / 250
        >>> q = np.sin(t)
        >>> quell.Recording.from_arrays({"motor_position": q}, time=t, units={"motor_position": "rad"})
        Recording('recording': motor_position (rad) 1000 samples at 250 Hz)
        """
        own = {role: values for role, values in channels.items() if isinstance(values, Channel)}
        arrays = {
            role: samples_of(role, one.values if isinstance(one, Channel) else one) for role, one in channels.items()
        }
        if rate is not None:
            of_one_length({role: array for role, array in arrays.items() if role not in own})
        given: list[tuple[str, str, NDArray[np.float64], list[NDArray[np.float64]]]] = []
        for role, array in arrays.items():
            if role in own:
                stamps, unit = seconds(own[role].time, what=f"channel {role}: time"), own[role].unit
            else:
                stamps = stamps_of(role, time, rate, len(array), time_unit)
                unit = (units or {}).get(role) or usual_unit(role)
            if missing == "drop":
                array, stamps = without_missing(array, stamps)
            given.append((role, unit, np.ascontiguousarray(stamps), columns_of(array)))
        return cls(_quell.Recording(name, payload, given))

    @classmethod
    def from_pandas(
        cls,
        data: pandas.DataFrame,
        channels: Mapping[str, Columns] | None = None,
        *,
        time: str | None = None,
        time_unit: TimeUnit = "s",
        rate: float | None = None,
        units: Mapping[str, str] | None = None,
        name: str = "recording",
        payload: str | None = None,
        missing: Missing = "drop",
    ) -> Recording:
        """
        Make a recording of a data frame.

        Parameters
        ----------
        data : pandas.DataFrame
            A row for each instant.
        channels : mapping of str to str or list of str, optional
            Columns by role; a list for a vector. Without it columns are taken that are called as a role,
            alone or with a unit: `motor_position_deg`.
        time : str, optional
            The column with stamps, or with instants. Without it a column called `time`, `time_s`, `t` or
            `timestamp`, else the index, where that is of instants or of numbers that are not whole.
        time_unit : {"s", "ms", "us", "ns"}, default "s"
            Unit of stamps that are numbers.
        rate : float, optional
            Rows a second, Hz, instead of a time.
        units : mapping of str to str, optional
            Units by role; else the unit in the column's name (`q1_deg`, `q1 [deg]`), else SI where the role
            has one.
        name : str, default "recording"
            What reports call it.
        payload : str, optional
            What the machine carries.
        missing : {"raise", "drop"}, default "drop"
            What is done with samples that are NaN.

        Returns
        -------
        Recording
            The recording.

        Raises
        ------
        RecordingError
            Where a column is absent, or as `from_arrays`.
        """
        variables: dict[str, Any] = {str(key): plain(data[key]) for key in data.columns}
        index = plain(data.index)
        if rate is None and time is None and _variables.time_of(variables) is None and index.dtype.kind in "fmM":
            variables["index"] = index
            time = "index"
        wanted = _variables.Wanted(channels, time, time_unit, rate, units)
        return cls._of_variables(variables, wanted, None, name, payload, missing)

    @classmethod
    def load(
        cls,
        path: str | Path,
        channels: Mapping[str, Columns] | None = None,
        *,
        time: str | None = None,
        time_unit: TimeUnit = "s",
        rate: float | None = None,
        units: Mapping[str, str] | None = None,
        where: Mapping[str, Any] | None = None,
        name: str | None = None,
        payload: str | None = None,
        missing: Missing = "drop",
    ) -> Recording:
        """
        Read a recording.

        A manifest, the folder of a `recording.toml`, an MCAP file with Quell's topics and a CSV file that can
        only mean one thing need no more than `path`. Parquet, MAT (v5, v7.3) and NPZ files have variables, which
        the other arguments name.

        Parameters
        ----------
        path : str or Path
            The file, or the folder.
        channels : mapping of str to str or list of str, optional
            Variables by role; `q[2]` is the third column of `q`, `log.q` the field of a MATLAB structure.
            Without it those are taken that are called as a role, alone or with a unit.
        time : str, optional
            The variable with stamps. Without it one called `time`, `time_s`, `t` or `timestamp`.
        time_unit : {"s", "ms", "us", "ns"}, default "s"
            Unit of stamps that are numbers.
        rate : float, optional
            Samples a second, Hz, instead of a time.
        units : mapping of str to str, optional
            Units by role; else the unit in the variable's name, else SI where the role has one.
        where : mapping of str to object, optional
            Only the rows in which these variables have these values, such as `{"episode_index": 3}`.
        name : str, optional
            What reports call it; the file's name by default.
        payload : str, optional
            What the machine carries.
        missing : {"raise", "drop"}, default "drop"
            What is done with samples that are NaN.

        Returns
        -------
        Recording
            The recording.

        Raises
        ------
        RecordingError
            With file, line and column, or file and variable.
        ImportError
            Where the package that reads the format is not installed; it is named.
        """
        path = Path(path)
        if not _variables.is_of_variables(path):
            if channels or time or rate or units or where:
                message = f"{path}: a recording.toml says what its columns are, or pandas.read_csv and from_pandas"
                raise RecordingError(message, file=str(path))
            return cls(_quell.Recording.load(path), path)
        variables = _variables.read(path, where or {})
        wanted = _variables.Wanted(channels, time, time_unit, rate, units)
        return cls._of_variables(variables, wanted, path, name or path.stem, payload, missing)

    @classmethod
    def joints(cls, path: str | Path) -> dict[str, Recording]:
        """
        Read the recordings of all joints of a robot.

        Parameters
        ----------
        path : str or Path
            A manifest whose channels name their joints, its folder, or an MCAP file.

        Returns
        -------
        dict of str to Recording
            By joint; empty where no joint is named.

        Raises
        ------
        RecordingError
            With file, line and column.
        """
        return {name: cls(inner, Path(path)) for name, inner in _quell.Recording.joints(path)}

    @classmethod
    def _of_variables(
        cls,
        variables: Mapping[str, Any],
        wanted: _variables.Wanted,
        path: Path | None,
        name: str,
        payload: str | None,
        missing: Missing,
    ) -> Recording:
        chosen, stamps, units = _variables.choose(variables, wanted, path)
        if path is not None and stamps is not None:
            _variables.check_one_test(variables, stamps, path)
        recording = cls.from_arrays(
            chosen,
            time=stamps,
            time_unit=wanted.time_unit,
            rate=wanted.rate,
            units=units,
            name=name,
            payload=payload,
            missing=missing,
        )
        recording._file = path
        return recording

    def save(self, folder: str | Path, *, compress: bool = False) -> Path:
        """
        Write the recording as a folder with a `recording.toml` and a CSV file for each channel.

        Parameters
        ----------
        folder : str or Path
            The folder, which is made where it is not there; its files of the same names are written over.
        compress : bool, default False
            Whether the CSV files are gzipped.

        Returns
        -------
        Path
            The folder: `quell diagnose FOLDER` and `Recording.load` read the same numbers.
        """
        self._inner.save(folder, compress)
        return Path(folder)

    @property
    def name(self) -> str:
        """What reports call it."""
        return self._inner.name

    @property
    def payload(self) -> str | None:
        """What the machine carries."""
        return self._inner.payload

    @property
    def file(self) -> Path | None:
        """The file that it was read from."""
        return self._file

    @cached_property
    def channels(self) -> tuple[Channel, ...]:
        """The channels in SI, in the order in which they were given."""
        held: list[Channel] = []
        for role, unit, time, columns in self._inner.channels():
            values = columns[0] if len(columns) == 1 else np.stack(columns, axis=1)
            held.append(Channel(values, time, unit, role))
        return tuple(held)

    def __getitem__(self, role: str) -> Channel:
        for channel in self.channels:
            if channel.role == role:
                return channel
        raise KeyError(role)

    def __contains__(self, role: object) -> bool:
        return any(channel.role == role for channel in self.channels)

    def __repr__(self) -> str:
        said = ", ".join(f"{role} ({unit}) {n} samples at {hertz:.4g} Hz" for role, unit, n, hertz in self._lines())
        return f"Recording({self.name!r}: {said})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self.name, self.payload, self._inner.channels(), self._file)

    def _lines(self) -> list[tuple[str, str, int, float]]:
        def rate(stamps: NDArray[np.float64]) -> float:
            return float(1.0 / np.median(np.diff(stamps))) if len(stamps) > 1 else float("nan")

        return [(one.role, one.unit, len(one.stamps), rate(one.stamps)) for one in self.channels]

    def _repr_html_(self) -> str:
        heads = ["channel", "unit", "samples", "rate / Hz"]
        return bold(self.name) + table(heads, self._lines())

    def to_pandas(self) -> pandas.DataFrame:
        """
        Give all channels as a data frame.

        Returns
        -------
        pandas.DataFrame
            Index `time_s`; a column for each channel, called by role and unit. Where channels have clocks of
            their own, an instant of one is NaN in the others.
        """
        import pandas

        series: list[Any] = []
        for channel in self.channels:
            index: Any = pandas.Index(channel.stamps, name="time_s")
            values = channel.array.reshape(len(channel.stamps), -1)
            for k in range(values.shape[1]):
                axis = "" if values.shape[1] == 1 else f"_{'xyz'[k]}"
                name = f"{channel.role}{axis}_{channel.unit}"
                series.append(pandas.Series(values[:, k], index=index, name=name))
        joined: Any = pandas.concat(series, axis=1)
        return joined.sort_index()

    def plot(self) -> Figure:
        """
        Draw each channel over time.

        Returns
        -------
        matplotlib.figure.Figure
            One axis for each channel.
        """
        import matplotlib.pyplot as plt

        count = len(self.channels)
        figure, axes = plt.subplots(
            count, 1, sharex=True, squeeze=False, figsize=(8, 2 * count), layout="constrained"
        )
        for channel, axis in zip(self.channels, axes[:, 0]):
            lines = axis.plot(channel.stamps, channel.array, linewidth=0.8)
            if len(lines) > 1:
                axis.legend(lines, ["x", "y", "z"])
            axis.set_ylabel(f"{channel.role}\n{channel.unit}")
        axes[-1, 0].set_xlabel("time / s")
        figure.suptitle(self.name)
        return figure


def _again(
    name: str,
    payload: str | None,
    channels: list[tuple[str, str, NDArray[np.float64], list[NDArray[np.float64]]]],
    file: Path | None,
) -> Recording:
    """A recording that was pickled."""
    return Recording(_quell.Recording(name, payload, channels), file)
