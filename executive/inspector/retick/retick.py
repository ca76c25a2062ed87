"""Ticks a recorded run again and says where it goes another way."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from executive.core.registry import Registry
from executive.engine.ticks import NodeStatus
from executive.inspector.past import PastRun
from executive.inspector.retick.cause import Causes
from executive.inspector.retick.differences import Comparison, TickDifference
from executive.inspector.retick.program import reload_program
from executive.inspector.retick.replay import Repeated, Replay
from executive.inspector.retick.standins import Asked, Beyond, WhatIf

OUTSIDE = "outside the recording"


@dataclass(frozen=True, slots=True)
class Outside:
    """A skill that was asked in a tick in which the recording has no answer of it.

    Attributes:
        tick: The tick.
        path: The skill.
        why: What the recording knows of it.
    """

    tick: int
    path: str
    why: str


@dataclass(frozen=True, slots=True)
class Retick:
    """What came of ticking a run again.

    Attributes:
        ticks: Number of ticks that were ticked again and held against the recording.
        of_ticks: Number of ticks in the recording.
        nodes: Number of nodes of the tree that was ticked.
        first: The first tick that is not as it was; None where all are.
        causes: Why it is not, in lines.
        later_ticks: Number of ticks after the first that are not as they were.
        later_nodes: Nodes that do something else in these, and in how many ticks each.
        outside: Skills that were asked outside the recording, each once.
        recorded_end: How the run ended.
        end: How it ends now.
        moved: Leaves that are at another path, or have another name: then and now.
        added: Paths of nodes that are only in the tree that was ticked.
        removed: Paths of nodes that are only in the recording.
        notes: What else is to be known.
    """

    ticks: int
    of_ticks: int
    nodes: int
    first: TickDifference | None
    causes: tuple[str, ...]
    later_ticks: int
    later_nodes: tuple[tuple[str, int], ...]
    outside: tuple[Outside, ...]
    recorded_end: str
    end: str
    moved: tuple[tuple[str, str], ...]
    added: tuple[str, ...]
    removed: tuple[str, ...]
    notes: tuple[str, ...]

    @property
    def identical(self) -> bool:
        """Whether every tick of the recording was ticked again, and none went otherwise."""
        return self.first is None and not self.outside and self.ticks == self.of_ticks


def retick(
    run: PastRun,
    types: Registry[type],
    *,
    edited: Sequence[Path] = (),
    what_if: WhatIf | None = None,
    beyond: Beyond | None = None,
) -> Retick:
    """Tick a run again with what its skills answered, and hold it against the recording.

    Args:
        run: The recorded run.
        types: Types that ports may have, by name.
        edited: Files of trees that take the place of recorded ones.
        what_if: What is to be otherwise.
        beyond: What skills answer outside the recording; None to end there.

    Raises:
        InputError: The recording holds no trees, or other ones than its node table says.
        DocumentError: All that is wrong with the trees.
    """
    original = reload_program(run.recording.header, types)
    program = reload_program(run.recording.header, types, edited) if edited else original
    question = what_if or WhatIf()
    replay = Replay(run, original, program, types, what_if=question, beyond=beyond)
    return _Reticking(run, replay, question).result()


class _Reticking:
    """One comparison under way."""

    def __init__(self, run: PastRun, replay: Replay, question: WhatIf) -> None:
        self._run, self._replay, self._question = run, replay, question
        self._first: TickDifference | None = None
        self._causes: tuple[str, ...] = ()
        self._later: Counter[str] = Counter()
        self._later_ticks, self._ticks = 0, 0
        self._last: Repeated | None = None

    def result(self) -> Retick:
        comparison = Comparison(self._replay, self._run.index)
        for repeated in self._replay.ticks():
            self._take(repeated, comparison.of(repeated))
        tree, index, recorded = self._replay.tree, self._run.index, self._replay.recorded
        pairs = [(tree.nodes[new].path, old) for new, old in enumerate(recorded)]
        known = {old for old in recorded if old is not None}
        return Retick(
            ticks=self._ticks,
            of_ticks=self._replay.script.length,
            nodes=len(recorded),
            first=self._first,
            causes=self._causes,
            later_ticks=self._later_ticks,
            later_nodes=tuple(self._later.most_common()),
            outside=tuple(self._outside()),
            recorded_end=self._recorded_end(),
            end=self._end(),
            moved=tuple(
                (index.nodes[old].path, path)
                for path, old in pairs
                if old is not None and index.nodes[old].path != path
            ),
            added=tuple(path for path, old in pairs if old is None),
            removed=tuple(node.path for old, node in enumerate(index.nodes) if old not in known),
            notes=tuple(self._notes()),
        )

    def _notes(self) -> Iterator[str]:
        """Yield why a value that was set may have changed nothing."""
        tick = self._question.tick
        for setting in self._question.values:
            name = setting.key.rpartition(":")[2]
            if setting not in self._replay.set_values:
                yield f"{name} had that value already"
            for place in self._run.index.writes_in.get(tick, ()):
                if place.key == setting.key:
                    writer = self._run.names.of_path(place.writer)
                    yield f"{name} was written by {writer} in tick {tick} itself, after it was set"

    def _take(self, repeated: Repeated, found: TickDifference | None) -> None:
        if repeated.recorded.number < self._replay.script.length:
            self._last = repeated
            self._ticks += not repeated.outside
        if found is None:
            return
        if self._first is None:
            self._first, self._causes = found, self._explained(found)
            return
        self._later_ticks += 1
        self._later.update(node.path for node in found.nodes)

    def _explained(self, found: TickDifference) -> tuple[str, ...]:
        return Causes(self._run, self._replay).of(found)

    def _outside(self) -> Iterator[Outside]:
        first: dict[int, Asked] = {}
        for asked in self._replay.stand_ins.outside:
            first.setdefault(asked.node, asked)
        for asked in first.values():
            path = self._replay.tree.nodes[asked.node].path
            yield Outside(asked.tick, path, self._known_of(asked))

    def _known_of(self, asked: Asked) -> str:
        if asked.recorded is None:
            return "it is only in the edited tree"
        ticks = self._run.index.answers[:, asked.recorded].nonzero()[0]
        later = ticks[ticks > asked.tick]
        if not len(ticks):
            return "it was never asked in the run"
        when = f"next in tick {later[0]}" if len(later) else f"last in tick {ticks[-1]}"
        return f"it was asked {when} of the run"

    def _recorded_end(self) -> str:
        result, last = self._run.recording.result, self._replay.script.length - 1
        if result is None:
            return f"the recording ends at tick {last}: the run was killed"
        return f"{result.report.outcome} at tick {last}"

    def _end(self) -> str:
        last = self._last
        if last is None:
            return "no tick was ticked again"
        number = last.recorded.number
        if last.outside:
            return f"{OUTSIDE} at tick {number}"
        if last.error is not None:
            return f"error at tick {number}: {last.error}"
        root = last.answers.get(0, NodeStatus.RUNNING)
        if root is NodeStatus.RUNNING:
            return f"still running at tick {number}, where the recording ends"
        return f"{root.value.lower()} at tick {number}"
