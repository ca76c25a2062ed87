"""Stretches where a trace lies upon itself: there nobody can count crossings from above."""

import numpy as np
from scipy.spatial import cKDTree

from perception.cable.polyline import arc_lengths, resample
from perception.cable.types import Points

# Centre lines nearer than this lie upon each other; side by side they are a cable width apart.
OVERLAP_PX = 5.0
# Parts of the trace that are nearer than this along it are the same piece.
OWN_PIECE_PX = 45.0
# A crossing at 15 degrees overlaps over 40 px; what overlaps much longer may hide others.
STRETCH_PX = (40.0, 60.0)


def longest_overlap_px(path_px: Points) -> float:
    """Return the length of the longest stretch over which a path lies upon itself [px].

    Args:
        path_px: Centre line, shape (N, 2).
    """
    line = resample(path_px)
    arcs = arc_lengths(line)
    near = cKDTree(line).query_ball_point(line, OVERLAP_PX)
    upon = [
        bool((np.abs(arcs[others] - arcs[number]) > OWN_PIECE_PX).any())
        for number, others in enumerate(near)
    ]
    edges = np.flatnonzero(np.diff(np.r_[0, upon, 0]))
    lengths = arcs[edges[1::2] - 1] - arcs[edges[::2]]
    return float(lengths.max(initial=0.0))


def separateness(path_px: Points) -> float:
    """Return the belief that all crossings of a path can be told apart, in [0, 1]."""
    short, long = STRETCH_PX
    return float(np.clip((long - longest_overlap_px(path_px)) / (long - short), 0.0, 1.0))
