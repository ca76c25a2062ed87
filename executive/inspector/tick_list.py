"""What each tick changed, with ticks that repeat each other told once."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

from executive.engine.ticks import RUNNER
from executive.inspector.brief import brief
from executive.inspector.index import FAILURE, INVALID, RUNNING, STATUSES, RunIndex
from executive.inspector.search import spans

_LONGEST_PATTERN = 8


@dataclass(frozen=True, slots=True)
class Event:
    """One thing that a tick changed.

    Attributes:
        what: Status that a node got, `write` or `fault`.
        name: Path of the node, or the full key.
        text: Why it failed, who halted it, or the value that was written.
        writer: Path of the node that wrote, empty otherwise.
    """

    what: str
    name: str
    text: str
    writer: str = ""


@dataclass(frozen=True, slots=True)
class TickEvents:
    """What one tick changed.

    Attributes:
        tick: Its number.
        time_s: When it began, on the cell's clock [s].
        duration_s: How long it took [s].
        events: What it changed, in the order of the tree, then writes, then faults.
    """

    tick: int
    time_s: float
    duration_s: float
    events: tuple[Event, ...]


@dataclass(frozen=True, slots=True)
class Stretch:
    """Ticks that go on like those before them.

    Attributes:
        first: First tick that is not told.
        last: Last tick that is not told.
        period: How many ticks, told just before, happen over and over; 0 where nothing happens.
        values: Keys whose values may differ all the same.
    """

    first: int
    last: int
    period: int
    values: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TickFilter:
    """Which part of a run is told.

    Attributes:
        nodes: Indices of the nodes.
        keys: Glob of keys; None for all.
        first: First tick.
        last: Last tick.
        only: Ticks to tell; None for all between first and last.
    """

    nodes: frozenset[int]
    keys: str | None
    first: int
    last: int
    only: frozenset[int] | None = None


def tick_list(index: RunIndex, asked: TickFilter) -> Iterator[TickEvents | Stretch]:
    """Return what ticks changed, in order; what repeats is one stretch."""
    if asked.only is None:
        yield from _told(index, asked, range(asked.first, asked.last + 1))
        return
    for first, last in spans(sorted(asked.only)):
        yield from _told(index, asked, range(first, last + 1))


def _told(
    index: RunIndex, asked: TickFilter, numbers: Sequence[int]
) -> Iterator[TickEvents | Stretch]:
    shapes = [_shape(index, asked, number) for number in numbers]
    place = 0
    while place < len(numbers):
        if not shapes[place]:
            end = _run_end(shapes, place)
            yield Stretch(numbers[place], numbers[end - 1], 0, ())
            place = end
            continue
        period, end = _repetition(shapes, place)
        yield from (_events(index, asked, number) for number in numbers[place : place + period])
        if end > place + period:
            values = tuple(sorted({n for s in shapes[place:end] for n in s if n.startswith("=")}))
            keys = tuple(name[1:] for name in values)
            yield Stretch(numbers[place + period], numbers[end - 1], period, keys)
        place = end


def _shape(index: RunIndex, asked: TickFilter, tick: int) -> tuple[str, ...]:
    """Return what happened in a tick without its values; empty where nothing did."""
    shape = [f"{node} {index.statuses[tick, node]}" for node in _changed(index, asked, tick)]
    said = index.outcome_codes.get(tick, ())
    shape += [f"{node} {status} {code}" for node, status, code in said if node in asked.nodes]
    shape += [
        f"={place.key}" for place in index.writes_in.get(tick, []) if _wanted(asked, place.key)
    ]
    return (*shape, *(fault.message for fault in index.faults.get(tick, ())))


def _wanted(asked: TickFilter, key: str) -> bool:
    name = key.rpartition(":")[2]
    return asked.keys is None or fnmatchcase(key, asked.keys) or fnmatchcase(name, asked.keys)


def _run_end(shapes: Sequence[tuple[str, ...]], place: int) -> int:
    end = place
    while end < len(shapes) and shapes[end] == shapes[place]:
        end += 1
    return end


def _repetition(shapes: Sequence[tuple[str, ...]], place: int) -> tuple[int, int]:
    """Return the period of what begins at a place, and where it ends; (1, place + 1) for none."""
    for period in range(1, _LONGEST_PATTERN + 1):
        end = place + period
        while end < len(shapes) and shapes[end] == shapes[end - period]:
            end += 1
        rounds = (end - place) // period
        if rounds >= 3 or (period == 1 and rounds == 2):
            return period, place + rounds * period
    return 1, place + 1


def _events(index: RunIndex, asked: TickFilter, tick: int) -> TickEvents:
    return TickEvents(
        tick,
        float(index.times_s[tick]),
        float(index.durations_s[tick]),
        (*_changes(index, asked, tick), *_others(index, asked, tick)),
    )


def _changes(index: RunIndex, asked: TickFilter, tick: int) -> Iterator[Event]:
    said = {node for node, _, _ in index.outcome_codes.get(tick, ())}
    for node in sorted({*_changed(index, asked, tick), *(said & asked.nodes)}):
        status = index.answers[tick, node] if node in said else index.statuses[tick, node]
        yield Event(STATUSES[status].value, index.nodes[node].path, why_so(index, node, tick))


def _changed(index: RunIndex, asked: TickFilter, tick: int) -> list[int]:
    """Return the nodes that got another status, save those that were done and were put back.

    A parent that starts anew puts its children back; nothing happened to them.
    """
    after = index.statuses[tick]
    before = index.statuses[tick - 1] if tick else np.zeros_like(after)
    changed = (before != after) & ((after != INVALID) | (before == RUNNING))
    return [node for node in np.flatnonzero(changed).tolist() if node in asked.nodes]


def why_so(index: RunIndex, node: int, tick: int) -> str:
    """Return why a node became what it is in a tick: its reason, or who halted it."""
    by = index.halted_by(node, tick)
    if by is not None:
        return "halted by the runner" if by == RUNNER else f"halted by {index.nodes[by].path}"
    reason = index.reason(node, tick) if index.answers[tick, node] == FAILURE else None
    return "" if reason is None else str(reason)


def _others(index: RunIndex, asked: TickFilter, tick: int) -> Iterator[Event]:
    for place in index.writes_in.get(tick, []):
        if _wanted(asked, place.key):
            yield Event("write", place.key, brief(index.value_at(place)), place.writer)
    for fault in index.faults.get(tick, ()):
        yield Event("fault", fault.path, fault.message)
