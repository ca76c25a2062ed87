"""How far an arm gets, and how far what its joints move is from their axes."""

from collections.abc import Sequence
from itertools import product

import coal
import numpy as np
import pinocchio as pin

from robots.interfaces import Floats

_CONFIGURATIONS = 64
_RESERVE = 1.05  # for what is between random configurations


def longest_reach_m(model: pin.Model, frame: int) -> float:
    """Return a bound on the distance of a frame from the first joint: all links in one line.

    Args:
        model: Of one arm.
        frame: Index of the tool's frame.
    """
    links = [float(np.linalg.norm(T.translation)) for T in list(model.jointPlacements)[2:]]
    return sum(links) + float(np.linalg.norm(model.frames[frame].placement.translation))


def levers_m(model: pin.Model, geometry: pin.GeometryModel, joints: Sequence[str]) -> Floats:
    """Return how far the farthest part that each joint moves is from its axis [m].

    Measured over random configurations, always the same ones, with a reserve.

    Args:
        model: The whole robot.
        geometry: Its shapes.
        joints: Names, in chain order.
    """
    rng = np.random.default_rng(0)
    data, placed = model.createData(), geometry.createData()
    outlines = [outline(shape.geometry) for shape in geometry.geometryObjects]
    radii = np.concatenate([np.full(len(points), radius) for points, radius in outlines])
    owners = np.repeat(
        [shape.parentJoint for shape in geometry.geometryObjects],
        [len(points) for points, _ in outlines],
    )
    numbers = [model.getJointId(name) for name in joints]
    moved = [np.isin(owners, list(model.subtrees[joint])) for joint in numbers]
    farthest: Floats = np.zeros(len(numbers))
    for _ in range(_CONFIGURATIONS):
        q = rng.uniform(model.lowerPositionLimit, model.upperPositionLimit)
        pin.computeJointJacobians(model, data, q)
        pin.updateGeometryPlacements(model, data, geometry, placed)
        placed_points = [
            points @ pose.rotation.T + pose.translation
            for (points, _), pose in zip(outlines, placed.oMg, strict=True)
        ]
        world = np.concatenate(placed_points)
        for index, joint in enumerate(numbers):
            axis = data.J[3:, model.joints[joint].idx_v]
            away = np.linalg.norm(np.cross(world - data.oMi[joint].translation, axis), axis=1)
            most = np.max(away + radii, where=moved[index], initial=0.0)
            farthest[index] = max(farthest[index], float(most))
    return _RESERVE * farthest


def outline(solid: coal.CollisionGeometry) -> tuple[Floats, float]:
    """Return points, shape (p, 3), and a radius so that balls around them span a shape."""
    if isinstance(solid, coal.Capsule):
        ends = np.array([[0.0, 0.0, -solid.halfLength], [0.0, 0.0, solid.halfLength]])
        return ends, float(solid.radius)
    if isinstance(solid, coal.Sphere):
        return np.zeros((1, 3)), float(solid.radius)
    solid.computeLocalAABB()
    corners = product(*zip(solid.aabb_local.min_, solid.aabb_local.max_, strict=True))
    return np.array(list(corners)), 0.0
