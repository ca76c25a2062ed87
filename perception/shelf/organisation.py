"""How well ordered a shelf is, estimated from what is seen of it.

The thesis leaves this to the future (section 8.2): semantics mislead where nothing is in order.
Each object's nearest seen neighbour is either one that its affinities prefer, or any; the share of
the former is the degree of organisation. Its posterior on a grid, from an even prior, gives the
mean.
"""

from collections.abc import Mapping

import numpy as np

from perception.shelf.affinity import AffinityMatrix
from perception.shelf.types import Box

GRID = 41


def organisation_of(boxes: Mapping[str, Box], affinity: AffinityMatrix) -> float:
    """Return the posterior mean of the degree of organisation, in (0, 1).

    Args:
        boxes: Objects where they were first seen.
        affinity: Affinities; names that they do not know are left out.

    Returns:
        A half, the prior's mean, while fewer than three known objects are seen.
    """
    names = [name for name in boxes if name in affinity.names]
    if len(names) < 3:
        return 0.5
    pick = [affinity.index(name) for name in names]
    centres_m = np.array([(boxes[name].x_m, boxes[name].y_m) for name in names])
    apart = ((centres_m[:, None] - centres_m[None]) ** 2).sum(axis=2)
    np.fill_diagonal(apart, np.inf)
    rows = affinity.rows[np.ix_(pick, pick)]
    rows = rows / rows.sum(axis=1, keepdims=True)
    preferred = rows[np.arange(len(names)), apart.argmin(axis=1)]
    shares = (np.arange(GRID) + 0.5) / GRID
    by_chance = 1.0 / (len(names) - 1)
    logs = np.log(shares[:, None] * preferred + (1.0 - shares[:, None]) * by_chance).sum(axis=1)
    weights = np.exp(logs - logs.max())
    return float((shares * weights).sum() / weights.sum())
