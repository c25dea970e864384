"""Numbers that nobody means: refused with an error of the package, never a panic, never a crash."""

from __future__ import annotations

import itertools
import warnings

import numpy as np
import quell

ODD = [0.0, -1.0, 1e-300, 1e300, float("inf"), float("-inf"), float("nan"), 1e-9, 7.3, 1e9]


def held(work) -> bool:
    """Whether it came to an answer; an error of the package is one that is allowed."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            work()
    except quell.Error as error:
        assert str(error)
        return False
    return True


def test_odd_numbers_are_refused_or_taken() -> None:
    pairs = list(itertools.product(ODD, repeat=2))
    taken = 0
    for name, (a, b) in itertools.product(quell.shapers(), pairs):
        taken += held(lambda: quell.Shaper(name, (a, 0.05), rate=b))
        taken += held(lambda: quell.Shaper(name, (8.0, a), rate=250.0).residual([b, 8.0]))
    for a, b in pairs:
        taken += held(lambda: quell.recommend(quell.Mode(8.0, 0.05, a, b)))
        taken += held(lambda: quell.recommend((a, 0.05), acceptable=b, longest_delay=a))
        taken += held(lambda: quell.plan(a, b, quell.Limits(2.0, 8.0, 60.0), rate=250.0))
        taken += held(lambda: quell.plan(0.0, 1.0, quell.Limits(a, b, 60.0), rate=250.0, start_velocity=a))
        taken += held(lambda: quell.AdaptiveFilter(rate=250.0, longest_train=min(a, 10.0), horizon=min(b, 10.0)))
        taken += held(lambda: quell.Model("flexible_joint", natural_frequency_hz=a, damping_ratio=b))
        taken += held(lambda: quell.Recording.from_arrays({"torque": [a, b, 1.0]}, rate=100.0))
        taken += held(lambda: quell.Recording.from_arrays({"torque": [0.0, 1.0]}, time=[a, b]))
    assert taken > 100


def test_recordings_of_odd_numbers_are_refused_or_answered() -> None:
    rng = np.random.default_rng(5)
    model = quell.Model("flexible_joint", natural_frequency_hz=8.0, damping_ratio=0.06)
    units = {"motor_position": "rad", "deformation": "rad"}
    for n, scale in itertools.product([1, 2, 31, 40, 300], [1e-30, 1.0, 1e30]):
        channels = {name: scale * rng.standard_normal(n).cumsum() for name in units}
        recording = quell.Recording.from_arrays(channels, rate=100.0, units=units)
        held(lambda: quell.identify(recording))
        held(lambda: quell.score(model, recording))
        held(lambda: quell.diagnose(model, recording, time_limit=1e-3))
