"""The robot in Pinocchio: one model of the whole machine, one reduced model an arm.

A configuration is one vector with the arms' joints in the order of `RobotModel.arms`, each in
chain order; fingers are no part of it, they follow the gripper's opening. All poses are in the
world frame.
"""

from collections.abc import Mapping
from math import pi
from xml.etree import ElementTree as ET

import numpy as np
import pinocchio as pin

from executive.core.errors import InputError
from executive.core.registry import closest
from robots.descriptions.specs import ArmSpec, RobotSpec, yumi_spec
from robots.interfaces import ArmName, Floats
from robots.limits import JointLimits
from robots.motion.chain_kernels import Chain
from robots.motion.extents import levers_m, longest_reach_m
from robots.placement import Placement

# Dexterity below which small motions of the tool begin to ask for large ones of the joints.
SINGULAR_ZONE = 0.1


# Inverse kinematics stays that far from the joint limits: curves through its answers swing out.
LIMIT_RESERVE_RAD = 0.005


class ArmKinematics:
    """Forward kinematics and Jacobian of one arm, everything else of the robot locked.

    Attributes:
        model: The reduced model.
        lower: What inverse kinematics may use [rad], shape (n,); the limits are a little wider.
        upper: As `lower`.
        chain: The same arm for compiled loops.
        reach_m: The tool is never farther than this from the first joint [m].
    """

    def __init__(self, model: pin.Model, tcp: str, reach_m: float | None = None) -> None:
        """Take the reduced model of an arm and the name of its tool frame."""
        self.model = model
        self._data = model.createData()
        self._tcp = model.getFrameId(tcp)
        self.lower: Floats = model.lowerPositionLimit + LIMIT_RESERVE_RAD
        self.upper: Floats = model.upperPositionLimit - LIMIT_RESERVE_RAD
        self.chain = chain_of(model, self._tcp, self.lower, self.upper)
        self.reach_m = longest_reach_m(model, self._tcp) if reach_m is None else reach_m

    @property
    def redundant(self) -> bool:
        """Whether joints can move while the tool rests."""
        return int(self.model.nv) > 6

    @property
    def shoulder_m(self) -> Floats:
        """Position of the first joint in the world [m], shape (3,)."""
        return self.model.jointPlacements[1].translation.copy()

    def tcp_pose(self, positions_rad: Floats) -> pin.SE3:
        """Return T_world_tcp at joint positions of shape (n,)."""
        pin.forwardKinematics(self.model, self._data, positions_rad)
        return pin.updateFramePlacement(self.model, self._data, self._tcp).copy()

    def tcp_jacobian(self, positions_rad: Floats) -> tuple[pin.SE3, Floats]:
        """Return T_world_tcp and the Jacobian of the tool's twist in its own frame, (6, n)."""
        pin.computeJointJacobians(self.model, self._data, positions_rad)
        T_world_tcp = pin.updateFramePlacement(self.model, self._data, self._tcp)
        jacobian = pin.getFrameJacobian(self.model, self._data, self._tcp, pin.ReferenceFrame.LOCAL)
        return T_world_tcp, jacobian

    def dexterity(self, positions_rad: Floats) -> float:
        """Return the smallest singular value of the tool's Jacobian; 0 is a singularity."""
        return float(np.linalg.svd(self.tcp_jacobian(positions_rad)[1], compute_uv=False)[-1])


def chain_of(model: pin.Model, tcp: int, lower: Floats, upper: Floats) -> Chain:
    """Return an arm for compiled loops.

    Args:
        model: Its joints, one after the other, and no others.
        tcp: Number of its tool's frame, which the last joint moves.
        lower: What inverse kinematics may use, shape (n,).
        upper: As `lower`.

    Raises:
        InputError: The joints are not one after the other.
    """
    joints, tool = range(1, model.njoints), model.frames[tcp]
    if list(model.parents)[1:] != [j - 1 for j in joints] or tool.parentJoint != joints[-1]:
        names = ", ".join(list(model.names)[1:])
        raise InputError(f"{tool.name}: got joints {names}; expected a chain that ends there")
    data = model.createData()
    pin.computeJointJacobians(model, data, pin.neutral(model))
    twists = np.array(
        [pin.getJointJacobian(model, data, j, pin.ReferenceFrame.LOCAL)[:, j - 1] for j in joints]
    )
    placements = [*(model.jointPlacements[j] for j in joints), tool.placement]
    return Chain(
        rotations=np.array([placement.rotation for placement in placements]),
        offsets=np.array([placement.translation for placement in placements]),
        turns=np.ascontiguousarray(twists[:, 3:]),
        slides=np.ascontiguousarray(twists[:, :3]),
        lower=lower,
        upper=upper,
    )


class RobotModel:
    """A robot with one or more arms, standing in the world.

    Attributes:
        spec: Names of its parts.
        arms: Names of its arms, in the order of configurations.
        model: Pinocchio's model of the whole robot.
        geometry: Its shapes.
        kinematics: Of each arm alone.
        levers_m: How far the farthest part that a joint moves is from its axis, shape (n,).
        limits: Of the joints.
    """

    def __init__(self, spec: RobotSpec, placement: Placement) -> None:
        """Load a URDF and put its root where the placement says.

        Raises:
            InputError: The URDF cannot be used, or a joint or frame that the specification
                names is not in it.
        """
        self.spec = spec
        self.model, self.geometry = _loaded(spec)
        self.arms: tuple[str, ...] = tuple(spec.arms)
        _demand_names(spec, self.model)
        self._stand(placement)
        names = [name for arm in spec.arms.values() for name in arm.joints]
        self._arm_indices = np.array([self._index(name) for name in names])
        self._finger_indices = {
            name: np.array([self._index(finger) for finger in arm.fingers], dtype=int)
            for name, arm in spec.arms.items()
        }
        self.kinematics = {name: self._reduced(arm) for name, arm in spec.arms.items()}
        self.levers_m: Floats = np.concatenate([self._levers(arm) for arm in spec.arms.values()])
        self.limits = JointLimits.from_speeds(
            self.model.lowerPositionLimit[self._arm_indices],
            self.model.upperPositionLimit[self._arm_indices],
            self.model.velocityLimit[self._arm_indices],
        )

    @property
    def size(self) -> int:
        """Number of arm joints."""
        return len(self._arm_indices)

    def joints_of(self, arm: str) -> slice:
        """Return where an arm's joints are in a configuration."""
        start = 0
        for name in self.arms:
            stop = start + len(self.spec.arms[name].joints)
            if name == arm:
                return slice(start, stop)
            start = stop
        raise KeyError(arm)

    def complete(self, positions_rad: Floats, openings_m: Mapping[ArmName, float]) -> Floats:
        """Return Pinocchio's configuration of the whole robot, fingers included."""
        q: Floats = np.zeros(self.model.nq)
        q[self._arm_indices] = positions_rad
        for arm, opening_m in openings_m.items():
            q[self._finger_indices[arm]] = opening_m / 2
        return q

    def write_arms(self, q: Floats, positions_rad: Floats) -> None:
        """Overwrite the arm joints of a complete configuration, in place."""
        q[self._arm_indices] = positions_rad

    def tcp_pose(self, arm: str, positions_rad: Floats) -> pin.SE3:
        """Return T_world_tcp of an arm at a configuration of all arms."""
        return self.kinematics[arm].tcp_pose(positions_rad[self.joints_of(arm)])

    def _index(self, joint: str) -> int:
        return int(self.model.joints[self.model.getJointId(joint)].idx_q)

    def _stand(self, placement: Placement) -> None:
        T_world_body = pin.SE3(
            pin.rpy.rpyToMatrix(0.0, 0.0, placement.yaw_rad), np.array(placement.position_m)
        )
        for joint in range(1, self.model.njoints):
            if self.model.parents[joint] == 0:
                placed = T_world_body * self.model.jointPlacements[joint]
                self.model.jointPlacements[joint] = placed
        for frame in self.model.frames:
            if frame.parentJoint == 0:
                frame.placement = T_world_body * frame.placement
        for shape in self.geometry.geometryObjects:
            if shape.parentJoint == 0:
                shape.placement = T_world_body * shape.placement

    def _reduced(self, spec: ArmSpec) -> ArmKinematics:
        locked = [
            self.model.getJointId(name) for name in self.model.names[1:] if name not in spec.joints
        ]
        reduced = pin.buildReducedModel(self.model, locked, pin.neutral(self.model))
        return ArmKinematics(reduced, spec.tcp, spec.reach_m)

    def _levers(self, spec: ArmSpec) -> Floats:
        if spec.levers_m is not None:
            return np.array(spec.levers_m)
        return levers_m(self.model, self.geometry, spec.joints)


def _loaded(spec: RobotSpec) -> tuple[pin.Model, pin.GeometryModel]:
    """Parse a URDF; joints that turn without end are given one turn either way.

    A configuration then has one number a joint.
    """
    root = ET.parse(spec.urdf).getroot()
    for joint in root.findall("joint[@type='continuous']"):
        joint.set("type", "revolute")
        limit = joint.find("limit")
        limit = ET.SubElement(joint, "limit") if limit is None else limit
        limit.set("lower", str(-2.0 * pi))
        limit.set("upper", str(2.0 * pi))
    text = ET.tostring(root, encoding="unicode")
    folders = [str(spec.urdf.parent), str(spec.urdf.parent.parent)]
    try:
        model = pin.buildModelFromXML(text)
        geometry = pin.buildGeomFromUrdfString(
            model, text, pin.GeometryType.COLLISION, package_dirs=folders
        )
    except (ValueError, RuntimeError) as error:
        raise InputError(f"{spec.urdf}: Pinocchio cannot load it: {error}") from None
    if model.nq != model.nv or geometry.ngeoms == 0:
        what = "no collision shapes" if geometry.ngeoms == 0 else "a joint of several numbers"
        raise InputError(
            f"{spec.urdf}: got {what}; expected shapes to check collisions with, and joints "
            "that turn or slide"
        )
    return model, geometry


def _demand_names(spec: RobotSpec, model: pin.Model) -> None:
    for arm, parts in spec.arms.items():
        joints = [name for name in (*parts.joints, *parts.fingers) if name not in model.names]
        if joints:
            known = ", ".join(list(model.names)[1:])
            raise InputError(
                f"{spec.name}: {arm}: no joint {joints[0]!r} that moves; expected one of: {known}"
            )
        if not model.existFrame(parts.tcp):
            frames = [f.name for f in model.frames if f.type == pin.FrameType.BODY]
            raise InputError(
                f"{spec.name}: {arm}: no link {parts.tcp!r}; {closest(parts.tcp, frames)}"
            )


def yumi_model(placement: Placement) -> RobotModel:
    """Return the YuMi, left arm first, at its place."""
    return RobotModel(yumi_spec(), placement)
