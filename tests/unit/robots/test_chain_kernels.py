"""Compiled kinematics gives the numbers of Pinocchio, at any angle and for joints that slide."""

import numpy as np
import pinocchio as pin
import pytest

from executive.core.errors import InputError
from robots.interfaces import ARMS
from robots.motion.chain_kernels import free_direction, smallest_singular, tool, twist_to
from robots.motion.model import chain_of


def looked_at(chain, q):
    """Return rotation, position and Jacobian of a tool."""
    rotation, position, jacobian = np.empty((3, 3)), np.empty(3), np.empty((6, len(q)))
    tool(chain, q, rotation, position, jacobian)
    return rotation, position, jacobian


@pytest.mark.parametrize("name", ARMS)
def test_the_tool_and_its_jacobian_are_those_of_pinocchio(robot, rng, name):
    arm = robot.kinematics[name]
    for q in rng.uniform(arm.lower, arm.upper, (50, 7)):
        rotation, position, jacobian = looked_at(arm.chain, q)
        pose, expected = arm.tcp_jacobian(q)
        np.testing.assert_allclose(rotation, pose.rotation, atol=1e-12)
        np.testing.assert_allclose(position, pose.translation, atol=1e-12)
        np.testing.assert_allclose(jacobian, expected, atol=1e-12)


@pytest.mark.parametrize("name", ARMS)
def test_what_leaves_the_tool_and_how_dexterous_it_is_agree_with_a_decomposition(robot, rng, name):
    arm = robot.kinematics[name]
    for q in rng.uniform(arm.lower, arm.upper, (50, 7)):
        jacobian = arm.tcp_jacobian(q)[1].copy(order="C")
        assert smallest_singular(jacobian) == pytest.approx(arm.dexterity(q), abs=1e-7)
        free = free_direction(jacobian)
        assert np.linalg.norm(free) == pytest.approx(1.0)
        np.testing.assert_allclose(jacobian @ free, 0.0, atol=1e-12)


def test_an_arm_that_has_lost_a_direction_still_has_a_free_one(rng):
    jacobian = rng.standard_normal((6, 7))
    jacobian[4] = jacobian[3]
    assert smallest_singular(jacobian) == pytest.approx(0.0, abs=1e-7)
    np.testing.assert_allclose(jacobian @ free_direction(jacobian), 0.0, atol=1e-9)


def sliding_arm():
    """Return a model whose second joint slides askew, and the number of its tool's frame."""
    model = pin.Model()
    askew = pin.SE3(pin.rpy.rpyToMatrix(0.3, -0.5, 0.8), np.array([0.1, 0.2, 0.3]))
    turning = model.addJoint(0, pin.JointModelRX(), askew, "turns")
    sliding = model.addJoint(turning, pin.JointModelPY(), askew, "slides")
    last = model.addJoint(sliding, pin.JointModelRevoluteUnaligned(0.6, 0.0, 0.8), askew, "last")
    frame = pin.Frame("tool", last, 0, askew, pin.FrameType.OP_FRAME)
    return model, model.addFrame(frame)


def test_joints_may_slide_and_turn_about_any_axis(rng):
    model, frame = sliding_arm()
    data, limit = model.createData(), np.full(3, 2.0)
    chain = chain_of(model, frame, -limit, limit)
    for q in rng.uniform(-limit, limit, (20, 3)):
        pin.computeJointJacobians(model, data, q)
        pose = pin.updateFramePlacement(model, data, frame)
        expected = pin.getFrameJacobian(model, data, frame, pin.ReferenceFrame.LOCAL)
        rotation, position, jacobian = looked_at(chain, q)
        np.testing.assert_allclose(position, pose.translation, atol=1e-12)
        np.testing.assert_allclose(rotation, pose.rotation, atol=1e-12)
        np.testing.assert_allclose(jacobian, expected, atol=1e-12)


def test_joints_that_branch_are_no_chain():
    model, frame = sliding_arm()
    model.addJoint(1, pin.JointModelRX(), pin.SE3.Identity(), "beside")
    with pytest.raises(InputError, match="tool: got joints turns, slides, last, beside"):
        chain_of(model, frame, np.zeros(4), np.zeros(4))


@pytest.mark.parametrize("angle", [0.0, 1e-9, 1e-5, 0.01, 1.0, 3.0, np.pi - 1e-7])
def test_twists_are_logarithms_of_poses(rng, angle):
    for _ in range(20):
        axis = rng.standard_normal(3)
        turn = pin.exp3(angle * axis / np.linalg.norm(axis))
        start = pin.SE3.Random()
        end = start * pin.SE3(turn, rng.uniform(-1.0, 1.0, 3))
        twist = np.empty(6)
        twist_to(
            np.ascontiguousarray(start.rotation),
            start.translation,
            np.ascontiguousarray(end.rotation),
            end.translation,
            twist,
        )
        reached = start * pin.exp6(pin.Motion(twist))
        np.testing.assert_allclose(reached.homogeneous, end.homogeneous, atol=1e-8)
