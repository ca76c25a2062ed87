"""The controller looks after its arms by itself, whatever the driver does."""

import numpy as np
import pytest

from executive.core.work import InlineWorker
from robots.drivers.messages import Beat, EmergencyStop, Execute, GripCommand, Hold, Stop, numbers
from robots.drivers.samples import SampledTrajectory
from robots.limits import yumi_limits
from robots.motion.timing import rest_to_rest
from robots.placement import HOME_RAD
from simulation.loopback.controller import Controller
from simulation.loopback.settings import LoopbackSettings
from simulation.loopback.station import Station

LIMITS = yumi_limits()
AWAY_RAD = HOME_RAD + 0.3
CYCLE_S = 0.004


class Session:
    """A station, and a driver that beats as long as it is told to."""

    def __init__(self, **settings):
        self.settings = LoopbackSettings(lockstep=True, **settings)
        controller = Controller(HOME_RAD, LIMITS, CYCLE_S, self.settings.between_m, InlineWorker())
        self.station = Station(controller, self.settings, "me", 0.0)
        self.now_s = 0.0
        self.states = []

    def run(self, time_s, beats=True):
        for _ in range(round(time_s / CYCLE_S)):
            if beats:
                seen_s = self.states[-1].stamp_s if self.states else 0.0
                self.station.hear(Beat(time_s=self.now_s, seen_s=seen_s), self.now_s)
            self.now_s += CYCLE_S
            self.states += self.station.run_to(self.now_s)
        return self.states[-1]

    def send(self, command):
        self.station.hear(command, self.now_s)


def execute(number, trajectory=None, **changes):
    slow = trajectory or rest_to_rest(HOME_RAD, AWAY_RAD, LIMITS.slowed(0.3))
    samples = SampledTrajectory.of(slow, CYCLE_S)
    return Execute(number=number, period_s=CYCLE_S, samples=samples.to_bytes()).model_copy(
        update=changes
    )


def where(state):
    return numbers(state.positions_rad)


def jerks(states):
    accelerations = np.array([numbers(state.accelerations_rad_s2) for state in states])
    return np.diff(accelerations, axis=0) / CYCLE_S


def test_a_driver_that_is_heard_gets_its_motion():
    session = Session()
    session.send(execute(1))
    state = session.run(3.0)
    assert where(state) == pytest.approx(AWAY_RAD)
    assert (state.mode, state.taken, state.fault) == ("rest", 1, "")


def test_silence_in_motion_stops_the_arms_within_the_stated_time_and_the_limits():
    session = Session(silence_s=0.2)
    session.send(execute(1))
    session.run(0.3)
    session.run(0.204)
    assert session.states[-1].mode == "motion"
    silent = len(session.states)
    state = session.run(1.5, beats=False)
    stopping = next(k for k, one in enumerate(session.states) if one.mode == "stop")
    assert (stopping - silent) * CYCLE_S <= 0.2 + 2 * CYCLE_S
    assert state.mode == "rest"
    assert "stopped the arms by itself: it heard nothing newer than 0.20 s" in state.fault
    assert np.abs(where(state) - AWAY_RAD).max() > 0.02
    assert (np.abs(jerks(session.states[stopping - 1 : -1])) <= LIMITS.jerk * 1.001).all()


def test_answers_that_are_too_old_are_silence():
    session = Session(silence_s=0.2, latency_s=0.15)
    session.send(execute(1))
    assert "heard nothing newer" in session.run(1.0).fault


def test_silence_at_rest_is_forgiven():
    session = Session(silence_s=0.2)
    session.run(0.1)
    session.run(5.0, beats=False)
    session.run(0.1)
    session.send(execute(1))
    assert session.run(0.5).fault == ""


def test_after_a_fault_only_stops_are_taken():
    session = Session(silence_s=0.2)
    session.send(execute(1))
    session.run(0.3)
    session.run(1.5, beats=False)
    session.send(execute(2))
    state = session.run(0.1)
    assert (state.taken, state.refused, state.mode) == (2, 2, "rest")
    assert "stopped the arms by itself" in state.refusal


def test_a_cycle_that_comes_too_late_stops_the_arms():
    session = Session(stall_at_s=0.4, stall_s=0.4)
    session.send(execute(1))
    session.run(0.396)
    before_rad = where(session.states[-1])
    state = session.run(1.5)
    assert "a cycle came 0.40 s late; expected 0.25 s at most" in state.fault
    assert (state.mode, session.states[-1].stamp_s) == ("rest", pytest.approx(1.896))
    assert np.abs(where(state) - before_rad).max() < 0.1


def test_a_short_stall_is_made_up_for():
    session = Session(stall_at_s=0.4, stall_s=0.1)
    session.send(execute(1))
    state = session.run(3.0)
    assert (where(state) == pytest.approx(AWAY_RAD), state.fault) == (True, "")


def test_a_gap_waits_for_what_is_missing_and_nothing_is_done_twice():
    session = Session()
    session.send(GripCommand(number=2, arm="left", grip="open"))
    assert session.run(0.1).taken == 0
    session.send(GripCommand(number=1, arm="left", grip="cage"))
    assert session.run(0.1).taken == 1
    session.send(GripCommand(number=1, arm="left", grip="pinch"))
    assert session.run(2.0).openings_m[0] == pytest.approx(0.011)
    session.send(GripCommand(number=2, arm="left", grip="open"))
    assert session.run(2.0).openings_m == (0.03, 0.03)


@pytest.mark.parametrize("stop", [Stop(number=3), EmergencyStop(number=3)])
def test_a_stop_does_not_wait_for_what_is_missing(stop):
    session = Session()
    session.send(execute(1))
    session.run(0.5)
    session.send(stop)
    assert session.run(0.008).mode != "motion"
    session.send(Hold(number=2))
    state = session.run(1.0)
    assert (state.taken, state.mode) == (3, "rest")
    assert np.abs(where(state) - AWAY_RAD).max() > 0.1


def beyond(**changes):
    """Return samples of a motion with some of them changed."""
    rows = SampledTrajectory.of(rest_to_rest(HOME_RAD, AWAY_RAD, LIMITS), CYCLE_S).rows.copy()
    for index, values in changes.items():
        rows[int(index[1:])] += values
    return rows.astype("<f8").tobytes()


@pytest.mark.parametrize(
    ("samples", "match"),
    [
        (b"abc", "a trajectory that is none"),
        (beyond(_30=np.nan), "of finite numbers"),
        (beyond(_0=0.001), "begins elsewhere"),
        (beyond(_30=[[0.2], [0.0], [0.0]]), "a joint faster than it may be"),
        (beyond(_30=[[0.0], [9.0], [0.0]]), "a joint faster than it may be"),
        (beyond(_30=[[9.0], [0.0], [0.0]]), "a joint beyond its limits of position"),
        (beyond(**{"_-1": [[0.0], [0.1], [0.0]]}), "do not begin and end at rest"),
    ],
)
def test_a_trajectory_that_no_joint_could_follow_is_refused(samples, match):
    session = Session()
    session.send(execute(1, samples=samples))
    state = session.run(0.1)
    assert (state.refused, state.taken, state.mode) == (1, 1, "rest")
    assert match in state.refusal
    assert np.array_equal(where(state), HOME_RAD)


def test_fingers_stop_at_what_is_between_them():
    session = Session(between_m={"left": 0.006})
    session.send(GripCommand(number=1, arm="left", grip="pinch"))
    session.send(GripCommand(number=2, arm="right", grip="pinch"))
    state = session.run(2.0)
    assert state.openings_m == (pytest.approx(0.006), 0.0)
    assert state.holding == (True, False)
    assert state.gripping == (False, False)
    session.send(GripCommand(number=3, arm="left", grip="open"))
    assert session.run(2.0).holding == (False, False)
