"""Recorded runs ticked again: how long an hour takes, and whether every tick is as it was."""

import gc
import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import seed as seeded

from benchmarks.fuzz import Bench, Log
from benchmarks.harness import Row, median, share
from benchmarks.random_documents import ROOTS, Node, document
from benchmarks.tick_trees import Scripts, cell, our_program
from executive.core.clock import ManualClock
from executive.core.registry import Registry
from executive.engine.loading.loader import Program
from executive.engine.nodes.builder import BuiltTree, build
from executive.engine.recording.messages import MissionHeader, SourceFile
from executive.engine.recording.writer import RecordingWriter
from executive.engine.running.mission_run import recorded_nodes
from executive.engine.running.probe import TreeProbe
from executive.inspector.past import PastRun
from executive.inspector.retick.retick import Retick, retick

TICK_HZ = 10.0
HOUR_TICKS = 36_000
STATIONS = 8
TREES, TREE_TICKS = 50, 60
MISSION_TIMEOUT_S = 60


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Tick an hour, random trees and the missions that ship again."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        trees = _trees(folder, seed, 10 if quick else TREES)
        runs = [_mission(folder, seed + i) for i in range(1 if quick else 3)]
        return [
            _hour(folder, seed, quick),
            share("retick_identical_trees", sum(trees), len(trees), ">= 1"),
            share("retick_identical_runs", sum(runs), len(runs), ">= 1"),
        ]


def _hour(folder: Path, seed: int, quick: bool) -> Row:
    """Record the cell at work, and tick it again: from opening the file to the answer."""
    ticks, repeats = (HOUR_TICKS // 10, 1) if quick else (HOUR_TICKS, 3)
    shape = cell(STATIONS)
    program = our_program(shape)
    tree = build(program, devices={"scripts": Scripts(shape, seed)}, clock=ManualClock())
    path = folder / "hour.mcap"
    _record(path, program, tree, ticks)
    samples = []
    for _ in range(repeats):
        gc.collect()
        began_s = time.process_time()
        found = _retick(path)
        samples.append((time.process_time() - began_s) * HOUR_TICKS / ticks)
        if not found.identical or found.ticks != ticks:
            raise RuntimeError(f"an hour is not ticked again as it was: {found}")
    return median("retick_hour_s", samples, "s", "<= 20")


def _trees(folder: Path, seed: int, count: int) -> list[bool]:
    """Return for random trees of every kind of node whether each is ticked again as it was."""
    bench, same = Bench(folder), []

    @seeded(seed)
    @settings(
        max_examples=count,
        deadline=None,
        database=None,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(ROOTS)
    def go(root: Node) -> None:
        program = bench.load(json.dumps(document(root)))
        clock = ManualClock()
        tree = build(program, devices={"log": Log()}, clock=clock, seed=seed)
        path = folder / "random.mcap"
        _record(path, program, tree, TREE_TICKS, seed, clock)
        same.append(_retick(path).identical)

    go()
    return same


def _mission(folder: Path, seed: int) -> bool:
    """Run the mission that ships as a user would, and tick it again."""
    cellwright = str(Path(sys.executable).with_name("cellwright"))
    path = str(folder / f"untangle_{seed}.mcap")
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    command = [cellwright, "run", "untangle", "--seed", str(seed), "--record", path]
    command += ["--timeout", str(MISSION_TIMEOUT_S)]
    ran = subprocess.run(command, capture_output=True, text=True, env=environment)
    if ran.returncode > 1:
        raise RuntimeError(ran.stderr)
    return subprocess.run([cellwright, "retick", path], capture_output=True).returncode == 0


def _record(
    path: Path,
    program: Program,
    tree: BuiltTree,
    ticks: int,
    seed: int = 0,
    clock: ManualClock | None = None,
) -> None:
    """Tick a tree over and over, on its clock if it has one, and record it."""
    header = MissionHeader(
        format=1,
        mission=program.tree.name,
        seed=seed,
        tick_hz=TICK_HZ,
        timeout_s=None,
        sources=tuple(
            SourceFile(file=source.file, sha256=source.sha256, text=source.text)
            for source in program.sources
        ),
        nodes=recorded_nodes(tree.nodes),
        started_utc="",
    )
    probe = TreeProbe(tree)
    with RecordingWriter(path, header) as writer:
        for number in range(ticks):
            time_s = number / TICK_HZ
            if clock is not None:
                clock.sleep_until(time_s)
            tick, error = probe.tick(number, time_s)
            writer.on_tick(tick)
            if error is not None:
                return


def _retick(path: Path) -> Retick:
    return retick(PastRun.open(path), Registry("port type"))
