"""The next move of a plan over an image: what is held, where it goes, what should be left."""

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.cable.planning.grasping import Grasp
from perception.cable.planning.plan import Plan, PlanStep
from perception.cable.polyline import arc_lengths, point_at
from perception.cable.types import Points
from perception.camera import GreyImage

ColourImage = NDArray[np.uint8]
Colour = tuple[int, int, int]

# Drawn at twice the size and shrunk again, so that thin lines stay smooth.
SCALE = 2
INK: Colour = (24, 24, 28)
WHITE: Colour = (255, 255, 255)
ROLE_COLOURS: dict[str, Colour] = {"cage": (80, 200, 255), "pinch": (255, 90, 170)}
MOVED: Colour = (255, 170, 60)
FONT = cv2.FONT_HERSHEY_SIMPLEX
RADIUS_PX, TIP_PX = 9.0, 12.0


def draw_plan(image: GreyImage, points_px: Points, plan: Plan) -> ColourImage:
    """Return the image as RGB with the first move of a plan drawn over it.

    The piece of cable that is moved is orange. A ring is a hand that cages, a disc one that
    pinches; arrows lead to where they go. A line of text says what is done, how many crossings
    there are and should be left, and what comes after.

    Args:
        image: Grey image, shape (H, W).
        points_px: The trace that was planned on, in the image, shape (N, 2).
        plan: The plan, its grasp points in the image.
    """
    large = cv2.resize(image, None, fx=SCALE, fy=SCALE, interpolation=cv2.INTER_CUBIC)
    dimmed = (large.astype(np.float32) * 0.7).astype(np.uint8)
    canvas: ColourImage = np.repeat(dimmed[:, :, None], 3, axis=2)
    if plan.steps:
        step = plan.steps[0]
        _draw_moved(canvas, points_px, step.interval)
        for grasp in step.grasps:
            _draw_grasp(canvas, grasp)
    _write(canvas, caption(plan))
    height, width = image.shape
    small = cv2.resize(canvas, (width, height), interpolation=cv2.INTER_AREA)
    return np.asarray(small, dtype=np.uint8)


def caption(plan: Plan) -> str:
    """Say in one line what a plan is."""
    seen = _counted(len(plan.seen))
    if plan.failure is not None:
        return f"{seen}: no plan: {plan.failure}"
    if not plan.steps:
        return f"{seen}: nothing to do"
    first, *others = plan.steps
    counts = f"{len(plan.seen)} -> {_counted(len(first.predicted))}"
    return f"{_said(first)}: {counts}" + "".join(f"; then {_said(step)}" for step in others)


def _said(step: PlanStep) -> str:
    end = f" {step.end}" if step.end else ""
    return f"{step.kind.value.replace('_', ' ')}{end}"


def _counted(crossings: int) -> str:
    return f"{crossings} crossing{'' if crossings == 1 else 's'}"


def _pixel(point: Points) -> tuple[int, int]:
    return round((float(point[0]) + 0.5) * SCALE), round((float(point[1]) + 0.5) * SCALE)


def _draw_moved(canvas: ColourImage, points_px: Points, interval: tuple[float, float]) -> None:
    arcs = arc_lengths(points_px)
    at = np.arange(interval[0] * arcs[-1], interval[1] * arcs[-1], 2.0)
    corners = np.array([_pixel(point) for point in point_at(points_px, arcs, at)], dtype=np.int32)
    cv2.polylines(
        canvas, [corners], isClosed=False, color=MOVED, thickness=2 * SCALE, lineType=cv2.LINE_AA
    )


def _draw_grasp(canvas: ColourImage, grasp: Grasp) -> None:
    colour, centre = ROLE_COLOURS[grasp.role], _pixel(grasp.point)
    length_px = float(np.linalg.norm(grasp.to - grasp.point))
    for width, ink in ((4 * SCALE, INK), (2 * SCALE, colour)):
        tip = min(TIP_PX / max(length_px, TIP_PX), 1.0)
        cv2.arrowedLine(canvas, centre, _pixel(grasp.to), ink, width, cv2.LINE_AA, 0, tip)
    fill = 2 * SCALE if grasp.role == "cage" else cv2.FILLED
    cv2.circle(canvas, centre, round((RADIUS_PX + 1.5) * SCALE), INK, fill, cv2.LINE_AA)
    cv2.circle(canvas, centre, round(RADIUS_PX * SCALE), colour, fill, cv2.LINE_AA)


def _write(canvas: ColourImage, text: str) -> None:
    """Write lines of text into the upper left corner, each as long as fits."""
    for row, line in enumerate(_wrapped(text, canvas.shape[1])):
        origin = (8 * SCALE, (18 + 18 * row) * SCALE)
        for width, ink in ((4 * SCALE, INK), (SCALE, WHITE)):
            cv2.putText(canvas, line, origin, FONT, 0.5 * SCALE, ink, width, cv2.LINE_AA)


def _wrapped(text: str, width: int) -> Sequence[str]:
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        (wide, _), _ = cv2.getTextSize(longer, FONT, 0.5 * SCALE, SCALE)
        if wide > width - 16 * SCALE and lines[-1]:
            lines.append(word)
        else:
            lines[-1] = longer
    return lines
