"""Where hands take the cable for a move, and where they go with it.

The trace tells how the cable lies now. Where it will lie after a move is not predicted, so for
later moves of a plan these are the places on the cable, drawn where they are now.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from perception.cable.grasp_points import GraspConfig, HeldStrand
from perception.cable.planning.moves import Hold, Move, MoveKind, Role
from perception.cable.planning.open_diagram import OpenDiagram
from perception.cable.polyline import arc_lengths
from perception.cable.topology.curve import Strand
from perception.cable.types import Points

STEP_PX = 4.0
# Ways that hands choose from, and places along each where room is looked for.
WAYS, SPOTS = 32, 12
# Room counts so much more than being near the best place, a pixel of it [1/px].
NEARNESS = 0.01


@dataclass(frozen=True, slots=True, eq=False)
class Grasp:
    """One hand's part in a move, in the coordinates of the trace.

    Attributes:
        role: Whether the hand holds the cable or lets it slide.
        point: Where it takes it, shape (2,).
        direction: Unit tangent of the cable there, shape (2,).
        to: Where the hand goes with it, shape (2,).
        arc: Arc position on the trace.
        room: Share of the wanted room for fingers that there is, in [0, 1].
    """

    role: Role
    point: Points
    direction: Points
    to: Points
    arc: float
    room: float


class Places:
    """All places of a trace where it might be taken, with the room around each."""

    def __init__(self, strand: Strand, diagram: OpenDiagram, config: GraspConfig) -> None:
        """Measure the room once."""
        line, arcs = strand.points, arc_lengths(strand.points)
        crossed_px = np.array(diagram.arcs) * arcs[-1]
        self.held = HeldStrand(line, arcs, np.empty((0, 2)), crossed_px, np.empty(0))
        self._config = config
        count = max(int(arcs[-1] / STEP_PX), 2)
        self._arcs = (np.arange(count) + 0.5) / count
        self._rooms = self._measured(self._arcs)
        self._best: dict[Hold, tuple[float, float]] = {}

    def _measured(self, arcs: Points) -> Points:
        clearances_px = self.held.clearances_px(arcs * self.held.length_px, self._config)
        rooms: Points = np.minimum(clearances_px / self._config.room_px, 1.0)
        return rooms

    def best(self, hold: Hold) -> tuple[float, float]:
        """Return the arc position where a hand should take the cable, and the room there."""
        if hold not in self._best:
            self._best[hold] = self._searched(hold)
        return self._best[hold]

    def _searched(self, hold: Hold) -> tuple[float, float]:
        low, high = np.searchsorted(self._arcs, hold.interval)
        arcs, rooms = self._arcs[low:high], self._rooms[low:high]
        if low == high:
            arcs = np.array([sum(hold.interval) / 2.0])
            rooms = self._measured(arcs)
        far_px = np.abs(arcs - hold.near) * self.held.length_px
        k = int(np.argmax(rooms - NEARNESS * far_px / self._config.room_px))
        return float(arcs[k]), float(rooms[k])

    def crowding(self, move: Move) -> float:
        """Return how much room is missing at the best places, added up over the hands."""
        return sum(1.0 - self.best(hold)[1] for hold in move.holds)

    def grasps(self, move: Move) -> tuple[Grasp, ...]:
        """Return what each hand does."""
        taken = [self.best(hold) for hold in move.holds]
        targets = self._targets(move, [arc for arc, _ in taken])
        return tuple(
            Grasp(
                role=hold.role,
                point=self._point(arc),
                direction=self.held.direction(arc * self.held.length_px),
                to=to,
                arc=arc,
                room=room,
            )
            for hold, (arc, room), to in zip(move.holds, taken, targets, strict=True)
        )

    def _targets(self, move: Move, arcs: Sequence[float]) -> list[Points]:
        """Return where each hand goes."""
        drawn_px = (move.interval[1] - move.interval[0]) * self.held.length_px
        far_px = drawn_px + 2.0 * self._config.room_px
        if len(arcs) == 2:
            # What lies between both hands becomes straight before more is drawn in.
            between_px = abs(arcs[1] - arcs[0]) * self.held.length_px
            span_px = between_px + (0.0 if move.kind is MoveKind.UNTWIST else far_px)
            return _apart(self._point(arcs[0]), self._point(arcs[1]), span_px)
        if move.stays is None:
            marks = move.across or move.interval
            return [np.mean([self._point(arc) for arc in marks], axis=0)]
        # An end that is lifted hangs on the cable behind the last strand that it lay on.
        lifted = move.kind is MoveKind.LIFT_END
        fold = self._fold(move.stays, near=move.interval) if lifted else arcs[0]
        return [self._free_way(fold, move.interval, far_px)]

    def _point(self, arc: float) -> Points:
        return self.held.point(arc * self.held.length_px)

    def _fold(self, stays: tuple[float, float], near: tuple[float, float]) -> float:
        """Return a place on the edge that stays, near the end that is moved."""
        reach = min(self._config.own_px / self.held.length_px, 0.5 * (stays[1] - stays[0]))
        return stays[0] + reach if stays[0] >= near[1] else stays[1] - reach

    def _free_way(self, fold: float, moved: tuple[float, float], far_px: float) -> Points:
        """Return the point at a distance whose straight way there is freest of other cable."""
        arcs, origin = self.held.arcs / self.held.length_px, self._point(fold)
        own = np.abs(arcs - fold) * self.held.length_px <= self._config.own_px
        stays = self.held.line[~own & ((arcs < moved[0]) | (arcs > moved[1]))]
        angles = np.arange(WAYS) * 2.0 * np.pi / WAYS
        ways = np.column_stack([np.cos(angles), np.sin(angles)])
        shares = np.arange(1, SPOTS + 1) / SPOTS
        spots = origin + far_px * shares[None, :, None] * ways[:, None, :]
        gaps_px = np.linalg.norm(spots[:, :, None] - stays[None, None], axis=3)
        nearest_px = gaps_px.min(axis=(1, 2), initial=1e3)
        freest: Points = spots[int(np.argmax(nearest_px)), -1]
        return freest


def _apart(a: Points, b: Points, span_px: float) -> list[Points]:
    """Return where two hands are when they have moved to a distance, or stay farther apart."""
    between = b - a
    now_px = max(float(np.linalg.norm(between)), 1e-9)
    step = 0.5 * max(span_px - now_px, 0.0) * between / now_px
    return [a - step, b + step]
