"""Goals become configurations that keep what was asked, or a reason that says what hinders."""

import numpy as np
import pytest

from robots.interfaces import ARMS, MotionFailure, PoseGoal, TcpGoal
from robots.motion.grasp import tool_poses
from robots.placement import HOME_RAD, REACH_OF_BOTH, REACH_OF_ONE

DOWN_M = np.array([0.0, 0.0, -0.06])


def goal(x, y, z=0.01, yaw=0.4, **more):
    return TcpGoal(np.array([x, y, z]), yaw, **more)


def test_tool_poses_keep_place_and_tilt_and_come_straightest_first():
    asked = goal(0.1, 0.05)
    tilts = []
    for group in tool_poses(asked, np.array([0.0, -0.4, 0.3])):
        for pose in group:
            rotation = pose.T_world_tcp.rotation
            assert pose.T_world_tcp.translation == pytest.approx(asked.position_m)
            assert rotation.T @ rotation == pytest.approx(np.eye(3), abs=1e-12)
            assert np.linalg.det(rotation) == pytest.approx(1.0)
            assert np.arccos(min(1.0, -rotation[2, 2])) == pytest.approx(pose.tilt_rad, abs=1e-7)
            tilts.append(pose.tilt_rad)
    assert tilts[0] == 0.0
    assert max(tilts) == pytest.approx(asked.max_tilt_rad)


def test_upright_poses_open_along_the_yaw_either_way_round():
    group = next(tool_poses(goal(0.1, 0.05, yaw=0.7), np.zeros(3)))
    along = np.array([np.cos(0.7), np.sin(0.7), 0.0])
    assert sorted(pose.T_world_tcp.rotation[:, 0] @ along for pose in group) == pytest.approx(
        [-1.0, 1.0]
    )


def test_leaning_about_the_opening_axis_keeps_the_fingertips_level():
    groups = list(tool_poses(goal(0.1, 0.05), np.array([0.0, -0.4, 0.3])))
    for pose in (*groups[1], *groups[2]):
        assert pose.T_world_tcp.rotation[2, 0] == pytest.approx(0.0, abs=1e-12)


def test_no_tilt_allowed_means_upright_poses_alone():
    assert len(list(tool_poses(goal(0.1, 0.05, max_tilt_rad=0.0), np.zeros(3)))) == 1


def test_solutions_are_free_within_limits_and_distinct(robot, solver):
    found = solver.configurations({"left": goal(-0.2, 0.0)}, HOME_RAD, 6)
    assert len(found) >= 3
    for q in found:
        assert robot.limits.contain(q)
        assert not solver.together.collides(q)
        assert q[7:] == pytest.approx(HOME_RAD[7:])
        assert robot.tcp_pose("left", q).translation == pytest.approx([-0.2, 0.0, 0.01], abs=1e-4)
    for i, one in enumerate(found):
        assert all(np.abs(one - other).max() > 0.1 for other in found[:i])


def test_the_same_question_has_the_same_answer(solver):
    asked = {"left": goal(-0.1, 0.05), "right": goal(0.1, 0.05)}
    first = solver.configurations(asked, HOME_RAD, 4)
    solver.configurations({"left": goal(-0.3, 0.0)}, HOME_RAD, 4)
    assert np.array_equal(first, solver.configurations(asked, HOME_RAD, 4))


def test_solutions_near_the_present_configuration_come_first(solver):
    near = solver.configurations({"left": goal(-0.2, 0.0)}, HOME_RAD, 6)[-1]
    again = solver.configurations({"left": goal(-0.2, 0.0)}, near, 6)[0]
    assert np.abs(again - near).max() < 0.01


def test_two_goals_are_reached_at_once_without_contact(robot, solver):
    asked = {"left": goal(-0.06, 0.0, yaw=0.0), "right": goal(0.06, 0.0, yaw=0.0)}
    for q in solver.configurations(asked, HOME_RAD, 4):
        assert not solver.together.collides(q)
        for arm in ARMS:
            reached = robot.tcp_pose(arm, q).translation
            assert reached == pytest.approx(asked[arm].position_m, abs=1e-4)


def test_a_goal_with_an_onward_motion_leaves_room_for_it(robot, solver):
    asked = goal(0.3, 0.1, z=0.068, onward_m=(DOWN_M,))
    for q in solver.configurations({"right": asked}, HOME_RAD, 6):
        lowered = solver.configurations({"right": goal(0.3, 0.1, z=0.008)}, q, 6)
        assert not isinstance(lowered, MotionFailure)


@pytest.mark.parametrize("far", [goal(0.0, 0.9), goal(0.0, 0.45), goal(0.0, 0.45, yaw=None)])
def test_out_of_reach_is_said_so(solver, far):
    failure = solver.configurations({"left": far}, HOME_RAD, 4)
    assert (failure.code, failure.stage) == ("motion.unreachable", "ik")
    assert "left arm" in failure.text
    assert failure.cause in ("reach", "joint_limit")


def test_a_pose_that_only_a_joint_limit_forbids_names_the_joint(solver):
    turned = PoseGoal(np.array([-0.12, 0.014, 0.105]), np.array([-0.65, -0.21, 0.51, -0.52]))
    failure = solver.configurations({"left": turned}, HOME_RAD, 4)
    assert (failure.code, failure.cause) == ("motion.unreachable", "joint_limit")
    assert failure.joint in failure.text
    assert failure.tried > 0


def test_a_goal_inside_the_table_names_the_table(solver):
    failure = solver.configurations({"left": goal(-0.2, 0.0, z=-0.02)}, HOME_RAD, 4)
    assert (failure.code, failure.stage) == ("motion.collision", "ik")
    assert "table" in failure.pair
    assert -0.05 < failure.distance_m < 0.005


def test_two_hands_in_one_place_name_both_arms(solver):
    failure = solver.configurations({"left": goal(0.0, 0.0), "right": goal(0.0, 0.0)}, HOME_RAD, 4)
    assert failure.code == "motion.collision"
    assert [body.split("_")[0] for body in failure.pair] == ["left", "right"]


def test_the_stated_reach_holds(solver, rng):
    for rectangle, least in ((REACH_OF_ONE, 1), (REACH_OF_BOTH, 2)):
        for _ in range(25):
            x, y = rng.uniform(rectangle.low_m, rectangle.high_m)
            asked = goal(x, y, z=0.068, yaw=rng.uniform(0, np.pi), onward_m=(DOWN_M,))
            assert sum(solver.reaches(arm, asked, HOME_RAD) for arm in ARMS) >= least, (x, y)
