"""Stretches on which a cable lies alone: there no network need tell where it goes on.

Pieces of the mask's centre line between two junctions, as thin as one strand and with no other
strand beside them, are gone along at once. What is near their ends is left to the network.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from perception.cable.graph import Edge, usual_radius
from perception.cable.observation import Observation
from perception.cable.polyline import arc_lengths, point_at, resample
from perception.cable.tracers.centre_line import smooth, tangents
from perception.cable.types import Points
from perception.models.frames import Floats, ScaledImage
from perception.models.tracer_crop import STEP, WIDTH

# Of a lonely piece so much is left out at both ends, and so much must be left [widths].
MARGIN_WIDTHS, LEAST_WIDTHS = 5.0, 4.0
# Where it is thicker than a usual strand by this factor, two strands may lie side by side.
THICK = 1.35
# Another strand nearer than this is beside it; what is nearer along it is the same [widths].
BESIDE_WIDTHS, OWN_WIDTHS = 1.8, 6.0
# Pixels of a skeleton are smoothed over this much [widths].
SMOOTHING_WIDTHS = 0.8
# A path is on a stretch where its last points are this near, and it runs along it.
NEAR, ALONG = 0.35 * WIDTH, 0.9
FINE = 0.25 * STEP


def stretches_px(observation: Observation) -> tuple[Points, ...]:
    """Return the stretches of what is seen, shape (N, 2) each, in pixels of the image."""
    graph, width_px = observation.graph, observation.mask.width_px
    lines = [resample(edge.points_px) for edge in graph.edges]
    arcs = [arc_lengths(line) for line in lines]
    tree = cKDTree(np.vstack(lines))
    thick_px, own_px = THICK * usual_radius(graph), OWN_WIDTHS * width_px
    # Places along all lines at once; lines are farther apart than a piece of one is long.
    first = np.cumsum([0.0, *(each[-1] + 2.0 * own_px for each in arcs)])
    along = np.concatenate([start + each for start, each in zip(first, arcs, strict=False)])
    found: list[Points] = []
    for number, edge in enumerate(graph.edges):
        if (
            number in graph.plugs
            or edge.length_px < (2.0 * MARGIN_WIDTHS + LEAST_WIDTHS) * width_px
        ):
            continue
        near = tree.query_ball_point(lines[number], BESIDE_WIDTHS * width_px)
        here = first[number] + arcs[number]
        alone = np.array(
            [bool((np.abs(along[k] - at) < own_px).all()) for k, at in zip(near, here, strict=True)]
        )
        alone &= _radii(edge, lines[number]) <= thick_px
        found += _pieces(smooth(edge.points_px, SMOOTHING_WIDTHS * width_px), alone, width_px)
    return tuple(found)


def _radii(edge: Edge, line: Points) -> Points:
    """Return the radius of the mask at points that lie evenly along an edge."""
    arcs = arc_lengths(edge.points_px)
    radii: Points = np.interp(np.linspace(0.0, arcs[-1], len(line)), arcs, edge.radius_px)
    return radii


def _pieces(line: Points, alone: NDArray[np.bool_], width_px: float) -> list[Points]:
    """Return the pieces of a line that are alone, without their margins."""
    arcs = arc_lengths(line)
    bounds = np.flatnonzero(np.diff(np.concatenate([[False], alone, [False]]).astype(int)))
    spacing_px, margin_px = arcs[-1] / max(len(alone) - 1, 1), MARGIN_WIDTHS * width_px
    pieces = []
    for begin, stop in zip(bounds[::2], bounds[1::2], strict=True):
        low, high = begin * spacing_px + margin_px, (stop - 1) * spacing_px - margin_px
        if high - low >= LEAST_WIDTHS * width_px:
            pieces.append(point_at(line, arcs, np.arange(low, high, 2.0)))
    return pieces


class Stretches:
    """Stretches in a scaled image, to be gone along.

    Args:
        lines_px: In pixels of the original image, shape (N, 2) each.
        scaled: The scaled image.
    """

    def __init__(self, lines_px: Sequence[Points], scaled: ScaledImage) -> None:
        lines = [resample(scaled.into(line), FINE) for line in lines_px]
        self._lines, self._arcs = lines, [arc_lengths(line) for line in lines]
        self._first = np.cumsum([0, *(len(line) for line in lines)])
        self._tree = cKDTree(np.vstack([np.empty((0, 2)), *lines]))
        self._ways = np.vstack([np.empty((0, 2)), *(tangents(line, 2) for line in lines)])

    def ahead(self, points: Floats) -> Floats:
        """Return the points that a path surely goes on by, one step apart.

        Args:
            points: Of the path, shape (N, 2), N >= 2.

        Returns:
            Points up to the end of the stretch that its last points are on, shape (K, 2); none
            where they are on none.
        """
        none = np.empty((0, 2))
        gaps, places = self._tree.query(points[-2:], distance_upper_bound=NEAR)
        if not np.isfinite(gaps).all():
            return none
        number = int(np.searchsorted(self._first, places[1], "right")) - 1
        if not self._first[number] <= places[0] < self._first[number + 1]:
            return none
        step = points[-1] - points[-2]
        along = float(self._ways[places[1]] @ step) / max(float(np.linalg.norm(step)), 1e-9)
        if abs(along) < ALONG:
            return none
        return self._walked(number, int(places[1] - self._first[number]), along > 0.0)

    def _walked(self, number: int, place: int, forwards: bool) -> Floats:
        line, arcs = self._lines[number], self._arcs[number]
        if forwards:
            return point_at(line, arcs, np.arange(arcs[place] + STEP, arcs[-1], STEP))
        return point_at(line, arcs, np.arange(arcs[place] - STEP, 0.0, -STEP))
