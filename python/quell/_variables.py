"""Files of variables: Parquet, MAT and NPZ; and which variable is which channel."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _quell
from ._samples import TimeUnit
from .errors import RecordingError

TIMES = ("time_s", "time", "t_s", "t", "timestamp")
Columns = Union[str, "list[str]"]


@dataclass(frozen=True)
class Wanted:
    """What the caller says of the variables."""

    channels: Mapping[str, Columns] | None
    time: str | None
    time_unit: TimeUnit
    rate: float | None
    units: Mapping[str, str] | None


def is_of_variables(path: Path) -> bool:
    """Whether the file is of one of these formats."""
    return path.suffix.lower() in (".parquet", ".pq", ".mat", ".npz")


def read(path: Path, where: Mapping[str, Any]) -> dict[str, Any]:
    """All variables of a file; of the rows in which some have these values."""
    if not path.exists():
        raise RecordingError(f"{path}: no such file or folder", file=str(path))
    try:
        variables = _reader(path)(path)
    except (OSError, ValueError, KeyError) as error:
        raise RecordingError(f"{path}: {error}", file=str(path)) from error
    rows = None
    for name, value in where.items():
        match = np.asarray(one_of(variables, name, path)) == value
        rows = match if rows is None else rows & match
    if rows is None:
        return variables
    if not rows.any():
        raise RecordingError(f"{path}: no row has {dict(where)}", file=str(path))
    count = len(rows)
    return {name: values[rows] for name, values in variables.items() if _shape(values)[:1] == (count,)}


def _reader(path: Path) -> Any:
    kinds = {".npz": _npz, ".mat": _mat}
    return kinds.get(path.suffix.lower(), _parquet)


def _npz(path: Path) -> dict[str, Any]:
    with np.load(path, allow_pickle=False) as file:
        return {name: np.asarray(file[name]) for name in file.files}


def _parquet(path: Path) -> dict[str, Any]:
    import pyarrow.parquet

    parquet: Any = pyarrow.parquet
    data: Any = parquet.read_table(path)
    variables: dict[str, Any] = {}
    for name in data.column_names:
        values = data.column(name).to_numpy()
        if values.dtype == object and len(values) and isinstance(values[0], (list, np.ndarray)):
            # A list in each row, as the state of a robot.
            values = np.stack([np.asarray(row, dtype=np.float64) for row in values])
        variables[name] = values
    return variables


def _mat(path: Path) -> dict[str, Any]:
    import scipy.io

    io: Any = scipy.io
    # v7.3 is HDF5 behind a block of 512 bytes, in which not all that write it put MATLAB's words.
    if _is_hdf5(path):
        return _hdf5(path)
    content = io.loadmat(path, squeeze_me=True, struct_as_record=True)
    variables: dict[str, Any] = {}
    for name, value in content.items():
        if not name.startswith("__"):
            _flatten(name, value, variables)
    return variables


def _flatten(name: str, value: Any, variables: dict[str, Any]) -> None:
    """The fields of a structure as variables of their own."""
    array = np.asarray(value)
    if array.dtype.names:
        for field in array.dtype.names:
            held: Any = array[field]
            _flatten(f"{name}.{field}", held.item() if held.ndim == 0 else held, variables)
    elif np.issubdtype(array.dtype, np.number):
        variables[name] = np.squeeze(array)


def _is_hdf5(path: Path) -> bool:
    signature = b"\x89HDF\r\n\x1a\n"
    with path.open("rb") as file:
        head = file.read(512 + len(signature))
    return head.startswith(signature) or head[512:] == signature


def _hdf5(path: Path) -> dict[str, Any]:
    import h5py

    h5: Any = h5py
    variables: dict[str, Any] = {}

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5.Dataset) and np.issubdtype(item.dtype, np.number):
            # MATLAB stores by columns, HDF5 by rows.
            variables[name.replace("/", ".")] = np.squeeze(np.transpose(item))

    with h5.File(path, "r") as file:
        file.visititems(visit)
    return variables


def time_of(variables: Mapping[str, Any]) -> str | None:
    """The variable that is called as a time."""
    lower = {name.lower(): name for name in reversed(list(variables))}
    return next((lower[name] for name in TIMES if name in lower), None)


def one_of(variables: Mapping[str, Any], name: str, path: Path | None) -> Any:
    """A variable, or a column of one: `q[2]`."""
    if name in variables:
        return variables[name]
    part = re.fullmatch(r"(.+)\[(\d+)\]", name)
    if part and part[1] in variables:
        values = np.asarray(variables[part[1]])
        column = int(part[2])
        if values.ndim == 2 and column < values.shape[1]:
            return values[:, column]
    place = f"{path}: " if path else ""
    there = ", ".join(f"{known} {_shape(variables[known])}" for known in list(variables)[:24])
    raise RecordingError(
        f'{place}column "{name}": there is none; there are: {there}',
        file=str(path) if path else None,
        column=name,
    )


def choose(
    variables: Mapping[str, Any], wanted: Wanted, path: Path | None
) -> tuple[dict[str, NDArray[np.float64]], Any, dict[str, str]]:
    """The arrays by role, their stamps, and their units."""
    named = wanted.channels or _by_name(variables, path)
    chosen: dict[str, NDArray[np.float64]] = {}
    units: dict[str, str] = {}
    for role, names in named.items():
        parts = [names] if isinstance(names, str) else list(names)
        arrays = [_numbers(variables, name, path) for name in parts]
        chosen[role] = arrays[0] if len(arrays) == 1 else np.stack(arrays, axis=1)
        unit = (wanted.units or {}).get(role) or unit_of(parts[0])
        if unit is not None:
            units[role] = unit
    if wanted.rate is not None:
        return chosen, None, units
    time = wanted.time or time_of(variables)
    if time is None:
        place = f"{path}: " if path else ""
        message = f"{place}no variable is called as a time: time or rate says when its samples are"
        raise RecordingError(message, file=str(path) if path else None)
    return chosen, one_of(variables, time, path), units


def check_one_test(variables: Mapping[str, Any], stamps: Any, path: Path) -> None:
    """Refuse a file whose time begins again with another value of a column, as that of an episode."""
    times = np.asarray(stamps)
    if times.ndim != 1 or times.dtype.kind not in "fiu" or len(times) < 2:
        return
    back = np.flatnonzero(np.diff(times) <= 0)
    if len(back) == 0:
        return
    for name, values in variables.items():
        column = np.asarray(values)
        if column.shape == times.shape and column.dtype.kind in "iuOUS":
            changes = np.flatnonzero(column[1:] != column[:-1])
            if np.array_equal(changes, back):
                message = f"{path}: its time begins again with each {name}: take one, as where={{{name!r}: {column[0].item()!r}}}"
                raise RecordingError(message, file=str(path), column=name)


def _numbers(variables: Mapping[str, Any], name: str, path: Path | None) -> NDArray[np.float64]:
    try:
        return np.asarray(one_of(variables, name, path), dtype=np.float64)
    except (TypeError, ValueError) as error:
        if isinstance(error, RecordingError):
            raise
        place = f"{path}: " if path else ""
        file = str(path) if path else None
        raise RecordingError(f'{place}column "{name}": {error}', file=file, column=name) from error


def unit_of(name: str) -> str | None:
    """The unit in a name: `q1_deg`, `q1 [deg]`, `q1 (deg)`."""
    known = {spelling for names, _ in _quell.units() for spelling in names}
    part = re.search(r"[\[(]([^\])]+)[\])]\s*$", name)
    if part and part[1] in known:
        return part[1]
    last = name.rsplit("_", 1)[-1]
    # Units that are a letter or a number end many a name that means something else.
    return last if last in known and len(last) > 1 else None


def _by_name(variables: Mapping[str, Any], path: Path | None) -> dict[str, Columns]:
    """The variables that are called as a role, alone or with a unit."""
    roles = [name for name, _, _ in _quell.roles()]
    known = {spelling for names, _ in _quell.units() for spelling in names}
    found: dict[str, Columns] = {}
    for name in variables:
        for role in roles:
            rest = name[len(role) :].strip(" _[]()")
            if name.startswith(role) and (rest == "" or rest in known):
                found.setdefault(role, name)
    if not found:
        place = f"{path}: " if path else ""
        there = ", ".join(f"{name} {_shape(variables[name])}" for name in list(variables)[:24])
        raise RecordingError(
            f"{place}no variable is called as a role; channels = {{role: variable}} says which are; there are: {there}",
            file=str(path) if path else None,
        )
    return found


def _shape(values: Any) -> tuple[int, ...]:
    return np.asarray(values).shape
