"""Recordings that the tests make themselves."""

from __future__ import annotations

import matplotlib
import numpy as np
import pytest
import quell

matplotlib.use("Agg")

RATE = 500.0


def deformation_of(acceleration: np.ndarray, hertz: float, damping: float) -> np.ndarray:
    """The exact answer of a linear joint to a motor side whose acceleration is linear between ticks."""
    w, h = 2.0 * np.pi * hertz, 1.0 / RATE
    # x' = A x + B a, with a' constant over a tick: one exponential of the whole.
    whole = np.zeros((4, 4))
    whole[0, 1] = whole[2, 3] = 1.0
    whole[1] = [-w * w, -2.0 * damping * w, -1.0, 0.0]
    values, vectors = np.linalg.eig(h * whole + 1e-12 * np.diag([0, 0, 1, 2]))
    step = (vectors @ np.diag(np.exp(values)) @ np.linalg.inv(vectors)).real
    state, out = np.zeros(2), [0.0]
    for now, then in zip(acceleration[:-1], acceleration[1:]):
        state = (step @ [*state, now, (then - now) / h])[:2]
        out.append(state[0])
    return np.array(out)


def moves(targets: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Position and acceleration of the motor side, with a rest of 1 s after each move."""
    limits, at = quell.Limits(2.5, 30.0, 600.0), 0.0
    position, acceleration = [np.zeros(int(RATE))], [np.zeros(int(RATE))]
    for target in targets:
        one = quell.plan(at, target, limits, rate=RATE)
        position += [one.position[1:], np.full(int(RATE), target)]
        acceleration += [one.acceleration[1:], np.zeros(int(RATE))]
        at = target
    return np.concatenate(position), np.concatenate(acceleration)


@pytest.fixture(scope="session")
def joint() -> dict[str, np.ndarray]:
    """Motor position and deformation, rad, of a joint of 8 Hz and 0.05, at 500 Hz."""
    position, acceleration = moves([0.8, 0.2, 1.1])
    noise = 2e-5 * np.random.default_rng(3).standard_normal(len(position))
    return {"motor_position": position, "deformation": deformation_of(acceleration, 8.0, 0.05) + noise}


@pytest.fixture(scope="session")
def recording(joint: dict[str, np.ndarray]) -> quell.Recording:
    """The same as a recording."""
    return quell.Recording.from_arrays(joint, rate=RATE, units=dict.fromkeys(joint, "rad"), name="joint")


@pytest.fixture(scope="session")
def model() -> quell.Model:
    """What is believed of it."""
    return quell.Model("flexible_joint", natural_frequency_hz=8.2, damping_ratio=0.06)
