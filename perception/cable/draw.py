"""What is believed about an image, drawn over it."""

import itertools
import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from perception.cable.polyline import arc_lengths, point_at
from perception.cable.types import CableScene, Crossing, Endpoint, Knot, Points, Trace
from perception.camera import GreyImage

ColourImage = NDArray[np.uint8]
Colour = tuple[int, int, int]

# Drawn at twice the size and shrunk again, so that thin lines stay smooth.
SCALE = 2
WHITE: Colour = (255, 255, 255)
INK: Colour = (24, 24, 28)
GREEN: Colour = (90, 220, 120)
CAGE: Colour = (80, 200, 255)
PINCH: Colour = (255, 90, 170)
KNOT: Colour = (255, 170, 60)
UNSURE: Colour = (255, 80, 80)
FONT = cv2.FONT_HERSHEY_SIMPLEX
GAP_PX = 15.0


def draw_scene(image: GreyImage, scene: CableScene) -> ColourImage:
    """Return the image as RGB with everything that is believed drawn over it.

    Traces run from violet to red, broken where they pass below; crossings carry their
    probability; circles are endpoints, a ring is the cage and a cross the pinch.

    Args:
        image: Grey image, shape (H, W).
        scene: What is believed about it.

    Returns:
        Colours, shape (H, W, 3), uint8.
    """
    height, width = image.shape
    dimmed = (image.astype(np.float32) * 0.8).astype(np.uint8)
    large = cv2.resize(dimmed, (width * SCALE, height * SCALE), interpolation=cv2.INTER_CUBIC)
    canvas: ColourImage = np.repeat(np.asarray(large, dtype=np.uint8)[:, :, None], 3, axis=2)
    for knot in scene.knots:
        _draw_knot(canvas, scene.traces[knot.trace], knot)
    for index, trace in enumerate(scene.traces):
        _draw_trace(canvas, index, trace, scene.crossings)
    for crossing in scene.crossings:
        _draw_crossing(canvas, crossing)
    for endpoint in scene.endpoints:
        _draw_endpoint(canvas, endpoint)
    for knot in scene.knots:
        _draw_grasps(canvas, knot)
    _draw_verdict(canvas, scene)
    small = cv2.resize(canvas, (width, height), interpolation=cv2.INTER_AREA)
    return np.asarray(small, dtype=np.uint8)


def _pixel(point: Points) -> tuple[int, int]:
    """Return a point of the image on the enlarged canvas."""
    return round((float(point[0]) + 0.5) * SCALE), round((float(point[1]) + 0.5) * SCALE)


def _polyline(canvas: ColourImage, points: Points, colour: Colour, thickness: int) -> None:
    corners = np.array([_pixel(point) for point in points], dtype=np.int32)
    cv2.polylines(
        canvas, [corners], isClosed=False, color=colour, thickness=thickness, lineType=cv2.LINE_AA
    )


def rainbow(share: float) -> Colour:
    """Return a colour from violet (0) over green to red (1)."""
    hue = np.uint8(round(140.0 * (1.0 - share)))
    red, green, blue = cv2.cvtColor(np.array([[[hue, 215, 255]]], np.uint8), cv2.COLOR_HSV2RGB)[
        0, 0
    ]
    return int(red), int(green), int(blue)


def _draw_trace(
    canvas: ColourImage, index: int, trace: Trace, crossings: Sequence[Crossing]
) -> None:
    line, arcs = trace.points_px, arc_lengths(trace.points_px)
    length_px = float(arcs[-1])
    gaps_px = [c.arc_under * length_px for c in crossings if c.trace_under == index]
    steps = np.append(np.arange(0.0, length_px, 4.0), length_px)
    for begin, end in itertools.pairwise(steps):
        middle = 0.5 * (begin + end)
        if any(abs(middle - gap) < 0.5 * GAP_PX for gap in gaps_px):
            continue
        piece = point_at(line, arcs, np.linspace(begin, end, 3))
        _polyline(canvas, piece, rainbow(middle / length_px), 2 * SCALE)


def _draw_crossing(canvas: ColourImage, crossing: Crossing) -> None:
    sure = min(max(2.0 * crossing.probability - 1.0, 0.0), 1.0)
    mixed = np.array(UNSURE) + sure * (np.array(WHITE) - np.array(UNSURE))
    colour: Colour = (int(mixed[0]), int(mixed[1]), int(mixed[2]))
    x, y = _pixel(crossing.position_px)
    cv2.circle(canvas, (x, y), 6 * SCALE, colour, 1, cv2.LINE_AA)
    text = f"{crossing.probability:.2f}".lstrip("0") if crossing.probability < 0.995 else "1"
    _text(canvas, text, (x + 7 * SCALE, y - 6 * SCALE), 0.36 * SCALE, colour)


def _draw_endpoint(canvas: ColourImage, endpoint: Endpoint) -> None:
    centre = _pixel(endpoint.position_px)
    cv2.circle(canvas, centre, 9 * SCALE, GREEN, SCALE, cv2.LINE_AA)
    ahead = _pixel(endpoint.position_px + 26.0 * endpoint.direction)
    cv2.arrowedLine(canvas, centre, ahead, GREEN, SCALE, cv2.LINE_AA, tipLength=0.3)


def _draw_knot(canvas: ColourImage, trace: Trace, knot: Knot) -> None:
    """Lay a broad translucent band under the piece of cable that is knotted."""
    arcs = arc_lengths(trace.points_px)
    begin, end = knot.interval
    points = point_at(trace.points_px, arcs, np.linspace(begin, end, 200) * arcs[-1])
    band = canvas.copy()
    _polyline(band, points, KNOT, 12 * SCALE)
    cv2.addWeighted(band, 0.35, canvas, 0.65, 0.0, dst=canvas)


def _draw_grasps(canvas: ColourImage, knot: Knot) -> None:
    cage, pinch = _pixel(knot.cage_px), _pixel(knot.pinch_px)
    for colour, width in ((INK, 4 * SCALE), (CAGE, 2 * SCALE)):
        cv2.circle(canvas, cage, 11 * SCALE, colour, width, cv2.LINE_AA)
    for colour, width in ((INK, 4 * SCALE), (PINCH, 2 * SCALE)):
        cv2.drawMarker(canvas, pinch, colour, cv2.MARKER_TILTED_CROSS, 20 * SCALE, width)
    _text(canvas, "cage", (cage[0] + 14 * SCALE, cage[1] + 4 * SCALE), 0.45 * SCALE, CAGE)
    _text(canvas, "pinch", (pinch[0] + 14 * SCALE, pinch[1] + 4 * SCALE), 0.45 * SCALE, PINCH)


def _draw_verdict(canvas: ColourImage, scene: CableScene) -> None:
    lines = [f"P(knotted) {scene.knotted_probability:.3f}"]
    lines += [
        f"cable {index + 1}: ends at {trace.end.value}, p {trace.probability:.2f}"
        for index, trace in enumerate(scene.traces)
    ] or ["no cable traced"]
    lines.append(
        f"{_count(len(scene.crossings), 'crossing')}, {_count(len(scene.knots), 'knot')}, "
        f"{_count(len(scene.endpoints), 'end')}"
    )
    for row, line in enumerate(lines):
        size = 0.62 if row == 0 else 0.45
        _text(canvas, line, (12 * SCALE, (24 + 19 * row) * SCALE), size * SCALE, WHITE)


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def _text(
    canvas: ColourImage, text: str, corner: tuple[int, int], size: float, colour: Colour
) -> None:
    """Write with a dark outline, which stays legible on cable and cloth."""
    thickness = max(math.floor(size), 1)
    for shade, width in ((INK, thickness + 2 * SCALE), (colour, thickness)):
        cv2.putText(canvas, text, corner, FONT, size, shade, width, cv2.LINE_AA)
