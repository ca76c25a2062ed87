"""What every `ArmsDriver` owes to its callers; one rig a driver."""

import numpy as np
import pytest

from executive.core.errors import DeviceError
from robots.descriptions.yumi import FINGER_SPEED_M_S
from robots.interfaces import ARMS, ArmsDriver
from robots.limits import yumi_limits
from robots.motion.timing import rest_to_rest
from robots.placement import HOME_RAD
from simulation.table_world import TableWorld

LIMITS = yumi_limits()
AWAY_RAD = HOME_RAD + np.tile([0.2, 0.3, -0.3, 0.2, 0.5, 0.3, -0.5], 2)
TRACKING_RAD = 1e-4
STEP_S = 1 / 240


class PyBulletRig:
    """The simulated arms, far from a cable."""

    def __init__(self):
        nodes_m = np.column_stack(
            [np.linspace(-0.1, 0.1, 21), np.full(21, 0.3), np.full(21, 0.004)]
        )
        self._world = TableWorld(nodes_m, round(1 / STEP_S))
        self.driver = self._world.driver

    def step(self):
        self._world.advance(1)

    def close(self):
        self._world.body.close()


RIGS = {"pybullet": PyBulletRig}


@pytest.fixture(params=sorted(RIGS))
def rig(request):
    rig = RIGS[request.param]()
    yield rig
    rig.close()


@pytest.fixture
def driver(rig):
    return rig.driver


def until_rest(rig):
    """Step until nothing moves and return the states on the way."""
    states = [rig.driver.state()]
    while states[-1].moving:
        rig.step()
        states.append(rig.driver.state())
        assert len(states) < 2000
    return states


def in_motion(rig, time_s=0.35):
    rig.driver.execute(rest_to_rest(HOME_RAD, AWAY_RAD, LIMITS))
    for _ in range(round(time_s / STEP_S)):
        rig.step()


def test_is_a_driver(driver):
    assert isinstance(driver, ArmsDriver)


def test_begins_at_rest_with_open_hands(driver):
    state = driver.state()
    assert not state.moving
    assert state.positions_rad == pytest.approx(HOME_RAD, abs=1e-6)
    assert state.velocities_rad_s == pytest.approx(np.zeros(14), abs=1e-6)
    assert state.openings_m == pytest.approx(dict.fromkeys(ARMS, 0.05), abs=1e-6)
    assert not any(driver.holds(arm) or driver.gripping(arm) for arm in ARMS)


def test_is_where_the_trajectory_says_at_every_time(rig, driver):
    trajectory = rest_to_rest(HOME_RAD, AWAY_RAD, LIMITS)
    start_s = driver.state().stamp_s
    driver.execute(trajectory)
    states = until_rest(rig)
    assert len(states) <= int(trajectory.duration_s / STEP_S) + 4
    for state in states:
        position, _, acceleration = trajectory.at(state.stamp_s - start_s)
        assert state.positions_rad == pytest.approx(position, abs=TRACKING_RAD)
        assert state.accelerations_rad_s2 == pytest.approx(acceleration, abs=1e-6)
    assert states[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)


def test_a_state_is_a_snapshot(rig, driver):
    in_motion(rig, 0.1)
    state = driver.state()
    before = state.positions_rad.copy(), state.accelerations_rad_s2.copy()
    rig.step()
    assert np.array_equal(state.positions_rad, before[0])
    assert np.array_equal(state.accelerations_rad_s2, before[1])


def test_refuses_a_trajectory_that_begins_elsewhere(rig, driver):
    with pytest.raises(DeviceError, match=r"begins elsewhere; got left joint \d off by 0.01"):
        driver.execute(rest_to_rest(HOME_RAD + 0.01, AWAY_RAD, LIMITS))
    assert not driver.state().moving
    rig.step()
    assert driver.state().positions_rad == pytest.approx(HOME_RAD, abs=1e-6)


def test_refuses_a_second_trajectory_and_goes_on_with_the_first(rig, driver):
    in_motion(rig, 0.1)
    with pytest.raises(DeviceError, match="a motion is under way"):
        driver.execute(rest_to_rest(driver.state().positions_rad, HOME_RAD, LIMITS))
    assert until_rest(rig)[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)


def test_a_stop_keeps_the_jerk_limits_and_the_path(rig, driver):
    in_motion(rig)
    driver.stop()
    states = until_rest(rig)
    accelerations = np.array([state.accelerations_rad_s2 for state in states])
    jerks = np.diff(accelerations, axis=0) / STEP_S
    assert (np.abs(jerks[:-1]) <= LIMITS.jerk * 1.001).all()
    assert (np.abs(accelerations) <= LIMITS.acceleration * 1.001).all()
    direction = (AWAY_RAD - HOME_RAD) / np.linalg.norm(AWAY_RAD - HOME_RAD)
    for state in states:
        gone = state.positions_rad - HOME_RAD
        assert np.linalg.norm(gone - (gone @ direction) * direction) < 10 * TRACKING_RAD
    assert np.abs(states[-1].velocities_rad_s).max() < 1e-3


def test_brakes_bite_harder_than_a_stop_does(rig, driver):
    in_motion(rig)
    driver.emergency_stop()
    braking_s = (len(until_rest(rig)) - 1) * STEP_S
    at_speed = rest_to_rest(HOME_RAD, AWAY_RAD, LIMITS).at(0.35)[1]
    assert braking_s < 0.6 * np.abs(at_speed / LIMITS.acceleration).max() + 2 * STEP_S


def test_brakes_may_take_over_from_a_stop_but_not_the_other_way_round(rig, driver):
    in_motion(rig)
    driver.stop()
    rig.step()
    driver.emergency_stop()
    rig.step()
    driver.stop()
    assert len(until_rest(rig)) * STEP_S < 0.15


def derivatives(states):
    """Return commanded velocities, accelerations and jerks over the steps between states."""
    accelerations = np.array([state.accelerations_rad_s2 for state in states])
    velocities = np.array([state.velocities_rad_s for state in states])
    return velocities, accelerations, np.diff(accelerations, axis=0) / STEP_S


def until_held(rig):
    """Hold the motion and step until it rests; return the states on the way."""
    rig.driver.hold()
    states = [rig.driver.state()]
    while not rig.driver.held():
        rig.step()
        states.append(rig.driver.state())
        assert len(states) < 2000
    return states


def long_way():
    """Return a motion that takes seconds, so that there is time to hold it."""
    return rest_to_rest(HOME_RAD, AWAY_RAD, LIMITS.slowed(0.4))


def on_a_long_way(rig, time_s):
    rig.driver.execute(long_way())
    for _ in range(round(time_s / STEP_S)):
        rig.step()


@pytest.mark.parametrize("time_s", [0.1, 0.5, 0.8])
def test_a_held_motion_rests_on_its_path_within_all_limits_and_is_taken_up_again(rig, time_s):
    on_a_long_way(rig, time_s)
    slowing = until_held(rig)
    assert slowing[-1].moving
    assert np.abs(slowing[-1].velocities_rad_s).max() < 1e-3
    for _ in range(50):
        rig.step()
    assert rig.driver.state().positions_rad == pytest.approx(slowing[-1].positions_rad, abs=1e-5)
    rig.driver.go_on()
    assert not rig.driver.held()
    states = [*slowing, *until_rest(rig)]
    velocities, accelerations, jerks = derivatives(states)
    assert (np.abs(velocities) <= LIMITS.velocity * 1.01).all()
    assert (np.abs(accelerations) <= LIMITS.acceleration * 1.001).all()
    assert (np.abs(jerks[:-1]) <= LIMITS.jerk * 1.001).all()
    direction = (AWAY_RAD - HOME_RAD) / np.linalg.norm(AWAY_RAD - HOME_RAD)
    for state in states:
        gone = state.positions_rad - HOME_RAD
        assert np.linalg.norm(gone - (gone @ direction) * direction) < 10 * TRACKING_RAD
    assert states[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)


def test_a_motion_may_be_held_again_while_it_is_taken_up(rig, driver):
    on_a_long_way(rig, 0.3)
    until_held(rig)
    driver.go_on()
    rig.step()
    where_rad = until_held(rig)[-1].positions_rad
    assert np.linalg.norm(where_rad - HOME_RAD) < np.linalg.norm(AWAY_RAD - HOME_RAD)
    driver.go_on()
    assert until_rest(rig)[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)


def test_a_held_motion_that_goes_on_at_once_still_arrives(rig, driver):
    on_a_long_way(rig, 0.3)
    driver.hold()
    rig.step()
    driver.go_on()
    states = until_rest(rig)
    assert (np.abs(derivatives(states)[2][:-1]) <= LIMITS.jerk * 1.001).all()
    assert states[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)


def test_a_stop_gives_a_held_motion_up(rig, driver):
    on_a_long_way(rig, 0.3)
    where_rad = until_held(rig)[-1].positions_rad
    driver.stop()
    until_rest(rig)
    driver.go_on()
    rig.step()
    assert driver.state().positions_rad == pytest.approx(where_rad, abs=TRACKING_RAD)
    driver.execute(rest_to_rest(driver.state().positions_rad, HOME_RAD, LIMITS))
    assert until_rest(rig)[-1].positions_rad == pytest.approx(HOME_RAD, abs=TRACKING_RAD)


def test_a_stop_while_a_motion_slows_down_keeps_the_limits(rig, driver):
    on_a_long_way(rig, 0.5)
    driver.hold()
    for _ in range(20):
        rig.step()
    driver.stop()
    _, accelerations, jerks = derivatives(until_rest(rig))
    assert (np.abs(accelerations) <= LIMITS.acceleration * 1.001).all()
    assert (np.abs(jerks[:-1]) <= LIMITS.jerk * 1.001).all()


def test_a_motion_that_is_nearly_over_ends_instead_of_being_held(rig, driver):
    on_a_long_way(rig, long_way().duration_s - 0.03)
    driver.hold()
    assert until_rest(rig)[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)
    driver.go_on()
    driver.execute(rest_to_rest(driver.state().positions_rad, HOME_RAD, LIMITS))
    assert until_rest(rig)[-1].positions_rad == pytest.approx(HOME_RAD, abs=TRACKING_RAD)


def test_holding_what_rests_does_nothing(rig, driver):
    driver.hold()
    assert not driver.held()
    driver.execute(rest_to_rest(HOME_RAD, AWAY_RAD, LIMITS))
    assert until_rest(rig)[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)


def test_nothing_moves_after_an_emergency_stop(rig, driver):
    in_motion(rig)
    driver.emergency_stop()
    until_rest(rig)
    here_rad = driver.state().positions_rad
    with pytest.raises(DeviceError, match="an emergency stop was made"):
        driver.execute(rest_to_rest(here_rad, HOME_RAD, LIMITS))
    with pytest.raises(DeviceError, match="an emergency stop was made"):
        driver.grip("left", "pinch")
    driver.go_on()
    rig.step()
    assert driver.state().positions_rad == pytest.approx(here_rad, abs=1e-5)


def test_moves_again_after_a_stop(rig, driver):
    in_motion(rig)
    driver.stop()
    until_rest(rig)
    driver.execute(rest_to_rest(driver.state().positions_rad, HOME_RAD, LIMITS))
    assert until_rest(rig)[-1].positions_rad == pytest.approx(HOME_RAD, abs=TRACKING_RAD)


def test_stopping_what_rests_does_nothing(rig, driver):
    driver.stop()
    driver.emergency_stop()
    assert not driver.state().moving
    rig.step()
    assert driver.state().positions_rad == pytest.approx(HOME_RAD, abs=1e-6)


@pytest.mark.parametrize("arm", ARMS)
def test_fingers_take_their_time_and_say_so(rig, driver, arm):
    driver.grip(arm, "pinch")
    openings_m = [driver.state().openings_m[arm]]
    while driver.gripping(arm):
        rig.step()
        openings_m.append(driver.state().openings_m[arm])
    speeds_m_s = np.diff(openings_m) / STEP_S
    assert np.abs(speeds_m_s).max() <= 2 * FINGER_SPEED_M_S * 1.01
    assert openings_m[-1] == pytest.approx(0.0, abs=1e-4)
    assert not driver.holds(arm)
    other = next(name for name in ARMS if name != arm)
    assert driver.state().openings_m[other] == pytest.approx(0.05, abs=1e-6)


def test_an_empty_cage_is_a_ring_that_holds_nothing(rig, driver):
    driver.grip("left", "cage")
    while driver.gripping("left"):
        rig.step()
    assert 0.008 < driver.state().openings_m["left"] < 0.013
    assert not driver.holds("left")


def test_fingers_move_while_the_arms_do(rig, driver):
    in_motion(rig, 0.05)
    driver.grip("right", "cage")
    assert until_rest(rig)[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)
    assert driver.state().openings_m["right"] < 0.03
