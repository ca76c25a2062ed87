"""A sampled trajectory is the trajectory."""

import numpy as np
import pytest

from robots.drivers.samples import SampledTrajectory
from robots.limits import yumi_limits
from robots.motion.timing import rest_to_rest
from robots.placement import HOME_RAD

LIMITS = yumi_limits()
PERIOD_S = 0.004
MOTION = rest_to_rest(HOME_RAD, HOME_RAD + 0.3, LIMITS)


@pytest.fixture
def sampled():
    return SampledTrajectory.of(MOTION, PERIOD_S)


def test_samples_are_those_of_the_trajectory(sampled):
    assert MOTION.duration_s <= sampled.duration_s < MOTION.duration_s + PERIOD_S
    for index in range(len(sampled.rows)):
        for ours, theirs in zip(
            sampled.at(index * PERIOD_S), MOTION.at(index * PERIOD_S), strict=True
        ):
            assert np.array_equal(ours, theirs)


def test_between_samples_it_stays_near_and_within_the_limits(sampled):
    times_s = np.linspace(0.0, MOTION.duration_s, 1731)
    ours = np.array([sampled.at(t) for t in times_s])
    theirs = np.array([MOTION.at(t) for t in times_s])
    assert np.abs(ours - theirs)[:, 0].max() < 1e-6
    assert np.abs(ours - theirs)[:, 1].max() < 1e-3
    jerks = np.diff(ours[:, 2], axis=0) / np.diff(times_s)[:, None]
    assert (np.abs(jerks) <= LIMITS.jerk * 1.001).all()
    assert (np.abs(ours[:, 2]) <= LIMITS.acceleration * 1.001).all()


def test_ends_are_those_of_the_trajectory_at_all_times_outside(sampled):
    assert np.array_equal(sampled.at(-1.0)[0], HOME_RAD)
    assert sampled.at(99.0)[0] == pytest.approx(HOME_RAD + 0.3)
    assert sampled.at(99.0)[1] == pytest.approx(np.zeros(14))


def test_bytes_bring_it_back(sampled):
    back = SampledTrajectory.from_bytes(PERIOD_S, sampled.to_bytes())
    assert np.array_equal(back.rows, sampled.rows)
    assert SampledTrajectory.of(back, PERIOD_S).to_bytes() == sampled.to_bytes()


@pytest.mark.parametrize(
    "data",
    [b"", b"\0" * 7, np.zeros(3 * 14).tobytes(), np.full(2 * 3 * 14, np.nan).tobytes()],
    ids=["nothing", "no number", "one sample", "not finite"],
)
def test_what_is_no_trajectory_is_refused(data):
    with pytest.raises(ValueError, match=r"."):
        SampledTrajectory.from_bytes(PERIOD_S, data)
