"""A toy cell and toy trees: the smallest things that a runner can run."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
from py_trees.behaviour import Behaviour
from py_trees.common import Status
from py_trees.composites import Selector, Sequence

from executive.core.clock import ManualClock, MissionClock
from executive.core.outcome import Outcome, failure
from executive.core.world import StreamMessage
from executive.engine.blackboard import Blackboard
from executive.engine.nodes.supervision import Supervision
from executive.engine.recording.actions import ActionLog
from executive.engine.recording.messages import (
    MissionHeader,
    RecordedNode,
    ResultMessage,
    RunReport,
)
from executive.engine.recording.reader import Recording
from executive.engine.recording.writer import RecordingWriter
from executive.engine.running.runner import Runner

RUNNING, SUCCESS, FAILURE = Status.RUNNING, Status.SUCCESS, Status.FAILURE


class Leaf(Behaviour):
    """Answers what it is told, and counts how often it was started and terminated.

    An item of `answers` is a status, an outcome, or something to call; the last one repeats.
    """

    def __init__(self, name, *answers, on_terminate=None):
        super().__init__(name)
        self.answers = list(answers)
        self.outcome = None
        self.starts = 0
        self.terminations = []
        self._on_terminate = on_terminate or (lambda: None)

    def initialise(self):
        self.starts += 1

    def update(self):
        answer = self.answers.pop(0) if len(self.answers) > 1 else self.answers[0]
        if callable(answer):
            answer = answer()
        self.outcome = answer if isinstance(answer, Outcome) else None
        return Status(answer.status.value) if self.outcome else answer

    def terminate(self, new_status):
        self.terminations.append(new_status)
        self._on_terminate()


def built(root, blackboard=None, acting=()):
    """Return a tree as the builder makes it, from py_trees nodes put together by hand."""
    blackboard = blackboard or Blackboard()
    nodes = []

    def visit(behaviour, parent, path):
        index = len(nodes)
        path = f"{path}/{behaviour.name}" if path else behaviour.name
        nodes.append(
            SimpleNamespace(
                index=index,
                path=path,
                name=behaviour.name,
                kind="skill" if not behaviour.children else "block",
                type=type(behaviour).__name__,
                parent=parent,
                file="toy.yaml",
                line=index + 1,
                column=1,
                acts=behaviour.name in acting,
                behaviour=behaviour,
            )
        )
        for child in behaviour.children:
            visit(child, index, path)

    visit(root, None, "")
    return SimpleNamespace(
        root=root,
        nodes=tuple(nodes),
        blackboard=blackboard,
        clock=MissionClock(ManualClock()),
        supervision=Supervision(),
        outputs=lambda: {},
    )


def header_of(tree, mission="toy", seed=0):
    """Return the header of a recording of a toy tree."""
    nodes = tuple(
        RecordedNode(
            path=node.path,
            name=node.name,
            kind=node.kind,
            type=node.type,
            parent=node.parent,
            file=node.file,
            line=node.line,
            acts=node.acts,
        )
        for node in tree.nodes
    )
    return MissionHeader(
        format=1,
        mission=mission,
        seed=seed,
        tick_hz=10.0,
        timeout_s=None,
        nodes=nodes,
        started_utc="2024-01-01T00:00:00Z",
    )


@dataclass
class ToyCell:
    """Counts how often it is stopped; streams one message a tick."""

    clock: ManualClock = field(default_factory=ManualClock)
    devices: Mapping[str, object] = field(default_factory=dict)
    calls: list[str] = field(default_factory=list)
    on_stop: Callable[[], None] = lambda: None

    def drain_streams(self) -> Iterable[StreamMessage]:
        return [StreamMessage("/toy", "toy.Beat", self.clock.now_s(), b'{"beat": 1}')]

    def stop(self) -> None:
        self.calls.append("stop")
        self.on_stop()

    def emergency_stop(self) -> None:
        self.calls.append("emergency_stop")

    def close(self) -> None:
        self.calls.append("close")

    def truth(self) -> object | None:
        return None


class Ticks:
    """An observer that keeps what it is told."""

    def __init__(self):
        self.ticks, self.messages = [], []

    def on_tick(self, tick):
        self.ticks.append(tick)

    def on_streams(self, messages):
        self.messages.extend(messages)


def record(path, root, blackboard=None, acting=(), seed=0, timeout_s=None, result=True):
    """Run a hand-made tree with a recorder; return the recording and the live ticks."""
    tree, seen = built(root, blackboard, acting), Ticks()
    header = header_of(tree, seed=seed)
    with RecordingWriter(path, header) as writer:
        actions = ActionLog(header.nodes)
        observers = (writer, seen, actions)
        run = Runner(tree, ToyCell(), tick_hz=10.0, timeout_s=timeout_s, observers=observers).run()
        if result:
            report = RunReport(
                mission="toy",
                seed=seed,
                outcome=run.outcome.value,
                reason=run.reason,
                claim=None,
                sim_s=run.sim_s,
                wall_s=run.wall_s,
                ticks=run.ticks,
                actions=actions.reports(),
                recording=str(path),
            )
            writer.write_result(ResultMessage(report=report, rate=run.rate))
    return Recording.open(path), seen.ticks


def busy_tree(blackboard=None, seed=0):
    """Return a tree that switches branches, fails, halts and writes for 600 ticks."""
    rng = np.random.default_rng(seed)
    counter = [0]

    def guard():
        counter[0] += 1
        if blackboard is not None and counter[0] % 7 == 0:
            blackboard.write("toy:count", counter[0], "mission/guard")
        return failure("guard.open", f"door {counter[0] % 5}") if rng.random() < 0.9 else SUCCESS

    def work():
        return FAILURE if counter[0] >= 600 else RUNNING

    return Selector(
        "mission",
        memory=False,
        children=[
            Sequence("wait", memory=False, children=[Leaf("guard", guard), Leaf("hold", RUNNING)]),
            Leaf("work", work),
        ],
    )
