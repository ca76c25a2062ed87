"""Crossings that share a place: where three strands meet, each hides the edges of the others."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from perception.cable.types import Crossing

# Crossings nearer than about half a cable's width share all of their pixels.
SHARED_PX = 4.0
# What over and under can be told by there is seen in pieces at best.
MOST_BELIEF = 0.75


def doubt_shared(
    crossings: Sequence[Crossing], within_px: float = SHARED_PX
) -> tuple[Crossing, ...]:
    """Return crossings, those that share a place with another one believed less.

    Args:
        crossings: The crossings.
        within_px: How near another one has to be. Networks have learned to look past a third
            strand, so only those that lie on each other need it.
    """
    places = np.array([crossing.position_px for crossing in crossings]).reshape(-1, 2)
    gaps = np.linalg.norm(places[:, None] - places[None], axis=2)
    np.fill_diagonal(gaps, np.inf)
    shared = gaps.min(axis=1, initial=np.inf) < within_px
    return tuple(
        replace(crossing, probability=min(crossing.probability, MOST_BELIEF)) if doubt else crossing
        for crossing, doubt in zip(crossings, shared, strict=True)
    )
