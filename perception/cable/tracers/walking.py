"""Ends that nobody sees are found by following the cable both ways from where it lies alone."""

from dataclasses import replace

import numpy as np

from perception.cable.tracers.paths import Ends, Path
from perception.cable.tracers.search import Search, SearchConfig, Sketch, run_searches
from perception.cable.tracers.starts import stepwise
from perception.cable.tracers.steps import StepModel
from perception.cable.types import Endpoint, Points, TraceEnd
from perception.models.frames import Floats, ScaledImage
from perception.models.tracer_crop import STEP

# Only an end is looked for, whichever way the cable comes there.
BEAM = 2
# An end's direction is that of so many steps before it.
LEAD = 2


def walked_ends(
    model: StepModel, config: SearchConfig, scaled: ScaledImage, line_px: Points, sketch: Sketch
) -> tuple[Endpoint, ...]:
    """Return the ends that a cable is followed to from the middle of a stretch.

    Args:
        model: Looks ahead.
        config: Settings of the search.
        scaled: The image in which cables have the width that the tracer knows.
        line_px: A stretch of cable that lies alone, in pixels of the original image.
        sketch: What is known of the cables.
    """
    line = stepwise(scaled.into(line_px))
    middle = len(line) // 2
    halves = (line[: middle + 2], line[middle:][::-1])
    none = Ends(np.empty((0, 2)), np.empty((0, 2)), np.empty(0))
    narrow = replace(config, beam=BEAM)
    searches = [
        Search([Path(half, np.zeros(len(half)))], none, narrow, sketch)
        for half in halves
        if len(half) > 1
    ]
    run_searches(model, scaled, searches, config.most_looks)
    found = [search.found()[0] for search in searches]
    return tuple(_end_of(path.points, path, scaled) for path in found if _has_ended(path))


def _has_ended(path: Path) -> bool:
    """Say whether a path came to where nothing goes on; whether that is an end is seen there."""
    return path.end in {TraceEnd.ENDPOINT, TraceEnd.LOST} and len(path.points) > LEAD


def _end_of(points: Floats, path: Path, scaled: ScaledImage) -> Endpoint:
    inwards = points[-1 - LEAD] - points[-1]
    length = max(float(np.linalg.norm(inwards)), 1e-9 * STEP)
    belief = float(np.exp(min(path.log_probability, 0.0)))
    return Endpoint(scaled.back(points[-1]), inwards / length, belief)
