"""Ticks a recorded run again: same times, same answers of skills, everything else anew."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

from py_trees.behaviour import Behaviour

from executive.core.clock import ManualClock
from executive.core.errors import InputError, NodeError
from executive.core.registry import Registry
from executive.engine.nodes.builder import BuiltTree, build
from executive.engine.nodes.skill_node import SkillBehaviour
from executive.engine.running.probe import TreeProbe
from executive.engine.running.stopping import stop_running
from executive.engine.ticks import NodeStatus, Tick
from executive.inspector.index import RUNNING
from executive.inspector.past import PastRun
from executive.inspector.rebuilt import Rebuilt
from executive.inspector.retick.matching import matched
from executive.inspector.retick.program import ReloadedProgram
from executive.inspector.retick.question import changed
from executive.inspector.retick.script import RecordedScript
from executive.inspector.retick.standins import Beyond, OutsideError, Setting, StandIns, WhatIf
from executive.inspector.retick.values import ReplayBoard

WHAT_IF = "what-if"
"""Writer of the values that a question sets."""


@dataclass(frozen=True, slots=True)
class Repeated:
    """One tick that was ticked again.

    Attributes:
        recorded: Its record.
        tick: What it did now.
        answers: What each node that was asked answered now, by index.
        error: What ended the run in it; None where nothing did.
        outside: Whether that was a skill that the recording knows no answer of.
    """

    recorded: Tick
    tick: Tick
    answers: Mapping[int, NodeStatus]
    error: NodeError | None = None
    outside: bool = False


class Replay:
    """One run that is ticked again, with the same tree or an edited one; use it once.

    Attributes:
        tree: The tree that is ticked.
        board: Its values.
        recorded: Index in the recording of each of its nodes, None where it has none.
        written: Its trees as they are written, with the values of now.
        stand_ins: What answers for its skills.
        script: What the recording says.
        set_values: Values that the question has changed so far.
    """

    def __init__(
        self,
        run: PastRun,
        original: ReloadedProgram,
        program: ReloadedProgram,
        types: Registry[type],
        *,
        what_if: WhatIf = WhatIf(),  # noqa: B008 - frozen
        beyond: Beyond | None = None,
    ) -> None:
        """Build the tree.

        Args:
            run: What was recorded.
            original: The trees that it was run from.
            program: The trees to tick; the same, or edited ones.
            types: Types that ports may have.
            what_if: What is otherwise.
            beyond: What skills answer outside the recording; None to end there.

        Raises:
            InputError: The trees are not those that were recorded.
        """
        self._run, self._what_if = run, what_if
        classes = tuple(types.get(name) for name in types)
        self._clock = ManualClock()
        self._values = (run.recording, classes)
        self.board = ReplayBoard(*self._values)
        self.script = RecordedScript(run.index)
        before = self._built(original, ReplayBoard(*self._values))
        _require_recorded(run, before)
        self.tree = self._built(program, self.board)
        self.written = Rebuilt(
            run.recording.header.model_copy(update={"sources": program.sources}), self.board
        )
        self.recorded = matched(self.tree.nodes, run.index, run.trees, self.written)
        self.stand_ins = StandIns(
            self.script,
            self.tree,
            self.recorded,
            dict(_wired_outputs(before)),
            what_if=what_if,
            beyond=beyond,
        )
        if self.script.meddled_nodes:
            self.board.filter_with(self.script.rewritten)
        self._probe = TreeProbe(self.tree, self.stand_ins.intercept)
        self._pauses_over = 0
        self.set_values: list[Setting] = []

    @cached_property
    def current(self) -> dict[int, int]:
        """Index in this tree by index in the recording."""
        return {old: new for new, old in enumerate(self.recorded) if old is not None}

    def ticks(self) -> Iterator[Repeated]:
        """Tick until this run, or the recording, is over; what the runner stopped comes last."""
        for number in range(self.script.length):
            repeated = self._tick(number)
            yield repeated
            if repeated.outside:
                return
            if repeated.error is not None or self._answers_early():
                break
        if self.script.length < len(self._run.index) and number == self.script.length - 1:
            yield self._end(number + 1)

    def _answers_early(self) -> bool:
        """Return whether the root has answered in a tick after which the run went on."""
        return self._probe.answer is not NodeStatus.RUNNING and self.script.answer(0) == RUNNING

    def _tick(self, number: int) -> Repeated:
        recorded = self.script.at(number)
        self._clock.sleep_until(recorded.time_s)
        pauses = self.script.pauses_before(recorded.time_s)
        for pause in pauses[self._pauses_over :]:
            self.tree.clock.skip(pause.lasted_s)
        self._pauses_over = len(pauses)
        if number == self._what_if.tick:
            self._set_values()
        tick, error = self._probe.tick(number, recorded.time_s)
        self.tree.supervision.drain()
        outside = error is not None and isinstance(error.__cause__, OutsideError)
        return Repeated(recorded, tick, self._probe.answers, error, outside)

    def _end(self, number: int) -> Repeated:
        recorded = self.script.at(number)
        self._clock.sleep_until(recorded.time_s)

        def error_of(behaviour: Behaviour, cause: BaseException) -> NodeError:
            return self._probe.error_of(behaviour, number, cause)

        stop_running(self.tree.root, self._probe.raised, error_of)
        tick = self._probe.record_end(number, recorded.time_s, ())
        return Repeated(recorded, tick, {})

    def _set_values(self) -> None:
        for setting in self._what_if.values:
            current = self.board.read(setting.key) if setting.key in self.board else None
            value = changed(current, setting, setting.fields)
            if not self.board.holds(setting.key, self.board.form(value)):
                self.board.write(setting.key, value, WHAT_IF)
                self.set_values.append(setting)

    def _built(self, program: ReloadedProgram, board: ReplayBoard) -> BuiltTree:
        header = self._run.recording.header
        return build(
            program.program,
            devices={},
            clock=self._clock,
            inputs=dict(header.inputs),
            seed=header.seed,
            blackboard=board,
        )


def _require_recorded(run: PastRun, tree: BuiltTree) -> None:
    recorded = [(node.path, node.kind) for node in run.index.nodes]
    built = [(node.path, node.kind) for node in tree.nodes]
    if recorded != built:
        first = next((a for a, b in zip(recorded, built, strict=False) if a != b), recorded[-1])
        raise InputError(
            f"{run.recording.path}: its sources do not give the tree that was recorded; got other "
            f"nodes from {first[0]} on; expected a recording of this version"
        )


def _wired_outputs(tree: BuiltTree) -> Iterator[tuple[int, Mapping[str, str]]]:
    for node in tree.nodes:
        if isinstance(node.behaviour, SkillBehaviour):
            yield node.index, node.behaviour.wired_outputs
