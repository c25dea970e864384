"""Samples and stamps of channels, as arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _quell
from .errors import RecordingError

TimeUnit = Literal["s", "ms", "us", "ns"]
PER_SECOND: dict[str, float] = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}


def numbers(what: str, values: ArrayLike) -> NDArray[np.float64]:
    """Values as numbers, a masked one as NaN; what is none is refused, with its place."""
    if np.iscomplexobj(values):
        raise RecordingError(f"{what}: its samples are complex numbers; give real parts, or magnitudes")
    try:
        masked: Any = np.ma
        if masked.is_masked(values):
            return np.where(masked.getmaskarray(values), np.nan, np.asarray(values, dtype=np.float64))
        return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise RecordingError(f"{what}: {_first_that_is_none(values) or error}") from error


def _first_that_is_none(values: ArrayLike) -> str | None:
    """Where the first value stands that is no number."""
    array: Any = np.asarray(values, dtype=object)
    places: Any = np.ndindex(array.shape)
    for index in places:
        try:
            float(array[index])
        except (TypeError, ValueError):
            column = f" of column {index[1]}" if len(index) > 1 else ""
            return f"sample {index[0]}{column} is {array[index]!r}, not a number"
    return None


def seconds(time: ArrayLike, unit: TimeUnit = "s", what: str = "time") -> NDArray[np.float64]:
    """Stamps in seconds; instants count from the first, and whole numbers too large to be exact as well."""
    stamps: Any = np.asarray(time)
    if stamps.ndim != 1:
        raise RecordingError(f"{what}: an array of shape {stamps.shape}; it is (n,)")
    if np.issubdtype(stamps.dtype, np.datetime64):
        stamps = stamps - stamps[:1]
    if np.issubdtype(stamps.dtype, np.timedelta64):
        return stamps / np.timedelta64(1, "s")
    if unit not in PER_SECOND:
        raise RecordingError(f'time_unit "{unit}": it is one of {", ".join(PER_SECOND)}')
    if np.issubdtype(stamps.dtype, np.integer) and len(stamps) and abs(int(stamps[-1])) > 2**53:
        stamps = stamps - stamps[0]
    told = numbers(what, stamps)
    return told if unit == "s" else told / PER_SECOND[unit]


def plain(values: Any) -> Any:
    """A column or an index as an array; instants of a time zone without it, missing numbers as NaN."""
    import pandas

    types: Any = pandas.api.types
    # Such a column has a missing value of its own, which is no number.
    if types.is_extension_array_dtype(values.dtype) and types.is_numeric_dtype(values.dtype) and values.isna().any():
        return values.to_numpy(dtype=np.float64, na_value=np.nan)
    if getattr(values.dtype, "tz", None) is None:
        return values.to_numpy()
    return (getattr(values, "dt", values)).tz_convert(None).to_numpy()


def stamps_of(
    role: str, time: ArrayLike | None, rate: float | None, count: int, unit: TimeUnit
) -> NDArray[np.float64]:
    if (time is None) == (rate is None):
        raise RecordingError(f"channel {role}: either time or rate says when its samples are")
    if time is not None:
        return seconds(time, unit, f"channel {role}: time")
    if not (rate and np.isfinite(rate) and rate > 0.0):
        raise RecordingError(f"channel {role}: a rate of {rate} Hz is not a finite number above 0")
    return np.arange(count) / rate


def of_one_length(arrays: Mapping[str, NDArray[np.float64]]) -> None:
    """Refuses channels that one rate cannot be of: it says of all that they begin and end together."""
    lengths = {role: len(array) for role, array in arrays.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{role} has {length}" for role, length in lengths.items())
        raise RecordingError(
            f"one rate is of channels of one length: samples: {told}; give one with a clock of its own as a quell.Channel"
        )


def usual_unit(role: str) -> str:
    for name, _, usual in _quell.roles():
        if name == role and len(usual) > 1:
            raise RecordingError(f'channel {role}: units = {{"{role}": ...}} says its unit, such as {" or ".join(usual)}')
        if name == role:
            return usual[0]
    return "1"


def without_missing(
    array: NDArray[np.float64], stamps: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    if len(array) != len(stamps):
        return array, stamps
    there = ~np.isnan(array.reshape(len(array), -1)).any(axis=1) & ~np.isnan(stamps)
    if there.all():
        return array, stamps
    return array[there], stamps[there]


def samples_of(role: str, values: ArrayLike) -> NDArray[np.float64]:
    array = numbers(f"channel {role}", values)
    if array.ndim not in (1, 2):
        raise RecordingError(f"channel {role}: an array of shape {array.shape}; it is (n,) or (n, 3)")
    return array


def columns_of(array: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    if array.ndim == 1:
        return [np.ascontiguousarray(array)]
    return [np.ascontiguousarray(array[:, k]) for k in range(array.shape[1])]
