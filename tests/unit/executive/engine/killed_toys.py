"""Toy missions that are killed: a world with a memory, skills that use it, and ways to run them."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from textwrap import dedent, indent
from typing import Annotated, Any, ClassVar

import numpy as np

from executive.core.clock import ManualClock
from executive.core.errors import DeviceError, InputError
from executive.core.outcome import failure, success
from executive.core.registry import Registry
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.world import StreamMessage
from executive.engine.checkpoints.choosing import chosen
from executive.engine.checkpoints.resuming import Consent, recorded_mission, take_up
from executive.engine.loading.loader import load_mission
from executive.engine.nodes.builder import build
from executive.engine.recording.reader import Recording
from executive.engine.running.control import RunControl
from executive.engine.running.mission_run import RunPlan, run_mission


@dataclass(frozen=True)
class Part:
    """A part of the toy world."""

    name: str
    picture: np.ndarray


class World:
    """Remembers what was done in it."""

    def __init__(self):
        self.journal, self.held = [], ""

    def note(self, line):
        self.journal.append(line)


class Work(Skill):
    """Works for some ticks; fails the first times."""

    OUT: ClassVar = {"part": Port(Part), "count": Port(int)}
    REASONS = frozenset({"work.failed"})
    ACTS = True

    def __init__(self, world: World) -> None:
        self._world = world

    def run(self, label: Annotated[str, In("name")], ticks: int = 1, fails: int = 0) -> SkillRun:
        self._world.note(f"{label} starts")
        for _ in range(ticks - 1):
            yield
        count = sum(line == f"{label} starts" for line in self._world.journal)
        if count <= fails:
            return failure("work.failed", f"{label} failed", count=count)
        self._world.note(f"{label} ends")
        picture = np.full((4, 5), count, np.uint8)
        return success(part=Part(label, picture), count=count)

    def stop(self) -> None:
        self._world.note("stopped")


class Draw(Skill):
    """Succeeds half of the time."""

    OUT: ClassVar = {"drawn": Port(float)}
    REASONS = frozenset({"draw.blank"})

    def __init__(self, rng: np.random.Generator, world: World) -> None:
        self._rng, self._world = rng, world

    def run(self) -> SkillRun:
        drawn = float(self._rng.random())
        self._world.note(f"drew {drawn:.6f}")
        return success(drawn=drawn) if drawn > 0.5 else failure("draw.blank")
        yield


class Hold(Skill):
    """Takes something, or puts it down again."""

    def __init__(self, world: World) -> None:
        self._world = world

    def run(self, what: str) -> SkillRun:
        self._world.held = what
        return success()
        yield


@dataclass
class WorldCell:
    """A cell with a snapshot of its world, its clock included."""

    clock: ManualClock = field(default_factory=ManualClock)
    world: World = field(default_factory=World)
    devices: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self):
        self.devices = {"world": self.world, "rng": np.random.default_rng(7)}

    def drain_streams(self):
        return [StreamMessage("/toy", "toy.Beat", self.clock.now_s(), b'{"beat": 1}')]

    def stop(self):
        pass

    def emergency_stop(self):
        pass

    def close(self):
        pass

    def truth(self):
        return None

    def snapshot(self):
        if self.world.held:
            raise DeviceError(f"the toy holds {self.world.held}")
        return json.dumps([self.clock.now_s(), self.world.journal]).encode()

    def restore(self, snapshot):
        try:
            now_s, self.world.journal[:] = json.loads(snapshot)
        except ValueError:
            raise InputError("no snapshot of a toy") from None
        self.clock.sleep_until(now_s)


class RealCell(WorldCell):
    """A cell that cannot be put back."""

    snapshot = restore = None


def skills():
    """Return the toy skills."""
    registry = Registry("skill")
    for skill in (Work, Draw, Hold):
        registry.add(skill.__name__.lower(), skill)
    return registry


def types():
    """Return the toy types."""
    registry = Registry("port type")
    registry.add("Part", Part)
    return registry


HEADER = """
format: 1
mission: m
cell: toy_cell
timeout_s: {timeout_s}
in:
  list: {{type: "list[str]", default: [a, b, c]}}
root:
"""


def write_mission(folder, root, timeout_s=60.0):
    """Write a mission from its root node; return its file."""
    (folder / "toy_cell.yaml").write_text("format: 1\ncell: toy_cell\nworld: toy\n")
    file = folder / "m.yaml"
    text = HEADER.format(timeout_s=timeout_s) + indent(dedent(root).strip(), "  ") + "\n"
    file.write_text(text)
    return file


def run(file, record, cell=None, inputs=None):
    """Run a mission of a file to its end; return its recording and its cell."""
    mission = load_mission(file, skills=skills(), types=types())
    cell, inputs = cell or WorldCell(), inputs or {}
    plan = RunPlan(mission, 3, inputs, {}, mission.document.timeout_s, record)
    tree = build(mission, devices=cell.devices, clock=cell.clock, inputs=inputs, seed=3)
    run_mission(plan, tree, cell, RunControl())
    return Recording.open(record), cell


def resume(path, record, *, wanted="", cell=None, consent=None):
    """Go on from a recording; return the new one and its cell."""
    earlier, cell, consent = Recording.open(path), cell or WorldCell(), consent or Consent()
    info = chosen(earlier, wanted)
    header = earlier.header
    mission, _ = recorded_mission(header, consent, skills=skills(), types=types())
    taken_up = take_up(info, earlier, mission, cell, consent, classes=(Part,))
    plan = RunPlan(
        *(mission, header.seed, header.inputs, header.scenario, header.timeout_s, Path(record)),
        resumption=taken_up.resumption,
    )
    run_mission(plan, taken_up.tree, taken_up.cell, RunControl())
    return Recording.open(Path(record)), cell
