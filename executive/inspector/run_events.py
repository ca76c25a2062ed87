"""A run as what happened in it, without when: leaves that ended and keys that were written.

Two runs are compared by these sequences, node by node and key by key, so one that took longer
somewhere is not different everywhere after.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cached_property

from executive.engine.ticks import NodeStatus
from executive.inspector.index import Activation
from executive.inspector.past import PastRun

CLOCKED = ("*.seconds",)
"""Fields that hold times of the machine's clock; they never agree."""

Outcome = tuple[str, str]
"""How a leaf ended: its status, and the code of its reason or an empty text."""


@dataclass(frozen=True, slots=True)
class Ended:
    """One leaf ended.

    Attributes:
        path: Path of the leaf.
        outcome: How.
        text: What it said about it.
        start: Tick in which it started.
        tick: Tick in which it ended.
        span_s: How long it took on the cell's clock [s].
        rank: How many leaves of the run had ended before.
    """

    path: str
    outcome: Outcome
    text: str
    start: int
    tick: int
    span_s: float
    rank: int


@dataclass(frozen=True, slots=True)
class Wrote:
    """One key was written.

    Attributes:
        key: The full key.
        writer: Path of the node that wrote.
        tick: When.
        position: Place among the writes of that tick.
        rank: How many leaves of the run had ended before that tick, and in it before the writer.
    """

    key: str
    writer: str
    tick: int
    position: int
    rank: int


class RunEvents:
    """What happened in one run."""

    def __init__(self, run: PastRun, ignored: Sequence[str]) -> None:
        """Gather it; values whose key or field matches a glob of `ignored` count as equal."""
        self.run, self._ignored = run, (*CLOCKED, *ignored)
        self.outcomes: dict[str, list[Ended]] = {}
        for ended in self._all_ended():
            self.outcomes.setdefault(ended.path, []).append(ended)

    @cached_property
    def writes(self) -> dict[str, list[Wrote]]:
        """Writes by key, in order."""
        ranks = {(e.path, e.tick): e.rank for ends in self.outcomes.values() for e in ends}
        before = self._ended_before()
        return {
            key: [
                Wrote(
                    key,
                    place.writer,
                    place.tick,
                    place.position,
                    ranks.get((place.writer, place.tick), before[place.tick]),
                )
                for place in places
            ]
            for key, places in self.run.index.writes.items()
            if not any(fnmatchcase(key, pattern) for pattern in self._ignored)
        }

    def value(self, wrote: Wrote) -> object:
        """Return a written value without what is ignored; images by what is in them."""
        value = self.run.recording.tick(wrote.tick).writes[wrote.position].value
        return self._kept(value, wrote.key)

    def digest(self, wrote: Wrote) -> tuple[str, str]:
        """Return the writer and a hash of what it wrote."""
        text = json.dumps(self.value(wrote), sort_keys=True)
        return wrote.writer, hashlib.blake2b(text.encode(), digest_size=8).hexdigest()

    def _kept(self, value: object, name: str) -> object:
        if isinstance(value, list | tuple):
            return [self._kept(item, name) for item in value]
        if not isinstance(value, Mapping):
            return value
        if value.get("$type") == "image" and "image" in value:
            return {**value, "image": self._images.get(int(value["image"]), "missing")}
        return {
            field: self._kept(item, f"{name}.{field}")
            for field, item in value.items()
            if not self._is_ignored(f"{name}.{field}")
            and not (field == "array" and "hash" in value)
        }

    def _is_ignored(self, name: str) -> bool:
        short = name.rpartition(":")[2]
        return any(fnmatchcase(name, p) or fnmatchcase(short, p) for p in self._ignored)

    @cached_property
    def _images(self) -> dict[int, str]:
        return {
            image.number: hashlib.blake2b(image.png, digest_size=8).hexdigest()
            for image in self.run.recording.images()
        }

    def _all_ended(self) -> Iterator[Ended]:
        index = self.run.index
        lives = [
            life
            for node in range(len(index.nodes))
            if not index.children[node]
            for life in _told(self.run, node)
        ]
        order: dict[int, dict[int, int]] = {}
        for life in lives:
            if life.end not in order:
                visited = index.recording.tick(life.end).visited
                order[life.end] = {node: place for place, node in enumerate(visited)}
        last = len(index.nodes)
        lives.sort(key=lambda life: (life.end, order[life.end].get(life.node, last), life.node))
        for rank, life in enumerate(lives):
            reason = index.reason(life.node, life.end)
            code = "" if reason is None else reason.code
            yield Ended(
                index.nodes[life.node].path,
                (_WORDS[life.status], code),
                "" if reason is None else reason.text,
                life.start,
                life.end,
                index.span_s(life),
                rank,
            )

    def _ended_before(self) -> list[int]:
        """Return for each tick how many leaves had ended before it."""
        counts = [0] * (len(self.run.index) + 1)
        for ends in self.outcomes.values():
            for ended in ends:
                counts[ended.tick + 1] += 1
        for tick in range(1, len(counts)):
            counts[tick] += counts[tick - 1]
        return counts


_WORDS = {
    NodeStatus.SUCCESS: "SUCCESS",
    NodeStatus.FAILURE: "FAILURE",
    NodeStatus.INVALID: "halted",
    NodeStatus.RUNNING: "running at the end",
}


def _told(run: PastRun, node: int) -> Iterator[Activation]:
    """Yield the lives of a leaf; one that answers the same tick after tick is told once.

    How often a condition of a reactive branch is asked is a matter of time, not of outcome.
    """
    before: Activation | None = None
    for life in run.index.activations(node):
        instant = life.start == life.end
        again = before is not None and before.start == before.end == life.end - 1
        if not (again and instant and before is not None and before.status is life.status):
            yield life
        before = life
