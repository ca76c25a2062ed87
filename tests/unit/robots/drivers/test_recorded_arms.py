"""What a recording has of the arms, as a driver shows it."""

import numpy as np
import pytest

from executive.core.clock import ManualClock
from executive.core.errors import DeviceError, RecordingError
from executive.core.world import StreamMessage
from executive.engine.recording.messages import MissionHeader
from executive.engine.recording.reader import Recording
from executive.engine.recording.writer import RecordingWriter
from robots.drivers.recorded_arms import RecordedArms
from robots.drivers.samples import SampledTrajectory
from robots.interfaces import ARMS, ArmsDriver, ArmsState
from robots.limits import yumi_limits
from robots.motion.timing import rest_to_rest
from robots.placement import HOME_RAD
from simulation.streams import Stream, joint_states_json

AWAY_RAD = HOME_RAD + 0.3
MOTION = SampledTrajectory.of(rest_to_rest(HOME_RAD, AWAY_RAD, yumi_limits().slowed(0.3)), 0.004)
BEGINS_S, CLOSES_S, CLOSED_M = 2.0, 6.0, 0.0066


def truth(time_s):
    """Return what the arms do: rest, move at 2 s, close the left gripper on a cable at 6 s."""
    closing_m = max(0.05 - 0.05 * max(time_s - CLOSES_S, 0.0), CLOSED_M)
    openings_m = {"left": closing_m, "right": 0.05}
    return ArmsState(*MOTION.at(time_s - BEGINS_S), openings_m, True, time_s)


def recorded(path, messages):
    header = MissionHeader(
        format=1, mission="m", seed=0, tick_hz=10.0, timeout_s=None, nodes=(), started_utc="now"
    )
    with RecordingWriter(path, header) as writer:
        writer.on_streams(messages)
    return Recording.open(path)


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    stream = Stream("/joint_states", "JointStates", 20.0)
    for step in range(240 * 9):
        time_s = step / 240
        if stream.due(time_s):
            stream.add(time_s, joint_states_json(truth(time_s)))
    return recorded(tmp_path_factory.mktemp("run") / "run.mcap", stream.drain())


@pytest.fixture
def clock():
    return ManualClock()


@pytest.fixture
def arms(recording, clock):
    return RecordedArms(recording, clock)


def test_is_a_driver(arms):
    assert isinstance(arms, ArmsDriver)


def test_shows_at_any_time_where_the_arms_were(arms, clock):
    for time_s in np.arange(0.0, 9.0, 0.013):
        clock.sleep_until(time_s)
        state, true = arms.state(), truth(time_s)
        assert state.stamp_s == time_s
        # 20 Hz leaves gaps in which speeds change by what accelerations allow.
        assert state.positions_rad == pytest.approx(true.positions_rad, abs=2e-3)
        assert state.velocities_rad_s == pytest.approx(true.velocities_rad_s, abs=0.05)
        assert state.openings_m == pytest.approx(dict(true.openings_m), abs=2e-3)


def test_tells_what_moved_and_what_was_held(arms, clock):
    story = []
    for time_s in (1.9, 2.4, 5.5, 6.2, 8.0):
        clock.sleep_until(time_s)
        story.append((arms.state().moving, arms.gripping("left"), arms.holds("left")))
    assert story == [
        (False, False, False),
        (True, False, False),
        (False, False, False),
        (False, True, False),
        (False, False, True),
    ]
    assert not any([arms.gripping("right"), arms.holds("right"), arms.held()])


def test_a_state_is_a_snapshot(arms, clock):
    state = arms.state()
    state.positions_rad[:] = 99.0
    assert arms.state().positions_rad == pytest.approx(HOME_RAD, abs=1e-4)


def test_after_the_run_its_last_state_stays(arms, clock):
    assert (arms.start_s, arms.end_s) == (0.0, pytest.approx(7.0, abs=0.2))
    clock.sleep_until(1000.0)
    assert arms.state().positions_rad == pytest.approx(AWAY_RAD, abs=1e-4)
    assert not arms.state().accelerations_rad_s2.any()


@pytest.mark.parametrize(
    "command",
    [
        lambda arms: arms.execute(MOTION),
        lambda arms: arms.grip("left", "open"),
        lambda arms: arms.hold(),
        lambda arms: arms.go_on(),
    ],
)
def test_takes_no_commands(arms, command):
    with pytest.raises(DeviceError, match="shows what was recorded"):
        command(arms)


def test_stops_are_always_allowed(arms):
    arms.stop()
    arms.emergency_stop()
    assert not arms.state().moving


def test_a_recording_without_arms_is_refused(tmp_path, clock):
    with pytest.raises(RecordingError, match="no arms to show; got no message of /joint_states"):
        RecordedArms(recorded(tmp_path / "run.mcap", []), clock)


@pytest.mark.parametrize("data", [b"{}", b'{"names": [], "positions": [], "velocities": []}'])
def test_joint_states_of_another_robot_are_refused(tmp_path, clock, data):
    messages = [StreamMessage("/joint_states", "JointStates", 1.0, data)]
    with pytest.raises(RecordingError, match=r"at 1.000 s: got no joint states of these arms"):
        RecordedArms(recorded(tmp_path / "run.mcap", messages), clock)


def test_a_single_message_is_a_state(tmp_path, clock):
    still = joint_states_json(truth(0.0))
    messages = [StreamMessage("/joint_states", "JointStates", 1.0, still)]
    arms = RecordedArms(recorded(tmp_path / "run.mcap", messages), clock)
    assert arms.state().positions_rad == pytest.approx(HOME_RAD, abs=1e-4)
    assert not any(arms.gripping(arm) for arm in ARMS)
