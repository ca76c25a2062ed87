"""Recorded runs of random trees, to be ticked again."""

import json
import zlib
from typing import Annotated, ClassVar

import numpy as np
from toy_language import Journal, toy_skills, toy_types
from toy_runs import ToyCell

from benchmarks.random_documents import INNER, document
from executive.core.clock import ManualClock
from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.engine.loading.loader import load_program
from executive.engine.nodes.builder import build
from executive.engine.recording.messages import MissionHeader, SourceFile
from executive.engine.recording.reader import Recording
from executive.engine.recording.writer import RecordingWriter
from executive.engine.running.mission_run import recorded_nodes
from executive.engine.running.runner import Runner
from executive.inspector.past import PastRun

TICK_HZ = 10.0


class Moody(Skill):
    """Answer by chance that depends on the name and the tick alone."""

    OUT: ClassVar = {"value": Port(int, "drawn")}
    REASONS: ClassVar = frozenset({"moody.no"})

    def __init__(self, clock: ManualClock) -> None:
        self._clock = clock

    def run(self, name: Annotated[str, In("its name")]) -> SkillRun:
        while (drawn := self._draw(name)) < 3:
            yield
        return success(value=drawn) if drawn < 7 else failure("moody.no", str(drawn))

    def _draw(self, name):
        tick = round(self._clock.now_s() * TICK_HZ)
        return zlib.crc32(f"{name}/{tick}".encode()) % 10


def moody_skills():
    """Return the toy skills, the moody one among them."""
    registry = toy_skills()
    registry.add("moody", Moody)
    return registry


def recorded(folder, root, *, seed=0, ticks=30, name="run", ports=None, skills=moody_skills,
             interceptors=(), keep_sources=True):  # fmt: skip
    """Run a tree and return the recorded run; `interceptors` are made from the tree."""
    (folder / "inner.yaml").write_text(INNER)
    file = folder / "t.yaml"
    file.write_text(json.dumps({**document(root), **(ports or {})}))
    program = load_program(file, skills=skills(), types=toy_types())
    clock = ManualClock()
    devices = {"journal": Journal(), "clock": clock}
    tree = build(program, devices=devices, clock=clock, seed=seed)
    sources = tuple(
        SourceFile(file=source.file, sha256=source.sha256, text=source.text)
        for source in program.sources
    )
    header = MissionHeader(
        format=1, mission="t", seed=seed, tick_hz=TICK_HZ, timeout_s=ticks / TICK_HZ,
        sources=sources if keep_sources else (), nodes=recorded_nodes(tree.nodes), started_utc="",
    )  # fmt: skip
    path = folder / f"{name}.mcap"
    with RecordingWriter(path, header) as writer:
        Runner(
            tree, ToyCell(clock), tick_hz=TICK_HZ, timeout_s=ticks / TICK_HZ, observers=(writer,),
            interceptors=[make(tree) for make in interceptors],
        ).run()  # fmt: skip
    return PastRun(Recording.open(path))


class MoodyTrees:
    """Random trees of moody leaves, conditions on what these wrote, guards and memory."""

    def __init__(self, seed, leaves=9):
        self._rng = np.random.default_rng(seed)
        self._left, self._count = leaves, 0

    def root(self, depth=0):
        """Return the root of a new one."""
        if depth == 4 or self._left <= 1 or (depth > 1 and self._rng.random() < 0.3):
            return self._leaf()
        kind = str(self._rng.choice([
            "sequence", "reactive_sequence", "selector", "reactive_selector", "parallel",
            "retry", "timeout", "inverter", "if_then_else", "while_do_else", "force_success",
        ]))  # fmt: skip
        name = {"name": self._name()} if depth else {}
        if kind in ("retry", "timeout", "inverter", "force_success"):
            own = {"retry": {"times": 3, "delay_s": 0.1}, "timeout": {"seconds": 0.5}}
            return {kind: {**name, **own.get(kind, {}), **self._guard(),
                           "child": self.root(depth + 1)}}  # fmt: skip
        count = 3 if "else" in kind else int(self._rng.integers(2, 4))
        own = {"parallel": {"succeed": "any" if self._rng.random() < 0.5 else "all"}}
        children = [self.root(depth + 1) for _ in range(count)]
        return {kind: {**name, **own.get(kind, {}), **self._guard(), "children": children}}

    def _leaf(self):
        self._left -= 1
        name = self._name()
        if self._rng.random() < 0.4:
            return {"when": f"v > {int(self._rng.integers(2, 6))}", "name": name}
        return {"skill": "moody", "name": name, "in": {"name": name}, "out": {"value": "$v"},
                **self._guard()}  # fmt: skip

    def _guard(self):
        if self._rng.random() < 0.7:
            return {}
        kind = str(self._rng.choice(["if", "while", "unless"]))
        return {kind: f"v < {int(self._rng.integers(3, 7))}"}

    def _name(self):
        self._count += 1
        return f"n{self._count}"


KEEP = {"keep": {"v": 3}}
