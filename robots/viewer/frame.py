"""One moment of a scene, as viewers take it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from robots.interfaces import Floats
from robots.viewer.overlays import Overlay


@dataclass(frozen=True, slots=True, eq=False)
class CameraCone:
    """What an overhead camera sees.

    Attributes:
        position_m: The camera in the world [m], shape (3,).
        corners_m: Where the corners of its image meet the table, in order, shape (4, 3) [m].
    """

    position_m: Floats
    corners_m: Floats


@dataclass(frozen=True, slots=True)
class ShownBox:
    """A box that moves, as it is drawn.

    Attributes:
        size_m: Whole edge lengths.
        colour: Red, green and blue, 0 to 255.
    """

    size_m: tuple[float, float, float]
    colour: tuple[int, int, int]


@dataclass(frozen=True, slots=True, eq=False)
class SceneFrame:
    """Where everything that moves is at one moment, in the world frame.

    Attributes:
        time_s: On the cell's clock [s].
        link_poses: Pose of each link's URDF frame by the link's name, shape (7,): position [m],
            then quaternion xyzw; of each box its middle. What is left out stays where it was.
        cable_m: Centre line of the cable in order, shape (N, 3), N >= 2 [m]; None without one.
            Of several it is the first.
        cable_radius_m: Radius of the cable [m].
        trace_m: What perception last took for the cable, shape (M, 3), M >= 2 [m]; None before
            the first look.
        camera: The overhead camera; None before the first look.
        caption: One line on what goes on, e.g. the running node and its belief.
        boxes: Boxes that move, by names that no link has; the same in every frame.
        more_cables_m: Centre lines of the other cables, as many in every frame.
        overlays: What is laid over the scene, by name. One that is the same object as in the
            frame before has not changed.
    """

    time_s: float
    link_poses: Mapping[str, Floats]
    cable_m: Floats | None = None
    cable_radius_m: float = 0.0
    trace_m: Floats | None = None
    camera: CameraCone | None = None
    caption: str = ""
    boxes: Mapping[str, ShownBox] = field(default_factory=dict)
    more_cables_m: tuple[Floats, ...] = ()
    overlays: Mapping[str, Overlay] = field(default_factory=dict)

    @property
    def cables_m(self) -> tuple[Floats, ...]:
        """Centre lines of all cables."""
        return () if self.cable_m is None else (self.cable_m, *self.more_cables_m)


def thinned(points: Floats, count: int) -> Floats:
    """Return at most `count` of the points, first and last among them, evenly spread."""
    if len(points) <= count:
        return points
    return points[np.linspace(0, len(points) - 1, count).round().astype(int)]


def overlay_changes(
    before: Mapping[str, Overlay], now: Mapping[str, Overlay]
) -> Iterator[tuple[str, Overlay | None]]:
    """Yield the overlays that are others than before, by name; None for one that has gone."""
    for name in sorted(now.keys() | before.keys()):
        overlay = now.get(name)
        if overlay is not before.get(name):
            yield name, overlay
