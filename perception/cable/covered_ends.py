"""Ends whose connector is crossed: a trace stops where a connector begins, the cable does not."""

import numpy as np
from scipy.spatial import cKDTree

from perception.cable.tracers.centre_line import arc_lengths, resample
from perception.cable.types import Points

# From where the cable's own width ends to the tip of a connector.
CONNECTOR_PX = 40.0
# A strand whose centre line comes nearer than this to a connector's axis lies across it.
ACROSS_PX = 7.0
# The piece that leads to an end gives its direction, and does not cross it.
LEAD_PX = 15.0


def ends_are_clear(path_px: Points) -> bool:
    """Return whether no strand of a path crosses a connector at one of its ends.

    Such a crossing is one of the cable's, and does not show in the trace.

    Args:
        path_px: Centre line from end to end, shape (N, 2).
    """
    line = resample(path_px)
    arcs = arc_lengths(line)
    if arcs[-1] <= 2.0 * (CONNECTOR_PX + LEAD_PX):
        return True
    return _end_is_clear(line, arcs) and _end_is_clear(line[::-1], arcs[-1] - arcs[::-1])


def _end_is_clear(line: Points, arcs: Points) -> bool:
    """Look at the end that a line begins with; `arcs` is how far each point is from there."""
    lead = line[int(np.searchsorted(arcs, LEAD_PX))]
    outwards = (line[0] - lead) / np.linalg.norm(line[0] - lead)
    steps = np.arange(0.0, CONNECTOR_PX, 2.0)[:, None]
    others = line[arcs > CONNECTOR_PX + LEAD_PX]
    gaps, _ = cKDTree(others).query(line[0] + steps * outwards)
    return bool(gaps.min() > ACROSS_PX)
