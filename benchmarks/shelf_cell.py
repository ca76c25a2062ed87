"""Searches in the shelf cell with physics, by the protocol of the thesis's Table 7.6.

Twelve pharmacy scenes, three each of 7, 8, 9 and 10 objects; a search ends when half of the target
shows, or after two actions an object. The arm, contacts, friction and suction are simulated;
detection is perfect, and depth is noisy. All policies search the same scenes. `ours` is the
mission's own reasoner, which is told that half of the target is to show. For the other policies a
target that shows, but not by half, is freed by one rule: move away what stands before it; semantics
are taken in the image, as the thesis does where depth is noisy (section 6.3). `least` knows where
everything stands, and moves it without physics: about the fewest moves that could do.

`--scenes N` takes more or fewer scenes, `--policies` some of the policies; of more than twelve
there are rows for the first twelve and for all. With `--kept FILE` each
search is written down when it is over, and a benchmark that was killed goes on from there.
"""

import argparse
import json
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from benchmarks.harness import Row, mean, median, share
from benchmarks.search_bounds import least_moves
from benchmarks.search_ours import OurSearcher
from benchmarks.search_trials import Way, WaySearcher
from benchmarks.searching import Searcher, search
from executive.app.shelf_services import reach_of
from perception.camera import CameraModel
from perception.shelf.language.stored import stored_affinity
from perception.shelf.planning.free_floor import CELL_M, free_cells
from perception.shelf.planning.looking_ahead import ANYHOW, FIXED, Situation
from perception.shelf.planning.moves import Move, Push
from perception.shelf.planning.room import Reach
from perception.shelf.planning.ways_out import freeing_move
from perception.shelf.types import Box, ShelfView
from robots.shelf_tool import (
    Cuboid,
    LookFrom,
    PushAlong,
    PutElsewhere,
    ToolAction,
    ToolResult,
)
from simulation.shelf.contents import MoveFailure, MoveResult
from simulation.shelf.scenes import Scene
from simulation.shelf_cell.cell import ShelfCell

SEED = 880_001
COUNTS = (7, 8, 9, 10)
SCENES = 12
# The share of the target that has to show.
SHOWN = 0.5
POLL_S = 0.1
# Who knows everything, and needs no arm.
LEAST = "least"
_KNOWN = frozenset(MoveFailure)


@dataclass(frozen=True, slots=True)
class Search:
    """How one search went.

    Attributes:
        found: Whether enough of the target shows.
        actions: Pushes and places, those that failed included.
        failures: Of these, how many failed.
        toppled: Boxes that do not stand any more.
        arm_s: Time on the robot's clock.
    """

    found: bool
    actions: int
    failures: int
    toppled: int
    arm_s: float


class PhysicalShelf:
    """The shelf cell as `benchmarks.searching` searches it; detection is perfect."""

    def __init__(self, cell: ShelfCell) -> None:
        """Bind a cell; the detector is told the truth."""
        self._cell, self._detector = cell, cell.oracle_detector
        self._known: Mapping[str, Box] = {}

    @property
    def camera(self) -> CameraModel:
        """The camera at the middle viewpoint."""
        return self._cell.search_camera

    def look(self) -> ShelfView:
        """Take the camera to the middle viewpoint and look."""
        self.do(LookFrom("centre"))
        frame = self._cell.camera.capture()
        found = self._detector.detect(frame)
        labels = tuple(found.names[int(index)] for index in found.probabilities.argmax(axis=1))
        return ShelfView(frame.depth_m, found.segments, labels, self.camera)

    def know(self, boxes: Mapping[str, Box]) -> None:
        """Take note of where things are thought to stand: it is there that the arm acts."""
        self._known = boxes

    def act(self, move: Move) -> MoveResult:
        """Push or put elsewhere what was seen."""
        box = self._known[move.label]
        thing = Cuboid(box.x_m, box.y_m, box.size_m, box.bottom_m)
        if isinstance(move, Push):
            result = self.do(PushAlong(thing, move.shift_m))
        else:
            result = self.do(PutElsewhere(thing, move.x_m, move.y_m))
        if result.failure is None:
            return MoveResult(None, result.moved_m, result.met_m)
        code = result.failure.value
        return MoveResult(MoveFailure(code) if code in _KNOWN else MoveFailure.NOT_SEEN)

    def visible_share(self, name: str) -> float:
        """Return how much of the target shows; truth, for scoring."""
        truth = self._cell.truth()
        assert name == truth.target
        return truth.visible_share

    def do(self, action: ToolAction) -> ToolResult:
        """Carry an action out to its end."""
        self._cell.tool.start(action)
        while (result := self._cell.tool.result()) is None:
            self._cell.clock.sleep_until(self._cell.clock.now_s() + POLL_S)
        return result


class ThesisSearcher(WaySearcher):
    """Searches one of the thesis's ways, and frees a target that shows a little."""

    def choose(self) -> Move | None:
        """Choose the next move."""
        assert isinstance(self.world, PhysicalShelf)
        self.world.know({sighting.label: sighting.box for sighting in self.seen})
        return self._freeing() or super().choose()

    def _freeing(self) -> Move | None:
        labels = tuple(sighting.label for sighting in self.seen)
        if self.target not in labels:
            return None
        places_m = self.poses.places_m
        situation = Situation(
            self.shelf, self.way.reach, self.view.camera, labels,
            tuple(sighting.box for sighting in self.seen),
            np.array([FIXED if name == self.target else ANYHOW for name in labels]),
            self.contacts.footprints, free_cells(self.view, self.shelf, self.caster), CELL_M,
            self.sizes[self.target], places_m, np.full(len(places_m), 1.0 / len(places_m)),
            self.been,
        )  # fmt: skip
        return freeing_move(situation, self.target)


class MissionSearcher(OurSearcher):
    """Searches as the mission does; the arm acts where it believes that things stand."""

    def choose(self) -> Move | None:
        """Choose the next move."""
        assert isinstance(self.world, PhysicalShelf)
        self.world.know(self.belief.boxes)
        return super().choose()


def searchers(reach: Reach) -> Mapping[str, Callable[[Scene, PhysicalShelf], Searcher]]:
    """Return who searches, by name; none is told the taxonomy."""
    affinity = stored_affinity("pharmacy")

    def by(way: Way) -> Callable[[Scene, PhysicalShelf], Searcher]:
        return lambda scene, world: ThesisSearcher(scene, way, world, enough=SHOWN)

    return {
        "spatial_nn": by(Way("network", None, flat=True, reach=reach)),
        "spatial": by(Way("minimum", None, flat=True, reach=reach)),
        "heuristic": by(Way("masks", affinity, "image", flat=True, reach=reach)),
        "s4": by(Way("network", affinity, "image", flat=True, reach=reach)),
        "ours": lambda scene, world: MissionSearcher(scene, affinity, reach, world, enough=SHOWN),
    }


class Kept:
    """Searches that are over, by scene and policy, in a file with a line for each."""

    def __init__(self, file: Path | None) -> None:
        """Read what an earlier run has kept; None keeps nothing."""
        self._file = file
        self._found: dict[str, Search] = {}
        if file is not None and file.exists():
            for line in file.read_text(encoding="utf-8").splitlines():
                row = json.loads(line)
                self._found[row["key"]] = Search(**row["search"])

    def get(self, key: str) -> Search | None:
        """Return a search that is over."""
        return self._found.get(key)

    def add(self, key: str, search: Search) -> None:
        """Write down a search."""
        if self._file is not None:
            with self._file.open("a", encoding="utf-8") as file:
                file.write(json.dumps({"key": key, "search": asdict(search)}) + "\n")


def run(quick: bool, seed: int, words: Sequence[str] = ()) -> Sequence[Row]:
    """Search every scene by every policy."""
    options = _options(words, quick)
    kept, found = Kept(options.kept), dict[str, list[Search]]()
    began_s = time.perf_counter()
    for number in range(options.scenes):
        scenario = {"domain": "pharmacy", "count": COUNTS[number % len(COUNTS)]}
        for name in options.policies:
            scene_seed = SEED + 1000 * seed + number
            key = f"{scene_seed} {name}"
            went = kept.get(key)
            if went is None:
                went = _search(name, scenario, scene_seed)
                kept.add(key, went)
            found.setdefault(name, []).append(went)
            _tell(f"{number + 1} {name}: {went}, {time.perf_counter() - began_s:.0f} s")
    rows = _rows({name: searches[:SCENES] for name, searches in found.items()})
    if options.scenes > SCENES:
        rows += [replace(row, name=f"{row.name} of {options.scenes}") for row in _rows(found)]
    return rows


def _options(words: Sequence[str], quick: bool) -> argparse.Namespace:
    names = [*searchers(Reach()), LEAST]
    parser = argparse.ArgumentParser(prog="python -m benchmarks shelf-cell")
    parser.add_argument("--scenes", type=int, default=2 if quick else SCENES)
    parser.add_argument("--policies", nargs="+", choices=names, default=names)
    parser.add_argument("--kept", type=Path, help="file of searches that are over")
    return parser.parse_args(words)


def _search(name: str, scenario: Mapping[str, object], seed: int) -> Search:
    cell = ShelfCell({"detector": "oracle"}, scenario, seed)
    try:
        reach = reach_of(cell.tool.shape)
        if name == LEAST:
            strong = replace(reach, lift_kg=float("inf"), lift_nm=float("inf"))
            went = least_moves(cell.scene, strong, SHOWN)
        else:
            searcher = searchers(reach)[name](cell.scene, PhysicalShelf(cell))
            went = search(searcher, 2 * len(cell.scene.names))
        return Search(
            went.success, went.actions, went.refusals, cell.truth().toppled, cell.clock.now_s()
        )
    finally:
        cell.close()


def _rows(found: Mapping[str, Sequence[Search]]) -> list[Row]:
    rows = []
    for name, searches in found.items():
        fewest, none = ("<= 2.0", "<= 0") if name == "ours" else ("", "")
        hits = [search for search in searches if search.found]
        rows.append(share(f"success {name}", len(hits), len(searches)))
        if hits:
            rows.append(mean(f"actions {name}", [each.actions for each in hits], "", fewest))
        if name == LEAST:
            continue
        rows.append(mean(f"toppled {name}", [each.toppled for each in searches], "", none))
        rows.append(mean(f"failed actions {name}", [each.failures for each in searches], ""))
    every = [search for name, searches in found.items() if name != LEAST for search in searches]
    per_action = [each.arm_s / each.actions for each in every if each.actions]
    rows.append(median("arm time an action", per_action, "s"))
    return rows


def _tell(text: str) -> None:
    print(text, file=sys.stderr, flush=True)
