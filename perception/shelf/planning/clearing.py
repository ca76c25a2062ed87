"""An answer to stuck searches: Distribution Area Reduction, which also clears its way.

The published policy gives up when nothing that covers the distribution can be moved. Here it then
moves another object: one that stands where the tool, or the covering object itself, has to pass.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import cache

import numpy as np

from perception.shelf.casting import BoxCaster
from perception.shelf.planning.dar import HASTE_1_M, DistributionAreaReduction
from perception.shelf.planning.moves import Move
from perception.shelf.planning.options import Option, options
from perception.shelf.planning.room import Reach, blade_lane, footprints, front_lane, overlapping
from perception.shelf.types import Bools, Box, Floats, Shelf, ShelfView, Sighting

# How much free room beside an object makes a push of it worth while.
AHEAD_M = 0.05
# Objects that cover less than this share of the distribution are not worth a way.
LEAST_COVER = 0.02

# An object this close to where it has been is back there.
BACK_M = 0.015

# Footprints that all have to be free for one kind of move, shape (L, 4).
Lanes = Floats


class ReductionWithClearing:
    """Chooses as `DistributionAreaReduction` does, and clears a way where that is stuck.

    It remembers from where it has moved objects, and moves none back there: clearing and reduction
    would else undo each other. A search has one of its own.
    """

    def __init__(self, shelf: Shelf, caster: BoxCaster, reach: Reach) -> None:
        """Take what stays the same; see `DistributionAreaReduction`."""
        self._shelf, self._caster, self._reach = shelf, caster, reach
        self._reduction = DistributionAreaReduction(shelf, caster, reach)
        self._left: dict[str, list[Box]] = {}

    def choose(
        self, occupancy: Floats, view: ShelfView, seen: Sequence[Sighting], met: Floats
    ) -> Move | None:
        """Choose the next move; see `DistributionAreaReduction.choose`.

        Returns:
            A move, or None when no single move brings a covering object closer to being free.
        """

        @cache
        def moves_of(index: int) -> list[Option]:
            found = options(seen[index], seen, view, self._shelf, self._caster, self._reach, met)
            return self._new(seen[index].label, found)

        move = self._reduction.reduce(occupancy, seen, moves_of)
        move = move or self._clear(occupancy, seen, met, moves_of)
        if move is not None:
            box = next(sighting.box for sighting in seen if sighting.label == move.label)
            self._left.setdefault(move.label, []).append(box)
        return move

    def _new(self, label: str, found: Sequence[Option]) -> list[Option]:
        """Return the moves that do not bring an object back to where it has been."""
        been_m = np.array([(box.x_m, box.y_m) for box in self._left.get(label, [])]).reshape(-1, 2)
        return [
            option
            for option in found
            if not (np.abs(been_m - (option.box.x_m, option.box.y_m)) < BACK_M).all(axis=1).any()
        ]

    def _clear(
        self,
        occupancy: Floats,
        seen: Sequence[Sighting],
        met: Floats,
        moves_of: Callable[[int], Sequence[Option]],
    ) -> Move | None:
        covers = np.array([occupancy[sighting.mask].sum() for sighting in seen])
        order: list[int] = np.argsort(-covers, kind="stable").tolist()
        wanted = [index for index in order if covers[index] > LEAST_COVER * covers.sum()]
        # What is in the way of a wanted object, and cannot leave, is wanted next. The list grows.
        for index in wanted:
            best, blockers = self._clearing(index, moves_of, occupancy, seen, met)
            if best is not None:
                return best
            wanted += [other for other in blockers if other not in wanted]
        return None

    def _clearing(
        self,
        index: int,
        moves_of: Callable[[int], Sequence[Option]],
        occupancy: Floats,
        seen: Sequence[Sighting],
        met: Floats,
    ) -> tuple[Move | None, list[int]]:
        """Return the move of another object that leaves least in the way of one, and all these."""
        rows = footprints([sighting.box for sighting in seen])
        best: tuple[tuple[int, float], Move] | None = None
        blockers: list[int] = []
        for lanes in self._ways(rows[index]):
            standing = _in_the_way(rows, lanes)
            standing[index] = False
            blocked = int(standing.sum())
            # What was met is not known to be movable, and a free way was of no use.
            if blocked == 0 or _in_the_way(met, lanes).any():
                continue
            in_way: list[int] = np.flatnonzero(standing).tolist()
            blockers += in_way
            for other in in_way:
                clearing = _leaving(moves_of(other), lanes)
                for option, left in zip(
                    clearing, self._reduction.overlaps(clearing, occupancy), strict=True
                ):
                    cost = float(left) + HASTE_1_M * option.far_m
                    if best is None or (blocked, cost) < best[0]:
                        best = (blocked, cost), option.move
        return (None if best is None else best[1]), blockers

    def _ways(self, own: Floats) -> Iterator[Lanes]:
        """Yield what has to be free to take an object out, or to push it to either side."""
        if self._reach.suction:
            yield front_lane(own)[None]
        for sign in (-1, 1):
            side_m = own[2] if sign > 0 else own[0]
            low_m, high_m = sorted((side_m, side_m + sign * AHEAD_M))
            lane = blade_lane(own, sign, self._reach)
            lanes = np.array([lane, [low_m, own[1], high_m, own[3]]])
            if lanes[:, 0].min() >= 0.0 and lanes[:, 2].max() <= self._shelf.width_m:
                yield lanes


def _in_the_way(rows: Floats, lanes: Lanes) -> Bools:
    return np.asarray(overlapping(rows[:, None], lanes[None]).any(axis=1))


def _leaving(found: Sequence[Option], lanes: Lanes) -> list[Option]:
    """Return the moves after which their object is out of the way."""
    if not found:
        return []
    inside = _in_the_way(footprints([option.box for option in found]), lanes)
    return [option for option, blocks in zip(found, inside, strict=True) if not blocks]
