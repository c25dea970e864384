"""The measuring chain: encoder on the motor side and one output sensor on a clock of its own.

A stamp s of the output clock means the true time s + clock offset (+ skew s). The encoder's clock is the reference.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import cont2discrete, lfilter
from scipy.spatial.transform import Rotation

ENCODER_PERIOD_S = 0.004
ENCODER_STEP = 2 * np.pi / 2 ** 22
# The encoder's electronics jitter by a fraction of a step. Without it the last bit toggles in time with a ringing arm,
# which a lightly damped model amplifies to twice the tracker's noise.
ENCODER_JITTER = 0.25
FIRST_STAMP_S = 0.0007


@dataclass
class Chain:
    """An output sensor; effects change a copy of it."""

    role: str
    period: float
    noise_std: float
    noise_kind: str                 # "white" or "ar1"
    clock_offset: float
    rotation: np.ndarray            # frame of a tracker
    translation: np.ndarray
    clock: list = field(default_factory=list)      # maps true times of samples (taken in turn)
    lags: list = field(default_factory=list)       # (numerator, denominator) of linear lags
    static: list = field(default_factory=list)     # maps (values, motor position, run quantities) without memory
    drift: list = field(default_factory=list)      # functions of time, added to the values
    drop: list = field(default_factory=list)       # functions (rng, count) -> mask of samples kept


def random_chain(rng, role, fast, lever):
    """A sensor of the given role with random noise, frame and clock offset."""
    noise_m = float(rng.choice([5e-6, 1e-5, 1.5e-5]))
    noise, period = {
        "tip_position": (noise_m, 0.001 if fast else 0.003),
        "deformation": (noise_m / lever, 0.001 if fast else 0.003),
        "tip_acceleration": (round(rng.uniform(0.04, 0.1), 4), 0.001),
    }[role]
    return Chain(role, period, noise, "ar1" if rng.random() < 0.12 else "white", rng.uniform(-0.002, 0.002),
                 Rotation.random(rng=rng).as_matrix(), rng.uniform(-4, 4, 3))


def noise(rng, chain, shape):
    """Measurement noise of standard deviation `noise_std`; "ar1" is a first-order recursion with coefficient 0.5."""
    white = rng.standard_normal(shape)
    if chain.noise_kind == "ar1":
        start = white[:1]
        white = lfilter([np.sqrt(0.75)], [1, -0.5], white[1:], axis=0, zi=0.5 * start)[0]
        white = np.vstack([start, white])
    return chain.noise_std * white


def quantity(run, chain, lever):
    """What the sensor would see without noise, at every engine step, in the arm's own frame."""
    if chain.role == "tip_position":
        return run.tip
    if chain.role == "deformation":
        return run.deformation[:, None]
    spline = CubicSpline(run.time, run.tip)
    return tangential(spline(run.time, 2), run.angle)


def tangential(acceleration, angle):
    """Component along the direction in which the tip moves."""
    return (-np.sin(angle) * acceleration[:, 0] + np.cos(angle) * acceleration[:, 1])[:, None]


def record(rng, run, chain, lever, begin):
    """Samples a run from time `begin` on, as a recording with clocks that start there."""
    dt = run.time[1] - run.time[0]
    values = quantity(run, chain, lever)
    for apply in chain.static:
        values = apply(values, run)
    for num, den in chain.lags:
        b, a, _ = cont2discrete((num, den), dt, method="foh")
        values = np.column_stack([lfilter(b.ravel(), a, v - v[0]) + v[0] for v in values.T])

    end = run.time[-1] - begin
    encoder_time = np.arange(0, int(end / ENCODER_PERIOD_S + 1e-9) + 1) * ENCODER_PERIOD_S
    index = np.rint((encoder_time + begin) / dt).astype(int)
    dither = ENCODER_JITTER * rng.standard_normal(index.size)
    encoder = np.rint(run.motor[index] / ENCODER_STEP + dither) * ENCODER_STEP + 0.0

    # Every sample falls within the encoder's span, unless the arm rests before it.
    first = FIRST_STAMP_S + (0.004 if begin > 0 else 0.0)
    stamps = first + chain.period * np.arange(int((end - 0.004 - first) / chain.period))
    true_time = stamps + chain.clock_offset
    for warp in chain.clock:
        true_time = warp(true_time)
    lead = true_time + begin                      # before the start the arm is at rest, so clipping is exact there
    sampled = CubicSpline(run.time, values)(np.clip(lead, 0.0, run.time[-1]))
    for add in chain.drift:
        sampled = sampled + add(true_time)
    if chain.role == "tip_position":
        sampled = sampled @ chain.rotation.T + chain.translation
    sampled = sampled + noise(rng, chain, sampled.shape)
    keep = np.ones(stamps.size, bool)
    for drop in chain.drop:
        keep &= drop(rng, stamps.size)
    return {"role": chain.role, "encoder_time": encoder_time, "encoder": encoder, "time": stamps[keep],
            "values": sampled[keep], "time_digits": 4}
