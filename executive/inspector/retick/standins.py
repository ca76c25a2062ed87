"""Stands in the place of skills and answers what the recording says that they answered."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from py_trees.common import Status

from executive.core.errors import CellwrightError
from executive.core.outcome import RUNNING, Outcome, failure, success
from executive.core.outcome import Status as Answer
from executive.engine.blackboard import Write
from executive.engine.nodes.builder import BuiltTree
from executive.engine.nodes.calls import TickCall
from executive.engine.nodes.interception import Junction
from executive.engine.nodes.skill_node import SkillBehaviour
from executive.engine.ticks import NodeStatus
from executive.inspector.index import INVALID
from executive.inspector.index import SUCCESS as SUCCEEDED
from executive.inspector.retick.script import RecordedScript
from executive.inspector.retick.values import RecordedValue

FORCED = "retick.forced"
"""Reason code of a failure that a question has forced."""

BEYOND = "retick.beyond"
"""Reason code of a failure of a skill of which the recording knows no answer."""

Beyond = Literal["running", "success", "failure"]

_BEYOND: Mapping[Beyond, Outcome] = {
    "running": RUNNING,
    "success": success(),
    "failure": failure(BEYOND, "the recording has no answer of it"),
}


class OutsideError(CellwrightError):
    """A skill was asked in a tick in which it was not asked in the run."""


class RepeatedError(CellwrightError):
    """A skill raised in the run, and so it does again."""


@dataclass(frozen=True, slots=True)
class Setting:
    """A value that a key of the blackboard, or a field of its value, is to have.

    Attributes:
        key: The full key.
        fields: The way from its value to the field; empty for the value itself.
        value: The value, as in YAML.
    """

    key: str
    fields: tuple[str, ...]
    value: object

    def __str__(self) -> str:
        """Return `KEY.FIELD=VALUE`."""
        return f"{'.'.join((self.key, *self.fields))}={self.value}"


@dataclass(frozen=True, slots=True)
class WhatIf:
    """What is to be otherwise in one tick.

    Attributes:
        tick: Number of the tick.
        forced: Answers by index of the node in the tree that is ticked.
        values: Values of the blackboard, set before the tick.
    """

    tick: int = -1
    forced: Mapping[int, Answer] = field(default_factory=lambda: MappingProxyType({}))
    values: tuple[Setting, ...] = ()


@dataclass(frozen=True, slots=True)
class Asked:
    """A skill that was asked outside the recording.

    Attributes:
        tick: In which tick.
        node: Its index in the tree that is ticked.
        recorded: Its index in the recording, None for one that is only in the edited tree.
    """

    tick: int
    node: int
    recorded: int | None


class StandIns:
    """Answers for the skills of a tree, and for nodes whose answer is forced.

    Attributes:
        outside: Skills that were asked outside the recording so far.
        forced_now: Nodes whose answer was made another one by the question so far.
    """

    def __init__(
        self,
        script: RecordedScript,
        tree: BuiltTree,
        recorded: Sequence[int | None],
        ports: Mapping[int, Mapping[str, str]],
        *,
        what_if: WhatIf,
        beyond: Beyond | None,
    ) -> None:
        """Stand in for the skills of a tree.

        Args:
            script: What the recording says.
            tree: The tree that is ticked.
            recorded: Index in the recording of each node, None where it has none.
            ports: Keys of the recorded skills' outputs by port, by index in the recording.
            what_if: What is otherwise.
            beyond: What skills answer outside the recording; None to end there.
        """
        self._script, self._tree, self._recorded, self._ports = script, tree, recorded, ports
        self._what_if, self._beyond = what_if, beyond
        self.outside: list[Asked] = []
        self.forced_now: set[int] = set()
        for info in tree.nodes:
            if isinstance(info.behaviour, SkillBehaviour):
                self._repeat_halts(info.behaviour, recorded[info.index])

    def intercept(self, junction: Junction) -> TickCall:
        """Return the call that a parent makes instead of ticking a node; an `Interceptor`."""
        recorded = self._recorded[junction.index]
        tick = junction.tick
        if isinstance(junction.node, SkillBehaviour):
            tick = self._skill(junction, recorded)
        if recorded is not None and recorded in self._script.meddled_nodes:
            tick = self._forced_then(junction, recorded, tick)
        if junction.index in self._what_if.forced:
            tick = self._forced_now(junction, recorded, tick)
        return tick

    def _skill(self, junction: Junction, recorded: int | None) -> TickCall:
        node, script, index = junction.node, self._script, junction.index
        note, running = junction.log.events.append, (index, NodeStatus.RUNNING)
        ports = {} if recorded is None else self._ports[recorded]
        path = "" if recorded is None else script.index.nodes[recorded].path

        def tick() -> Status:
            if node.status is not Status.RUNNING:
                node.initialise()
            answer = INVALID if recorded is None else script.answer(recorded)
            if answer == INVALID:
                outcome = self._unknown(index, recorded, path)
            elif recorded is not None:
                outcome = script.outcome(recorded)
            node.outcome = outcome
            if outcome.status is Answer.RUNNING:
                node.status = Status.RUNNING
                note(running)
                return Status.RUNNING
            if answer == SUCCEEDED:
                node.write(_outputs(ports, script.writes(path)))
            node.status = Status[outcome.status.name]
            note((index, NodeStatus[outcome.status.name]))
            status: Status = node.status
            return status

        return tick

    def _unknown(self, node: int, recorded: int | None, path: str) -> Outcome:
        """Return what a skill answers that the recording has no answer of.

        Raises:
            RepeatedError: It raised.
            OutsideError: It was not asked, and nothing is said about such skills.
        """
        tick = self._script.tick.number
        if recorded is not None and (raised := self._script.raised(path)):
            raise RepeatedError(raised)
        self.outside.append(Asked(tick, node, recorded))
        if self._beyond is None:
            name = self._tree.nodes[node].path
            raise OutsideError(f"{name}: asked in tick {tick}, outside the recording")
        return _BEYOND[self._beyond]

    def _forced_then(self, junction: Junction, recorded: int, tick: TickCall) -> TickCall:
        """Answer for a node, or raise in its place, where somebody did so in the run."""
        script, node = self._script, junction.node
        path = script.index.nodes[recorded].path

        def repeated() -> Status:
            if not script.meddled(recorded):
                if script.delayed(recorded) and node.status is Status.RUNNING:
                    node.status = Status.INVALID  # it has yet to be started
                return tick()
            if script.forced(recorded) is None and not script.raised(path):
                return tick()
            if script.answered(recorded) is None:
                junction.log.note_raised(node, terminating=False)
                raise RepeatedError(script.raised(path))
            return junction.answer(script.outcome(recorded))

        return repeated

    def _forced_now(self, junction: Junction, recorded: int | None, tick: TickCall) -> TickCall:
        """Answer for a node in the tick of the question, unless it answers so anyway."""
        index, wanted = junction.index, self._what_if.forced[junction.index]
        outcomes = {
            Answer.RUNNING: RUNNING,
            Answer.SUCCESS: success(),
            Answer.FAILURE: failure(FORCED, "forced by the question"),
        }

        def forced() -> Status:
            if self._script.tick.number != self._what_if.tick:
                return tick()
            if recorded is not None and self._script.answered(recorded) is wanted:
                status = tick()
                if status is Status[wanted.name]:
                    return status
            self.forced_now.add(index)
            return junction.answer(outcomes[wanted])

        return forced

    def _repeat_halts(self, node: SkillBehaviour, recorded: int | None) -> None:
        """Let a skill raise while it is halted where it did so in the run."""
        if recorded is None:
            return
        script, terminate = self._script, node.terminate
        path = script.index.nodes[recorded].path

        def terminate_again(_: Status) -> None:
            terminate(_)
            answered = script.answered(recorded)
            if answered in (None, Answer.RUNNING) and (raised := script.raised(path)):
                raise RepeatedError(raised)

        if path in script.raising:
            node.terminate = terminate_again  # type: ignore[method-assign]  # of this node alone


def _outputs(ports: Mapping[str, str], writes: Sequence[Write]) -> dict[str, RecordedValue]:
    """Return what a skill gave, by port; a write may have been kept from the blackboard."""
    left = list(writes)
    outputs = {}
    for port, key in ports.items():
        place = next((place for place, write in enumerate(left) if write.key == key), None)
        if place is not None:
            outputs[port] = RecordedValue(left.pop(place).value)
    return outputs
