"""What traces leave over: a large piece of cable that none explains makes them doubtful."""

from collections.abc import Sequence
from dataclasses import replace

import cv2
import numpy as np

from perception.cable.observation import Observation
from perception.cable.types import Trace
from perception.cable.wholeness import left_beside, pieces_along

# A trace that leaves over a piece of the first size [squared widths] may be right, with one of the
# second size it is believed so many times less. Chosen on 147 traces believed in more than half, of
# scenes as `benchmarks.knot_scenes` draws them with seed 4242: 98 % of the 137 right ones left
# less than the second size, counting all that hangs together, and 6 of the 10 wrong ones more.
LEFT_WIDTHS2 = (2.0, 5.0)
STILL_BELIEVED = 0.4
# Ways of less belief are as good as none.
LEAST_BELIEF = 0.02
# A piece so near to the border may be another cable that goes through the view.
BORDER_PX = 3


def doubt_left_over(
    observation: Observation, cables: Sequence[tuple[Trace, ...]]
) -> list[tuple[Trace, ...]]:
    """Return the ways to trace each cable, those that leave much over believed less.

    Args:
        observation: What is seen.
        cables: For each cable the ways to trace it, the likeliest first.
    """
    doubted = []
    for number, ways in enumerate(cables):
        others = [other[0] for k, other in enumerate(cables) if k != number]
        told = [
            replace(way, probability=way.probability * _share(observation, way, others))
            if way.probability >= LEAST_BELIEF
            else way
            for way in ways
        ]
        doubted.append(tuple(sorted(told, key=lambda way: -way.probability)))
    return doubted


def _share(observation: Observation, way: Trace, others: Sequence[Trace]) -> float:
    """Return how much of the belief in a way to trace a cable stays."""
    small, large = LEFT_WIDTHS2
    much = (largest_left(observation, way, others) - small) / (large - small)
    return 1.0 - (1.0 - STILL_BELIEVED) * float(np.clip(much, 0.0, 1.0))


def largest_left(observation: Observation, way: Trace, others: Sequence[Trace]) -> float:
    """Return the size of the largest piece that hangs together with a trace and none explains.

    Args:
        observation: What is seen.
        way: The trace.
        others: Traces of other cables.

    Returns:
        Its area [squared cable widths].
    """
    graph, mask = observation.graph, observation.mask
    plugs = [graph.edges[number].points_px for number in sorted(graph.plugs)]
    cable = pieces_along(mask.cable, way.points_px)
    lines = [way.points_px, *(other.points_px for other in others)]
    spots = left_beside(cable, lines, plugs, mask.width_px).astype(np.uint8)
    _, labels, stats, _ = cv2.connectedComponentsWithStats(spots, connectivity=8)
    sizes = stats[:, cv2.CC_STAT_AREA].copy()
    inner = np.zeros(spots.shape, dtype=bool)
    inner[BORDER_PX:-BORDER_PX, BORDER_PX:-BORDER_PX] = True
    # The first label is all that is not left.
    sizes[np.unique(np.append(labels[~inner], 0))] = 0
    return float(sizes.max()) / mask.width_px**2
