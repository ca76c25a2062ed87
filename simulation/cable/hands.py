"""Grippers as the cable feels them: what they take, and how they hold it."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from simulation.cable.parameters import RodParameters

Floats = NDArray[np.float64]
GraspMode = Literal["pinch", "cage"]

# Finger tips reach this far beyond the tool centre point.
TIP_BEYOND_TCP_M = 0.006
# The space between the fingers: how deep inside the hand, and how wide, a cable counts.
DEPTH_M, WIDTH_M = 0.020, 0.008
# Less cable than this between the fingers is not a grasp.
SHORTEST_HOLD_M = 0.003
# Fingers close at this speed, and bring the cable to their middle.
CLOSING_SPEED_M_S = 0.05


@dataclass(slots=True, eq=False)
class Strand:
    """One piece of cable in a hand.

    Attributes:
        mode: How it is held.
        arc: Where along the chain, in segments from the first node.
        span: First and last node of the cable.
        p_tcp_m: Where it is held in the tool frame, shape (3,).
        rest_x_m: Where along the opening direction closed fingers hold it.
        force_n: Force of the hand on it over the last advance, world frame, shape (3,).
    """

    mode: GraspMode
    arc: float
    span: tuple[int, int]
    p_tcp_m: Floats
    rest_x_m: float
    force_n: Floats = field(default_factory=lambda: np.zeros(3))

    def arc_limits(self, plug_nodes: int) -> tuple[float, float]:
        """Return how far it may slide: a plug does not pass, but may be what is held."""
        first, last = self.span
        return (min(float(first + plug_nodes), self.arc), max(float(last - plug_nodes), self.arc))

    def held_m(self, nodes_m: Floats) -> Floats:
        """Return where that point of the cable is, given all nodes, shape (3,)."""
        first, last = self.span
        return point_on(nodes_m[first : last + 1], self.arc - first)

    def closed_by(self, duration_s: float) -> Floats:
        """Return where closing fingers hold it after that time, tool frame, shape (3,)."""
        left = self.rest_x_m - self.p_tcp_m[0]
        step = CLOSING_SPEED_M_S * duration_s
        return self.p_tcp_m + np.array([np.clip(left, -step, step), 0.0, 0.0])


class Hand:
    """A gripper: where it is, where it is going, what it holds."""

    def __init__(self, pose: Floats) -> None:
        """Stand still at `pose` (T_world_tcp), open."""
        self.pose = pose
        self.next_pose = pose
        self.strands: tuple[Strand, ...] = ()

    def close(
        self,
        mode: GraspMode,
        nodes_m: Floats,
        spans: Sequence[tuple[int, int]],
        opening_m: Floats,
        parameters: RodParameters,
    ) -> None:
        """Take every strand that passes between the fingers.

        Args:
            mode: What the fingers do.
            nodes_m: Of all cables, shape (N, 3).
            spans: First and last node of each cable.
            opening_m: Gap, width and depth of what is between the fingers.
            parameters: What the cables are made of.
        """
        rotation, origin = self.pose[:3, :3], self.pose[:3, 3]
        local = (nodes_m - origin) @ rotation
        half = 0.5 * opening_m
        low = np.array([-half[0], -half[1], -opening_m[2]])
        high = np.array([half[0], half[1], TIP_BEYOND_TCP_M])
        held = [
            (first + arc, (first, last), point_on(local[first : last + 1], arc))
            for first, last in spans
            for arc in strands_in_box(local[first : last + 1], low, high)
        ]
        held.sort(key=lambda item: (item[2][0], item[0]))
        middle = 0.5 * (len(held) - 1)
        self.strands = tuple(
            Strand(mode, arc, span, point, (rank - middle) * 2.0 * parameters.radius_m)
            for rank, (arc, span, point) in enumerate(held)
        )

    def strand_path(self, strand: Strand, duration_s: float) -> tuple[Floats, Floats]:
        """Return where a strand is held at both ends of an advance, world frame."""
        start = self._point(strand.p_tcp_m)
        end = self.next_pose[:3, :3] @ strand.closed_by(duration_s) + self.next_pose[:3, 3]
        return start, end

    def arrive(self, duration_s: float, nodes_m: Floats, tear_m: float) -> None:
        """Take the pose and the closing that the advance ended with; lose what was torn out."""
        for strand in self.strands:
            strand.p_tcp_m = strand.closed_by(duration_s)
        self.pose = self.next_pose
        self.strands = tuple(
            strand
            for strand in self.strands
            if np.linalg.norm(self._point(strand.p_tcp_m) - strand.held_m(nodes_m)) < tear_m
        )

    def _point(self, p_tcp_m: Floats) -> Floats:
        point: Floats = self.pose[:3, :3] @ p_tcp_m + self.pose[:3, 3]
        return point


def point_on(nodes_m: Floats, arc: float) -> Floats:
    """Return the point at `arc` segments from the first node, shape (3,)."""
    i = min(int(arc), len(nodes_m) - 2)
    return nodes_m[i] + (arc - i) * (nodes_m[i + 1] - nodes_m[i])


def strands_in_box(nodes_m: Floats, low_m: Floats, high_m: Floats) -> list[float]:
    """Return the middle (in segments) of each stretch of the chain inside a box.

    Args:
        nodes_m: Centre line in the frame of the box, shape (N, 3).
        low_m: Lower corner, shape (3,).
        high_m: Upper corner, shape (3,).
    """
    enter, leave = _clip(nodes_m, low_m, high_m)
    lengths_m = np.linalg.norm(np.diff(nodes_m, axis=0), axis=1)
    middles: list[float] = []
    begin = -1
    for i in range(len(enter) + 1):
        inside = i < len(enter) and enter[i] < leave[i]
        joined = inside and begin >= 0 and enter[i] == 0.0 and leave[i - 1] == 1.0
        if begin >= 0 and not joined:
            span = slice(begin, i)
            held_m = float(((leave - enter)[span] * lengths_m[span]).sum())
            if held_m >= SHORTEST_HOLD_M:
                middles.append(0.5 * (begin + enter[begin] + i - 1 + leave[i - 1]))
            begin = -1
        if inside and begin < 0:
            begin = i
    return middles


def _clip(nodes_m: Floats, low_m: Floats, high_m: Floats) -> tuple[Floats, Floats]:
    """Return where each segment enters and leaves a box, as fractions (slab method)."""
    start, step = nodes_m[:-1], np.diff(nodes_m, axis=0)
    step = np.where(np.abs(step) < 1e-12, 1e-12, step)
    first, second = (low_m - start) / step, (high_m - start) / step
    enter = np.maximum(np.minimum(first, second).max(axis=1), 0.0)
    leave = np.minimum(np.maximum(first, second).min(axis=1), 1.0)
    return enter, leave
