"""What is laid over a scene: lines, dots and pictures; what each of them means is the caller's."""

from dataclasses import dataclass

import numpy as np
from meshcat.commands import Delete, SetObject
from meshcat.geometry import (
    Box,
    ImageTexture,
    LineBasicMaterial,
    LineSegments,
    MeshBasicMaterial,
    PngImage,
    PointCloud,
    PointsGeometry,
)
from meshcat.path import Path

from robots.interfaces import Floats

_AXES = np.eye(3)
_THICK_M = 0.002


@dataclass(frozen=True, slots=True, eq=False)
class Lines:
    """Straight lines, a colour each.

    Attributes:
        segments_m: Both ends of each in the world [m], shape (n, 2, 3).
        colours: Red, green and blue in [0, 1], shape (n, 3).
    """

    segments_m: Floats
    colours: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Dots:
    """Dots, a colour each.

    Attributes:
        points_m: In the world [m], shape (n, 3).
        colours: Red, green and blue in [0, 1], shape (n, 3).
        size_m: Of a dot.
    """

    points_m: Floats
    colours: Floats
    size_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Screen:
    """A picture that stands in the scene.

    Attributes:
        png: The picture as a PNG file.
        T_world_screen: Of its middle, shape (4, 4); x to its right, y up, z to who looks at it.
        width_m: How wide it stands there.
        height_m: How high.
    """

    png: bytes
    T_world_screen: Floats
    width_m: float
    height_m: float


Overlay = Lines | Dots | Screen


def path_lines(points_m: Floats, colour: tuple[float, float, float]) -> Lines:
    """Return a line through points, shape (N, 3)."""
    segments_m = np.stack([points_m[:-1], points_m[1:]], axis=1)
    return Lines(segments_m, np.tile(colour, (len(segments_m), 1)))


def axes_lines(position_m: Floats, axes: Floats, length_m: float) -> Lines:
    """Return a frame's axes, the columns of `axes`, in red, green and blue."""
    ends_m = position_m + length_m * axes.T
    return Lines(np.stack([np.tile(position_m, (3, 1)), ends_m], axis=1), _AXES)


def joined(*parts: Lines) -> Lines:
    """Return all lines as one overlay."""
    return Lines(
        np.concatenate([part.segments_m for part in parts]),
        np.concatenate([part.colours for part in parts]),
    )


def facing(position_m: Floats, eye_m: Floats) -> Floats:
    """Return the pose of an upright screen that faces an eye, T_world_screen."""
    out = np.array([*(eye_m - position_m)[:2], 0.0])
    out /= np.linalg.norm(out)
    T = np.eye(4)
    T[:3, :3] = np.column_stack([np.cross((0.0, 0.0, 1.0), out), (0.0, 0.0, 1.0), out])
    T[:3, 3] = position_m
    return T


def draw_overlay(name: str, overlay: Overlay | None) -> SetObject | Delete:
    """Return the command that draws an overlay in place of what had its name, or takes it away."""
    path = Path(("overlays", name))
    match overlay:
        case Lines(segments_m, colours):
            ends = np.repeat(colours, 2, axis=0).astype(np.float32)
            points = segments_m.reshape(-1, 3).astype(np.float32)
            geometry = PointsGeometry(points.T, ends.T)
            material = LineBasicMaterial(vertexColors=True)
            return SetObject(LineSegments(geometry, material), None, path)
        case Dots(points_m, colours, size_m):
            points, shades = (part.astype(np.float32).T for part in (points_m, colours))
            return SetObject(PointCloud(points, shades, size=size_m), None, path)
        case Screen(png, T_world_screen, width_m, height_m):
            material = MeshBasicMaterial(map=ImageTexture(PngImage(png)))
            board = _Board([width_m, height_m, _THICK_M], T_world_screen)
            return SetObject(board, material, path)
        case None:
            return Delete(path)


class _Board(Box):
    """A box with a pose of its own, so that one command draws it where it stands."""

    def __init__(self, lengths_m: list[float], T_world: Floats) -> None:
        super().__init__(lengths_m)
        self._T_world = T_world

    def intrinsic_transform(self) -> Floats:
        """Return its pose as Meshcat flattens it: columns first."""
        return np.asarray(self._T_world.T)
