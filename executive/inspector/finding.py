"""The next tick in which something happened: a change, a failure, a write, what was asked for."""

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from executive.core.errors import InputError
from executive.core.registry import closest
from executive.inspector.index import FAILURE, RunIndex
from executive.inspector.search import search


@dataclass(frozen=True, slots=True)
class Wish:
    """What is looked for, and from where.

    Attributes:
        kind: `change` or `failure` of a node or of one below it, `write` of a key, or `where`
            an expression holds.
        start: Tick to look from; it is not found itself.
        forward: Whether later ticks are wanted.
        node: Path of the node, for changes and failures.
        key: Full name of the key, for writes.
        where: The expression.
    """

    kind: str
    start: int
    forward: bool = True
    node: str = ""
    key: str = ""
    where: str = ""


def found(index: RunIndex, wish: Wish) -> int | None:
    """Return the nearest tick that a wish asks for, None where there is none.

    Raises:
        InputError: It names what the recording does not have.
    """
    if wish.kind not in _KINDS:
        raise InputError(f"kind: got {wish.kind!r}; {closest(wish.kind, [*_KINDS])}")
    ticks = _KINDS[wish.kind](index, wish)
    if wish.forward:
        place = bisect_right(ticks, wish.start)
        return ticks[place] if place < len(ticks) else None
    place = bisect_left(ticks, wish.start)
    return ticks[place - 1] if place > 0 else None


def _changes(index: RunIndex, wish: Wish) -> Sequence[int]:
    statuses = index.statuses[:, _below(index, wish.node)]
    changed = (statuses[1:] != statuses[:-1]).any(axis=1)
    ticks: list[int] = (np.flatnonzero(changed) + 1).tolist()
    return ticks


def _failures(index: RunIndex, wish: Wish) -> Sequence[int]:
    failed = index.answers[:, _below(index, wish.node)] == FAILURE
    before = np.vstack([np.zeros_like(failed[:1]), failed[:-1]])
    ticks: list[int] = np.flatnonzero((failed & ~before).any(axis=1)).tolist()
    return ticks


def _writes(index: RunIndex, wish: Wish) -> Sequence[int]:
    if not wish.key:
        raise InputError("select a key of the blackboard first")
    return sorted({place.tick for place in index.writes.get(wish.key, ())})


def _where(index: RunIndex, wish: Wish) -> Sequence[int]:
    return search(index, wish.where)


def _below(index: RunIndex, path: str) -> list[int]:
    if path not in index.indices:
        raise InputError(f"no node {path!r}; {closest(path, [*index.indices])}")
    return [node for other, node in index.indices.items() if f"{other}/".startswith(f"{path}/")]


_KINDS: Mapping[str, Callable[[RunIndex, Wish], Sequence[int]]] = {
    "change": _changes,
    "failure": _failures,
    "where": _where,
    "write": _writes,
}
