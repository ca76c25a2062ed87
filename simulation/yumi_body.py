"""The YuMi and its table in PyBullet: position-controlled joints, poses of links.

The arms touch nothing but the table here; the cable is pushed by capsules that follow the links
(`simulation.table_world`), and collisions between the arms are the planner's business.
"""

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from robots.descriptions import urdf_path
from robots.descriptions.yumi import arm_joint_names, finger_joint_names
from robots.interfaces import ARMS, Arm
from robots.placement import YUMI_AT_TABLE, Placement, table_top
from simulation.bullet import import_pybullet

Floats = NDArray[np.float64]

# Far more than any motion needs: servo loops of real arms do not sag or lag visibly.
_JOINT_EFFORT, _FINGER_EFFORT_N = 300.0, 40.0
_ROBOT_GROUP, _TABLE_GROUP = 2, 1
_ROOT = "body"


class YumiBody:
    """One robot in a physics server of its own.

    Attributes:
        link_names: All links, the root first.
    """

    def __init__(
        self,
        positions_rad: Floats,
        openings_m: Mapping[Arm, float],
        step_s: float,
        placement: Placement = YUMI_AT_TABLE,
    ) -> None:
        """Put the robot at the table.

        Args:
            positions_rad: Of both arms' joints, shape (14,), left arm first.
            openings_m: Of the grippers.
            step_s: Length of a step.
            placement: Where the robot stands.
        """
        self._placement = placement
        self._bullet = import_pybullet()
        self._server = self._bullet.connect(self._bullet.DIRECT)
        self._bullet.setTimeStep(step_s, physicsClientId=self._server)
        self._add_table()
        self._robot = self._add_robot()
        joints = self._joints()
        self._links = dict(joints.values())
        self.link_names: tuple[str, ...] = (_ROOT, *self._links)
        self._arm_joints = [joints[n][1] for arm in ARMS for n in arm_joint_names(arm)]
        self._finger_joints = [joints[n][1] for arm in ARMS for n in finger_joint_names(arm)]
        self._driven = self._arm_joints + self._finger_joints
        self._forces = [_JOINT_EFFORT] * len(self._arm_joints)
        self._forces += [_FINGER_EFFORT_N] * len(self._finger_joints)
        self._place(positions_rad, openings_m)

    def drive(self, positions_rad: Floats, openings_m: Mapping[Arm, float]) -> None:
        """Say where joints and grippers are at the end of the next step.

        A position gain of one asks for exactly the speed that gets there in one step.
        """
        targets = [*positions_rad, *_finger_positions(openings_m)]
        ones = [1.0] * len(targets)
        self._bullet.setJointMotorControlArray(
            self._robot,
            self._driven,
            self._bullet.POSITION_CONTROL,
            targetPositions=targets,
            forces=self._forces,
            positionGains=ones,
            velocityGains=ones,
            physicsClientId=self._server,
        )

    def step(self) -> None:
        """Let one step of time pass."""
        self._bullet.stepSimulation(physicsClientId=self._server)

    def joint_state(self) -> tuple[Floats, Floats]:
        """Return positions [rad] and velocities [rad/s] of the arms, shape (14,) each."""
        states = self._states(self._arm_joints)
        return states[:, 0], states[:, 1]

    def joints(self) -> Floats:
        """Return position and velocity of all joints that are driven, shape (18, 2)."""
        return self._states(self._driven)

    def place_joints(self, joints: Floats) -> None:
        """Put all joints that are driven into the state that `joints` has returned."""
        for joint, (value, velocity) in zip(self._driven, joints.tolist(), strict=True):
            self._bullet.resetJointState(
                self._robot, joint, value, velocity, physicsClientId=self._server
            )

    def openings_m(self) -> Mapping[Arm, float]:
        """Return the distance between the fingers of each gripper."""
        fingers = self._states(self._finger_joints)[:, 0].reshape(len(ARMS), 2).sum(axis=1)
        return MappingProxyType({arm: float(m) for arm, m in zip(ARMS, fingers, strict=True)})

    def link_poses(self, names: Sequence[str]) -> tuple[Floats, Floats]:
        """Return positions [m], shape (N, 3), and quaternions xyzw, shape (N, 4), of links."""
        moving = [self._links[name] for name in names if name != _ROOT]
        states = self._bullet.getLinkStates(
            self._robot, moving, computeForwardKinematics=True, physicsClientId=self._server
        )
        poses = [state[4] + state[5] for state in states]
        if _ROOT in names:
            root = (*self._placement.position_m, *self._root_quat_xyzw())
            poses.insert(names.index(_ROOT), root)
        table = np.array(poses)
        return table[:, :3], table[:, 3:]

    def close(self) -> None:
        """Shut the physics server; nothing else may be called afterwards."""
        self._bullet.disconnect(physicsClientId=self._server)

    def _add_table(self) -> None:
        top = table_top()
        half = [0.5 * size for size in top.size_m]
        shape = self._bullet.createCollisionShape(
            self._bullet.GEOM_BOX, halfExtents=half, physicsClientId=self._server
        )
        table = self._bullet.createMultiBody(
            0.0, shape, basePosition=top.centre_m, physicsClientId=self._server
        )
        self._let_touch(table, -1, _TABLE_GROUP, _ROBOT_GROUP)

    def _add_robot(self) -> int:
        robot: int = self._bullet.loadURDF(
            str(urdf_path("yumi")),
            self._placement.position_m,
            self._root_quat_xyzw(),
            useFixedBase=True,
            physicsClientId=self._server,
        )
        for link in range(-1, self._bullet.getNumJoints(robot, physicsClientId=self._server)):
            self._let_touch(robot, link, _ROBOT_GROUP, _TABLE_GROUP)
        return robot

    def _root_quat_xyzw(self) -> tuple[float, float, float, float]:
        half = 0.5 * self._placement.yaw_rad
        return 0.0, 0.0, math.sin(half), math.cos(half)

    def _let_touch(self, body: int, link: int, group: int, others: int) -> None:
        self._bullet.setCollisionFilterGroupMask(
            body, link, group, others, physicsClientId=self._server
        )

    def _joints(self) -> dict[str, tuple[str, int]]:
        """Return the child link and the index of each joint, by its name, in their order."""
        count = self._bullet.getNumJoints(self._robot, physicsClientId=self._server)
        infos = [
            self._bullet.getJointInfo(self._robot, index, physicsClientId=self._server)
            for index in range(count)
        ]
        return {info[1].decode(): (info[12].decode(), info[0]) for info in infos}

    def _place(self, positions_rad: Floats, openings_m: Mapping[Arm, float]) -> None:
        values = [*positions_rad, *_finger_positions(openings_m)]
        for joint, value in zip(self._driven, values, strict=True):
            self._bullet.resetJointState(self._robot, joint, value, physicsClientId=self._server)
        self.drive(positions_rad, openings_m)

    def _states(self, joints: Sequence[int]) -> Floats:
        """Return position and velocity of joints, shape (N, 2)."""
        states = self._bullet.getJointStates(self._robot, joints, physicsClientId=self._server)
        return np.array([state[:2] for state in states])


def _finger_positions(openings_m: Mapping[Arm, float]) -> list[float]:
    """Return the positions of the two fingers of each hand; each makes half of the opening."""
    return [0.5 * openings_m[arm] for arm in ARMS for _ in finger_joint_names(arm)]
