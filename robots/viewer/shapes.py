"""Shapes that Meshcat's page can draw but that its Python side has no class for.

The page is three.js; these lower to the JSON of its own geometries, so that one short message
carries a whole capsule or cable.
"""

from typing import Any

import numpy as np
from meshcat.geometry import Box as BoxGeometry
from meshcat.geometry import Geometry
from scipy.spatial.transform import Rotation

from robots.descriptions.model import Box, Shape
from robots.interfaces import Floats

TUBE_SIDES = 8
_CAP_ARCS = 8
_LATHE_SEGMENTS = 24


class Lathe(Geometry):
    """A profile turned about the y axis (three.js LatheGeometry)."""

    def __init__(self, profile_m: Floats) -> None:
        """Take the profile: distance from the axis and height [m], shape (N, 2)."""
        super().__init__()
        self._profile_m = profile_m

    def lower(self, object_data: dict[str, Any]) -> dict[str, Any]:  # noqa: ARG002 - Meshcat's
        """Return the JSON of the geometry."""
        points = [{"x": float(x), "y": float(y)} for x, y in self._profile_m]
        return {
            "uuid": self.uuid,
            "type": "LatheGeometry",
            "points": points,
            "segments": _LATHE_SEGMENTS,
        }


class Tube(Geometry):
    """A round tube along a smooth curve through points (three.js TubeGeometry)."""

    def __init__(self, points_m: Floats, radius_m: float) -> None:
        """Take the centre line [m], shape (N, 3), and the radius [m]."""
        super().__init__()
        self._points_m, self._radius_m = points_m, radius_m

    def lower(self, object_data: dict[str, Any]) -> dict[str, Any]:  # noqa: ARG002 - Meshcat's
        """Return the JSON of the geometry, rounded to a hundredth of a millimetre."""
        path = {
            "type": "CatmullRomCurve3",
            "arcLengthDivisions": 2 * len(self._points_m),
            "points": np.round(self._points_m, 5).tolist(),
            "closed": False,
            "curveType": "catmullrom",
            "tension": 0.5,
        }
        return {
            "uuid": self.uuid,
            "type": "TubeGeometry",
            "path": path,
            "tubularSegments": 2 * len(self._points_m),
            "radius": self._radius_m,
            "radialSegments": TUBE_SIDES,
            "closed": False,
        }


def capsule_profile(length_m: float, radius_m: float) -> Floats:
    """Return the outline of a capsule along y, from pole to pole, shape (N, 2) [m]."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 2 * _CAP_ARCS)
    shift_m = np.where(angles < 0.0, -length_m / 2, length_m / 2)
    return np.column_stack([radius_m * np.cos(angles), radius_m * np.sin(angles) + shift_m])


def drawn(shape: Shape) -> tuple[Geometry, Floats]:
    """Return a link's shape as geometry, and where it sits in the link's frame, shape (4, 4)."""
    T_link_shape = np.eye(4)
    if isinstance(shape, Box):
        low_m, high_m = np.asarray(shape.low_m), np.asarray(shape.high_m)
        T_link_shape[:3, 3] = (low_m + high_m) / 2
        return BoxGeometry((high_m - low_m).tolist()), T_link_shape
    start_m, end_m = np.asarray(shape.start_m), np.asarray(shape.end_m)
    T_link_shape[:3, 3] = (start_m + end_m) / 2
    T_link_shape[:3, :3] = _y_along(end_m - start_m)
    profile_m = capsule_profile(float(np.linalg.norm(end_m - start_m)), shape.radius_m)
    return Lathe(profile_m), T_link_shape


def _y_along(direction: Floats) -> Floats:
    """Return a rotation that takes the y axis to a direction, shape (3, 3)."""
    if not direction.any():
        return np.eye(3)
    rotation, _ = Rotation.align_vectors([direction], [[0.0, 1.0, 0.0]])
    matrix: Floats = rotation.as_matrix()
    return matrix
