"""One object in several looks: which sighting is which object, and what it is by all readings."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from perception.shelf.beliefs import OUT_OF_VIEW, SeenObject
from perception.shelf.casting import BoxCaster
from perception.shelf.completing import beside, clear_of
from perception.shelf.detections import LEAST, Detections, entropy_bits
from perception.shelf.planning.room import footprints
from perception.shelf.sightings import sightings
from perception.shelf.stock import Stock
from perception.shelf.types import Box, Floats, ShelfView, Sighting, corners

# Sightings that fit an object worse are those of another one; see `_misfits`.
WORST_FIT = 0.7
# An object is gone when this share of where it stood is seen to be free.
GONE = 0.3
MARGIN_M = 0.02
# What is seen of an object is where it was known to be, when it lies so far beside that at most.
SAME_M = 0.006
UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """A depth image with what a detector made of it.

    Attributes:
        view: Depth and segments; its labels are the best names of this look alone.
        detections: What was detected.
        caster: Rays of the camera.
    """

    view: ShelfView
    detections: Detections
    caster: BoxCaster


def tracked(look: Look, before: Sequence[SeenObject], stock: Stock) -> tuple[SeenObject, ...]:
    """Return all objects that are known after a look.

    Of several readings of an object the one with the least entropy is kept (thesis, section 6.2).
    No two objects have one name: the stock has one of each.

    Args:
        look: The look.
        before: Objects known before it, where they are believed to stand now.
        stock: Sizes and names.
    """
    labels = unique_names(look.detections.probabilities, stock.names)
    seen = _sighted(look, labels, stock)
    partners = _partners(seen, look.detections, before)
    readings = look.detections.probabilities.copy()
    for number, partner in partners.items():
        both = np.array([readings[number], before[partner].probabilities])
        readings[number] = both[int(np.argmin(entropy_bits(both)))]
    kept = _kept(look, [before[i] for i in range(len(before)) if i not in partners.values()])
    rows = np.vstack([readings, *(one.probabilities[None] for one in kept)])
    names = unique_names(rows, stock.names)
    if names[: len(readings)] != labels:
        seen = _sighted(look, names[: len(readings)], stock)
    shares = _shares(look, seen)
    fresh = tuple(
        _measured(
            SeenObject(
                names[number],
                _certainty(rows[number], names[number], stock),
                rows[number],
                sighting.box,
                sighting.sure,
                sighting.loose_m,
                sighting.box,
                number,
                shares[number],
                shares[number],
            ),
            before[partners[number]] if number in partners else None,
        )
        for number, sighting in seen.items()
    )
    hidden = tuple(
        replace(one, label=name, certainty=_certainty(one.probabilities, name, stock))
        for one, name in zip(kept, names[len(readings) :], strict=True)
    )
    return _settled(fresh + hidden)


def unique_names(rows: Floats, names: tuple[str, ...]) -> tuple[str, ...]:
    """Give objects different names so that their probability is greatest together.

    Args:
        rows: Probabilities of the names, shape (K, N).
        names: The names.
    """
    rest = np.maximum(1.0 - rows.sum(axis=1), LEAST)
    # Each object may also have no name, on its own.
    none = np.where(np.eye(len(rows), dtype=bool), rest[:, None], LEAST**2)
    costs = -np.log(np.maximum(np.hstack([rows, none]), LEAST**2))
    _, picked = linear_sum_assignment(costs)
    unknown = iter(range(1, len(rows) + 1))
    return tuple(
        names[pick] if pick < len(names) else f"{UNKNOWN} {next(unknown)}" for pick in picked
    )


def _certainty(row: Floats, name: str, stock: Stock) -> float:
    if name in stock.names:
        return float(row[stock.names.index(name)])
    return float(max(1.0 - row.sum(), 0.0))


def _sighted(look: Look, labels: tuple[str, ...], stock: Stock) -> dict[int, Sighting]:
    """Return sightings by number of their segment; without depth there is none."""
    view = replace(look.view, labels=labels)
    found = sightings(view, stock.shelf, stock.sizes_m, look.caster)
    return {labels.index(sighting.label): sighting for sighting in found}


def _partners(
    seen: dict[int, Sighting], detections: Detections, before: Sequence[SeenObject]
) -> dict[int, int]:
    """Return which object known before each segment shows, where it shows one."""
    if not seen or not before:
        return {}
    numbers = list(seen)
    here = footprints([seen[number].box for number in numbers])
    there = footprints([one.box for one in before])
    known = np.array([one.probabilities for one in before])
    misfits = 1.0 - 0.5 * _overlap_shares(here, there)
    misfits -= 0.5 * _agreement(detections.probabilities[numbers], known)
    rows, columns = linear_sum_assignment(misfits)
    return {
        numbers[row]: int(column)
        for row, column in zip(rows, columns, strict=True)
        if misfits[row, column] < WORST_FIT
    }


def _overlap_shares(here: Floats, there: Floats) -> Floats:
    """Return intersection over union of footprints, shape (K, M)."""
    low = np.maximum(here[:, None, :2], there[None, :, :2])
    high = np.minimum(here[:, None, 2:], there[None, :, 2:])
    common = np.maximum(high - low, 0.0).prod(axis=2)
    areas = [(rows[:, 2:] - rows[:, :2]).prod(axis=1) for rows in (here, there)]
    shares: Floats = common / (areas[0][:, None] + areas[1][None] - common)
    return shares


def _agreement(here: Floats, there: Floats) -> Floats:
    """Return how much of two readings agrees, shape (K, M): the overlap of distributions."""
    rest = [np.maximum(1.0 - rows.sum(axis=1, keepdims=True), 0.0) for rows in (here, there)]
    one, other = np.hstack([here, rest[0]]), np.hstack([there, rest[1]])
    shares: Floats = np.minimum(one[:, None], other[None]).sum(axis=2)
    return shares


def _measured(now: SeenObject, before: SeenObject | None) -> SeenObject:
    """Return an object where all that was measured of it agrees."""
    if before is None:
        return now
    now = replace(now, first=before.first)
    sure, known = footprints([now.sure, before.box])
    wide_m = SAME_M + np.array(before.loose_m)
    inside = (sure[:2] > known[:2] - wide_m).all() and (sure[2:] < known[2:] + wide_m).all()
    if not inside or now.box.size_m != before.box.size_m:
        return now
    better = before if before.measured > now.share else now
    x_m, loose_x_m = _agreed(now.box.x_m, before.box.x_m, better.box.x_m, now, before, 0)
    y_m, loose_y_m = _agreed(now.box.y_m, before.box.y_m, better.box.y_m, now, before, 1)
    return replace(
        now, box=now.box.at(x_m, y_m), loose_m=(loose_x_m, loose_y_m), measured=better.measured
    )


def _agreed(
    here_m: float, there_m: float, better_m: float, now: SeenObject, before: SeenObject, axis: int
) -> tuple[float, float]:
    """Return the middle of where two ranges overlap and how loose it is; else the better one."""
    loose_m, was_m = now.loose_m[axis], before.loose_m[axis]
    low_m, high_m = max(here_m - loose_m, there_m - was_m), min(here_m + loose_m, there_m + was_m)
    if low_m <= high_m and max(loose_m, was_m) > SAME_M:
        return 0.5 * (low_m + high_m), 0.5 * (high_m - low_m)
    if abs(loose_m - was_m) > SAME_M:
        return (here_m, loose_m) if loose_m < was_m else (there_m, was_m)
    return better_m, min(loose_m, was_m)


def _settled(objects: tuple[SeenObject, ...]) -> tuple[SeenObject, ...]:
    """Return objects whose place is loose in the middle of where no other one stands."""
    sure = footprints([one.sure for one in objects])
    settled = []
    for index, one in enumerate(objects):
        places_m = _tried(one)
        if len(places_m) > 1:
            others = sure[beside([each.sure for each in objects], index)]
            free = clear_of(one.box, places_m, others)
            if free.any() and not free.all():
                low_m, high_m = float(places_m[free, 0].min()), float(places_m[free, 0].max())
                box = one.box.at(0.5 * (low_m + high_m), one.box.y_m)
                one = replace(one, box=box, loose_m=(0.5 * (high_m - low_m), one.loose_m[1]))
        settled.append(one)
    return tuple(settled)


def _tried(one: SeenObject) -> Floats:
    """Return places along x where an object that is loose may stand, shape (K, 2)."""
    loose_m = one.loose_m[0] if one.loose_m[0] > SAME_M else 0.0
    count = 1 + round(2.0 * loose_m / SAME_M)
    x_m = one.box.x_m + np.linspace(-loose_m, loose_m, count)
    return np.column_stack([x_m, np.full(count, one.box.y_m)])


def _shares(look: Look, seen: dict[int, Sighting]) -> dict[int, float]:
    """Return how much of each object's silhouette its segment covers."""
    shown = look.caster.cast(*corners([sighting.box for sighting in seen.values()]))
    whole = shown.sums(np.ones(len(shown.pixel)))
    return {
        number: float(min(1.0, sighting.mask.sum() / max(pixels, 1.0)))
        for (number, sighting), pixels in zip(seen.items(), whole, strict=True)
    }


def _kept(look: Look, unseen: Sequence[SeenObject]) -> list[SeenObject]:
    """Return those of the objects that are not in view which may stand where they stood."""
    shown = look.caster.cast(*corners([_core(one.box) for one in unseen]))
    depth_m = look.view.depth_m.ravel()[shown.pixel]
    free = shown.sums((depth_m > shown.depth_m + MARGIN_M).astype(np.float64))
    whole = np.maximum(shown.sums(np.ones(len(shown.pixel))), 1.0)
    return [
        replace(one, number=OUT_OF_VIEW, share=0.0)
        for one, share in zip(unseen, free / whole, strict=True)
        if share < GONE
    ]


def _core(box: Box) -> Box:
    """Return the middle of a box, whose place is known to some millimetres alone."""
    width_m, depth_m, height_m = box.size_m
    return replace(box, size_m=(0.8 * width_m, 0.8 * depth_m, 0.9 * height_m))
