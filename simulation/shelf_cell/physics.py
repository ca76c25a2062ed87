"""Shelf, boxes and arm in one physics server: rigid bodies with contact, friction and gravity."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robots.descriptions import DESCRIPTIONS, urdf_path
from robots.descriptions.kinova import SUCTION_FRAME
from robots.placement import PlanningScene, StaticBox
from simulation.bullet import import_pybullet
from simulation.shelf_cell.boxes import HeavyBox

Floats = NDArray[np.float64]

GRAVITY_M_S2 = 9.81
_TOOL_LINKS = ("bluction", "cup")
# Boxes and boards touch everything; the arm's own parts do not touch each other, which is the
# planner's business.
_BOARD_GROUP, _BOX_GROUP, _ARM_GROUP = 1, 2, 4
# Friction between two of a kind; between two kinds it is the geometric mean.
_BOARD_FRICTION, _TOOL_FRICTION, _ARM_FRICTION = 0.35, 0.25, 0.5
# Contacts resolve more finely than by default: stacks and wedged boxes must not creep.
_SOLVER_ITERATIONS = 100
# Faces rub over their whole area, contact points do not: without it boxes at rest turn slowly.
_SPINNING_FRICTION_M = 0.002
_STILL_M_S, _STILL_RAD_S = 1e-3, 1e-2


class ShelfPhysics:
    """The bodies.

    Attributes:
        link_names: All links of the arm, the root first.
        boards: What stands still.
        box_names: All boxes, in the order of their poses.
        box_sizes_m: Their edge lengths, shape (N, 3).
        step_s: Length of a step.
    """

    def __init__(
        self,
        robot: str,
        scene: PlanningScene,
        boxes: Sequence[HeavyBox],
        positions_rad: Floats,
        step_s: float,
    ) -> None:
        """Set everything up; nothing moves yet.

        Args:
            robot: Name of the arm's description.
            scene: Where the arm stands, and the boards.
            boxes: What stands in the shelf.
            positions_rad: Of the arm's joints, shape (n,).
            step_s: Length of a step.
        """
        self._bullet: Any = import_pybullet()
        self._server: int = self._bullet.connect(self._bullet.DIRECT)
        self.step_s = step_s
        self._call("setTimeStep", step_s)
        self._call("setGravity", 0.0, 0.0, -GRAVITY_M_S2)
        self._call("setPhysicsEngineParameter", numSolverIterations=_SOLVER_ITERATIONS)
        self.boards = scene.boxes
        for board in scene.boxes:
            self._add_board(board)
        self._bodies = {box.name: self._add_box(box) for box in boxes}
        self._names = {body: name for name, body in self._bodies.items()}
        self.box_names = tuple(self._bodies)
        self.box_sizes_m = np.array([box.box.size_m for box in boxes]).reshape(-1, 3)
        self._robot_name = robot
        self._robot = self._add_arm(robot, scene)
        self._take_links()
        self._place(positions_rad)

    def drive(self, positions_rad: Floats) -> None:
        """Say where the joints are to be at the end of the next step; motors have real torques.

        A position gain of one asks for exactly the speed that gets there in one step.
        """
        ones = [1.0] * len(self._joints)
        self._call(
            "setJointMotorControlArray",
            self._robot,
            self._joints,
            self._bullet.POSITION_CONTROL,
            targetPositions=positions_rad.tolist(),
            forces=self._efforts,
            positionGains=ones,
            velocityGains=ones,
        )

    def step(self) -> None:
        """Let one step of time pass."""
        self._call("stepSimulation")

    def joint_state(self) -> tuple[Floats, Floats]:
        """Return positions [rad] and velocities [rad/s] of the joints, shape (n,) each."""
        states = np.array(
            [state[:2] for state in self._call("getJointStates", self._robot, self._joints)]
        )
        return states[:, 0], states[:, 1]

    def link_poses(self) -> Floats:
        """Return position [m] and quaternion xyzw of every link, shape (L, 7)."""
        states = self._call(
            "getLinkStates",
            self._robot,
            list(range(len(self.link_names) - 1)),
            computeForwardKinematics=True,
        )
        return np.array([self._root, *((*state[4], *state[5]) for state in states)])

    def link_pose(self, name: str) -> Floats:
        """Return position [m] and quaternion xyzw of a link, shape (7,)."""
        state = self._call(
            "getLinkState", self._robot, self._link(name), computeForwardKinematics=True
        )
        return np.array([*state[4], *state[5]])

    def box_poses(self) -> Floats:
        """Return position [m] and quaternion xyzw of every box's centre, shape (N, 7)."""
        poses = [
            self._call("getBasePositionAndOrientation", body) for body in self._bodies.values()
        ]
        return np.array([(*position, *quat) for position, quat in poses]).reshape(-1, 7)

    def boxes_still(self) -> bool:
        """Return whether no box moves to speak of."""
        for body in self._bodies.values():
            linear, angular = self._call("getBaseVelocity", body)
            if max(map(abs, linear)) > _STILL_M_S or max(map(abs, angular)) > _STILL_RAD_S:
                return False
        return True

    def kinetic_energy_j(self) -> float:
        """Return the energy of motion of all boxes, turning left out."""
        energies = []
        for body in self._bodies.values():
            linear, _ = self._call("getBaseVelocity", body)
            mass_kg = self._call("getDynamicsInfo", body, -1)[0]
            energies.append(0.5 * mass_kg * float(np.square(linear).sum()))
        return sum(energies)

    def forces_on_arm_n(self) -> dict[str, Floats]:
        """Return the force on the arm by each box that it touches, and by boards, named ''."""
        forces: dict[str, Floats] = {}
        for contact in self._call("getContactPoints", bodyA=self._robot):
            name = self._names.get(contact[2], "")
            forces[name] = forces.get(name, np.zeros(3)) + _force(contact)
        return forces

    def outer_force_n(self, name: str) -> Floats:
        """Return the force on a box by all but the arm, gravity left out, shape (3,)."""
        contacts = self._call("getContactPoints", bodyA=self._bodies[name])
        return _total([c for c in contacts if c[2] != self._robot])

    def faces_ahead(self, starts_m: Floats, ends_m: Floats) -> list[tuple[str, float, Floats]]:
        """Return the box, the share of the way and the normal that each ray meets.

        Args:
            starts_m: Shape (R, 3).
            ends_m: Shape (R, 3).

        Returns:
            One entry a ray; the name is empty where it meets no box.
        """
        hits = self._call(
            "rayTestBatch", starts_m.tolist(), ends_m.tolist(), collisionFilterMask=_BOX_GROUP
        )
        return [(self._names.get(hit[0], ""), float(hit[2]), np.array(hit[4])) for hit in hits]

    def attach(self, name: str) -> int:
        """Fix a box to the suction frame as it is now; returns what `release` takes."""
        self._wake(name)
        tip = self.link_pose(SUCTION_FRAME)
        position, quat = self._call("getBasePositionAndOrientation", self._bodies[name])
        inverse = self._bullet.invertTransform(position, quat)
        in_box = self._bullet.multiplyTransforms(*inverse, tip[:3].tolist(), tip[3:].tolist())
        constraint: int = self._call(
            "createConstraint",
            self._robot,
            self._link(SUCTION_FRAME),
            self._bodies[name],
            -1,
            self._bullet.JOINT_FIXED,
            [0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0],
            in_box[0],
            [0.0, 0.0, 0.0, 1.0],
            in_box[1],
        )
        return constraint

    def load(self, constraint: int) -> tuple[Floats, Floats]:
        """Return force [N] and torque [N m] of an attached box on the suction frame, in it."""
        state = np.array(self._call("getConstraintState", constraint)).reshape(2, 3)
        quat = self.link_pose(SUCTION_FRAME)[3:].tolist()
        # The server tells both along the axes of the world.
        force_n, torque_nm = state @ np.reshape(self._bullet.getMatrixFromQuaternion(quat), (3, 3))
        return force_n, torque_nm

    def release(self, name: str, constraint: int) -> None:
        """Let go of an attached box."""
        self._call("removeConstraint", constraint)
        self._wake(name)

    def close(self) -> None:
        """Shut the physics server; nothing else may be called afterwards."""
        self._call("disconnect")

    def _call(self, name: str, *args: Any, **named: Any) -> Any:
        return getattr(self._bullet, name)(*args, physicsClientId=self._server, **named)

    def _wake(self, name: str) -> None:
        state = self._bullet.ACTIVATION_STATE_WAKE_UP
        self._call("changeDynamics", self._bodies[name], -1, activationState=state)

    def _add_board(self, board: StaticBox) -> None:
        body = self._add_body(board.size_m, 0.0, board.centre_m, _BOARD_GROUP)
        self._call("changeDynamics", body, -1, lateralFriction=_BOARD_FRICTION**0.5)

    def _add_box(self, box: HeavyBox) -> int:
        centre_m = (box.box.x_m, box.box.y_m, box.box.bottom_m + 0.5 * box.box.size_m[2])
        body = self._add_body(box.box.size_m, box.mass_kg, centre_m, _BOX_GROUP)
        self._call(
            "changeDynamics",
            body,
            -1,
            lateralFriction=box.friction**0.5,
            spinningFriction=_SPINNING_FRICTION_M,
            activationState=self._bullet.ACTIVATION_STATE_ENABLE_SLEEPING,
        )
        return body

    def _add_body(
        self,
        size_m: tuple[float, float, float],
        mass_kg: float,
        centre_m: tuple[float, float, float],
        group: int,
    ) -> int:
        half = [0.5 * size for size in size_m]
        shape = self._call("createCollisionShape", self._bullet.GEOM_BOX, halfExtents=half)
        body: int = self._call("createMultiBody", mass_kg, shape, basePosition=centre_m)
        self._let_touch(body, -1, group, _BOARD_GROUP | _BOX_GROUP | _ARM_GROUP)
        return body

    def _add_arm(self, robot: str, scene: PlanningScene) -> int:
        placement = scene.placement
        quat = self._bullet.getQuaternionFromEuler([0.0, 0.0, placement.yaw_rad])
        self._root = (*placement.position_m, *quat)
        body: int = self._call(
            "loadURDF", str(urdf_path(robot)), placement.position_m, quat, useFixedBase=True
        )
        for link in range(-1, self._call("getNumJoints", body)):
            self._let_touch(body, link, _ARM_GROUP, _BOARD_GROUP | _BOX_GROUP)
        return body

    def _let_touch(self, body: int, link: int, group: int, others: int) -> None:
        self._call("setCollisionFilterGroupMask", body, link, group, others)

    def _take_links(self) -> None:
        count = self._call("getNumJoints", self._robot)
        infos = [self._call("getJointInfo", self._robot, index) for index in range(count)]
        root = DESCRIPTIONS[self._robot_name]().links[0].name
        self.link_names = (root, *(info[12].decode() for info in infos))
        moving = [info for info in infos if info[2] == self._bullet.JOINT_REVOLUTE]
        self._joints = [info[0] for info in moving]
        self._efforts = [info[10] for info in moving]
        for number, name in enumerate(self.link_names[1:]):
            friction = _TOOL_FRICTION if name in _TOOL_LINKS else _ARM_FRICTION
            self._call("changeDynamics", self._robot, number, lateralFriction=friction**0.5)

    def _link(self, name: str) -> int:
        return self.link_names.index(name) - 1

    def _place(self, positions_rad: Floats) -> None:
        for joint, value in zip(self._joints, positions_rad.tolist(), strict=True):
            self._call("resetJointState", self._robot, joint, value)
        self.drive(positions_rad)


def _force(contact: Sequence[Any]) -> Floats:
    """Return the force of a contact point on its first body: normal and both of friction."""
    normal, first, second = (np.array(contact[index]) for index in (7, 11, 13))
    force: Floats = contact[9] * normal + contact[10] * first + contact[12] * second
    return force


def _total(contacts: Sequence[Sequence[Any]]) -> Floats:
    return np.sum([_force(contact) for contact in contacts], axis=0) if contacts else np.zeros(3)
