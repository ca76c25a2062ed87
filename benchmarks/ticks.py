"""How fast trees tick, recorder and all, beside py_trees; and what a recording costs.

Every pair of timings runs the same cell for the same ticks, one after the other in the same
moment, so that a noisy machine slows both; seconds are those of the process on its core. Ours
is what a mission does in every tick: the probe with its guard against exceptions, and the
recorder writing to a file. Theirs is `BehaviourTree.tick()` without visitors. The cells that
are compared are stations at work (`cell`), where memory lets most nodes rest, and blocks in
which nearly every node is ticked every time (`blocks`).
"""

import gc
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from statistics import median as middle
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray
from py_trees.behaviour import Behaviour
from py_trees.blackboard import Blackboard
from py_trees.trees import BehaviourTree

from benchmarks import checking, reticking
from benchmarks.harness import Row, median, percentile_95
from benchmarks.tick_trees import Node, Scripts, blocks, cell, chain, our_tree, their_tree
from executive.engine.nodes.builder import BuiltTree
from executive.engine.recording.messages import MissionHeader
from executive.engine.recording.reader import Recording
from executive.engine.recording.writer import RecordingWriter
from executive.engine.running.mission_run import recorded_nodes
from executive.engine.running.probe import TreeProbe

TICK_HZ = 10.0
HOUR_TICKS = 36_000
STATIONS = 8
"""Of 22 nodes each: 177 with the root."""

GROWTH = (10, 100, 1000, 5000)
DEPTHS = (10, 50, 100, 200)
GROWTH_GOAL = "<= 1.5"


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Time pairs, growth and chains, then record an hour and read it."""
    pairs, hour = (15, HOUR_TICKS // 10) if quick else (200, HOUR_TICKS)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "bench.mcap"
        rows = _ratios("", cell(STATIONS), seed, pairs, path, ">= 1.0")
        rows += _ratios("_all_ticked", blocks(177), seed, pairs, path)
        rows += _growth(seed, 3 if quick else 15)
        rows += _recording(hour, seed, path)
    return [*rows, *reticking.run(quick, seed), *checking.run(quick, seed)]


def _ratios(
    suffix: str, shape: Node, seed: int, pairs: int, path: Path, goal: str = ""
) -> list[Row]:
    """Compare one cell with py_trees', with and without the recorder."""
    recorded = Pair(shape, seed, path).ratios(pairs)
    bare = Pair(shape, seed, None).ratios(pairs)
    return [
        median(f"tick_ratio_to_py_trees{suffix}", recorded, "1", goal),
        median(f"tick_ratio_without_recorder{suffix}", bare, "1"),
        median(f"recorder_share_of_tick{suffix}", [1.0 - _over(bare, recorded)], "1"),
    ]


def _over(bare: Sequence[float], recorded: Sequence[float]) -> float:
    return middle(recorded) / middle(bare)


class Ours:
    """A tree of ours that is ticked as a mission ticks it."""

    def __init__(self, tree: BuiltTree, path: Path | None) -> None:
        """Prepare; without a path nothing is recorded."""
        self._probe, self._number = TreeProbe(tree), 0
        self.writer = None if path is None else RecordingWriter(path, header_of(tree))

    def tick(self) -> None:
        """Tick once, and record it."""
        tick, error = self._probe.tick(self._number, self._number / TICK_HZ)
        if error is not None:
            raise error
        if self.writer is not None:
            self.writer.on_tick(tick)
        self._number += 1


class Pair:
    """The same cell as a tree of ours and as one of py_trees' nodes."""

    def __init__(self, shape: Node, seed: int, path: Path | None) -> None:
        """Build both."""
        Blackboard.clear()
        self._scripts = Scripts(shape, seed), Scripts(shape, seed)
        self._ours = Ours(our_tree(shape, self._scripts[0]), path)
        root: Behaviour = their_tree(shape, self._scripts[1])
        self._theirs = BehaviourTree(root)

    def ratios(self, pairs: int, ticks: int = 100) -> list[float]:
        """Return how many times faster ours is, over and over."""
        cpu_s(self._ours.tick, ticks), cpu_s(self._theirs.tick, ticks)
        ratios = []
        for number in range(pairs):
            ours, theirs = self._ours.tick, self._theirs.tick
            if number % 2:
                their_s = cpu_s(theirs, ticks)
                ratios.append(their_s / cpu_s(ours, ticks))
            else:
                our_s = cpu_s(ours, ticks)
                ratios.append(cpu_s(theirs, ticks) / our_s)
        self._check()
        return ratios

    def _check(self) -> None:
        if self._ours.writer is not None:
            self._ours.writer.close()
        ours, theirs = (scripts.updates for scripts in self._scripts)
        if ours != theirs:
            raise RuntimeError(f"the trees did not do the same: {ours} and {theirs} updates")


def _growth(seed: int, repeats: int) -> list[Row]:
    """Time blocks of growing number and chains of growing depth; nothing is recorded."""
    rows = []
    for kind, make, sizes in (("", blocks, GROWTH), ("chain_", chain, DEPTHS)):
        ours, theirs = {}, {}
        for size in sizes:
            ours[size], theirs[size] = _costs_s(make(size), seed, repeats)
            rows.append(median(f"ticks_per_s_{kind}{size}", [1.0 / s for s in ours[size]], "1/s"))
        for size in sizes[1:]:
            name = f"cost_per_node_{kind}{size}_to_10"
            rows.append(_growth_row(name, ours, size, 10, GROWTH_GOAL if kind else ""))
            rows.append(_growth_row(f"py_trees_{name}", theirs, size, 10))
        if not kind:
            name = "cost_per_node_5000_to_1000"
            rows.append(_growth_row(name, ours, 5000, 1000, GROWTH_GOAL))
    return rows


def _costs_s(shape: Node, seed: int, repeats: int) -> tuple[list[float], list[float]]:
    """Return seconds a tick, in turn: ours without recorder, and py_trees'."""
    Blackboard.clear()
    ours = Ours(our_tree(shape, Scripts(shape, seed)), None)
    theirs = BehaviourTree(their_tree(shape, Scripts(shape, seed)))
    ticks = max(10, 10_000 // shape.size)
    cpu_s(ours.tick, ticks), cpu_s(theirs.tick, ticks)
    costs = [(cpu_s(ours.tick, ticks), cpu_s(theirs.tick, ticks)) for _ in range(repeats)]
    return [cost / ticks for cost, _ in costs], [cost / ticks for _, cost in costs]


def _growth_row(
    name: str, costs_s: Mapping[int, Sequence[float]], size: int, base: int, goal: str = ""
) -> Row:
    base_s = middle(costs_s[base]) / base
    return median(name, [cost_s / size / base_s for cost_s in costs_s[size]], "1", goal)


def _recording(ticks: int, seed: int, path: Path) -> list[Row]:
    """Record the cell at work for an hour of its clock, then open the file and seek in it."""
    shape = cell(STATIONS)
    ours = Ours(our_tree(shape, Scripts(shape, seed)), path)
    for _ in range(ticks):
        ours.tick()
    assert ours.writer is not None
    live_bytes = path.stat().st_size
    closing_s = cpu_s(ours.writer.close, 1)
    size = path.stat().st_size
    hours = HOUR_TICKS / ticks
    opening_s, seeks_ms = _reading(path, np.random.default_rng(seed).permutation(ticks)[:200])
    opening_s = [each * hours for each in opening_s]
    return [
        median("record_bytes_per_tick", [size / ticks], "B"),
        median("record_bytes_per_tick_while_running", [live_bytes / ticks], "B"),
        median("record_mb_per_hour_at_10_hz", [size / ticks * HOUR_TICKS / 1e6], "MB"),
        median("close_hour_s", [closing_s * hours], "s"),
        median("open_hour_s", opening_s, "s", "<= 2"),
        percentile_95("seek_ms", seeks_ms, "ms", "<= 100"),
    ]


def _reading(path: Path, numbers: NDArray[np.int64]) -> tuple[list[float], list[float]]:
    """Open a recording over and over; jump to some ticks each time [s, ms]."""
    opening_s, seeks_ms = [], []
    for part in np.array_split(numbers, 10):
        opened: list[Recording] = []
        opening_s.append(cpu_s(partial(_open, path, opened), 1))
        seeks_ms += [1e3 * cpu_s(partial(_seek, opened[0], int(k)), 1) for k in part]
    return opening_s, seeks_ms


def _open(path: Path, opened: list[Recording]) -> None:
    opened.append(Recording.open(path))


def _seek(recording: Recording, number: int) -> None:
    recording.tick(number)
    recording.statuses(number)
    recording.blackboard(number)


def header_of(tree: BuiltTree) -> MissionHeader:
    """Return what a recording of a tree begins with."""
    return MissionHeader(
        format=1,
        mission="bench",
        seed=0,
        tick_hz=TICK_HZ,
        timeout_s=None,
        nodes=recorded_nodes(tree.nodes),
        started_utc="",
    )


def cpu_s(act: Callable[[], object], times: int) -> float:
    """Return how long the process takes to do something some times [s]."""
    gc.collect()
    began_s = time.process_time()
    for _ in range(times):
        act()
    return time.process_time() - began_s
