"""What speaks for and against a trace, in numbers that no image's size or look changes.

Lengths are in steps of the tracer, two cable widths each.
"""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.cable.tracers.hypotheses import Hypothesis, apart
from perception.cable.tracers.paths import Path
from perception.cable.tracers.survey import Survey
from perception.cable.types import TraceEnd
from perception.models.frames import Floats
from perception.models.tracer_crop import STEP, WIDTH

FEATURES = (
    "there",
    "back",
    "joined",
    "unknown_end",
    "edge",
    "lost",
    "unexplained",
    "shared",
    "doubled",
    "off_cable",
    "sharpest_turn",
    "bending",
)
NONE_FEATURES = ("one", "doubt", "doubt_elsewhere")
# A trace accounts for the mask so far to either side [widths]; other strands' borders reach in.
BAND_WIDTHS = 1.7
# Lines lie upon each other where they are this near and parallel.
UPON = 0.55 * WIDTH
# Points of one trace nearer along it are the same piece [steps].
OWN_PIECE = 5
MOST = 40.0


def evidence(survey: Survey, start: int, candidates: Sequence[Hypothesis]) -> Floats:
    """Return the features of each trace, shape (K, len(FEATURES))."""
    seen = _components_of(survey, start)
    return np.array([_features(survey, start, one, seen) for one in candidates]).reshape(
        -1, len(FEATURES)
    )


def doubts(survey: Survey, start: int) -> Floats:
    """Return the features of "none of these", shape (len(NONE_FEATURES),)."""
    others = [-_best(found) for number, found in enumerate(survey.found) if number != start]
    mean = float(np.mean(others)) if others else 0.0
    return np.array([1.0, -_best(survey.found[start]), mean])


def _best(found: Sequence[Path]) -> float:
    return max(min((path.log_probability for path in found[:1]), default=-MOST), -MOST)


def _features(survey: Survey, start: int, one: Hypothesis, seen: NDArray[np.uint8]) -> list[float]:
    others = [
        found[0].points
        for number, found in enumerate(survey.found)
        if number not in (start, one.reached) and found
    ]
    turns = _turns(one.points)
    return [
        one.there,
        one.back,
        float(one.joined),
        float(one.end is TraceEnd.ENDPOINT and one.reached is None),
        float(one.end is TraceEnd.EDGE),
        float(one.end in (TraceEnd.LOST, TraceEnd.RETRACE)),
        _much(_unexplained(survey, [one.points, *others], seen)),
        _much(sum(_upon(one.points, other) for other in others)),
        _much(_doubled(one.points)),
        _much(_off_cable(survey, one.points)),
        float(turns.max(initial=0.0)),
        float(np.sqrt(np.mean(turns**2))) if len(turns) else 0.0,
    ]


def _much(length: float) -> float:
    """Return a length whose growth counts less and less."""
    return float(np.log1p(min(length, MOST)))


def _components_of(survey: Survey, start: int) -> NDArray[np.uint8]:
    """Return the pieces of the mask that hang together with paths from a start."""
    labels = np.asarray(cv2.connectedComponents(survey.cable)[1])
    points = np.vstack([path.points for path in survey.found[start][:1]] or [np.zeros((0, 2))])
    columns, rows = _places(survey, points).T
    touched = np.unique(labels[rows, columns])
    return np.asarray(np.isin(labels, touched[touched > 0]), np.uint8)


def _places(survey: Survey, points: Floats) -> NDArray[np.int64]:
    limits = np.array(survey.cable.shape[::-1]) - 1
    places: NDArray[np.int64] = (
        np.rint((points + 0.5) * survey.zoom - 0.5).astype(np.int64).clip(0, limits)
    )
    return places


def _unexplained(survey: Survey, lines: Sequence[Floats], seen: NDArray[np.uint8]) -> float:
    """Return the length of cable in the mask that no line goes over [steps]."""
    left = seen.copy()
    thickness = max(round(BAND_WIDTHS * WIDTH * survey.zoom), 1)
    for line in lines:
        fixed = np.rint(((line + 0.5) * survey.zoom - 0.5) * 8.0).astype(np.int32)[:, None]
        cv2.polylines(left, [fixed], False, (0,), thickness, cv2.LINE_8, 3)
    return float(left.sum()) / (WIDTH * STEP * survey.zoom**2)


def _upon(line: Floats, other: Floats) -> float:
    """Return how many points of a line lie upon another one and along it, either way."""
    if len(line) < 2 or len(other) < 2:
        return 0.0
    near = np.minimum(apart(line, other), apart(line, other[::-1])[:, ::-1]).min(axis=1)
    return float((near < UPON).sum())


def _doubled(line: Floats) -> float:
    """Return how many points of a line lie upon other stretches of it and along them."""
    near = np.minimum(apart(line, line), apart(line, line[::-1])[:, ::-1])
    number = np.arange(len(line))
    own = np.abs(number[:, None] - number[None]) < OWN_PIECE
    return float((np.where(own, np.inf, near).min(axis=1, initial=np.inf) < UPON).sum())


def _off_cable(survey: Survey, line: Floats) -> float:
    """Return how many steps of a line lie beside the mask."""
    halves = np.vstack([line, 0.5 * (line[1:] + line[:-1])])
    columns, rows = _places(survey, halves).T
    near = cv2.dilate(survey.cable, np.ones((3, 3), np.uint8))
    return 0.5 * float((near[rows, columns] == 0).sum())


def _turns(line: Floats) -> Floats:
    """Return by how much a line turns at each inner point [rad]."""
    steps = np.diff(line, axis=0)
    angles = np.arctan2(steps[:, 1], steps[:, 0])
    turns: Floats = np.abs((np.diff(angles) + np.pi) % (2.0 * np.pi) - np.pi)
    return turns
