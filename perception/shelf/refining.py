"""Names by company: what stands beside an object tells what it is (thesis, section 6.2)."""

import numpy as np

from perception.shelf.affinity import AffinityMatrix
from perception.shelf.detections import Detections, entropy_bits
from perception.shelf.types import Floats

# Neighbours count less by exp(-distance / REACH).
REACH_SHARE = 0.1
# Objects that are surer than this speak for others and are not spoken for.
SURE_BITS = 0.5


def refined(detections: Detections, affinity: AffinityMatrix) -> Detections:
    """Multiply what objects may be by what their sure neighbours would have beside them.

    P'(i) is proportional to P(i) * sum_j d_j M[j, i] / sum_j d_j over the sure neighbours j, with
    d_j = exp(-a * distance in the image). The surest of the unsure go first, and then speak too.

    Args:
        detections: What was read; names that the affinities do not know stay as they are.
        affinity: Affinities.
    """
    rows = detections.probabilities.copy()
    columns = [affinity.names.index(name) if name in affinity.names else -1
               for name in detections.names]  # fmt: skip
    known = np.array(columns) >= 0
    if detections.count < 2 or not known.any():
        return detections
    matrix = affinity.rows[np.ix_(np.array(columns)[known], np.array(columns)[known])]
    centres_px = _centres_px(detections)
    reach_px = REACH_SHARE * detections.segments.shape[1]
    bits = entropy_bits(rows)
    sure = bits < SURE_BITS
    for number in np.argsort(bits, kind="stable").tolist():
        if not sure[number] and sure.any():
            apart_px = np.linalg.norm(centres_px[sure] - centres_px[number], axis=1)
            near = np.exp(-apart_px / reach_px)
            company = near @ (rows[sure][:, known] @ matrix) / max(float(near.sum()), 1e-12)
            rows[number, known] = _reweighted(rows[number, known], company)
        sure[number] = sure[number] or entropy_bits(rows[number][None])[0] < SURE_BITS
    return Detections(detections.segments, detections.names, rows)


def _reweighted(row: Floats, company: Floats) -> Floats:
    """Return a row times its company, with the sum that it had."""
    product = row * company
    if product.sum() <= 0.0:
        return row
    weighted: Floats = product * (row.sum() / product.sum())
    return weighted


def _centres_px(detections: Detections) -> Floats:
    """Return the centre of each object in the image, shape (K, 2)."""
    centres = [
        [axis.mean() for axis in np.nonzero(detections.segments == number)]
        for number in range(detections.count)
    ]
    return np.array(centres, dtype=np.float64)
