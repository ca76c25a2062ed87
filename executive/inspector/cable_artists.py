"""How recorded values of `perception.cable.types` are drawn."""

from collections.abc import Iterator, Mapping
from typing import Any

from executive.inspector.shapes import Colour, Pixel, Shape

# Beliefs below these are shown as doubtful, and as bad.
_SURE, _UNSURE = 0.9, 0.7
_ARROW_PX = 28.0


def trace(value: Mapping[str, Any]) -> Iterator[Shape]:
    """Draw a `Trace` as a line through the rainbow, with its belief at its end."""
    points = _points(value["points_px"])
    probability, end = value["probability"], value["end"]["value"]
    about = f"trace: P = {probability:.3f}, ends at {end}"
    yield Shape("line", points, "path", about=about)
    if points:
        yield Shape("dot", points[-1:], _colour(probability), f"{end} {probability:.2f}", about)


def endpoint(value: Mapping[str, Any]) -> Iterator[Shape]:
    """Draw an `Endpoint` as a ring, with an arrow into the cable."""
    at, probability = _point(value["position_px"]), value["probability"]
    yield Shape("ring", (at,), "end", about=f"endpoint: P = {probability:.3f}")
    yield Shape("arrow", (at, _towards(at, value["direction"])), "end")


def crossing(value: Mapping[str, Any]) -> Iterator[Shape]:
    """Draw a `Crossing` as a dot with the belief that it is this way round."""
    probability = value["probability"]
    about = (
        f"crossing: over at {value['arc_over']:.3f}, under at {value['arc_under']:.3f} "
        f"of the trace, P = {probability:.3f}"
    )
    label = f"{probability:.2f}" if probability < _SURE else ""
    yield Shape("dot", (_point(value["position_px"]),), _colour(probability), label, about)


def knot(value: Mapping[str, Any]) -> Iterator[Shape]:
    """Draw a `Knot` as the two places to hold it, with the directions of the cable there."""
    for hand in ("cage", "pinch"):
        at = _point(value[f"{hand}_px"])
        yield Shape("ring", (at,), "hand", hand, f"{hand} of the knot")
        yield Shape("arrow", (at, _towards(at, value[f"{hand}_direction"])), "hand")


def _colour(probability: float) -> Colour:
    if probability >= _SURE:
        return "good"
    return "doubtful" if probability >= _UNSURE else "bad"


def _points(array: Mapping[str, Any]) -> tuple[Pixel, ...]:
    return tuple((float(x), float(y)) for x, y in array.get("values", ()))


def _point(array: Mapping[str, Any]) -> Pixel:
    x, y = array["values"]
    return float(x), float(y)


def _towards(at: Pixel, direction: Mapping[str, Any]) -> Pixel:
    dx, dy = direction["values"]
    return at[0] + _ARROW_PX * dx, at[1] + _ARROW_PX * dy
