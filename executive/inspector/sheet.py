"""A contact sheet of a recorded run: all its looks in one image."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from executive.core.errors import InputError, RecordingError
from executive.engine.recording.reader import Recording
from executive.inspector.overlays import Picture, picture_of
from executive.inspector.shapes import Colour, Shape

ColourImage = NDArray[np.uint8]

# Blue, green, red, as OpenCV has them.
COLOURS: dict[Colour, tuple[int, int, int]] = {
    "path": (220, 160, 60),
    "good": (120, 220, 90),
    "doubtful": (60, 200, 255),
    "bad": (80, 80, 255),
    "hand": (255, 90, 220),
    "end": (255, 220, 80),
}
WHITE = (255, 255, 255)
FONT = cv2.FONT_HERSHEY_SIMPLEX
# A sheet has so many looks in a row, each at this share of its size, but as wide as this [px].
COLUMNS, SHARE, LEAST_WIDTH = 4, 0.5, 320


def write_sheet(recording: Path, file: Path) -> None:
    """Write all images of a run in one, each with what was believed about it.

    Raises:
        InputError: The file is no image's, or cannot be written.
        RecordingError: The recording cannot be read, or holds no image.
    """
    run = Recording.open(recording)
    looks = [_captioned(look) for look in _looks(run)]
    if not looks:
        raise RecordingError(f"{recording}: no looks to show; got no image; expected some")
    height, width = (max(look.shape[axis] for look in looks) for axis in (0, 1))
    rows = -(-len(looks) // COLUMNS)
    sheet: ColourImage = np.zeros((rows * height, COLUMNS * width, 3), np.uint8)
    for number, look in enumerate(looks):
        top, left = number // COLUMNS * height, number % COLUMNS * width
        sheet[top : top + look.shape[0], left : left + look.shape[1]] = look
    _save(file, sheet)


def _save(file: Path, image: ColourImage) -> None:
    try:
        written = cv2.imwrite(str(file), image)
    except cv2.error:
        written = False
    if not written:
        raise InputError(f"--sheet {file}: cannot be written; expected a .png or .jpg in a folder")


@dataclass(frozen=True, slots=True, eq=False)
class _Look:
    """An image, when it was taken, and what was made of it."""

    image: NDArray[np.uint8]
    time_s: float
    shapes: Sequence[Shape]


def _looks(run: Recording) -> Iterator[_Look]:
    """Yield the images in order, each with all that was made of it before it was forgotten."""
    images = list(run.images())
    begins = [_tick_at(run, image.time_s) for image in images]
    for image, begin, end in zip(images, begins, [*begins[1:], len(run)], strict=True):
        picture = _last_picture(run, image.number, begin, end)
        shapes = () if picture is None else picture.shapes
        yield _Look(run.image(image.number), image.time_s, shapes)


def _last_picture(run: Recording, number: int, begin: int, end: int) -> Picture | None:
    """Return an image as it was understood at the last tick that still holds it.

    A round that begins anew forgets the one before it, so that tick is searched for.
    """
    low, high, found = begin, end - 1, None
    while low <= high:
        middle = (low + high) // 2
        picture = picture_of(run.blackboard(middle))
        if picture is not None and picture.image == number:
            found, low = picture, middle + 1
        else:
            high = middle - 1
    return found


def _tick_at(run: Recording, time_s: float) -> int:
    """Return the first tick at or after a time."""
    low, high = 0, len(run) - 1
    while low < high:
        middle = (low + high) // 2
        low, high = (low, middle) if run.tick(middle).time_s >= time_s else (middle + 1, high)
    return low


def _captioned(look: _Look) -> ColourImage:
    way_to_bgr = cv2.COLOR_GRAY2BGR if look.image.ndim == 2 else cv2.COLOR_RGB2BGR
    canvas: ColourImage = np.asarray(cv2.cvtColor(look.image, way_to_bgr), dtype=np.uint8)
    for shape in look.shapes:
        _draw(canvas, shape)
    share = max(SHARE, LEAST_WIDTH / canvas.shape[1])
    way = cv2.INTER_AREA if share < 1.0 else cv2.INTER_NEAREST
    tile = cv2.resize(canvas, None, fx=share, fy=share, interpolation=way)
    cv2.putText(tile, f"{look.time_s:.1f} s", (6, 18), FONT, 0.5, WHITE, 1, cv2.LINE_AA)
    return np.asarray(tile, dtype=np.uint8)


def _draw(canvas: ColourImage, shape: Shape) -> None:
    if not shape.points:
        return
    colour = COLOURS[shape.colour]
    points = np.rint(np.array(shape.points)).astype(np.int32)
    at = (int(points[0, 0]), int(points[0, 1]))
    if shape.kind == "line":
        cv2.polylines(canvas, [points], isClosed=False, color=colour, thickness=2)
    elif shape.kind == "arrow":
        cv2.arrowedLine(canvas, at, (int(points[1, 0]), int(points[1, 1])), colour, 2)
    else:
        cv2.circle(canvas, at, 10 if shape.kind == "ring" else 5, colour, 2)
    if shape.label:
        cv2.putText(canvas, shape.label, (at[0] + 12, at[1] - 8), FONT, 0.6, colour, 1, cv2.LINE_AA)
