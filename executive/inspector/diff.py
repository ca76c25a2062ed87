"""Where two runs first went apart, because of what, and what came of it."""

import difflib
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import PurePath
from typing import TypeVar

from executive.inspector.past import PastRun
from executive.inspector.run_events import Ended, RunEvents, Wrote

NOT_AGAIN = "did not run again"

T = TypeVar("T")


class DiffKind(StrEnum):
    """What differs; each is worse than the one before."""

    TIMING = "timing"
    VALUE = "value"
    OUTCOME = "outcome"


@dataclass(frozen=True, slots=True)
class Place:
    """Where one run is at a divergence.

    Attributes:
        tick: The tick; None where the run has nothing there.
        time_s: When it began, on the cell's clock [s].
        what: What the run has there, in words.
    """

    tick: int | None
    time_s: float | None
    what: str


@dataclass(frozen=True, slots=True)
class Divergence:
    """The first place where two runs differ in one way.

    Attributes:
        kind: Outcome, value or timing.
        name: Path of the leaf, or the full key.
        a: Where the first run is.
        b: Where the second run is.
        detail: What exactly differs.
        rank: How much had happened before.
        inputs: Keys that the node reads and that differed by then.
    """

    kind: DiffKind
    name: str
    a: Place
    b: Place
    detail: str
    rank: int
    inputs: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Consequence:
    """How differently one leaf ended over the whole runs.

    Attributes:
        path: Path of the leaf.
        matched: Ends that both runs have, in order.
        only_a: Ends that only the first has.
        only_b: Ends that only the second has.
    """

    path: str
    matched: int
    only_a: tuple[str, ...]
    only_b: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class RunDiff:
    """How two runs differ.

    Attributes:
        before: What differed before the first tick: seed, inputs, sources, versions.
        first: The first divergence of each kind, the earliest first.
        consequences: Leaves that ended otherwise, in the order of the tree.
        ends: How each of the two runs ended.
    """

    before: tuple[str, ...]
    first: tuple[Divergence, ...]
    consequences: tuple[Consequence, ...]
    ends: tuple[str, str]

    def differs(self, worst: DiffKind) -> bool:
        """Return whether they differ in a way that is as bad as `worst`, or worse."""
        ways = [*DiffKind]
        return any(ways.index(d.kind) >= ways.index(worst) for d in self.first)


def diff_runs(run_a: PastRun, run_b: PastRun, ignored: Sequence[str] = ()) -> RunDiff:
    """Compare two runs.

    Args:
        run_a: The one that is held to be right.
        run_b: The other.
        ignored: Globs of keys and fields (`trace.probability`) whose values count as equal.
    """
    a, b = RunEvents(run_a, ignored), RunEvents(run_b, ignored)
    found = [*_outcomes(a, b), *_values(a, b), *_timings(a, b)]
    first = [
        min(same, key=lambda d: d.rank)
        for kind in reversed(DiffKind)
        if (same := [d for d in found if d.kind is kind])
    ]
    # A value is written before its writer ends; what took longer shows at the end.
    first.sort(
        key=lambda d: (d.rank, [DiffKind.VALUE, DiffKind.OUTCOME, DiffKind.TIMING].index(d.kind))
    )
    return RunDiff(
        tuple(_before(run_a, run_b)),
        tuple(first),
        tuple(_consequences(a, b)),
        (_end(run_a), _end(run_b)),
    )


def _pairs(
    a: Mapping[str, list[T]], b: Mapping[str, list[T]]
) -> Iterator[tuple[str, list[T], list[T]]]:
    for name in dict.fromkeys([*a, *b]):
        yield name, a.get(name, []), b.get(name, [])


def _common(a: Sequence[Hashable], b: Sequence[Hashable]) -> int:
    """Return how many items two sequences begin with alike."""
    return next(
        (i for i, (x, y) in enumerate(zip(a, b, strict=False)) if x != y), min(len(a), len(b))
    )


def _outcomes(a: RunEvents, b: RunEvents) -> Iterator[Divergence]:
    for path, in_a, in_b in _pairs(a.outcomes, b.outcomes):
        same = _common([e.outcome for e in in_a], [e.outcome for e in in_b])
        if same == max(len(in_a), len(in_b)):
            continue
        at_a, at_b = _at(in_a, same), _at(in_b, same)
        rank = min(event.rank for event in (at_a, at_b) if event is not None)
        place_a = _ended_place(a, at_a) if at_a else _no_place(a, path)
        place_b = _ended_place(b, at_b) if at_b else _no_place(b, path)
        detail = f"{place_a.what} in A, {place_b.what} in B"
        inputs = tuple(_differing_inputs(a, b, path, at_a, at_b))
        yield Divergence(DiffKind.OUTCOME, path, place_a, place_b, detail, rank, inputs)


def _at(events: Sequence[T], place: int) -> T | None:
    return events[place] if place < len(events) else None


def _said(ended: Ended) -> str:
    status, code = ended.outcome
    return f"{status} ({code}{f': {ended.text}' if ended.text else ''})" if code else status


def _no_place(events: RunEvents, path: str) -> Place:
    """Return what a node did in a run that has no further outcome of it."""
    index, ended = events.run.index, events.outcomes.get(path, [])
    node = index.indices.get(path)
    lives = [] if node is None else index.activations(node)
    # An answer that is given again in tick after tick has been given once.
    again = bool(ended) and any(life.start > ended[-1].tick for life in lives)
    return Place(None, None, "answered the same ever after" if again else NOT_AGAIN)


def _ended_place(events: RunEvents, ended: Ended) -> Place:
    return Place(ended.tick, float(events.run.index.times_s[ended.tick]), _said(ended))


def _differing_inputs(
    a: RunEvents, b: RunEvents, path: str, at_a: Ended | None, at_b: Ended | None
) -> Iterator[str]:
    """Yield the keys that a node reads and that held different values when it started."""
    node = a.run.index.indices.get(path)
    if node is None or at_a is None or at_b is None:
        return
    for key in sorted(a.run.reads.get(node, ())):
        values = [
            _last(events, key, at.start)
            for events, at in ((a, at_a), (b, at_b))
            if key in events.writes
        ]
        if len(values) == 2 and values[0] != values[1]:
            yield key


def _last(events: RunEvents, key: str, tick: int) -> str | None:
    before = [wrote for wrote in events.writes[key] if wrote.tick <= tick]
    return events.digest(before[-1])[1] if before else None


def _values(a: RunEvents, b: RunEvents) -> Iterator[Divergence]:
    for key, in_a, in_b in _pairs(a.writes, b.writes):
        same = _common([a.digest(w) for w in in_a], [b.digest(w) for w in in_b])
        at_a, at_b = _at(in_a, same), _at(in_b, same)
        if at_a is None or at_b is None:
            # One run wrote it more often: that comes of an outcome, unless nothing else differs.
            if at_a is None and at_b is None:
                continue
            rank = min(wrote.rank for wrote in (at_a, at_b) if wrote is not None)
            detail = f"written {len(in_a)} times in A, {len(in_b)} times in B"
        else:
            rank = min(at_a.rank, at_b.rank)
            detail = first_difference(a.value(at_a), b.value(at_b)) or "written by another node"
        place_a, place_b = _wrote_place(a, at_a), _wrote_place(b, at_b)
        yield Divergence(DiffKind.VALUE, key, place_a, place_b, detail, rank)


def _wrote_place(events: RunEvents, wrote: Wrote | None) -> Place:
    if wrote is None:
        return Place(None, None, "not written again")
    by = events.run.names.of_path(wrote.writer) or "an input of the mission"
    return Place(wrote.tick, float(events.run.index.times_s[wrote.tick]), f"written by {by}")


def first_difference(a: object, b: object, at: str = "") -> str:
    """Return the first field in which two recorded values differ, with both values."""
    if isinstance(a, Mapping) and isinstance(b, Mapping) and a.keys() == b.keys():
        pairs = [(f"{at}.{key}", a[key], b[key]) for key in a]
    elif isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        pairs = [(f"{at}[{place}]", a[place], b[place]) for place in range(len(a))]
    elif isinstance(a, list) and isinstance(b, list):
        return f"{at or 'the value'} has {len(a)} items in A, {len(b)} in B"
    else:
        return "" if a == b else f"{at or 'the value'} is {_shown(a)} in A, {_shown(b)} in B"
    return next((found for name, x, y in pairs if (found := first_difference(x, y, name))), "")


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:59]}…"


def _timings(a: RunEvents, b: RunEvents) -> Iterator[Divergence]:
    period_s = 1.0 / a.run.recording.header.tick_hz
    for path, in_a, in_b in _pairs(a.outcomes, b.outcomes):
        for at_a, at_b in zip(in_a, in_b, strict=False):
            if at_a.outcome != at_b.outcome:
                break
            if abs(at_a.span_s - at_b.span_s) > 0.5 * period_s:
                detail = f"took {at_a.span_s:.2f} s in A, {at_b.span_s:.2f} s in B"
                rank = min(at_a.rank, at_b.rank)
                places = _ended_place(a, at_a), _ended_place(b, at_b)
                yield Divergence(DiffKind.TIMING, path, *places, detail, rank)
                break


def _consequences(a: RunEvents, b: RunEvents) -> Iterator[Consequence]:
    for path, in_a, in_b in _pairs(a.outcomes, b.outcomes):
        words_a = [" ".join(filter(None, e.outcome)) for e in in_a]
        words_b = [" ".join(filter(None, e.outcome)) for e in in_b]
        if words_a == words_b:
            continue
        same = _common(words_a, words_b)
        matcher = difflib.SequenceMatcher(None, words_a[same:], words_b[same:], autojunk=False)
        only_a: list[str] = []
        only_b: list[str] = []
        for tag, i, i_end, j, j_end in matcher.get_opcodes():
            if tag != "equal":
                only_a += words_a[same + i : same + i_end]
                only_b += words_b[same + j : same + j_end]
        matched = len(words_a) - len(only_a)
        yield Consequence(path, matched, tuple(only_a), tuple(only_b))


def _before(a: PastRun, b: PastRun) -> Iterator[str]:
    """Yield what differed before the first tick."""
    one, other = a.recording.header, b.recording.header
    for name in (
        "mission",
        "seed",
        "tick_hz",
        "timeout_s",
        "inputs",
        "scenario",
        "cell",
        "versions",
    ):
        found = first_difference(getattr(one, name), getattr(other, name))
        if found:
            yield found.replace("the value", name) if "the value" in found else f"{name}{found}"
    yield from _sources(a, b)


def _sources(a: PastRun, b: PastRun) -> Iterator[str]:
    texts = [
        {PurePath(source.file).name: source for source in run.recording.header.sources}
        for run in (a, b)
    ]
    for file in dict.fromkeys([*texts[0], *texts[1]]):
        in_a, in_b = texts[0].get(file), texts[1].get(file)
        if in_a is None or in_b is None:
            yield f"{file} is only in {'B' if in_a is None else 'A'}"
        elif in_a.sha256 != in_b.sha256:
            yield f"{file} was changed: {_first_line(in_a.text, in_b.text)}"
    if not texts[0] and [n.path for n in a.index.nodes] != [n.path for n in b.index.nodes]:
        yield "the trees have other nodes"


def _first_line(a: str, b: str) -> str:
    lines_a, lines_b = a.splitlines(), b.splitlines()
    at = _common(lines_a, lines_b)
    old, new = _at(lines_a, at), _at(lines_b, at)
    shown = [("ends" if line is None else repr(line.strip())) for line in (old, new)]
    return f"line {at + 1} is {shown[0]} in A, {shown[1]} in B"


def _end(run: PastRun) -> str:
    result = run.recording.result
    if result is None:
        return "has no result"
    because = f" ({result.report.reason})" if result.report.reason else ""
    return f"{result.report.outcome} after {result.report.sim_s:.1f} s{because}"
