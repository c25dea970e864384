"""Samples and stamps of channels, as arrays."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _quell
from .errors import RecordingError

TimeUnit = Literal["s", "ms", "us", "ns"]
PER_SECOND: dict[str, float] = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}


def seconds(time: ArrayLike, unit: TimeUnit = "s") -> NDArray[np.float64]:
    """Stamps in seconds; instants count from the first, and whole numbers too large to be exact as well."""
    stamps: Any = np.asarray(time)
    if np.issubdtype(stamps.dtype, np.datetime64):
        stamps = stamps - stamps[:1]
    if np.issubdtype(stamps.dtype, np.timedelta64):
        return stamps / np.timedelta64(1, "s")
    if unit not in PER_SECOND:
        raise RecordingError(f'time_unit "{unit}": it is one of {", ".join(PER_SECOND)}')
    if np.issubdtype(stamps.dtype, np.integer) and len(stamps) and abs(int(stamps[-1])) > 2**53:
        stamps = stamps - stamps[0]
    return np.asarray(stamps, dtype=np.float64) / PER_SECOND[unit]


def plain(values: Any) -> Any:
    """A column or an index as an array; instants of a time zone without it."""
    if getattr(values.dtype, "tz", None) is None:
        return values.to_numpy()
    return (getattr(values, "dt", values)).tz_convert(None).to_numpy()


def stamps_of(
    role: str, time: ArrayLike | None, rate: float | None, count: int, unit: TimeUnit
) -> NDArray[np.float64]:
    if (time is None) == (rate is None):
        raise RecordingError(f"channel {role}: either time or rate says when its samples are")
    if time is not None:
        return seconds(time, unit)
    if not (rate and np.isfinite(rate) and rate > 0.0):
        raise RecordingError(f"channel {role}: a rate of {rate} Hz is not a finite number above 0")
    return np.arange(count) / rate


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
    return array[there], stamps[there]


def columns_of_role(role: str, array: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    if array.ndim not in (1, 2):
        raise RecordingError(f"channel {role}: an array of shape {array.shape}; it is (n,) or (n, 3)")
    if array.ndim == 1:
        return [np.ascontiguousarray(array)]
    return [np.ascontiguousarray(array[:, k]) for k in range(array.shape[1])]
