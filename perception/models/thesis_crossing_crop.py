"""What the thesis's classifier sees: one visit of a crossing, cut out along its strand.

Shivakumar 2023, section 3.2: 20 x 20 pixels, turned so that first and last point of the strand
lie level; channels are the strand's own points, the place, and grey values. There cables are
5 to 6 px wide, which holds here for all images.
"""

import numpy as np

from perception.models.frames import Crop, Floats, ScaledImage, cut, draw_line, turned_frame

SIZE = 20
WIDTH = 5.5
CENTRE = (9.5, 9.5)
# Piece of the strand that is drawn, to either side of the crossing.
REACH = 10.0
THICKNESS = 2
PLACE_SIGMA = 1.0


def make_visit(scaled: ScaledImage, path: Floats) -> Crop:
    """Return own strand, place and grey of one visit, shape (3, SIZE, SIZE).

    Args:
        scaled: Image in which cables are `WIDTH` pixels wide.
        path: Points of the strand over `REACH` to either side; the middle one is the crossing.
    """
    centre, chord = path[len(path) // 2], path[-1] - path[0]
    frame = turned_frame(centre, chord / max(float(np.linalg.norm(chord)), 1e-9), CENTRE)
    strand = np.zeros((SIZE, SIZE), np.uint8)
    draw_line(strand, frame.into(path), 255, THICKNESS)
    visit = np.empty((3, SIZE, SIZE), np.float32)
    visit[0] = strand / np.float32(255.0)
    visit[1] = _PLACE
    visit[2] = cut(scaled, frame, SIZE) / np.float32(255.0)
    return visit


def _place() -> Crop:
    x, y = np.arange(SIZE) - CENTRE[0], np.arange(SIZE)[:, None] - CENTRE[1]
    place: Crop = np.exp(-0.5 * (x * x + y * y) / PLACE_SIGMA**2).astype(np.float32)
    return place


_PLACE = _place()
