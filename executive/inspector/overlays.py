"""What is laid over the image of a tick: the values of that look, in their recorded form.

A recorded value names its type, and an artist of that type turns it into shapes.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from executive.engine.recording.reader import KeyState
from executive.inspector import cable_artists
from executive.inspector.shapes import Shape

Artist = Callable[[Mapping[str, Any]], Iterator[Shape]]

ARTISTS: Mapping[str, Artist] = {
    "perception.cable.types.Crossing": cable_artists.crossing,
    "perception.cable.types.Endpoint": cable_artists.endpoint,
    "perception.cable.types.Knot": cable_artists.knot,
    "perception.cable.types.Trace": cable_artists.trace,
}


@dataclass(frozen=True, slots=True)
class Picture:
    """An image with what was believed about it.

    Attributes:
        image: Number of the image in the recording.
        size_px: Its width and height.
        key: Key that holds it.
        tick: Tick that wrote it.
        shapes: What to lay over it, keys in the order of their writing.
    """

    image: int
    size_px: tuple[int, int]
    key: str
    tick: int
    shapes: tuple[Shape, ...]


def picture_of(states: Mapping[str, KeyState]) -> Picture | None:
    """Return the latest image on a blackboard with all that was written since it was taken."""
    seen = [(state.tick, key, image) for key, state in states.items() for image in _images(state)]
    if not seen:
        return None
    tick, key, image = max(seen, key=lambda found: (found[0], found[2]["image"]))
    height, width = image["shape"][:2]
    later = sorted(
        (state for state in states.values() if state.tick >= tick), key=lambda state: state.tick
    )
    shapes = tuple(shape for state in later for shape in _drawn(state.value))
    return Picture(image["image"], (width, height), key, tick, shapes)


def _images(state: KeyState) -> Iterator[Mapping[str, Any]]:
    value = state.value
    candidates = [value, *value.values()] if isinstance(value, dict) else []
    for candidate in candidates:
        if isinstance(candidate, dict) and candidate.get("$type") == "image":
            yield candidate


def _drawn(value: Any) -> Iterator[Shape]:
    if isinstance(value, list):
        for item in value:
            yield from _drawn(item)
    elif isinstance(value, dict):
        kind = str(value.get("$type"))
        if kind in ARTISTS:
            yield from ARTISTS[kind](value)
        elif kind == "tuple":
            yield from _drawn(value["items"])
