"""Recorded runs of toy trees in YAML whose leaves do as they are told."""

import dataclasses
import itertools
from pathlib import Path
from textwrap import dedent, indent
from typing import Annotated, ClassVar

import numpy as np
from toy_runs import ToyCell

from executive.core.clock import ManualClock
from executive.core.outcome import failure, success
from executive.core.registry import Registry
from executive.core.skill import In, Port, Skill, SkillRun
from executive.engine.loading.loader import load_program
from executive.engine.nodes.builder import build
from executive.engine.recording.messages import (
    MissionHeader,
    ResultMessage,
    RunReport,
    SourceFile,
)
from executive.engine.recording.reader import Recording
from executive.engine.recording.writer import RecordingWriter
from executive.engine.running.mission_run import recorded_nodes
from executive.engine.running.runner import Runner
from executive.inspector.past import PastRun


class Script:
    """A device that tells each leaf what to answer: letters R, S and F by the leaf's name.

    Every tick takes one letter; the last one repeats.
    """

    def __init__(self, letters):
        self._letters = {name: list(said) for name, said in letters.items()}

    def next(self, name):
        left = self._letters[name]
        return left.pop(0) if len(left) > 1 else left[0]


class Act(Skill):
    """Answer what the script says."""

    OUT: ClassVar = {"value": Port(float, "what it was given")}
    REASONS: ClassVar = frozenset({"act.failed"})
    ACTS = True

    def __init__(self, script: Script) -> None:
        self._script = script

    def run(
        self, name: Annotated[str, In("whose letters")], value: Annotated[float, In("v")] = 0.0
    ) -> SkillRun:
        while (letter := self._script.next(name)) == "R":
            yield
        if letter == "F":
            return failure("act.failed", f"{name} was told to")
        return success(value=value)


def acting():
    """Return the skills of toy trees."""
    registry = Registry("skill")
    registry.add("act", Act)
    return registry


def act(name, **wires):
    """Return the YAML of a leaf called `name`."""
    given = "".join(f", {key}: {value}" for key, value in wires.items())
    return f"{{skill: act, name: {name}, in: {{name: {name}{given}}}}}"


def past(
    folder, root, letters, ports="", *, name="a", seed=0, timeout_s=60.0, inputs=None, mission="t",
    skills=None, devices=None,
):  # fmt: skip
    """Run a tree of which only the root is given; return the recorded run.

    Leaves do what the letters say, or run other skills with devices of their own. Every tick
    takes 2 ms of the machine's clock, so that equal runs have equal recordings.
    """
    folder = Path(folder)
    body = indent(dedent(root).strip(), "  ")
    file = folder / f"{mission}.yaml"
    file.write_text(f"format: 1\ntree: {mission}\n{dedent(ports).strip()}\nroot:\n{body}\n")
    program = load_program(file, skills=skills or acting(), types=Registry("port type"))
    clock = ManualClock()
    devices = devices or {"script": Script(letters)}
    tree = build(program, devices=devices, clock=clock, inputs=inputs or {})
    header = MissionHeader(
        format=1,
        mission=mission,
        seed=seed,
        tick_hz=10.0,
        timeout_s=timeout_s,
        inputs=inputs or {},
        sources=tuple(
            SourceFile(file=source.file, sha256=source.sha256, text=source.text)
            for source in program.sources
        ),
        nodes=recorded_nodes(tree.nodes),
        started_utc="2024-01-01T00:00:00Z",
    )
    path = folder / f"{name}.mcap"
    with RecordingWriter(path, header) as writer:
        runner = Runner(
            tree, ToyCell(clock), tick_hz=10.0, timeout_s=timeout_s, observers=(_Steady(writer),)
        )
        result = runner.run()
        report = RunReport(
            mission=mission, seed=seed, outcome=result.outcome.value,
            reason=result.reason, claim=None,
            sim_s=result.sim_s, wall_s=0.5, ticks=result.ticks, actions=(),
            recording=str(path),
        )  # fmt: skip
        writer.write_result(ResultMessage(report=report, rate=result.rate))
    return PastRun(Recording.open(path))


class _Steady:
    """Hands ticks on as if each had taken 2 ms."""

    def __init__(self, writer):
        self._writer = writer

    def on_tick(self, tick):
        self._writer.on_tick(dataclasses.replace(tick, duration_s=0.002))

    def on_streams(self, messages):
        self._writer.on_streams(messages)


class RandomTree:
    """A random tree of blocks and turned answers, and what it answers by plain logic.

    Attributes:
        root: Its YAML.
        leaves: Names of its leaves.
    """

    def __init__(self, seed, kinds=("sequence", "selector", "inverter"), most_leaves=6):
        self._rng = np.random.default_rng(seed)
        self._kinds, self._left = kinds, most_leaves
        self._names = (f"leaf_{i}" for i in itertools.count())
        self.leaves = []
        self._shape = self._grown(0)
        self.root = self._yaml(self._shape)

    def answer(self, says):
        """Return whether the tree succeeds when each leaf succeeds as told, by name."""
        return self._value(self._shape, says)

    def letters(self, says, slow=True):
        """Return the script for answers by name, some of them after a while."""
        waits = self._rng.integers(0, 4 if slow else 1, len(says))
        return {
            name: "R" * int(wait) + ("S" if says[name] else "F")
            for name, wait in zip(says, waits, strict=True)
        }

    def random_answers(self):
        """Return answers of all leaves by name."""
        return {name: bool(self._rng.random() < 0.5) for name in self.leaves}

    def _grown(self, depth):
        if self._left <= 1 or depth == 3 or (depth and self._rng.random() < 0.3):
            self._left -= 1
            self.leaves.append(next(self._names))
            return self.leaves[-1]
        kind = str(self._rng.choice(self._kinds))
        count = 1 if kind == "inverter" else int(self._rng.integers(2, 4))
        return kind, [self._grown(depth + 1) for _ in range(count)]

    def _yaml(self, shape, deep=0):
        if isinstance(shape, str):
            return act(shape)
        kind, children = shape
        inner = [self._yaml(child, deep + 1) for child in children]
        if kind == "inverter":
            return f"{{inverter: {{child: {inner[0]}}}}}"
        return f"{{{kind}: {{children: [{', '.join(inner)}]}}}}"

    def _value(self, shape, says):
        if isinstance(shape, str):
            return says[shape]
        kind, children = shape
        values = [self._value(child, says) for child in children]
        if kind == "inverter":
            return not values[0]
        return all(values) if kind in ("sequence", "parallel") else any(values)


def all_answers(names):
    """Yield every way in which leaves can answer."""
    for values in itertools.product((True, False), repeat=len(names)):
        yield dict(zip(names, values, strict=True))
