"""Whether cables end where they seem to: the tracer looks outwards over each end.

A mask that breaks where a cable is dim, shaded or crossed has dead ends that are no ends. Who
comes along the cable there sees it go on.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from pydantic import BaseModel, ConfigDict
from scipy.special import expit, logit

from perception.cable.tracers.paths import Path
from perception.cable.tracers.steps import StepModel
from perception.cable.types import Endpoint
from perception.models.frames import Floats, ScaledImage
from perception.models.tracer_crop import STEP

# So far before an end, and at it, the tracer looks outwards [steps].
LOOKS = (0.5, 0.0)
# Points of the path that leads there; their directions tell the way.
BEFORE = np.array([[2.0], [1.0], [0.0]])
# No belief of a network is surer than this.
LEAST = 1e-3


class EndWeights(BaseModel):
    """What the odds of an end are made of: a constant and the log odds of two witnesses.

    Attributes:
        one: The constant.
        seen: Weight of who saw the end.
        stops: Weight of the tracer, who looks outwards there.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    one: float = 0.8
    seen: float = 0.55
    stops: float = 0.8


def judged(
    model: StepModel, scaled: ScaledImage, ends: Sequence[Endpoint], weights: EndWeights
) -> tuple[Endpoint, ...]:
    """Return ends with what the tracer believes of them, too, the surest first.

    Args:
        model: Looks ahead.
        scaled: The image in which cables have the width that the tracer knows.
        ends: In the original image.
        weights: How both are weighed.
    """
    if not ends:
        return ()
    odds = weights.one + witnesses(model, scaled, ends) @ (weights.seen, weights.stops)
    beliefs = expit(odds).tolist()
    told = [replace(end, probability=belief) for end, belief in zip(ends, beliefs, strict=True)]
    return tuple(sorted(told, key=lambda end: -end.probability))


def witnesses(model: StepModel, scaled: ScaledImage, ends: Sequence[Endpoint]) -> Floats:
    """Return the log odds of each end by who saw it and by the tracer, shape (N, 2)."""
    seen = np.array([end.probability for end in ends])
    return np.column_stack([_logit(seen), _logit(stops(model, scaled, ends))])


def stops(model: StepModel, scaled: ScaledImage, ends: Sequence[Endpoint]) -> Floats:
    """Return how far the tracer believes at each end that the cable stops, shape (N,)."""
    paths = [_towards(scaled, end, inside) for end in ends for inside in LOOKS]
    beliefs = np.array([outlook.end for outlook in model.outlooks(scaled, paths)])
    highest: Floats = beliefs.reshape(len(ends), len(LOOKS)).max(axis=1)
    return highest


def _towards(scaled: ScaledImage, end: Endpoint, inside: float) -> Path:
    points = scaled.into(end.position_px) + (BEFORE + inside) * STEP * end.direction
    return Path(points, np.zeros(len(points)))


def _logit(beliefs: Floats) -> Floats:
    odds: Floats = logit(np.clip(beliefs, LEAST, 1.0 - LEAST))
    return odds
