"""What every `ArmsDriver` owes to its callers; `arm_rigs` names those that are tried."""

import threading

import numpy as np
import pytest

from executive.core.errors import DeviceError
from robots.descriptions.yumi import FINGER_SPEED_M_S, OPEN_OPENING_M
from robots.interfaces import ARMS, ArmsDriver
from robots.limits import yumi_limits
from robots.motion.timing import rest_to_rest
from robots.placement import HOME_RAD

LIMITS = yumi_limits()
AWAY_RAD = HOME_RAD + np.tile([0.2, 0.3, -0.3, 0.2, 0.5, 0.3, -0.5], 2)
WAY_RAD = AWAY_RAD - HOME_RAD
TRACKING_RAD = 1e-4
LONGEST_S = 10.0


@pytest.fixture
def rig(rig_class):
    rig = rig_class()
    yield rig
    rig.close()


@pytest.fixture
def driver(rig):
    return rig.driver


def states_while(rig, goes_on):
    """Step while something goes on; return the states on the way, each once, and the last."""
    states = [rig.driver.state()]
    end_s = states[0].stamp_s + LONGEST_S
    while goes_on():
        rig.step()
        state = rig.driver.state()
        if state.stamp_s > states[-1].stamp_s:
            states.append(state)
        assert state.stamp_s < end_s
    return states


def until_rest(rig):
    """Step until nothing moves and return the states on the way."""
    return states_while(rig, lambda: rig.driver.state().moving)


def until_held(rig):
    """Hold the motion and step until it rests; return the states on the way."""
    rig.driver.hold()
    return states_while(rig, lambda: not rig.driver.held())


def pass_time(rig, time_s):
    """Step for a time."""
    end_s = rig.driver.state().stamp_s + time_s
    while rig.driver.state().stamp_s < end_s:
        rig.step()


def start(rig, trajectory, time_s):
    """Execute a trajectory and step until it has gone on for a time by what the states show."""
    rig.driver.execute(trajectory)
    states = states_while(rig, lambda: not rig.driver.state().accelerations_rad_s2.any())
    pass_time(rig, begun_s(trajectory, states[-1]) + time_s - states[-1].stamp_s)


def begun_s(trajectory, early):
    """Return when a trajectory began, from a state while its acceleration still rises."""
    size = np.linalg.norm(early.accelerations_rad_s2)
    low_s, high_s = 0.0, 0.08
    assert size < np.linalg.norm(trajectory.at(high_s)[2])
    for _ in range(50):
        middle_s = (low_s + high_s) / 2
        below = np.linalg.norm(trajectory.at(middle_s)[2]) < size
        low_s, high_s = (middle_s, high_s) if below else (low_s, middle_s)
    return early.stamp_s - low_s


def quick():
    return rest_to_rest(HOME_RAD, AWAY_RAD, LIMITS)


def long_way():
    """Return a motion that takes seconds, so that there is time to hold it."""
    return rest_to_rest(HOME_RAD, AWAY_RAD, LIMITS.slowed(0.4))


def in_motion(rig, time_s=0.2):
    start(rig, quick(), time_s)


def on_a_long_way(rig, time_s):
    start(rig, long_way(), time_s)


def derivatives(states):
    """Return velocities, accelerations and the mean jerks between states.

    The last jerk is left out: an acceleration that has all but gone may end in a step.
    """
    stamps_s = np.array([state.stamp_s for state in states])
    accelerations = np.array([state.accelerations_rad_s2 for state in states])
    velocities = np.array([state.velocities_rad_s for state in states])
    jerks = np.diff(accelerations, axis=0) / np.diff(stamps_s)[:, None]
    return velocities, accelerations, jerks[:-1]


def assert_smooth(states):
    velocities, accelerations, jerks = derivatives(states)
    assert (np.abs(velocities) <= LIMITS.velocity * 1.01).all()
    assert (np.abs(accelerations) <= LIMITS.acceleration * 1.001).all()
    assert (np.abs(jerks) <= LIMITS.jerk * 1.001).all()


def assert_on_the_path(states):
    direction = WAY_RAD / np.linalg.norm(WAY_RAD)
    for state in states:
        gone = state.positions_rad - HOME_RAD
        assert np.linalg.norm(gone - (gone @ direction) * direction) < 10 * TRACKING_RAD


def test_is_a_driver(driver):
    assert isinstance(driver, ArmsDriver)


def test_begins_at_rest_with_open_hands(driver):
    state = driver.state()
    assert not state.moving
    assert not driver.held()
    assert state.positions_rad == pytest.approx(HOME_RAD, abs=1e-6)
    assert state.velocities_rad_s == pytest.approx(np.zeros(14), abs=1e-6)
    assert state.openings_m == pytest.approx(dict.fromkeys(ARMS, OPEN_OPENING_M), abs=1e-6)
    assert not any(driver.holds(arm) or driver.gripping(arm) for arm in ARMS)


def test_is_where_the_trajectory_says_at_every_time(rig, driver):
    trajectory = quick()
    asked_s = driver.state().stamp_s
    driver.execute(trajectory)
    states = until_rest(rig)
    began_s = begun_s(trajectory, next(s for s in states if s.accelerations_rad_s2.any()))
    assert -1e-6 <= began_s - asked_s <= rig.delay_s + 1e-6
    for state in states:
        position, _, acceleration = trajectory.at(max(state.stamp_s - began_s, 0.0))
        assert state.positions_rad == pytest.approx(position, abs=TRACKING_RAD)
        assert state.accelerations_rad_s2 == pytest.approx(acceleration, abs=1e-6)
    took_s = states[-1].stamp_s - began_s
    assert took_s <= trajectory.duration_s + 3 * rig.step_s + rig.delay_s
    assert states[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)


def test_moves_from_the_moment_that_it_is_told_to(rig, driver):
    driver.execute(quick())
    assert driver.state().moving
    with pytest.raises(DeviceError, match="a motion is under way"):
        driver.execute(quick())
    driver.grip("left", "cage")
    assert driver.gripping("left")


def test_stamps_never_go_back_and_go_on_at_rest(rig, driver):
    stamps_s = []
    for _ in range(40):
        rig.step()
        stamps_s.append(driver.state().stamp_s)
    assert (np.diff(stamps_s) >= 0.0).all()
    assert stamps_s[-1] - stamps_s[0] == pytest.approx(39 * rig.step_s, abs=rig.delay_s + 1e-6)


def test_a_state_is_a_snapshot(rig, driver):
    in_motion(rig, 0.1)
    state = driver.state()
    before = state.positions_rad.copy(), state.accelerations_rad_s2.copy()
    pass_time(rig, rig.step_s)
    assert np.array_equal(state.positions_rad, before[0])
    assert np.array_equal(state.accelerations_rad_s2, before[1])


def test_refuses_a_trajectory_that_begins_elsewhere(rig, driver):
    with pytest.raises(DeviceError, match=r"begins elsewhere; got left joint \d off by 0.01"):
        driver.execute(rest_to_rest(HOME_RAD + 0.01, AWAY_RAD, LIMITS))
    assert not driver.state().moving
    pass_time(rig, rig.delay_s + rig.step_s)
    assert driver.state().positions_rad == pytest.approx(HOME_RAD, abs=1e-6)


def test_refuses_a_second_trajectory_and_goes_on_with_the_first(rig, driver):
    in_motion(rig, 0.1)
    with pytest.raises(DeviceError, match="a motion is under way"):
        driver.execute(rest_to_rest(driver.state().positions_rad, HOME_RAD, LIMITS))
    assert until_rest(rig)[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)


def test_a_stop_keeps_the_jerk_limits_and_the_path(rig, driver):
    far_rad = HOME_RAD + 2 * WAY_RAD
    start(rig, rest_to_rest(HOME_RAD, far_rad, LIMITS), 0.15)
    driver.stop()
    states = until_rest(rig)
    assert_smooth(states)
    assert_on_the_path(states)
    assert np.linalg.norm(states[-1].positions_rad - far_rad) > 0.05
    assert np.abs(states[-1].velocities_rad_s).max() < 1e-3


def test_a_stop_right_after_the_start_is_a_stop(rig, driver):
    driver.execute(long_way())
    driver.stop()
    assert np.linalg.norm(until_rest(rig)[-1].positions_rad - HOME_RAD) < 0.05
    pass_time(rig, rig.delay_s + rig.step_s)
    here_rad = driver.state().positions_rad
    assert np.linalg.norm(here_rad - HOME_RAD) < 0.05
    driver.execute(rest_to_rest(here_rad, AWAY_RAD, LIMITS))
    assert until_rest(rig)[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)


def test_brakes_bite_harder_than_a_stop_does(rig, driver):
    in_motion(rig)
    driver.emergency_stop()
    states = until_rest(rig)
    braking_s = states[-1].stamp_s - states[0].stamp_s
    speeds = np.abs([state.velocities_rad_s for state in states]).max(axis=0)
    stopping_s = (speeds / LIMITS.acceleration).max()
    assert braking_s < 0.6 * stopping_s + 2 * rig.step_s + rig.delay_s
    assert np.linalg.norm(states[-1].positions_rad - AWAY_RAD) > 0.05


def test_brakes_may_take_over_from_a_stop_but_not_the_other_way_round(rig, driver):
    in_motion(rig)
    driver.stop()
    rig.step()
    driver.emergency_stop()
    rig.step()
    driver.stop()
    states = until_rest(rig)
    assert states[-1].stamp_s - states[0].stamp_s < 0.15 + rig.delay_s


def test_an_emergency_stop_may_come_from_any_thread(rig, driver):
    in_motion(rig, 0.05)
    other = threading.Thread(target=driver.emergency_stop)
    other.start()
    other.join()
    states = until_rest(rig)
    assert np.linalg.norm(states[-1].positions_rad - AWAY_RAD) > 0.05
    with pytest.raises(DeviceError, match="an emergency stop was made"):
        driver.execute(rest_to_rest(states[-1].positions_rad, HOME_RAD, LIMITS))


@pytest.mark.parametrize("time_s", [0.1, 0.5, 0.8])
def test_a_held_motion_rests_on_its_path_within_all_limits_and_is_taken_up_again(rig, time_s):
    on_a_long_way(rig, time_s)
    slowing = until_held(rig)
    assert slowing[-1].moving
    assert np.abs(slowing[-1].velocities_rad_s).max() < 1e-3
    pass_time(rig, 0.2)
    assert rig.driver.state().positions_rad == pytest.approx(slowing[-1].positions_rad, abs=1e-5)
    rig.driver.go_on()
    assert not rig.driver.held()
    states = [*slowing, *until_rest(rig)]
    assert_smooth(states)
    assert_on_the_path(states)
    assert states[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)


def test_a_motion_may_be_held_again_while_it_is_taken_up(rig, driver):
    on_a_long_way(rig, 0.3)
    until_held(rig)
    driver.go_on()
    rig.step()
    where_rad = until_held(rig)[-1].positions_rad
    assert np.linalg.norm(where_rad - HOME_RAD) < np.linalg.norm(WAY_RAD)
    driver.go_on()
    assert until_rest(rig)[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)


def test_a_held_motion_that_goes_on_at_once_still_arrives(rig, driver):
    on_a_long_way(rig, 0.3)
    driver.hold()
    rig.step()
    driver.go_on()
    states = until_rest(rig)
    assert_smooth(states)
    assert states[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)


def test_a_stop_gives_a_held_motion_up(rig, driver):
    on_a_long_way(rig, 0.3)
    where_rad = until_held(rig)[-1].positions_rad
    driver.stop()
    until_rest(rig)
    driver.go_on()
    pass_time(rig, rig.delay_s + rig.step_s)
    assert driver.state().positions_rad == pytest.approx(where_rad, abs=TRACKING_RAD)
    driver.execute(rest_to_rest(driver.state().positions_rad, HOME_RAD, LIMITS))
    assert until_rest(rig)[-1].positions_rad == pytest.approx(HOME_RAD, abs=TRACKING_RAD)


def test_a_stop_while_a_motion_slows_down_keeps_the_limits(rig, driver):
    on_a_long_way(rig, 0.5)
    driver.hold()
    pass_time(rig, 0.08)
    driver.stop()
    assert_smooth(until_rest(rig))


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
    driver.execute(quick())
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
    pass_time(rig, rig.delay_s + rig.step_s)
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
    pass_time(rig, rig.delay_s + rig.step_s)
    assert driver.state().positions_rad == pytest.approx(HOME_RAD, abs=1e-6)


@pytest.mark.parametrize("arm", ARMS)
def test_fingers_take_their_time_and_say_so(rig, driver, arm):
    driver.grip(arm, "pinch")
    states = states_while(rig, lambda: driver.gripping(arm))
    openings_m = np.array([state.openings_m[arm] for state in states])
    speeds_m_s = np.diff(openings_m) / np.diff([state.stamp_s for state in states])
    assert np.abs(speeds_m_s).max() <= 2 * FINGER_SPEED_M_S * 1.01
    assert openings_m[-1] == pytest.approx(0.0, abs=1e-4)
    assert not driver.holds(arm)
    other = next(name for name in ARMS if name != arm)
    assert driver.state().openings_m[other] == pytest.approx(OPEN_OPENING_M, abs=1e-6)


def test_fingers_that_close_open_again(rig, driver):
    driver.grip("left", "pinch")
    pass_time(rig, 0.2)
    driver.grip("left", "open")
    states_while(rig, lambda: driver.gripping("left"))
    assert driver.state().openings_m["left"] == pytest.approx(OPEN_OPENING_M, abs=1e-4)
    assert not driver.holds("left")


def test_an_empty_cage_is_a_ring_that_holds_nothing(rig, driver):
    driver.grip("left", "cage")
    states_while(rig, lambda: driver.gripping("left"))
    assert 0.008 < driver.state().openings_m["left"] < 0.013
    assert not driver.holds("left")


def test_fingers_move_while_the_arms_do(rig, driver):
    in_motion(rig, 0.05)
    driver.grip("right", "cage")
    assert until_rest(rig)[-1].positions_rad == pytest.approx(AWAY_RAD, abs=TRACKING_RAD)
    assert driver.state().openings_m["right"] < 0.045


def test_a_stop_lets_fingers_finish_what_they_began(rig, driver):
    in_motion(rig, 0.05)
    driver.grip("right", "cage")
    driver.stop()
    until_rest(rig)
    states_while(rig, lambda: driver.gripping("right"))
    assert 0.008 < driver.state().openings_m["right"] < 0.013
