"""Answers to `who` and `history`: who wrote a key, from what to what, and who reads it."""

from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from executive.inspector.brief import brief
from executive.inspector.index import WritePlace
from executive.inspector.past import PastRun


@dataclass(frozen=True, slots=True)
class Reader:
    """A node that reads a key by the wiring of the tree.

    Attributes:
        node: Index of the node.
        runs: Ticks in which it started between the write and the next one.
    """

    node: int
    runs: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Written:
    """One value of a key, from its write until the next.

    Attributes:
        place: The write.
        value: What was written, in one line.
        previous: The write before; None for the first.
        previous_value: What it was before, in one line; empty for the first.
        until: Tick of the next write; None when it was the last.
        readers: Who reads the key, and when they ran with this value.
    """

    place: WritePlace
    value: str
    previous: WritePlace | None
    previous_value: str
    until: int | None
    readers: tuple[Reader, ...]


def who_wrote(run: PastRun, key: str, tick: int) -> Written | None:
    """Return the value that a key had after a tick, None where it had none yet.

    Readers come from the wiring of the tree: which nodes read the key; which of them started
    (a condition: was asked) while it had this value comes from the recording.
    """
    places = run.index.writes[key]
    count = bisect_right(places, tick, key=lambda place: place.tick)
    return written_at(run, key, count - 1) if count else None


def written_at(run: PastRun, key: str, place: int) -> Written:
    """Return the write of a key at a place in its history, counted from 0."""
    places = run.index.writes[key]
    previous = places[place - 1] if place else None
    until = places[place + 1].tick if place + 1 < len(places) else None
    return Written(
        places[place],
        brief(run.index.value_at(places[place])),
        previous,
        "" if previous is None else brief(run.index.value_at(previous)),
        until,
        tuple(_readers(run, places, place)),
    )


def _readers(run: PastRun, places: Sequence[WritePlace], place: int) -> Iterator[Reader]:
    """Yield who reads a key, with the starts at which it had the value of one of its writes."""
    for node, keys in sorted(run.reads.items()):
        if places[place].key in keys:
            starts = [life.start for life in run.index.activations(node)]
            runs = (tick for tick in starts if _value_at(run, places, node, tick) == place)
            yield Reader(node, tuple(runs))


def _value_at(run: PastRun, places: Sequence[WritePlace], node: int, tick: int) -> int:
    """Return which write's value a node found when it was asked in a tick, -1 for none."""
    before = bisect_left(places, tick, key=lambda place: place.tick) - 1
    end = bisect_right(places, tick, key=lambda place: place.tick)
    if before + 1 == end:  # nothing was written in that tick: no need to look who came first
        return before
    run.board.at(tick, node)
    found = run.board.place(places[0].key)
    return -1 if found is None else places.index(found)
