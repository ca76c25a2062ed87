"""The URDF is what the tables say, and each reader of it sees the same robot."""

import numpy as np
import pinocchio as pin
import pytest

from robots.descriptions import DESCRIPTIONS, kinova, urdf_path
from robots.descriptions.urdf import to_urdf
from robots.descriptions.yumi import arm_joint_names, finger_joint_names
from robots.interfaces import ARMS


@pytest.fixture(scope="module")
def model():
    return pin.buildModelFromUrdf(str(urdf_path("yumi")))


def configuration(model, positions):
    q = pin.neutral(model)
    for name, value in positions.items():
        q[model.joints[model.getJointId(name)].idx_q] = value
    return q


def poses(model, q):
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    return {frame.name: data.oMf[i] for i, frame in enumerate(model.frames)}


@pytest.mark.parametrize("name", sorted(DESCRIPTIONS))
def test_packaged_urdf_is_current(name):
    assert urdf_path(name).read_text(encoding="utf-8") == to_urdf(DESCRIPTIONS[name]())


def test_ready_pose_of_the_published_model_points_down_at_its_published_place(model):
    degrees = [-47.6, 4.6, -28.3, 34.0, 110.7, 23.2, -9.6]
    positions = dict(zip(arm_joint_names("right"), np.radians(degrees), strict=True))
    tcp = poses(model, configuration(model, positions))["right_tcp"]
    assert tcp.translation == pytest.approx([0.30, -0.30, 0.10], abs=1e-3)
    assert tcp.rotation[:, 2] == pytest.approx([0, 0, -1], abs=5e-3)


def test_left_arm_is_nearly_the_mirror_of_the_right(model):
    degrees = np.array([-47.6, 4.6, -28.3, 34.0, 110.7, 23.2, -9.6])
    mirror = np.array([-1, 1, -1, 1, -1, 1, -1])
    right = dict(zip(arm_joint_names("right"), np.radians(degrees), strict=True))
    left = dict(zip(arm_joint_names("left"), np.radians(degrees * mirror), strict=True))
    frames = poses(model, configuration(model, {**right, **left}))
    expected = frames["right_tcp"].translation * [1, -1, 1]
    assert frames["left_tcp"].translation == pytest.approx(expected, abs=2.9e-3)


def test_published_link_lengths_come_out(model):
    at = poses(model, pin.neutral(model))
    for arm in ARMS:
        shoulder, elbow = at[f"{arm}_link_2"].translation, at[f"{arm}_link_4"].translation
        assert np.linalg.norm(elbow - shoulder) == pytest.approx(
            np.hypot(0.17283 + 0.07873, 0.03 + 0.04188), abs=1e-3
        )
        assert np.linalg.norm(
            at[f"{arm}_gripper_base"].translation - at[f"{arm}_link_7"].translation
        ) == pytest.approx(0.007)


def test_fingers_part_along_the_tool_x_axis_and_shut_at_zero(model):
    for arm in ARMS:
        a, b = finger_joint_names(arm)
        shut = poses(model, pin.neutral(model))
        opened = poses(model, configuration(model, {a: 0.02, b: 0.02}))
        tcp = shut[f"{arm}_tcp"]
        for finger, sign in (("a", -1.0), ("b", 1.0)):
            frame = f"{arm}_finger_{finger}"
            moved = opened[frame].translation - shut[frame].translation
            assert tcp.rotation.T @ moved == pytest.approx([sign * 0.02, 0, 0], abs=1e-9)


@pytest.mark.parametrize("name", sorted(DESCRIPTIONS))
def test_every_shape_and_limit_reaches_pinocchio(name):
    model, robot = pin.buildModelFromUrdf(str(urdf_path(name))), DESCRIPTIONS[name]()
    geometry = pin.buildGeomFromUrdf(model, str(urdf_path(name)), pin.GeometryType.COLLISION)
    assert geometry.ngeoms == sum(len(link.shapes) for link in robot.links)
    moving = [joint for joint in robot.joints if joint.limits is not None]
    assert model.nq == model.nv == len(moving)
    for joint in moving:
        index = model.joints[model.getJointId(joint.name)].idx_q
        assert model.lowerPositionLimit[index] == pytest.approx(joint.limits.lower, rel=1e-8)
        assert model.upperPositionLimit[index] == pytest.approx(joint.limits.upper, rel=1e-8)
        assert model.velocityLimit[index] == pytest.approx(joint.limits.velocity, rel=1e-8)


@pytest.mark.parametrize("name", sorted(DESCRIPTIONS))
def test_pybullet_sees_the_same_kinematics(name):
    pybullet = pytest.importorskip("pybullet")
    model = pin.buildModelFromUrdf(str(urdf_path(name)))
    client = pybullet.connect(pybullet.DIRECT)
    try:
        body = pybullet.loadURDF(str(urdf_path(name)), useFixedBase=True, physicsClientId=client)
        rng = np.random.default_rng(0)
        q = rng.uniform(model.lowerPositionLimit, model.upperPositionLimit)
        expected = poses(model, q)
        indices = range(pybullet.getNumJoints(body, physicsClientId=client))
        infos = [pybullet.getJointInfo(body, i, physicsClientId=client) for i in indices]
        for info in infos:
            if model.existJointName(info[1].decode()):
                value = q[model.joints[model.getJointId(info[1].decode())].idx_q]
                pybullet.resetJointState(body, info[0], value, physicsClientId=client)
        for info in infos:
            state = pybullet.getLinkState(
                body, info[0], computeForwardKinematics=True, physicsClientId=client
            )
            pose = expected[info[12].decode()]
            assert state[4] == pytest.approx(pose.translation, abs=1e-5)
    finally:
        pybullet.disconnect(client)


@pytest.mark.parametrize("name", ["kinova_j2s6s200", "kinova_j2s7s300"])
def test_kinova_reaches_as_far_as_is_published(name):
    model = pin.buildModelFromUrdf(str(urdf_path(name)))
    rng, farthest = np.random.default_rng(1), 0.0
    for _ in range(1500):
        at = poses(model, rng.uniform(model.lowerPositionLimit, model.upperPositionLimit))
        arm = at["end_effector"].translation - at["link_2"].translation
        farthest = max(farthest, float(np.linalg.norm(arm)))
    assert 0.95 < farthest <= kinova.REACH_M


def test_the_tool_looks_and_sucks_along_the_blade():
    model = pin.buildModelFromUrdf(str(urdf_path("kinova_j2s7s300")))
    at = poses(model, pin.neutral(model))
    ahead = at[kinova.BLADE_FRAME].rotation[:, 2]
    cup = at[kinova.SUCTION_FRAME].translation - at[kinova.BLADE_FRAME].translation
    assert cup == pytest.approx(kinova.CUP_AHEAD_M * ahead)
    assert at[kinova.CAMERA_FRAME].rotation[:, 2] == pytest.approx(ahead)
