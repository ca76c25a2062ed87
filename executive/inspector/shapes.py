"""Shapes that are laid over an image, in pixels of that image."""

from dataclasses import dataclass
from typing import Literal

Colour = Literal["path", "good", "doubtful", "bad", "hand", "end"]
Pixel = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Shape:
    """One thing to draw.

    Attributes:
        kind: A `line` through all points, or a `ring`, `dot` or `arrow` at the first; an arrow
            points to the second.
        points: Image points (x, y) [px].
        colour: What it means; a `path` runs through the colours of the rainbow.
        label: Text beside it; empty for none.
        about: What there is to know about it, shown when it is pointed at.
    """

    kind: Literal["line", "ring", "dot", "arrow"]
    points: tuple[Pixel, ...]
    colour: Colour
    label: str = ""
    about: str = ""
