"""What the crossing's network sees: the crossing from one strand's side, and from the other's."""

import numpy as np

from perception.models.frames import Crop, Floats, ScaledImage, cut, draw_line, turned_frame

SIZE = 32
WIDTH = 5.5
CENTRE = (15.5, 15.5)
# Piece of each strand that is drawn, to either side of the crossing [pixels of the crop].
REACH = 18.0
THICKNESS = 2


def make_views(scaled: ScaledImage, centre: Floats, strands: tuple[Floats, Floats]) -> Crop:
    """Return grey, own strand and other strand, seen along each strand; (2, 3, SIZE, SIZE).

    Args:
        scaled: Image in which cables are `WIDTH` pixels wide.
        centre: The crossing in that image, shape (2,).
        strands: Points of both strands near the crossing, in that image.
    """
    return np.stack([_view(scaled, centre, strands[k], strands[1 - k]) for k in (0, 1)])


def _view(scaled: ScaledImage, centre: Floats, own: Floats, other: Floats) -> Crop:
    chord = own[-1] - own[0]
    heading = chord / max(float(np.linalg.norm(chord)), 1e-9)
    frame = turned_frame(centre, heading, CENTRE)
    lines = np.zeros((2, SIZE, SIZE), np.uint8)
    for line, points in zip(lines, (own, other), strict=True):
        draw_line(line, frame.into(points), 255, THICKNESS)
    view = np.empty((3, SIZE, SIZE), np.float32)
    view[0] = _normalised(cut(scaled, frame, SIZE), lines)
    view[1:] = lines / np.float32(255.0)
    return view


def _normalised(grey: Crop, lines: "np.ndarray[tuple[int, ...], np.dtype[np.uint8]]") -> Crop:
    """Return grey values of mean 0 and deviation 1, cables on the bright side."""
    mean, deviation = float(grey.mean()), float(grey.std())
    on_cable = lines.max(axis=0) > 100
    dark = on_cable.any() and float(grey[on_cable].mean()) < mean
    gain = (-1.0 if dark else 1.0) / max(deviation, 2.0)
    normalised: Crop = np.clip((grey - mean) * gain, -4.0, 4.0)
    return normalised
