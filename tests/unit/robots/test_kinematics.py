"""Kinematics in the world frame, and inverse kinematics that undoes them."""

import numpy as np
import pinocchio as pin
import pytest

from robots.interfaces import ARMS
from robots.limits import yumi_limits
from robots.motion.ik import random_bank, solve_pose
from robots.placement import HOME_RAD


def random_positions(arm, rng, count):
    return rng.uniform(arm.lower, arm.upper, (count, 7))


def test_the_left_arm_stands_at_negative_x_and_both_behind_the_table(robot):
    shoulders = [robot.kinematics[arm].shoulder_m for arm in ARMS]
    assert shoulders[0] == pytest.approx([-0.0725, -0.425 + 0.05355, 0.41492 - 0.10])
    assert shoulders[1] == pytest.approx(shoulders[0] * [-1, 1, 1])


def test_a_configuration_lists_the_left_arm_first(robot):
    moved = HOME_RAD.copy()
    moved[robot.joints_of("left")] += 0.1
    tools = {arm: robot.tcp_pose(arm, HOME_RAD).translation.copy() for arm in ARMS}
    assert np.linalg.norm(robot.tcp_pose("left", moved).translation - tools["left"]) > 0.01
    assert robot.tcp_pose("right", moved).translation == pytest.approx(tools["right"])


def test_limits_of_the_tables_and_of_the_urdf_are_the_same(robot):
    for name in ("lower", "upper", "velocity", "acceleration", "jerk"):
        assert getattr(robot.limits, name) == pytest.approx(getattr(yumi_limits(), name), rel=1e-8)


@pytest.mark.parametrize("name", ARMS)
def test_jacobian_is_the_derivative_of_the_tool_pose(robot, rng, name):
    arm = robot.kinematics[name]
    step = 1e-6
    for q in random_positions(arm, rng, 20):
        pose, jacobian = arm.tcp_jacobian(q)
        pose = pose.copy()
        for joint in range(7):
            nudge = np.zeros(7)
            nudge[joint] = step
            twist = pin.log6(pose.actInv(arm.tcp_pose(q + nudge))).vector / step
            assert jacobian[:, joint] == pytest.approx(twist, abs=1e-5)


@pytest.mark.parametrize("name", ARMS)
def test_the_tool_is_never_out_of_its_stated_reach(robot, rng, name):
    arm = robot.kinematics[name]
    farthest = max(
        np.linalg.norm(arm.tcp_pose(q).translation - arm.shoulder_m)
        for q in random_positions(arm, rng, 2000)
    )
    assert 0.75 < farthest <= arm.reach_m


@pytest.mark.parametrize("name", ARMS)
def test_inverse_undoes_forward_from_the_starts_of_the_bank(robot, rng, name):
    arm = robot.kinematics[name]
    bank = random_bank(arm, rng, 200)
    solved = 0
    for q in random_positions(arm, rng, 200):
        target = arm.tcp_pose(q)
        starts = bank.near(target, 200)
        answers = (solve_pose(arm, target, start) for start in starts)
        answer = next((found for found in answers if found is not None), None)
        if answer is not None:
            solved += 1
            reached = arm.tcp_pose(answer)
            assert reached.translation == pytest.approx(target.translation, abs=2e-5)
            assert reached.rotation == pytest.approx(target.rotation, abs=2e-5)
            assert np.all((answer >= arm.lower) & (answer <= arm.upper))
    assert solved >= 199


def test_a_pose_out_of_reach_has_no_inverse(robot):
    arm = robot.kinematics["left"]
    far = pin.SE3(np.eye(3), np.array([0.0, 1.0, 0.2]))
    assert solve_pose(arm, far, HOME_RAD[:7]) is None


def test_bank_starts_come_nearest_first(robot, rng):
    arm = robot.kinematics["right"]
    bank = random_bank(arm, rng, 30)
    target = arm.tcp_pose(HOME_RAD[7:])
    gaps = []
    for q in bank.near(target, 30):
        tool = arm.tcp_pose(q)
        apart = np.linalg.norm(tool.translation - target.translation)
        gaps.append(np.hypot(apart, 0.4 * np.linalg.norm((tool.rotation - target.rotation)[:, 2])))
    assert len(gaps) == 30
    assert gaps == sorted(gaps)
