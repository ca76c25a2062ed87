"""Where hands take the cable for a move, and where they go with it.

The trace tells how the cable lies now. Where it will lie after a move is not predicted, so for
later moves of a plan these are the places on the cable, drawn where they are now.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from perception.cable.grasp_points import GraspConfig, HeldStrand
from perception.cable.planning.moves import END_MOVES, Hold, Move, MoveKind, Role
from perception.cable.planning.open_diagram import OpenDiagram
from perception.cable.polyline import arc_lengths
from perception.cable.topology.curve import Strand
from perception.cable.types import Points

STEP_PX = 4.0
# Hands look for a free way this far to both sides of the best one, so finely.
WAYS = 32
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
        points = [self.held.point(arc * self.held.length_px) for arc, _ in taken]
        return tuple(
            Grasp(
                hold.role,
                point,
                self.held.direction(arc * self.held.length_px),
                to,
                arc,
                room,
            )
            for hold, (arc, room), point, to in zip(
                move.holds, taken, points, self._targets(move, points), strict=True
            )
        )

    def _targets(self, move: Move, points: Sequence[Points]) -> list[Points]:
        """Return where each hand goes."""
        drawn_px = (move.interval[1] - move.interval[0]) * self.held.length_px
        if len(points) == 2:
            return _apart(points[0], points[1], drawn_px)
        if move.kind not in END_MOVES:
            return [self._beside(move)]
        origin = self._fold(move) if move.kind is MoveKind.LIFT_END else points[0]
        return [self._free_way(origin, move.interval, drawn_px)]

    def _beside(self, move: Move) -> Points:
        """Return the middle of a strand's new way: between its ends, or where it will cross."""
        marks = move.across or move.interval
        middle: Points = np.mean([self.held.point(a * self.held.length_px) for a in marks], axis=0)
        return middle

    def _fold(self, move: Move) -> Points:
        """Return where an end that is lifted will hang on the cable that stays."""
        stays = move.interval[1] if move.end == "start" else move.interval[0]
        return self.held.point(stays * self.held.length_px)

    def _free_way(self, origin: Points, moved: tuple[float, float], far_px: float) -> Points:
        """Return the point at a distance whose straight way there is freest of other cable."""
        arcs = self.held.arcs / self.held.length_px
        stays = self.held.line[(arcs < moved[0]) | (arcs > moved[1])]
        stays = stays[np.linalg.norm(stays - origin, axis=1) > self._config.own_px]
        angles = np.arange(WAYS) * 2.0 * np.pi / WAYS
        ways = np.column_stack([np.cos(angles), np.sin(angles)])
        shares = np.linspace(0.2, 1.0, 9)
        spots = origin + far_px * shares[None, :, None] * ways[:, None, :]
        gaps_px = np.linalg.norm(spots[:, :, None] - stays[None, None], axis=3)
        nearest_px = gaps_px.min(axis=(1, 2), initial=1e3)
        freest: Points = spots[int(np.argmax(nearest_px)), -1]
        return freest


def _apart(a: Points, b: Points, far_px: float) -> list[Points]:
    """Return where two hands are when they have moved apart, each half of the way."""
    between = b - a
    unit = between / max(float(np.linalg.norm(between)), 1e-9)
    return [a - 0.5 * far_px * unit, b + 0.5 * far_px * unit]
