"""Arrays that are handed to the compiled half."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .errors import Error, ShaperError


def columns_of(
    name: str, array: NDArray[np.float64], error: type[Error] = ShaperError
) -> list[NDArray[np.float64]]:
    """The columns of a command; an array that is contiguous is not copied."""
    if array.ndim not in (1, 2) or len(array) == 0:
        raise error(f"{name}: an array of shape {array.shape}; it is (n,) or (n, axes)")
    bad = np.argwhere(~np.isfinite(array))
    if len(bad):
        at = tuple(int(index) for index in bad[0])
        raise error(f"{name}: element {at} is {array[at]}, not a finite number")
    if array.ndim == 1:
        return [np.ascontiguousarray(array)]
    return [np.ascontiguousarray(array[:, axis]) for axis in range(array.shape[1])]
