"""Timed motions keep every limit at 1 kHz, join without steps, and stop where they may."""

import numpy as np
import pytest

from executive.core.errors import DeviceError
from robots.interfaces import ArmsState, Trajectory
from robots.limits import yumi_limits
from robots.motion.line_timing import time_curve
from robots.motion.stopping import stop_trajectory
from robots.motion.timing import PiecewiseTrajectory, cut_corners, rest_to_rest, stop_at_waypoints
from robots.placement import HOME_RAD

LIMITS = yumi_limits()
TOLERANCE = 1.001


def sampled(trajectory, period_s=0.001):
    times = np.append(np.arange(0.0, trajectory.duration_s, period_s), trajectory.duration_s)
    states = [trajectory.at(t) for t in times]
    return times, *(np.array([state[k] for state in states]) for k in range(3))


def assert_within_limits(trajectory, limits=LIMITS):
    times, q, v, a = sampled(trajectory)
    assert np.all(q >= limits.lower - 1e-9)
    assert np.all(q <= limits.upper + 1e-9)
    assert np.all(np.abs(v) <= limits.velocity * TOLERANCE)
    assert np.all(np.abs(a) <= limits.acceleration * TOLERANCE)
    jerk = np.diff(a, axis=0) / np.diff(times)[:, None]
    assert np.all(np.abs(jerk[:-1]) <= limits.jerk * TOLERANCE)


def assert_consistent(trajectory):
    """Position, velocity and acceleration are derivatives of each other: no steps anywhere."""
    times, q, v, a = sampled(trajectory)
    gaps = np.diff(times)[:, None]
    mean_v, mean_a = (v[1:] + v[:-1]) / 2, (a[1:] + a[:-1]) / 2
    assert np.abs(np.diff(q, axis=0) - mean_v * gaps).max() < 1e-4
    assert np.abs(np.diff(v, axis=0) - mean_a * gaps).max() < 1e-3


def detour(rng, count=5):
    bound = 0.5
    return [HOME_RAD + rng.uniform(-bound, bound, 14) for _ in range(count)]


def state_of(trajectory, time_s):
    return ArmsState(*trajectory.at(time_s), {}, True, time_s)


def test_an_edge_is_straight_and_keeps_limits(rng):
    a, b = detour(rng, 2)
    trajectory = PiecewiseTrajectory([rest_to_rest(a, b, LIMITS)])
    assert isinstance(trajectory, Trajectory)
    assert_within_limits(trajectory)
    assert_consistent(trajectory)
    _, q, _, _ = sampled(trajectory)
    shares = (q - a) / (b - a)
    assert np.ptp(shares, axis=1).max() < 1e-9


def test_slowed_limits_stretch_time_exactly(rng):
    a, b = detour(rng, 2)
    full, slow = (rest_to_rest(a, b, LIMITS.slowed(scale)).duration_s for scale in (1.0, 0.4))
    assert slow == pytest.approx(full / 0.4, rel=1e-6)


def test_outside_its_time_a_motion_rests_at_its_ends(rng):
    a, b = detour(rng, 2)
    trajectory = PiecewiseTrajectory([rest_to_rest(a, b, LIMITS)])
    for time_s, end in ((-1.0, a), (99.0, b)):
        position, velocity, _ = trajectory.at(time_s)
        assert position == pytest.approx(end)
        assert velocity == pytest.approx(np.zeros(14), abs=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_cut_corners_are_faster_and_as_legal(seed):
    rng = np.random.default_rng(seed)
    path = detour(rng)
    stops = stop_at_waypoints(path, LIMITS)
    cut = cut_corners(stops, LIMITS, lambda q: True, rng, tries=60)
    assert cut.duration_s < 0.9 * stops.duration_s
    assert cut.at(0.0)[0] == pytest.approx(path[0])
    assert cut.at(cut.duration_s)[0] == pytest.approx(path[-1])
    assert_within_limits(cut)
    assert_consistent(cut)


def test_corners_are_not_cut_through_obstacles(rng):
    path = [HOME_RAD, HOME_RAD + 0.4 * np.eye(14)[3], HOME_RAD + 0.4 * np.eye(14)[[3, 5]].sum(0)]
    stops = stop_at_waypoints(path, LIMITS)

    def is_free(q):
        return q[3] - HOME_RAD[3] >= q[5] - HOME_RAD[5] - 1e-9 and q[3] - HOME_RAD[3] > 0.38

    cut = cut_corners(stops, LIMITS, is_free, rng, tries=40)
    _, q, _, _ = sampled(cut, 0.01)
    inside = q[(q[:, 5] - HOME_RAD[5]) > 1e-3]
    assert np.all(inside[:, 3] - HOME_RAD[3] > 0.37)


def test_a_curve_is_passed_within_limits_and_rate(rng):
    s = np.linspace(0.0, 1.0, 40)[:, None]
    samples = HOME_RAD + 0.3 * np.sin(3.0 * s + rng.uniform(0, 1, 14)) * rng.uniform(0, 1, 14)
    fast, slow = (time_curve(samples, LIMITS, rate) for rate in (100.0, 0.5))
    assert_within_limits(fast)
    assert_consistent(fast)
    assert slow.duration_s > max(2.0, fast.duration_s)
    assert fast.at(fast.duration_s)[0] == pytest.approx(samples[-1])


def test_a_stop_on_an_edge_stays_on_the_edge(rng):
    a, b = detour(rng, 2)
    edge = PiecewiseTrajectory([rest_to_rest(a, b, LIMITS)])
    for share in (0.1, 0.3, 0.5, 0.8):
        stop = stop_trajectory(state_of(edge, share * edge.duration_s), LIMITS)
        assert_within_limits(stop)
        _, q, v, _ = sampled(stop)
        assert np.ptp((q - a) / (b - a), axis=1).max() < 1e-6
        assert v[-1] == pytest.approx(np.zeros(14), abs=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_a_stop_from_any_legal_motion_is_legal(seed):
    rng = np.random.default_rng(seed)
    stops = stop_at_waypoints(detour(rng), LIMITS)
    motion = cut_corners(stops, LIMITS, lambda q: True, rng, tries=40)
    for time_s in rng.uniform(0.0, motion.duration_s, 5):
        state = state_of(motion, time_s)
        stop = stop_trajectory(state, LIMITS)
        assert stop.at(0.0)[0] == pytest.approx(state.positions_rad)
        assert stop.at(0.0)[1] == pytest.approx(state.velocities_rad_s, abs=1e-9)
        assert stop.at(stop.duration_s)[1] == pytest.approx(np.zeros(14), abs=1e-9)
        assert stop.duration_s < 0.6
        assert_within_limits(stop)


def test_at_rest_there_is_nothing_to_stop():
    still = np.zeros(14)
    stop = stop_trajectory(ArmsState(HOME_RAD, still, still, {}, False, 0.0), LIMITS)
    assert stop.duration_s == pytest.approx(0.0)
    assert stop.at(0.0)[0] == pytest.approx(HOME_RAD)


def test_a_state_that_is_not_finite_cannot_be_stopped():
    broken = ArmsState(HOME_RAD, np.full(14, np.nan), np.zeros(14), {}, True, 0.0)
    with pytest.raises(DeviceError, match="not finite"):
        stop_trajectory(broken, LIMITS)
