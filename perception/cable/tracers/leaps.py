"""Steps that one look gives away together: where a cable runs on plainly, several are one.

The network also says where the cable is two and three steps ahead. That is trusted where it is
sharp, goes on as the steps before it, and lies on something as bright as the cable behind.
"""

import cv2
import numpy as np

from perception.cable.tracers.modes import Mode, find_modes
from perception.cable.tracers.steps import Outlook
from perception.models.frames import Crop, Floats
from perception.models.tracer_crop import HERE, SIZE, STEP

# On held-out samples a first step with this belief was wrong once in 1,000 times, later ones
# with theirs 7 times, most of them beyond the end of a cable.
SURE_FIRST, SURE_LATER = 0.9, 0.95
# Maps of later steps are broader.
REACH = 3
# Later steps are about as long as a step, and turn by no more than this.
LENGTHS, MOST_TURN = (0.75 * STEP, 1.25 * STEP), np.cos(0.7)
# What is left of the cable's brightness, over its surroundings, at a point that lies on it.
ON_CABLE = 0.4


def leap(outlook: Outlook, first: Mode) -> list[Floats]:
    """Return points after the first step that need no look of their own, in crop pixels.

    Args:
        outlook: Where the path may go on.
        first: The likeliest place of the first step.
    """
    if not outlook.clear or first.probability < SURE_FIRST:
        return []
    line = [np.asarray(HERE, dtype=float), first.point_crop]
    for cells in outlook.later:
        modes = find_modes(cells, SURE_LATER, 1, REACH)
        if not modes or not _goes_on(line, modes[0].point_crop):
            break
        line.append(modes[0].point_crop)
    return line[2:] if _all_on_cable(outlook.crop, line) else []


def _goes_on(line: list[Floats], point: Floats) -> bool:
    """Say whether a point continues a line without a jump or a sharp turn."""
    last, step = line[-1] - line[-2], point - line[-1]
    length = float(np.linalg.norm(step))
    turn = float(step @ last) / max(length * float(np.linalg.norm(last)), 1e-9)
    return LENGTHS[0] < length < LENGTHS[1] and turn > MOST_TURN


def _all_on_cable(crop: Crop, line: list[Floats]) -> bool:
    """Say whether all points of a line, and those half-way, are about as bright as its start."""
    points = np.array(line)
    places = np.vstack([points, 0.5 * (points[1:] + points[:-1])])
    size_px = crop.shape[-1]
    at_px = np.rint((places + 0.5) * size_px / SIZE - 0.5).astype(int).clip(0, size_px - 1)
    values = cv2.blur(crop[0], (3, 3))[at_px[:, 1], at_px[:, 0]]
    return bool((values > ON_CABLE * values[0]).all())
