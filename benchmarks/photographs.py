"""Photographs of cables with known paths, where a checkout has them beside it.

They are for evaluation only: nothing is trained on them, and they are no part of the project.
`CELLWRIGHT_PHOTOGRAPHS` names their folder, with `real_cable` (one white cable, ordered paths)
and `mbest` (Choi et al. 2023: one to three cables, label maps) in it.
"""

import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from perception.cable.following import followed_share
from perception.cable.interfaces import Tracer
from perception.cable.separation import separate
from perception.cable.types import Endpoint
from perception.camera import GreyImage

Floats = NDArray[np.float64]
Labels = NDArray[np.uint8]

FOLDER = Path(os.environ.get("CELLWRIGHT_PHOTOGRAPHS", "../shared/data"))
START_POINTS = 5


@dataclass(frozen=True, slots=True, eq=False)
class AnnotatedTrace:
    """A photograph with a piece of its cable's centre line, in order, shape (N, 2)."""

    image: GreyImage
    line_px: Floats


@dataclass(frozen=True, slots=True, eq=False)
class LabelledImage:
    """A photograph in colour, and which cable each pixel shows, 0 for none."""

    image: NDArray[np.uint8]
    labels: Labels


def annotated_traces() -> Iterator[AnnotatedTrace]:
    """Yield the traces of `real_cable`; none where there is no such folder."""
    path = FOLDER / "real_cable" / "annotations.json"
    traces = json.loads(path.read_text())["traces"] if path.exists() else []
    for trace in traces:
        image = cv2.imread(str(path.parent / trace["image"]), cv2.IMREAD_GRAYSCALE)
        yield AnnotatedTrace(np.asarray(image, np.uint8), np.array(trace["polyline_xy"], float))


def labelled_images() -> Iterator[LabelledImage]:
    """Yield the images of `mbest`; none where there is no such folder."""
    for path in sorted((FOLDER / "mbest").glob("*/images/*.jpg")):
        label = path.parent.parent / "labels" / f"{path.stem}.png"
        yield LabelledImage(
            np.asarray(cv2.imread(str(path)), np.uint8),
            np.asarray(cv2.imread(str(label), cv2.IMREAD_GRAYSCALE), np.uint8),
        )


def followed(tracer: Tracer, task: AnnotatedTrace, endpoints: tuple[Endpoint, ...] = ()) -> float:
    """Return which share of an annotated line a tracer follows from its first points."""
    trace = tracer.trace(task.image, task.line_px[:START_POINTS], endpoints)
    if trace is None or len(trace.points_px) < 2:
        return 0.0
    return followed_share(task.line_px, trace.points_px)


def told_apart(image: GreyImage, truth: Labels) -> tuple[bool, float]:
    """Return whether as many cables are found as there are, and the mean Dice of the best match.

    A cable that is not found counts 0.
    """
    traces, labels = separate(image)
    wanted = int(truth.max())
    overlaps = np.array(
        [
            [_dice(truth == a + 1, labels == b + 1) for b in range(len(traces))]
            for a in range(wanted)
        ]
    ).reshape(wanted, len(traces))
    rows, columns = linear_sum_assignment(-overlaps)
    return len(traces) == wanted, float(overlaps[rows, columns].sum() / wanted)


def _dice(a: NDArray[np.bool_], b: NDArray[np.bool_]) -> float:
    return 2.0 * float((a & b).sum()) / max(float(a.sum() + b.sum()), 1.0)
