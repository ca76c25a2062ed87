"""Says whether a configuration collides, and which two bodies do.

The broad phase is Pinocchio's naive one: over the few dozen primitives here it is five times
faster than testing every pair, and unlike the dynamic tree arrays it has missed no collision
(coal issues 750 and 784). `agrees_with_pairwise` checks that on random configurations.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import coal
import numpy as np
import pinocchio as pin

from robots.interfaces import Arm, Floats
from robots.motion.model import RobotModel
from robots.placement import PlanningScene, StaticBox

# Bodies that overlap by construction of their enclosing shapes, besides parent and child. The
# body's head box (its fifth shape) encloses what the shoulders turn in.
YUMI_OVERLAPS: tuple[tuple[str, str], ...] = tuple(
    pair
    for arm in ("left", "right")
    for pair in (
        ("body_4", f"{arm}_link_2_0"),
        (f"{arm}_link_5_0", f"{arm}_link_7_0"),
        (f"{arm}_link_5_0", f"{arm}_gripper_base_0"),
    )
)


@dataclass(frozen=True, slots=True)
class Margins:
    """How far bodies keep apart [m].

    Attributes:
        world_m: Links from static boxes.
        finger_world_m: Fingers from static boxes; they have to reach down to the table.
        arms_m: One arm from the other.
        own_m: Links of one arm, and arm and body; both are known exactly.
    """

    world_m: float = 0.005
    finger_world_m: float = 0.0005
    arms_m: float = 0.005
    own_m: float = 0.001


STANDARD_MARGINS = Margins()
# How much closer an excused pair may come [m]: rounding, not motion.
_EXCUSE_M = 1e-4


class CollisionModel:
    """A robot among static boxes."""

    def __init__(
        self,
        robot: RobotModel,
        scene: PlanningScene,
        *,
        arms: tuple[Arm, ...] | None = None,
        overlaps: tuple[tuple[str, str], ...] = YUMI_OVERLAPS,
        margins: Margins = STANDARD_MARGINS,
    ) -> None:
        """Build the pairs to check and the broad phase over them.

        Args:
            robot: Where the robot stands and how it moves; not modified.
            scene: Static boxes.
            arms: Arms that take part; the others are ignored. All when None.
            overlaps: Names of shapes that may overlap.
            margins: Distances to keep.
        """
        self.robot = robot
        self._geometry = robot.geometry.copy()
        self._static = {box.name for box in scene.boxes}
        for box in scene.boxes:
            self._geometry.addGeometryObject(_static_geometry(box))
        self._ignored = set(robot.arms) - set(robot.arms if arms is None else arms)
        self._body_names = [self._body_name(shape) for shape in self._geometry.geometryObjects]
        self._add_pairs(frozenset(map(frozenset, overlaps)))
        self._data = robot.model.createData()
        self._geometry_data = self._geometry.createData()
        self._margins_m = [
            self._margin(self._body_names[pair.first], self._body_names[pair.second], margins)
            for pair in self._geometry.collisionPairs
        ]
        self._demand_margins()
        self._manager = pin.BroadPhaseManager_NaiveCollisionManager(
            robot.model, self._geometry, self._geometry_data
        )
        self._q = robot.complete(np.zeros(robot.size), {})

    def checked_bodies(self) -> set[tuple[str, str]]:
        """Return the names of all pairs of bodies that are checked."""
        names = self._body_names
        return {(names[pair.first], names[pair.second]) for pair in self._geometry.collisionPairs}

    def set_openings(self, openings_m: Mapping[Arm, float]) -> None:
        """Take note of how far the grippers are open [m] in all later checks."""
        self._q = self.robot.complete(np.zeros(self.robot.size), openings_m)

    def collides(self, positions_rad: Floats) -> bool:
        """Return whether any pair is closer than its margin at a configuration of all arms."""
        self.robot.write_arms(self._q, positions_rad)
        return bool(
            pin.computeCollisions(self.robot.model, self._data, self._manager, self._q, True)
        )

    def colliding_pair(self, positions_rad: Floats) -> tuple[str, str] | None:
        """Return the names of two bodies that collide, or None; pairwise, hence slower."""
        self.robot.write_arms(self._q, positions_rad)
        pin.computeCollisions(
            self.robot.model, self._data, self._geometry, self._geometry_data, self._q, False
        )
        for pair, result in zip(
            self._geometry.collisionPairs, self._geometry_data.collisionResults, strict=True
        ):
            if result.isCollision():
                return self._body_names[pair.first], self._body_names[pair.second]
        return None

    def excuse(self, positions_rad: Floats) -> None:
        """Let pairs that are too close at a configuration be so, but no closer, from now on.

        A robot has to get away from where it stands. All other pairs, and those that an
        earlier call excused, keep their full margin.
        """
        self._demand_margins()
        if not self.collides(positions_rad):
            return
        pin.computeDistances(
            self.robot.model, self._data, self._geometry, self._geometry_data, self._q
        )
        for margin, request, result in zip(
            self._margins_m,
            self._geometry_data.collisionRequests,
            self._geometry_data.distanceResults,
            strict=True,
        ):
            if result.min_distance <= margin:
                request.security_margin = result.min_distance - _EXCUSE_M

    def agrees_with_pairwise(self, rng: np.random.Generator, count: int) -> bool:
        """Return whether broad phase and pairwise test agree on random configurations."""
        limits = self.robot.limits
        samples = rng.uniform(limits.lower, limits.upper, (count, self.robot.size))
        return all(
            self.collides(sample) == (self.colliding_pair(sample) is not None) for sample in samples
        )

    def _body_name(self, shape: pin.GeometryObject) -> str:
        if shape.name in self._static:
            return str(shape.name)
        return str(self.robot.model.frames[shape.parentFrame].name)

    def _arm_of(self, body: str) -> Arm | None:
        return next((arm for arm in self.robot.arms if body.startswith(f"{arm}_")), None)

    def _add_pairs(self, overlaps: frozenset[frozenset[str]]) -> None:
        self._geometry.removeAllCollisionPairs()
        shapes = self._geometry.geometryObjects
        neighbours = self._neighbours()
        for second in range(len(shapes)):
            for first in range(second):
                bodies = frozenset((self._body_names[first], self._body_names[second]))
                names = frozenset((shapes[first].name, shapes[second].name))
                fixed = shapes[first].parentJoint == shapes[second].parentJoint
                if self._ignored & {self._arm_of(body) for body in bodies}:
                    continue
                if not fixed and bodies not in neighbours and names not in overlaps:
                    self._geometry.addCollisionPair(pin.CollisionPair(first, second))

    def _neighbours(self) -> set[frozenset[str]]:
        """Return the pairs of links that a joint connects, and the fingers of each hand."""
        model = self.robot.model
        links = [frame for frame in model.frames if frame.type == pin.FrameType.BODY]
        pairs = {
            frozenset((a.name, b.name))
            for a in links
            for b in links
            if a.parentJoint in (b.parentJoint, model.parents[b.parentJoint])
        }
        for spec in self.robot.specs.values():
            fingers = [model.getJointId(name) for name in spec.fingers]
            pairs.add(frozenset(link.name for link in links if link.parentJoint in fingers))
        return pairs

    def _demand_margins(self) -> None:
        for margin, request in zip(
            self._margins_m, self._geometry_data.collisionRequests, strict=True
        ):
            request.security_margin = margin

    def _margin(self, first: str, second: str, margins: Margins) -> float:
        if first in self._static or second in self._static:
            finger = "_finger_" in first or "_finger_" in second
            return margins.finger_world_m if finger else margins.world_m
        arms = {self._arm_of(first), self._arm_of(second)}
        return margins.arms_m if None not in arms and len(arms) == 2 else margins.own_m


def _static_geometry(box: StaticBox) -> pin.GeometryObject:
    return pin.GeometryObject(
        box.name, 0, pin.SE3(np.eye(3), np.array(box.centre_m)), coal.Box(*box.size_m)
    )
