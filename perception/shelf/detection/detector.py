"""A detector of labelled products: segments by depth, names by looks and by text.

P(C | I, T) is proportional to P(C | T) P(C | I) (thesis, section 6.2). Text is read in the image
and in nearer views; of all readings of an object the one that leaves the least doubt is kept.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from perception.rgbd import RgbdFrame
from perception.shelf.detection.appearance import AppearanceModel, features_of
from perception.shelf.detection.reading import TextLine, TextReader
from perception.shelf.detection.segmenting import ShelfPoints, segmented, shelf_points
from perception.shelf.detection.wording import TextModel, Wording, plain
from perception.shelf.detections import Detections
from perception.shelf.types import NOTHING, Floats, Segments, Shelf

# What stands before and behind a line of text in another view may differ by so much.
SAME_M = 0.012
# Room round what stands on the shelf when it is read, as a share of the image's width.
ROOM_SHARE = 0.01
# Letters of at least this share of the largest make up the title.
TITLE_SHARE = 0.6


@dataclass(frozen=True, slots=True, eq=False)
class Objects:
    """What stands apart in a frame, and what it looks like.

    Attributes:
        frame: The frame.
        points: Where its pixels lie.
        segments: Which object each pixel shows, by number, or `NOTHING`.
        looks: P(name | looks) of each object, shape (K, N).
    """

    frame: RgbdFrame
    points: ShelfPoints
    segments: Segments
    looks: Floats

    @property
    def count(self) -> int:
        """Number of objects."""
        return len(self.looks)


class ProductDetector:
    """Finds labelled products; a `ShelfDetector`."""

    def __init__(
        self,
        shelf: Shelf,
        wordings: Sequence[Wording],
        appearance: AppearanceModel,
        reader: TextReader | None,
    ) -> None:
        """Put it together.

        Args:
            shelf: The inside that objects stand in.
            wordings: What is printed on the products, in the order of the model's names.
            appearance: How they look.
            reader: What reads labels; None for looks alone.
        """
        self._shelf, self._appearance, self._reader = shelf, appearance, reader
        self._text = TextModel(wordings)

    def detect(self, frame: RgbdFrame) -> Detections:
        """Return all objects in view, with what they look like and what can be read from here."""
        objects = self.find(frame)
        return self.named(objects, self.readings(objects, [frame]))

    def find(self, frame: RgbdFrame) -> Objects:
        """Tell the objects of a frame apart, and judge their looks."""
        points = shelf_points(frame, self._shelf)
        segments = segmented(points)
        count = int(segments.max()) + 1
        features = [
            features_of(frame.colour, points, segments == number) for number in range(count)
        ]
        names = len(self._appearance.names)
        looks = self._appearance.probabilities(np.array(features)) if count else None
        return Objects(frame, points, segments, np.zeros((0, names)) if looks is None else looks)

    def readings(
        self, objects: Objects, frames: Sequence[RgbdFrame], before: Floats | None = None
    ) -> Floats:
        """Return P(name | text) of each object, with none of them last, shape (K, N + 1).

        Args:
            objects: The objects of one frame.
            frames: Frames to read, that one or nearer ones; the surest reading is kept.
            before: Readings to begin with; None where nothing has been read.
        """
        nothing = np.tile(self._text.probabilities(""), (objects.count, 1))
        best = nothing if before is None else before.copy()
        doubt = _doubt(best)
        for frame in frames if self._reader is not None else ():
            lines = self._lines(frame, objects)
            for number, own in enumerate(lines):
                if own:
                    row = self._text.probabilities(*_texts(own))
                    bits = _doubt(row[None])[0]
                    if bits < doubt[number]:
                        best[number], doubt[number] = row, bits
        return best

    def named(self, objects: Objects, readings: Floats) -> Detections:
        """Return what objects are by looks and text.

        Args:
            objects: The objects.
            readings: P(name | text), with none of them last, shape (K, N + 1).
        """
        names = self._appearance.names
        # Of what is unknown nothing is known of its looks: they are as likely as those of any.
        looks = np.hstack([objects.looks, np.full((objects.count, 1), 1.0 / len(names))])
        both = looks * readings
        rows = both / both.sum(axis=1, keepdims=True)
        return Detections(objects.segments, names, rows[:, :-1])

    def _lines(self, frame: RgbdFrame, objects: Objects) -> list[list[TextLine]]:
        """Return the lines of text on each object, from above to below."""
        own = frame is objects.frame
        points = objects.points if own else shelf_points(frame, self._shelf)
        lines: list[list[TextLine]] = [[] for _ in range(objects.count)]
        for line in self._read(frame, points):
            number = _object_at(line, points, objects)
            if number != NOTHING:
                lines[number].append(line)
        return [sorted(group, key=lambda line: float(line.centre_px[1])) for group in lines]

    def _read(self, frame: RgbdFrame, points: ShelfPoints) -> list[TextLine]:
        """Read the part of a frame where things are."""
        assert self._reader is not None
        rows, columns = np.nonzero(points.things)
        if not len(rows):
            return []
        room = round(ROOM_SHARE * frame.colour.shape[1])
        top, left = max(0, rows.min() - room), max(0, columns.min() - room)
        part = frame.colour[top : rows.max() + room, left : columns.max() + room]
        corner = np.array([left, top], dtype=np.float64)
        return [
            TextLine(line.text, line.confidence, line.corners_px + corner)
            for line in self._reader.read(part)
        ]


def _object_at(line: TextLine, points: ShelfPoints, objects: Objects) -> int:
    """Return which object of another frame, or the same, a line of text is on."""
    height, width = points.things.shape
    column, row = np.clip(line.centre_px.round().astype(int), 0, [width - 1, height - 1])
    point_m = points.points_m[row, column]
    if not points.things[row, column]:
        return NOTHING
    if points is objects.points:
        return int(objects.segments[row, column])
    place = objects.frame.camera.project(point_m[None])[0].round().astype(int)
    height, width = objects.segments.shape
    if not (0 <= place[0] < width and 0 <= place[1] < height):
        return NOTHING
    there_m = objects.points.points_m[place[1], place[0]]
    if np.linalg.norm(there_m - point_m) < SAME_M:
        return int(objects.segments[place[1], place[0]])
    return _object_before(point_m, objects)


def _object_before(point_m: Floats, objects: Objects) -> int:
    """Return the object whose front a point is on that another hides in the objects' frame."""
    nearest, apart_m = NOTHING, SAME_M
    for number in range(objects.count):
        seen_m = objects.points.points_m[objects.segments == number]
        low, high = np.quantile(seen_m[:, 0], [0.01, 0.99])
        front_m = float(np.quantile(seen_m[:, 1], 0.05))
        beside_m = max(low - point_m[0], point_m[0] - high, 0.0)
        off_m = float(np.hypot(beside_m, front_m - point_m[1]))
        if off_m < apart_m:
            nearest, apart_m = number, off_m
    return nearest


def _texts(lines: Sequence[TextLine]) -> tuple[str, str]:
    """Return all text, and what of it is written large; what is said twice counts once."""
    largest = max(line.height_px for line in lines)
    title = {
        plain(line.text): line.text for line in lines if line.height_px >= TITLE_SHARE * largest
    }
    return " ".join(line.text for line in lines), " ".join(title.values())


def _doubt(readings: Floats) -> Floats:
    """Return the entropy of readings over names [bit]; what is unknown is no doubt among names."""
    named = readings[:, :-1] / readings[:, :-1].sum(axis=1, keepdims=True)
    bits: Floats = -(named * np.log2(named)).sum(axis=1)
    return bits
