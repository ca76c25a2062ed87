import numpy as np
import pytest

from robots.interfaces import ARMS
from robots.limits import yumi_limits
from robots.motion.model import yumi_model
from robots.motion.timing import rest_to_rest
from robots.placement import HOME_RAD, YUMI_AT_TABLE
from simulation.poses import pose_matrices
from simulation.yumi_body import YumiBody

STEP_S = 1 / 240
OPEN = dict.fromkeys(ARMS, 0.05)


@pytest.fixture
def body():
    body = YumiBody(HOME_RAD, OPEN, STEP_S)
    yield body
    body.close()


def link_pose(body, name):
    return pose_matrices(*body.link_poses([name]))[0]


def follow(body, trajectory, openings_m=OPEN):
    """Drive along a trajectory and yield the time after each step."""
    for step in range(1, int(trajectory.duration_s / STEP_S) + 2):
        body.drive(trajectory.at(step * STEP_S)[0], openings_m)
        body.step()
        yield step * STEP_S


def test_its_tools_are_where_the_planner_thinks_they_are():
    robot, limits = yumi_model(YUMI_AT_TABLE), yumi_limits()
    rng = np.random.default_rng(0)
    for _ in range(5):
        positions = rng.uniform(limits.lower, limits.upper)
        body = YumiBody(positions, OPEN, STEP_S)
        for arm in ARMS:
            expected = robot.tcp_pose(arm, positions)
            pose = link_pose(body, f"{arm}_tcp")
            assert pose[:3, 3] == pytest.approx(expected.translation, abs=1e-6)
            assert pose[:3, :3] == pytest.approx(expected.rotation, abs=1e-6)
        body.close()


def test_tracks_a_motion_at_full_speed_to_a_tenth_of_a_millimetre(body):
    robot = yumi_model(YUMI_AT_TABLE)
    goal = HOME_RAD + np.tile([0.4, 0.5, -0.6, 0.4, 1.0, 0.5, -1.0], 2)
    trajectory = rest_to_rest(HOME_RAD, goal, yumi_limits())
    errors_m = []
    for time_s in follow(body, trajectory):
        for arm in ARMS:
            expected_m = robot.tcp_pose(arm, trajectory.at(time_s)[0]).translation
            errors_m.append(np.linalg.norm(link_pose(body, f"{arm}_tcp")[:3, 3] - expected_m))
    assert max(errors_m) < 1e-4


def test_measured_velocities_are_the_slope_of_measured_positions(body):
    trajectory = rest_to_rest(HOME_RAD, HOME_RAD + 0.3, yumi_limits())
    before = body.joint_state()[0]
    for _ in follow(body, trajectory):
        now, velocity = body.joint_state()
        assert velocity == pytest.approx((now - before) / STEP_S, abs=1e-6)
        before = now


def test_fingers_open_and_close_symmetrically(body):
    openings_m = {"left": 0.03, "right": 0.0}
    for _ in range(30):
        body.drive(HOME_RAD, openings_m)
        body.step()
    assert body.openings_m() == pytest.approx(openings_m, abs=1e-5)
    for arm in ARMS:
        tool, a, b = (link_pose(body, f"{arm}_{name}") for name in ("tcp", "finger_a", "finger_b"))
        across = tool[:3, 0]
        to_a, to_b = (across @ (finger[:3, 3] - tool[:3, 3]) for finger in (a, b))
        assert abs(to_a - to_b) == pytest.approx(openings_m[arm], abs=1e-5)
        assert to_a + to_b == pytest.approx(0.0, abs=1e-5)


def test_two_robots_move_independently():
    first, second = (YumiBody(HOME_RAD, OPEN, STEP_S) for _ in range(2))
    for _ in range(5):
        first.drive(HOME_RAD + 0.01, OPEN)
        first.step()
    assert second.joint_state()[0] == pytest.approx(HOME_RAD)
    first.close()
    second.step()
    second.close()


def test_importing_the_physics_prints_nothing(capfd):
    YumiBody(HOME_RAD, OPEN, STEP_S).close()
    assert capfd.readouterr() == ("", "")
