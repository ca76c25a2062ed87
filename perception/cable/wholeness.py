"""Whether a trace can be the whole cable: nothing of it may be left over."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.cable.coverage import coverage_of
from perception.cable.observation import Observation
from perception.cable.polyline import pixels_of
from perception.cable.types import Points

# A trace that explains less than the first share is not the whole cable, from the second on it
# may be: pixels in the shade of a bundle are not always near its centre lines.
SHARES = (0.86, 0.94)
# A piece of cable beside a trace, farther from it than this share of a width, is left out; one of
# the first size [squared widths] is a shadow or a wide crossing, one of the second is a hook that
# the trace has cut short. On 11 looks at untied cables the largest was 0.4, on two looks at cables
# that a cut hook made look untied 0.5 and 1.4.
BESIDE_WIDTHS = 0.75
HOOK_WIDTHS2 = (0.45, 0.9)
# Connectors are wide; what is that near to an end belongs to one.
CONNECTOR_PX = 45.0


def wholeness(observation: Observation, path_px: Points) -> float:
    """Return the belief that a trace leaves none of its cable out, in [0, 1].

    Connectors count as explained. As long as no more than two are in view, all that is seen is
    one cable; else only what hangs together with the trace is known to be the same.

    Args:
        observation: What is seen.
        path_px: Centre line of the trace, shape (N, 2).
    """
    graph, cable = observation.graph, observation.mask.cable
    plugs = [graph.edges[number].points_px for number in sorted(graph.plugs)]
    if len(plugs) not in (1, 2):
        cable = pieces_along(cable, path_px)
    low, high = SHARES
    share = coverage_of(cable, np.concatenate([path_px, *plugs])).share
    explained = float(np.clip((share - low) / (high - low), 0.0, 1.0))
    return explained * _no_hook(cable, path_px, plugs, observation.mask.width_px)


def _no_hook(
    cable: NDArray[np.bool_], path_px: Points, plugs: Sequence[Points], width_px: float
) -> float:
    """Return the belief that no piece of cable beside a trace was cut short."""
    spots = left_beside(cable, [path_px], plugs, width_px).astype(np.uint8)
    sizes = cv2.connectedComponentsWithStats(spots, connectivity=8)[2][1:, cv2.CC_STAT_AREA]
    largest = float(sizes.max(initial=0)) / width_px**2
    small, large = HOOK_WIDTHS2
    return float(np.clip((large - largest) / (large - small), 0.0, 1.0))


def left_beside(
    cable: NDArray[np.bool_], paths_px: Sequence[Points], plugs: Sequence[Points], width_px: float
) -> NDArray[np.bool_]:
    """Return the pixels of cable beside all paths, but for those at ends and at connectors.

    Args:
        cable: Which pixels show cable, shape (height, width).
        paths_px: Centre lines of traces.
        plugs: Centre lines of connectors.
        width_px: Width of the cables.
    """
    aside = np.ones(cable.shape, np.uint8)
    lines = [np.rint(path_px).astype(np.int32) for path_px in paths_px]
    cv2.polylines(aside, lines, isClosed=False, color=(0,))
    left = cable & (cv2.distanceTransform(aside, cv2.DIST_L2, 5) > BESIDE_WIDTHS * width_px)
    spots = left.astype(np.uint8)
    for end in np.concatenate([*(path_px[[0, -1]] for path_px in paths_px), *plugs]):
        centre = (round(float(end[0])), round(float(end[1])))
        cv2.circle(spots, centre, round(CONNECTOR_PX), (0,), thickness=-1)
    return spots.astype(bool)


def pieces_along(cable: NDArray[np.bool_], path_px: Points) -> NDArray[np.bool_]:
    """Return the connected pieces of the mask that a path runs over."""
    labels = np.asarray(cv2.connectedComponents(cable.astype(np.uint8))[1])
    return np.isin(labels, np.unique(labels[pixels_of(path_px, cable.shape)])) & cable
