"""Tell cables apart: which pixel shows which of several alike cables."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.cable.classifiers.edges import EdgeClassifier
from perception.cable.mask import CableMask
from perception.cable.observation import observe
from perception.cable.polyline import arc_lengths, pixels_of, point_at
from perception.cable.tracers.skeleton import SkeletonTracer
from perception.cable.types import Crossing, Points, Trace
from perception.camera import GreyImage

Labels = NDArray[np.uint8]

# A strand that lies on top is painted so many cable widths to either side of a crossing.
ON_TOP_WIDTHS = 1.6
# Strokes are this much wider than cables, so that no pixel of the mask is left out.
BROADER = 1.2
_SHIFT = 4


def separate(image: GreyImage) -> tuple[tuple[Trace, ...], Labels]:
    """Return the cables of an image and which pixels show them.

    Returns:
        One trace a cable, longest first, and 0 for the table or k for cable k - 1 at every
        pixel, shape (height, width). Where two cables cross, the upper one is shown.
    """
    observation = observe(image)
    if observation is None:
        return (), np.zeros(image.shape, np.uint8)
    traces = SkeletonTracer().strands_observed(observation)
    crossings = EdgeClassifier().classify(image, traces)
    return traces, paint(observation.mask, traces, crossings)


def paint(mask: CableMask, traces: Sequence[Trace], crossings: Sequence[Crossing]) -> Labels:
    """Return which pixels show which trace, 1 for the first, 0 for none."""
    labels = np.zeros(mask.cable.shape, np.uint8)
    for number, trace in enumerate(traces, start=1):
        _stroke(labels, mask, trace.points_px, number)
    for crossing in crossings:
        if crossing.trace_over != crossing.trace_under:
            points = traces[crossing.trace_over].points_px
            arcs = arc_lengths(points)
            at_px = crossing.arc_over * arcs[-1]
            reach_px = ON_TOP_WIDTHS * mask.width_px
            piece = point_at(points, arcs, np.linspace(at_px - reach_px, at_px + reach_px, 24))
            _stroke(labels, mask, piece, crossing.trace_over + 1)
    return labels * mask.cable.astype(np.uint8)


def _stroke(labels: Labels, mask: CableMask, points_px: Points, number: int) -> None:
    """Paint a line as wide as the mask is along it, in place."""
    radii = mask.radius_px[pixels_of(points_px, labels.shape)]
    width_px = 2.0 * float(np.median(radii[radii > 0.0])) if (radii > 0.0).any() else mask.width_px
    fixed = np.round(points_px * (1 << _SHIFT)).astype(np.int32)[:, None]
    thickness = max(round(BROADER * width_px), 1)
    cv2.polylines(labels, [fixed], False, number, thickness, cv2.LINE_8, _SHIFT)
