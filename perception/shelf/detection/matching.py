"""Which segments of one image are which of another, by what they cover."""

import numpy as np

from perception.shelf.types import NOTHING, Floats, Segments

# From half of its pixels on, a segment can be matched by one other alone.
HALF = 0.5


def overlaps(truth: Segments, found: Segments) -> Floats:
    """Return intersection over union of all pairs, shape (objects in truth, objects found)."""
    rows, columns = int(truth.max()) + 1, int(found.max()) + 1
    both = np.zeros((rows + 1, columns + 1))
    # What is nothing counts in the last row and column.
    np.add.at(both, (truth.ravel(), found.ravel()), 1.0)
    areas_truth, areas_found = both.sum(axis=1, keepdims=True), both.sum(axis=0, keepdims=True)
    union = areas_truth + areas_found - both
    shared: Floats = (both / np.maximum(union, 1.0))[:rows, :columns]
    return shared


def matched(truth: Segments, found: Segments) -> dict[int, int]:
    """Return which segment is found for each true one, where most of both is shared."""
    assert NOTHING == -1, "np.add.at relies on it"
    shared = overlaps(truth, found)
    if not shared.size:
        return {}
    best = shared.argmax(axis=1)
    return {row: int(best[row]) for row in range(len(best)) if shared[row, best[row]] > HALF}
