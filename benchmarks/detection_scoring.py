"""Scores of detections of products: mean average precision and top-k (thesis, Table 7.2)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from perception.shelf.detection.matching import matched, overlaps
from perception.shelf.types import NOTHING, Bools, Floats, Segments

IOUS = np.linspace(0.5, 0.95, 10)
# A detection is one of every name that it has with at least this probability.
LEAST_SCORE = 0.01
RECALLS = np.linspace(0.0, 1.0, 101)


@dataclass(frozen=True, slots=True, eq=False)
class Truth:
    """What stands in one image.

    Attributes:
        segments: Which object each pixel shows, by number, or `NOTHING`.
        labels: Number of each object's name, shape (T,); -1 for none of the names.
        counted: Which objects are shown enough to be asked for, shape (T,).
    """

    segments: Segments
    labels: NDArray[np.int64]
    counted: Bools


@dataclass(frozen=True, slots=True, eq=False)
class Claims:
    """All claims about one image: an object, a name, how sure, and how well it lies.

    Attributes:
        names: Shape (C,).
        scores: Shape (C,).
        hits: Whether it is right at each overlap asked for, shape (C, 10).
        asked: Numbers of the names that are there to be found.
    """

    names: NDArray[np.int64]
    scores: Floats
    hits: Bools
    asked: NDArray[np.int64]


def claims(truth: Truth, found: Segments, chances: Floats) -> Claims:
    """Judge all claims about an image.

    Args:
        truth: What stands there.
        found: Which detected object each pixel shows.
        chances: P(name) of each detected object, shape (K, N).
    """
    shared = _box_overlaps(truth.segments, found, len(truth.labels), len(chances))
    # What lies on an object that is hardly shown is neither right nor wrong.
    on = overlaps(truth.segments, found)
    idle = np.zeros(len(chances), dtype=bool)
    for column in range(on.shape[1]):
        best = int(on[:, column].argmax()) if len(on) else 0
        idle[column] = bool(len(on) and on[best, column] > 0.0 and not truth.counted[best])
    objects, names = np.nonzero((chances >= LEAST_SCORE) & ~idle[:, None])
    scores = chances[objects, names]
    order = np.argsort(-scores, kind="stable")
    objects, names, scores = objects[order], names[order], scores[order]
    where = {int(label): row for row, label in enumerate(truth.labels) if truth.counted[row]}
    hits = np.zeros((len(scores), len(IOUS)), dtype=bool)
    taken = np.zeros((chances.shape[1], len(IOUS)), dtype=bool)
    for claim, (thing, name) in enumerate(zip(objects.tolist(), names.tolist(), strict=True)):
        if name in where:
            hits[claim] = (shared[where[name], thing] >= IOUS) & ~taken[name]
            taken[name] |= hits[claim]
    asked = truth.labels[truth.counted & (truth.labels >= 0)]
    return Claims(names, scores, hits, asked)


def mean_average_precision(images: Sequence[Claims]) -> float:
    """Return mAP over overlaps of 0.50 to 0.95, in [0, 1].

    Precision is interpolated at 101 recalls; names that are never there do not count.
    """
    names = np.concatenate([image.names for image in images])
    scores = np.concatenate([image.scores for image in images])
    hits = np.concatenate([image.hits for image in images])
    asked = np.concatenate([image.asked for image in images])
    values = [
        _average_precision(scores[names == name], hits[names == name], int((asked == name).sum()))
        for name in np.unique(asked).tolist()
    ]
    return float(np.mean(values))


def ranks(truth: Truth, found: Segments, chances: Floats) -> NDArray[np.int64]:
    """Return at which rank each counted object of a name has it, from 1; 0 where it is not found.

    Args:
        truth: What stands there.
        found: Which detected object each pixel shows.
        chances: P(name) of each detected object, shape (K, N).
    """
    pairs = matched(truth.segments, found)
    picked = np.flatnonzero(truth.counted & (truth.labels >= 0))
    rows = []
    for number in picked.tolist():
        if number not in pairs:
            rows.append(0)
            continue
        row = chances[pairs[number]]
        rows.append(1 + int((row > row[truth.labels[number]]).sum()))
    return np.array(rows, dtype=np.int64)


def _average_precision(scores: Floats, hits: Bools, count: int) -> float:
    if not len(scores):
        return 0.0
    right = np.cumsum(hits[np.argsort(-scores, kind="stable")], axis=0)
    precision = right / np.arange(1, len(scores) + 1)[:, None]
    best = np.maximum.accumulate(precision[::-1], axis=0)[::-1]
    values = []
    for column in range(hits.shape[1]):
        at = np.searchsorted(right[:, column] / count, RECALLS - 1e-12)
        reached = at < len(scores)
        values.append(float(best[np.minimum(at, len(scores) - 1), column][reached].sum()) / 101.0)
    return float(np.mean(values))


def _box_overlaps(truth: Segments, found: Segments, rows: int, columns: int) -> Floats:
    """Return intersection over union of bounding boxes, shape (rows, columns)."""
    first, second = _bounds(truth, rows), _bounds(found, columns)
    low = np.maximum(first[:, None, :2], second[None, :, :2])
    high = np.minimum(first[:, None, 2:], second[None, :, 2:])
    both = np.maximum(high - low, 0.0).prod(axis=2)
    areas = [(bounds[:, 2:] - bounds[:, :2]).prod(axis=1) for bounds in (first, second)]
    shared: Floats = both / np.maximum(areas[0][:, None] + areas[1][None] - both, 1e-9)
    return shared


def _bounds(segments: Segments, count: int) -> Floats:
    """Return (x, y) of both corners of each object's box, shape (count, 4)."""
    bounds = np.zeros((count, 4))
    rows, columns = np.nonzero(segments != NOTHING)
    numbers = segments[rows, columns]
    for number in np.unique(numbers).tolist():
        own = numbers == number
        x, y = columns[own], rows[own]
        bounds[number] = (x.min(), y.min(), x.max() + 1, y.max() + 1)
    return bounds
