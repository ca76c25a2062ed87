"""Says whether a configuration collides, and which two bodies do.

The broad phase is Pinocchio's naive one: over the few dozen primitives here it is five times
faster than testing every pair, and unlike the dynamic tree arrays it has missed no collision
(coal issues 750 and 784). `demand_agreement` checks that on random configurations
before the first plan.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from executive.core.errors import DeviceError
from robots.interfaces import ArmName, Floats
from robots.motion.bodies import (
    arm_of,
    attached_geometry,
    named_boxes,
    static_geometry,
    tool_bodies,
)
from robots.motion.model import RobotModel
from robots.placement import AttachedBox, PlanningScene


@dataclass(frozen=True, slots=True)
class Margins:
    """How far bodies keep apart [m].

    Attributes:
        world_m: Links from static boxes.
        finger_world_m: Fingers and other tools from static boxes; they have to reach things.
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
        arms: tuple[str, ...] | None = None,
        margins: Margins = STANDARD_MARGINS,
    ) -> None:
        """Build the pairs to check and the broad phase over them.

        Args:
            robot: Where the robot stands and how it moves; not modified.
            scene: Static boxes, and boxes that arms carry.
            arms: Arms that take part; the others are ignored. All when None.
            margins: Distances to keep.

        Raises:
            InputError: A box is carried by an arm that the robot does not have, or two boxes
                have the same name.
        """
        self.robot = robot
        self._geometry = robot.geometry.copy()
        self._boxes = named_boxes(robot, scene)
        for box in scene.boxes:
            self._geometry.addGeometryObject(static_geometry(box))
        for carried in scene.attached:
            self._geometry.addGeometryObject(attached_geometry(robot, carried))
        self._tools = tool_bodies(robot)
        self._ignored = set(robot.arms) - set(robot.arms if arms is None else arms)
        shapes = self._geometry.geometryObjects
        self._body_names = [self._body_name(shape) for shape in shapes]
        self._arms = [arm_of(robot, shape.parentJoint) for shape in shapes]
        self._add_pairs(frozenset(map(frozenset, robot.spec.overlaps)))
        self._data = robot.model.createData()
        self._geometry_data = self._geometry.createData()
        self._margins_m = [
            self._margin(pair.first, pair.second, margins) for pair in self._geometry.collisionPairs
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

    def set_openings(self, openings_m: Mapping[ArmName, float]) -> None:
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
        return next(iter(self._colliding(positions_rad, stop_at_first=True)), None)

    def colliding_pairs(self, positions_rad: Floats) -> set[tuple[str, str]]:
        """Return the names of all pairs of bodies that collide."""
        return set(self._colliding(positions_rad, stop_at_first=False))

    def _colliding(self, positions_rad: Floats, stop_at_first: bool) -> Iterator[tuple[str, str]]:
        self.robot.write_arms(self._q, positions_rad)
        pin.updateGeometryPlacements(
            self.robot.model, self._data, self._geometry, self._geometry_data, self._q
        )
        pin.computeCollisions(self._geometry, self._geometry_data, stop_at_first)
        for pair, result in zip(
            self._geometry.collisionPairs, self._geometry_data.collisionResults, strict=True
        ):
            if result.isCollision():
                yield self._body_names[pair.first], self._body_names[pair.second]

    def distance_m(self, pair: tuple[str, str], positions_rad: Floats) -> float:
        """Return how far apart two bodies are at a configuration [m]; below 0 they overlap.

        Args:
            pair: Two bodies that are checked.
            positions_rad: Of all arms, shape (n,).
        """
        self.robot.write_arms(self._q, positions_rad)
        pin.updateGeometryPlacements(
            self.robot.model, self._data, self._geometry, self._geometry_data, self._q
        )
        names = self._body_names
        return min(
            float(pin.computeDistance(self._geometry, self._geometry_data, index).min_distance)
            for index, shapes in enumerate(self._geometry.collisionPairs)
            if {names[shapes.first], names[shapes.second]} == set(pair)
        )

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

    def disagreements(self, rng: np.random.Generator, count: int) -> int:
        """Return at how many of `count` random configurations the pairwise test disagrees."""
        limits = self.robot.limits
        samples = rng.uniform(limits.lower, limits.upper, (count, self.robot.size))
        return sum(self.collides(q) != (self.colliding_pair(q) is not None) for q in samples)

    def demand_agreement(self, rng: np.random.Generator, count: int) -> None:
        """Compare broad phase and pairwise test on random configurations.

        Raises:
            DeviceError: They disagree, as some broad phases of coal did.
        """
        wrong = self.disagreements(rng, count)
        if wrong:
            raise DeviceError(
                f"collision checks: got {wrong} of {count} configurations in which the broad "
                "phase disagrees with the test of all pairs; expected 0; try another release "
                "of pin and coal"
            )

    def _body_name(self, shape: pin.GeometryObject) -> str:
        if shape.name in self._boxes:
            return str(shape.name)
        return str(self.robot.model.frames[shape.parentFrame].name)

    def _add_pairs(self, overlaps: frozenset[frozenset[str]]) -> None:
        self._geometry.removeAllCollisionPairs()
        shapes = self._geometry.geometryObjects
        neighbours = self._neighbours()
        for second in range(len(shapes)):
            for first in range(second):
                bodies = frozenset((self._body_names[first], self._body_names[second]))
                names = frozenset((shapes[first].name, shapes[second].name))
                fixed = shapes[first].parentJoint == shapes[second].parentJoint
                if self._ignored & {self._arms[first], self._arms[second]}:
                    continue
                excused = bodies in neighbours or overlaps & {bodies, names}
                if not fixed and not excused and not self._may_touch(bodies):
                    self._geometry.addCollisionPair(pin.CollisionPair(first, second))

    def _may_touch(self, bodies: frozenset[str]) -> bool:
        """Return whether a box of the scene or in a hand may be touched by the other body."""
        boxes = [self._boxes[body] for body in bodies if body in self._boxes]
        return any(bodies & set(box.touched_by) for box in boxes)

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
        for spec in self.robot.spec.arms.values():
            fingers = [model.getJointId(name) for name in spec.fingers]
            pairs.add(frozenset(link.name for link in links if link.parentJoint in fingers))
        return pairs

    def _demand_margins(self) -> None:
        for margin, request in zip(
            self._margins_m, self._geometry_data.collisionRequests, strict=True
        ):
            request.security_margin = margin

    def _margin(self, first: int, second: int, margins: Margins) -> float:
        bodies = self._body_names[first], self._body_names[second]
        boxes = [self._boxes[body] for body in bodies if body in self._boxes]
        carried = [box.margin_m for box in boxes if isinstance(box, AttachedBox)]
        if carried:
            return min(carried)
        if boxes:
            return margins.finger_world_m if self._tools & set(bodies) else margins.world_m
        arms = {self._arms[first], self._arms[second]}
        return margins.arms_m if None not in arms and len(arms) == 2 else margins.own_m
