"""Modes of vibration, and how well they are known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, Union, cast, runtime_checkable

from .errors import ShaperError

__all__ = ["HasModes", "Mode", "ModeLike", "ModesLike"]


@dataclass(frozen=True)
class Mode:
    """
    A vibratory mode, and how well it is known.

    Parameters
    ----------
    frequency_hz : float
        Undamped natural frequency, Hz, above 0.
    damping_ratio : float
        Damping ratio, 0 to below 1.
    frequency_std_hz : float, default 0
        One standard deviation of the frequency, Hz.
    damping_std : float, default 0
        One standard deviation of the damping ratio.
    """

    frequency_hz: float
    damping_ratio: float
    frequency_std_hz: float = 0.0
    damping_std: float = 0.0


@runtime_checkable
class HasModes(Protocol):
    """What has modes, as an identification."""

    @property
    def modes(self) -> tuple[Mode, ...]:
        """The modes, the strongest first."""
        ...


ModeLike = Union[Mode, tuple[float, float]]
ModesLike = Union[ModeLike, Sequence[ModeLike], HasModes]


def given(modes: ModesLike) -> list[tuple[float, float, float, float]]:
    """Frequency, damping ratio and their deviations of each mode; a deviation that is not known is 0."""
    if isinstance(modes, Mode):
        return [_numbers(modes)]
    if isinstance(modes, HasModes):
        modes = modes.modes
    if not hasattr(modes, "__len__"):
        raise _no_mode(modes)
    if len(modes) == 2 and all(isinstance(value, (int, float)) for value in modes):
        return [_numbers(cast("tuple[float, float]", modes))]
    return [_numbers(mode) for mode in cast(Sequence[ModeLike], modes)]


def _numbers(mode: ModeLike) -> tuple[float, float, float, float]:
    if not isinstance(mode, Mode):
        try:
            frequency, damping = mode
            mode = Mode(float(frequency), float(damping))
        except (TypeError, ValueError) as error:
            raise _no_mode(mode) from error
    hertz = mode.frequency_hz
    if not (math.isfinite(hertz) and hertz > 0.0):
        raise ShaperError(f"natural frequency {hertz} Hz is not a finite number above 0")
    deviations = [mode.frequency_std_hz, mode.damping_std]
    frequency_std, damping_std = (std if math.isfinite(std) else 0.0 for std in deviations)
    return hertz, mode.damping_ratio, frequency_std, damping_std


def _no_mode(value: object) -> ShaperError:
    return ShaperError(f"{value!r} is no mode: one is (natural frequency in Hz, damping ratio), or a quell.Mode")
