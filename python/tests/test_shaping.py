"""Shapers, filters and moves against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
import quell


def test_val_zv_has_the_impulses_of_singer_and_seering() -> None:
    hertz, damping = 8.0, 0.05
    k = math.exp(-damping * math.pi / math.sqrt(1.0 - damping**2))
    zv = quell.Shaper("zv", (hertz, damping), rate=1000)
    half_period = 0.5 / (hertz * math.sqrt(1.0 - damping**2))
    np.testing.assert_allclose(zv.impulses, [[0.0, 1.0 / (1.0 + k)], [half_period, k / (1.0 + k)]], rtol=1e-12)
    assert zv.residual([hertz, 1.2 * hertz])[0] < 1e-12 < 0.1 < zv.residual(1.2 * hertz)


@pytest.mark.parametrize("name", quell.shapers())
def test_a_filter_by_steps_over_arrays_and_a_whole_command_are_one(name: str) -> None:
    move = quell.plan(0.3, 1.1, quell.Limits(2.0, 8.0, 60.0), rate=250)
    shaper = quell.Shaper(name, (6.0, 0.04), rate=250)
    whole = shaper.apply(move.position)
    kernel = np.zeros(round(shaper.taps[-1, 0] * 250) + 1)
    np.add.at(kernel, np.round(shaper.taps[:, 0] * 250).astype(int), shaper.taps[:, 1])
    expected = np.convolve(move.position - 0.3, kernel) + 0.3
    np.testing.assert_allclose(whole[: len(move.position)], expected[: len(move.position)], atol=1e-12)
    assert whole[-1] == move.position[-1]
    filters = [quell.AdaptiveFilter(rate=250) for _ in range(2)]
    for one in filters:
        one.install(shaper)
        one.reset(0.3)
    steps = [filters[0].step(*tick) for tick in zip(move.position, move.velocity, move.acceleration)]
    arrays = filters[1].apply(move.position, move.velocity, move.acceleration)
    np.testing.assert_array_equal(np.array(steps), arrays)
    np.testing.assert_allclose(arrays[:, 0], whole[: len(arrays)], atol=1e-12)


def test_arrays_are_read_where_they_are_whatever_their_layout() -> None:
    shaper = quell.Shaper("ei", [(6.0, 0.04), (17.0, 0.02)], rate=250)
    columns = np.random.default_rng(1).standard_normal((200, 3)).cumsum(axis=0)
    together = shaper.apply(columns)
    for axis in range(3):
        alone = shaper.apply(columns[:, axis])
        np.testing.assert_array_equal(together[: len(alone), axis], alone)
    np.testing.assert_array_equal(shaper.apply(columns[::-2, 0]), shaper.apply(columns[::-2, 0].copy()))
    np.testing.assert_array_equal(shaper.apply([0, 1, 1]), shaper.apply(np.array([0.0, 1.0, 1.0])))


def test_a_shaper_is_changed_in_motion() -> None:
    limits = quell.Limits(2.0, 20.0, 400.0)
    move = quell.plan(0.0, 1.0, quell.Limits(1.6, 10.0, 100.0), rate=250)
    wrong, right = (quell.Shaper("zv", (hertz, 0.05), rate=250) for hertz in (9.0, 6.0))
    left = []
    for changes in (False, True):
        filter = quell.AdaptiveFilter(rate=250)
        filter.install(wrong)
        at, rest = 60, np.full(1000, 1.0)
        filter.apply(move.position[:at], move.velocity[:at], move.acceleration[:at])
        if changes:
            told = filter.retune(right, limits, move.position[at:], move.velocity[at:], move.acceleration[at:])
            assert told.outcome == "corrected" and told.peak_over_limit <= 1.0 + 1e-9
        filter.apply(move.position[at:], move.velocity[at:], move.acceleration[at:])
        filter.apply(rest)
        assert filter.is_settled
        shaped, unshaped = filter.residual((6.0, 0.05))
        left.append(shaped / unshaped)
    assert left[1] < 0.2 * left[0]


def test_a_move_keeps_its_limits_and_ends_on_its_target() -> None:
    limits = [quell.Limits(2.0, 8.0, 60.0), quell.Limits(1.0, 5.0, 40.0)]
    move = quell.plan([0.0, 1.0], [0.7, -0.4], limits, rate=1000, start_velocity=[0.2, 0.0])
    assert move.position.shape == (len(move.time), 2)
    np.testing.assert_array_equal(move.position[-1], [0.7, -0.4])
    for axis, limit in enumerate(limits):
        jerk = np.diff(move.acceleration[:-1, axis]) * 1000
        peaks = [np.abs(one).max() for one in (move.velocity[:, axis], move.acceleration[:, axis], jerk)]
        assert np.all(peaks <= np.array([limit.velocity, limit.acceleration, limit.jerk]) * (1.0 + 1e-6))


@pytest.mark.parametrize(
    ("error", "words", "work"),
    [
        (quell.ShaperError, 'did you mean "zvd"', lambda: quell.Shaper("zvdx", (8, 0.05), rate=250)),
        (quell.ShaperError, "-8", lambda: quell.Shaper("zv", (-8, 0.05), rate=250)),
        (quell.ShaperError, "rate of 0", lambda: quell.Shaper("zv", (8, 0.05), rate=0)),
        (quell.ShaperError, r"\(1,\) is nan", lambda: quell.shape([0, np.nan], (8, 0.05), rate=250)),
        (quell.ShaperError, r"shape \(0,\)", lambda: quell.shape([], (8, 0.05), rate=250)),
        (quell.ShaperError, "0.001", lambda: quell.AdaptiveFilter(250).install(quell.Shaper("zv", (8, 0.05), 1000))),
        (quell.ShaperError, "velocity: inf", lambda: quell.AdaptiveFilter(250).step(0.0, np.inf)),
        (quell.PlanError, "axis 1", lambda: quell.plan([0, 0], [1, np.inf], quell.Limits(1, 1, 1), rate=250)),
        (quell.PlanError, "one shape", lambda: quell.plan([0, 0], [1, 2, 3], quell.Limits(1, 1, 1), rate=250)),
        (quell.PlanError, "-1", lambda: quell.plan(0, 1, quell.Limits(-1, 1, 1), rate=250)),
    ],
)
def test_bad_input_is_refused_with_its_value(error, words, work) -> None:
    with pytest.raises(error, match=words):
        work()
