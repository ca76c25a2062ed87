"""Ours: the move that begins the sequence which is expected to show the target soonest.

A beam search over sequences of moves on the belief over the target's poses. After each move the
target is either seen, where its pose shows, or it is not, and then it stands in one of the poses
that are still hidden. What a sequence costs is how often a move is expected to be needed, plus what
is estimated to come after its end: for each hidden pose the least effort to uncover it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from perception.camera import CameraModel
from perception.shelf.planning.kernels import Ints, consider, moved_rows, moves_from, rising
from perception.shelf.planning.lifting import tries
from perception.shelf.planning.moves import Move, Place, Plan, Push
from perception.shelf.planning.outlook import COARSE, Grain, outlook, restricted
from perception.shelf.planning.partings import partings, pushes_of
from perception.shelf.planning.room import Reach, footprints
from perception.shelf.types import Bools, Box, Floats, Shelf, Size, stands_on

# Whether an object may be moved, and how; what is out of view may be moved once it is seen.
FIXED, ANYHOW, BY_PUSH, BY_CUP, UNSEEN = range(5)
# An object this close to where it has been is back there.
BACK_M = 0.015
# Objects that are all this close to where they were together stand as they stood.
SAME_M = 0.004
# Poses that are less likely together than this are not planned for.
REST = 0.02
# Of two moves that are as good, the shorter one: a metre costs this part of a move.
HASTE_1_M = 1e-3
# Partings are thought of for so many of the likeliest poses, and so many of them weighed.
PARTED, WEIGHED = 40, 80
# A plan that makes no more moves for a find needs no parting, which is of two moves or more.
EASY = 2.0
# A pose that should show this share of its face, and does not, is not where the target stands.
MOST_SHOWN = 0.8
# What finds less of the target's probability finds nothing.
LEAST_FOUND = 1e-3
# So many children of a branch compete for each place in the beam.
SHORTLIST = 4


@dataclass(frozen=True, slots=True)
class Depth:
    """How far to look ahead.

    Attributes:
        moves: Longest sequence.
        beam: Sequences that are kept at each length.
        steps_m: Distance of ends of pushes, and of places along x and y.
        tail: Factor on the effort that is estimated to come after a sequence.
        block_m: Poses in one block of the floor of this size are planned for as one.
    """

    moves: int = 3
    beam: int = 8
    steps_m: tuple[float, float, float] = (0.03, 0.05, 0.08)
    tail: float = 1.5
    block_m: float = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Situation:
    """What is known when a move is to be chosen.

    Attributes:
        shelf: The shelf.
        reach: What the tool needs.
        camera: From where the next look will be.
        labels: Names of the objects.
        boxes: Where they stand, in the order of `labels`.
        movable: How each may be moved (`FIXED`, `ANYHOW`, `BY_PUSH`, `BY_CUP`, `UNSEEN`),
            shape (B,).
        met: Footprints of what is in the way unseen, shape (M, 4).
        floor: Which cells of the floor are known to be free, as `free_floor` has them.
        cell_m: Size of these cells.
        target_m: Size of the target.
        places_m: Where its centre may be, shape (K, 2).
        weights: Probability of each place, shape (K,).
        been: Where objects were moved from, or could not be moved to: none is brought there.
        before: The same of all moves so far, in order: no arrangement that showed nothing is made
            again.
        unseen_m: Where a small thing may stand that nobody has seen, shape (U, 2).
        barred: Objects that cannot be pushed from where they stand, and to which side: +1 for
            along x, -1 for against it.
        belied: Share of its face by which a target in each place should have shown in some look,
            and did not, shape (K,); empty where that is not known.
    """

    shelf: Shelf
    reach: Reach
    camera: CameraModel
    labels: tuple[str, ...]
    boxes: tuple[Box, ...]
    movable: Ints
    met: Floats
    floor: Bools
    cell_m: float
    target_m: Size
    places_m: Floats
    weights: Floats
    been: Sequence[tuple[str, Box]] = ()
    before: Sequence[tuple[str, Box]] = ()
    unseen_m: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    barred: Sequence[tuple[str, int]] = ()
    belied: Floats = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True, slots=True, eq=False)
class _Branch:
    """A sequence of moves, and what is known where it is carried out and shows nothing."""

    boxes: Floats
    weights: Floats
    unfound: float
    spent: float
    cost: float
    moves: tuple[Move, ...] = ()
    shows: tuple[float, ...] = ()

    @property
    def toil(self) -> float:
        """How many moves it makes for each time that it finds the target."""
        found = 1.0 - self.unfound
        return (self.spent - self.unfound) / found if found > LEAST_FOUND else np.inf


def look_ahead(
    situation: Situation, depth: Depth | None = None, grain: Grain = COARSE
) -> Plan | None:
    """Return the best sequence of moves, or None when nothing that helps can be moved.

    Args:
        situation: What is known.
        depth: How far to look; None for the defaults.
        grain: How finely it is judged what shows.
    """
    return _Search(situation, depth or Depth(), grain).best()


@dataclass(frozen=True, slots=True, eq=False)
class KernelInputs:
    """A situation as compiled code takes it; see `kernels.moves_from`."""

    boxes: Floats
    met: Floats
    shelf_m: Floats
    reach: Floats
    steps_m: Floats
    floor: Floats


def kernel_inputs(situation: Situation, depth: Depth | None = None) -> KernelInputs:
    """Return a situation as compiled code takes it."""
    shelf, reach = situation.shelf, situation.reach
    boxes = situation.boxes
    rows = [
        (*box.low_m[:2], *box.high_m[:2], box.high_m[2], _bottom_m(box, boxes)) for box in boxes
    ]
    floor = np.zeros(np.array(situation.floor.shape) + 1)
    floor[1:, 1:] = situation.floor.cumsum(axis=0).cumsum(axis=1)
    return KernelInputs(
        boxes=np.array(rows, dtype=np.float64).reshape(-1, 6),
        met=np.ascontiguousarray(situation.met, dtype=np.float64).reshape(-1, 4),
        shelf_m=np.array([shelf.width_m, shelf.depth_m]),
        reach=np.array([reach.blade_m, reach.overlap_m, reach.gap_m, float(reach.suction)]),
        steps_m=np.array((depth or Depth()).steps_m),
        floor=floor,
    )


def _bottom_m(box: Box, boxes: Sequence[Box]) -> float:
    """Return how high a box stands; one that stands on nothing known is in the way of all below."""
    return box.bottom_m if any(stands_on(box, other) for other in boxes) else 0.0


def named_move(situation: Situation, index: int, by_cup: bool, corner: Floats) -> Move:
    """Return the move of an object whose low corner goes somewhere, shape (2,)."""
    own = footprints([situation.boxes[index]])[0]
    return _named(situation.labels[index], own, by_cup, corner)


def _named(label: str, own: Floats, by_cup: bool, corner: Floats) -> Move:
    if not by_cup:
        return Push(label, float(corner[0] - own[0]))
    middle = corner + 0.5 * (own[2:4] - own[:2])
    return Place(label, float(middle[0]), float(middle[1]))


def open_moves(situation: Situation, boxes: Floats, moves: tuple[Ints, Ints, Floats]) -> Bools:
    """Say which moves are not known to fail, and bring nothing back to where it has been.

    Args:
        situation: What is known.
        boxes: Where objects stand before the moves, shape (B, 6).
        moves: As `kernels.moves_from` has them.

    Returns:
        One for each move, shape (M,).
    """
    moved, by_cup, corners = moves
    fine = np.ones(len(moved), dtype=bool)
    numbers = {label: number for number, label in enumerate(situation.labels)}
    for label, box in situation.been:
        if label in numbers:
            back = np.abs(corners - np.array(box.low_m[:2])).max(axis=1) < BACK_M
            fine &= ~(back & (moved == numbers[label]))
    for label, sign in situation.barred:
        if label in numbers:
            number = numbers[label]
            pushes = (moved == number) & (by_cup == 0)
            stays = abs(boxes[number, 0] - situation.boxes[number].low_m[0]) < BACK_M
            fine &= ~(pushes & (sign * (corners[:, 0] - boxes[number, 0]) > 0.0) & stays)
    return fine & ~_again(situation, boxes, moved, corners)


def _again(situation: Situation, boxes: Floats, moved: Ints, corners: Floats) -> Bools:
    """Say which moves bring all objects back to where they were together, shape (M,)."""
    past_m = _arrangements(situation)
    near: Bools = np.asarray((np.abs(boxes[:, :2] - past_m) < SAME_M).all(axis=2))
    others = near.sum(axis=1)[:, None] - near[:, moved] == len(boxes) - 1
    there = (np.abs(corners - past_m[:, moved]) < SAME_M).all(axis=2)
    return np.asarray((others & there).any(axis=0))


def _arrangements(situation: Situation) -> Floats:
    """Return the low corners of all objects before each of the moves, shape (J, B, 2)."""
    now_m, past_m = footprints(situation.boxes)[:, :2], list[Floats]()
    numbers = {label: number for number, label in enumerate(situation.labels)}
    for label, box in reversed(situation.before):
        if label in numbers:
            now_m[numbers[label]] = box.low_m[:2]
            past_m.append(now_m.copy())
    return np.array(past_m).reshape(-1, len(now_m), 2)


class _Search:
    """One decision."""

    def __init__(self, situation: Situation, depth: Depth, grain: Grain) -> None:
        self._situation, self._depth, self._grain = situation, depth, grain
        self._inputs = kernel_inputs(situation, depth)
        self._again = np.array(
            [tries(box.size_m, situation.reach) - 1.0 for box in situation.boxes]
        )
        poses, weights = _blocks(situation, depth.block_m)
        places_m = situation.places_m[poses]
        self._view = outlook(situation.camera, places_m, situation.target_m, grain)
        belied = situation.belied[poses] if len(situation.belied) else np.zeros(len(poses))
        weights = self._hidden(weights, belied, grain)
        kept = _likely(weights) if weights.any() else np.zeros(0, dtype=np.int64)
        self._places_m = places_m[kept]
        self._view = restricted(self._view, kept)
        self._weights = weights[kept] / weights[kept].sum()

    def best(self) -> Plan | None:
        if not len(self._weights):
            return None
        ahead = self._by_beam()
        if ahead is not None and ahead.toil <= EASY:
            return _plan(ahead)
        parting = self._by_parting()
        if ahead is None or parting is None:
            return _plan(ahead or parting)
        return _plan(min(ahead, parting, key=lambda branch: branch.toil))

    def _by_beam(self) -> _Branch | None:
        start = _Branch(self._inputs.boxes, self._weights, 1.0, 1.0, np.inf)
        beam, done = [start], list[_Branch]()
        for _ in range(self._depth.moves):
            longer = _best([child for branch in beam for child in self._children(branch)],
                           self._depth.beam)  # fmt: skip
            beam = [self._carried_out(branch) for branch in longer]
            done += [branch for branch in beam if branch.unfound < REST]
            beam = [branch for branch in beam if branch.unfound >= REST]
            if not beam:
                break
        return min([*done, *beam], key=lambda branch: branch.cost, default=None)

    def _by_parting(self) -> _Branch | None:
        """Return the pushes of many objects that are the least toil, where any show anything.

        Of stacks no partings are known.
        """
        situation, inputs = self._situation, self._inputs
        if inputs.boxes[:, 5].any():
            return None
        likely = np.argsort(-self._weights, kind="stable")[:PARTED]
        ways = partings(
            inputs.boxes,
            np.isin(situation.movable, (ANYHOW, BY_PUSH, UNSEEN)),
            inputs.met,
            situation.target_m[:2],
            (float(inputs.shelf_m[0]), situation.reach.gap_m),
            self._view,
            self._places_m,
            likely[self._weights[likely] > 0.0],
            self._grain,
        )
        start = _Branch(inputs.boxes, self._weights, 1.0, 1.0, np.inf)
        best: _Branch | None = None
        for way in sorted(ways, key=lambda one: one.count)[:WEIGHED]:
            if best is not None and way.count >= best.toil:
                break
            pushes = pushes_of(
                way, inputs.boxes, situation.movable != UNSEEN, inputs.met, inputs.shelf_m[0],
                inputs.reach,
            )  # fmt: skip
            branch = self._pushed(start, pushes) if self._may_begin(pushes) else None
            if branch is not None and (best is None or branch.toil < best.toil):
                best = branch
        return best

    def _may_begin(self, pushes: Sequence[tuple[int, Floats]]) -> bool:
        first = pushes[:1]
        moved = np.array([index for index, _ in first], dtype=np.int64)
        corners = np.array([corner for _, corner in first]).reshape(-1, 2)
        by_cup, boxes = np.zeros(len(moved), dtype=np.int64), self._inputs.boxes
        return len(first) == 1 and bool(
            open_moves(self._situation, boxes, (moved, by_cup, corners))[0]
        )

    def _pushed(self, branch: _Branch, pushes: Sequence[tuple[int, Floats]]) -> _Branch | None:
        """Return a branch with pushes one after the other; None when they show nothing."""
        for index, corner in pushes:
            cost = branch.spent
            longer = self._child(branch, (index, False, corner), 0.0, cost)
            seen, shown = self._assess(longer.boxes, longer.weights)
            unfound = max(branch.unfound - shown, 0.0)
            branch = replace(
                longer,
                weights=np.where(seen, 0.0, longer.weights),
                unfound=unfound,
                spent=branch.spent + unfound,
                shows=(*branch.shows, shown),
            )
        return branch if branch.unfound < 1.0 - LEAST_FOUND else None

    def _hidden(self, weights: Floats, belied: Floats, grain: Grain) -> Floats:
        """Return the weights of the poses that are not in view.

        What should show already, or should have shown before, and did not, is hidden by a hair:
        places are known to some millimetres, and a pose stands for its block. To be seen, more of
        it must show than that. Where all should be in view, what is believed is wrong somewhere:
        anything hidden may be it.
        """
        shows = self._view.shows
        face, rises = shows / grain.shown, self._rises(self._inputs.boxes, np.ones(len(weights)))
        now, before = rises >= shows, belied >= grain.shown
        more = np.maximum(np.where(now, rises / face, 0.0), np.where(before, belied, 0.0))
        self._view = replace(
            self._view, shows=np.maximum(shows, (more + grain.more * (more > 0.0)) * face)
        )
        hidden = np.where(now & (rises > MOST_SHOWN * face), 0.0, weights)
        return hidden if hidden.sum() > 0.0 else np.where(now, 0.0, 1.0)

    def _children(self, branch: _Branch) -> list[_Branch]:
        """Return the branch with each of the best next moves, not yet carried out."""
        situation, view, inputs = self._situation, self._view, self._inputs
        moved, by_cup, corners = moves_from(
            branch.boxes, situation.movable, inputs.met, inputs.shelf_m, inputs.reach,
            inputs.steps_m, inputs.floor, situation.cell_m,
        )  # fmt: skip
        fresh = open_moves(situation, branch.boxes, (moved, by_cup, corners))
        moved, by_cup, corners = moved[fresh], by_cup[fresh], corners[fresh]
        shown, behind = consider(
            branch.boxes, situation.movable, inputs.met, inputs.shelf_m[0], inputs.reach,
            view.slopes, view.eye, view.column, view.depth, view.top, view.start, view.shows,
            branch.weights, moved, corners,
        )  # fmt: skip
        far_m = np.abs(corners - branch.boxes[moved, :2]).sum(axis=1)
        again = branch.unfound * np.where(by_cup == 1, self._again[moved], 0.0)
        costs = branch.spent + again + self._depth.tail * behind + HASTE_1_M * far_m
        # A shortlist is enough: siblings compete for the same beam.
        order = np.argsort(costs, kind="stable")[: SHORTLIST * self._depth.beam]
        return [
            self._child(
                branch,
                (int(moved[pick]), bool(by_cup[pick]), corners[pick]),
                float(shown[pick]),
                float(costs[pick]),
                float(again[pick]),
            )
            for pick in order.tolist()
        ]

    def _child(
        self,
        branch: _Branch,
        move: tuple[int, bool, Floats],
        shown: float,
        cost: float,
        again: float = 0.0,
    ) -> _Branch:
        index, by_cup, corner = move
        boxes = moved_rows(branch.boxes, index, np.asarray(corner, dtype=np.float64))
        unfound = max(branch.unfound - shown, 0.0)
        named = _named(self._situation.labels[index], branch.boxes[index], by_cup, corner)
        return _Branch(
            boxes, branch.weights, unfound, branch.spent + again + unfound, cost,
            (*branch.moves, named), (*branch.shows, shown),
        )  # fmt: skip

    def _carried_out(self, branch: _Branch) -> _Branch:
        """Return a branch with the poses ruled out that its last move shows."""
        seen, _ = self._assess(branch.boxes, branch.weights)
        return replace(branch, weights=np.where(seen, 0.0, branch.weights))

    def _assess(self, boxes: Floats, weights: Floats) -> tuple[Bools, float]:
        """Return which poses show that weigh anything, and their weight."""
        rises = self._rises(boxes, weights)
        seen: Bools = (weights > 0.0) & (rises >= self._view.shows)
        return seen, float(weights[seen].sum())

    def _rises(self, boxes: Floats, weights: Floats) -> Floats:
        """Return by how much each pose rises above what is before it, where it weighs anything."""
        view = self._view
        return rising(
            boxes, view.slopes, view.eye, view.column, view.depth, view.top, view.start, weights
        )


def _plan(branch: _Branch | None) -> Plan | None:
    if branch is None:
        return None
    return Plan(branch.moves, branch.shows[0], branch.cost, 1.0 - branch.unfound)


def _best(branches: list[_Branch], most: int) -> list[_Branch]:
    """Return the cheapest branches; of those that end alike, one."""
    best: dict[bytes, _Branch] = {}
    for branch in sorted(branches, key=lambda one: one.cost):
        if len(best) == most:
            break
        best.setdefault(np.round(branch.boxes, 3).tobytes(), branch)
    return list(best.values())


def _blocks(situation: Situation, block_m: float) -> tuple[Ints, Floats]:
    """Return the likeliest pose of each block of the floor, and the block's probability."""
    blocks = np.floor(situation.places_m / block_m).astype(np.int64)
    order = np.lexsort((-situation.weights, blocks[:, 1], blocks[:, 0]))
    ordered = blocks[order]
    first = np.ones(len(order), dtype=bool)
    first[1:] = (ordered[1:] != ordered[:-1]).any(axis=1)
    sums = np.add.reduceat(situation.weights[order], np.flatnonzero(first))
    poses = order[first]
    ascending = np.argsort(poses)
    return poses[ascending], sums[ascending]


def _likely(weights: Floats) -> Ints:
    """Return the fewest poses that hold all but the rest of the probability, ascending."""
    order = np.argsort(-weights, kind="stable")
    count = int(np.searchsorted(np.cumsum(weights[order]), (1.0 - REST) * weights.sum())) + 1
    return np.sort(order[:count])
