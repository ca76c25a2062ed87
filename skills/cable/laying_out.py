"""Where two hands pull a knot apart to, so that the cable does not end up in a heap.

What a pull leaves is predicted from the trace: what hangs on either hand has followed it, and
where the hands are farther apart than there was cable between them, that is straight, and the
tail as much shorter. Where this crosses itself seldom, and little tail is left to draw, is best.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import hypot
from typing import Literal

import numpy as np

from perception.cable.polyline import arc_lengths, point_at
from perception.cable.topology.curve import self_intersections
from perception.cable.types import ImaginedHand
from robots.interfaces import Floats
from robots.placement import TABLE_SIZE_M
from skills.cable.knot_sites import REACH_X_M, REACH_Y_M

# Where a caging and a pinching hand go, on the table, shape (2,) each.
Ends = tuple[Floats, Floats]

# The line is looked at in steps of this length.
STEP_M = 0.025
# A hand's way is followed in so many parts.
PARTS = 4
# What hands can choose from: how far apart, which way, and where their middle is.
SPANS_M = (0.76, 0.66, 0.56, 0.46, 0.36, 0.26)
ANGLES_RAD = tuple(np.deg2rad((-60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0)))
MIDDLES_X_M = (-0.2, -0.1, 0.0, 0.1, 0.2)
MIDDLES_Y_M = (-0.14, -0.06, 0.02, 0.10, 0.16)
# Arms that are to pass each other collide: hands keep so far apart along the table.
ABREAST_M = 0.10
# What is out there falls off the table, or is not seen well.
RIM_M = 0.03
# In crossings: a metre of tail that is left to draw, that any is left, and a step of cable close
# beside another.
TAIL_COST, LEFT_COST, BESIDE_COST = 20.0, 4.0, 0.15
# In crossings: a step of cable that would come to lie off the table.
OFF_COST = 1.0
# A plug does not pass through a cage: so much before it is there, that hand lets the cable go.
PLUG_M = 0.04
# A strand that passes so near to where a hand takes hold may come between its fingers too.
FINGERS_M = 0.018
# It pulls at least so much of the way before it lets go.
LEAST_SHARE = 0.1
# A tail is out when so much more has been drawn: connectors, and cable that was not quite straight.
MARGIN_M = 0.06
BESIDE_M = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Pull:
    """Two hands at a cable: one where its tail enters a loop, one at the strand that closes it.

    The first hand lets the cable slide (a cage) where the hands go farther apart than there is
    cable between them; else it takes the cable along (a pinch), and with it the tail.

    Attributes:
        line_m: The cable on the table, evenly spaced, shape (N, 2).
        cage_m: Length from its start to the first hand: the tail that is to be drawn out.
        pinch_m: The same of the other hand, farther along.
    """

    line_m: Floats
    cage_m: float
    pinch_m: float

    def slides(self, ends: Ends) -> bool:
        """Return whether the first hand is a cage for places of both hands."""
        return float(np.linalg.norm(ends[1] - ends[0])) > self.pinch_m - self.cage_m

    def drawn_m(self, ends: Ends) -> float:
        """Return how much of the tail is drawn out, at most all of it."""
        return min(max(0.0, self._taken_m(ends)), self.cage_m)

    def left_m(self, ends: Ends) -> float:
        """Return how much is still to be drawn until the tail is out for sure."""
        return max(0.0, self.cage_m + MARGIN_M - max(0.0, self._taken_m(ends)))

    def _taken_m(self, ends: Ends) -> float:
        """Return how much farther apart the hands go than the cable between them reaches."""
        span_m = float(np.linalg.norm(ends[1] - ends[0]))
        if self.slides(ends):
            return span_m - (self.pinch_m - self.cage_m)
        arcs = arc_lengths(self.line_m)
        hands_m = point_at(self.line_m, arcs, np.array([self.cage_m, self.pinch_m]))
        return span_m - float(np.linalg.norm(hands_m[1] - hands_m[0]))

    def lets_go(self, ends: Ends) -> float:
        """Return the share of the hands' way after which the first one opens, before the plug.

        Where the hands pull on against a plug, it is torn out of them, and the cable flies.
        """
        shares = np.linspace(LEAST_SHARE, 1.0, 46)[:, None]
        hands_m = point_at(
            self.line_m, arc_lengths(self.line_m), np.array([self.cage_m, self.pinch_m])
        )
        between_m = (1.0 - shares) * (hands_m[1] - hands_m[0]) + shares * (ends[1] - ends[0])
        taut = np.linalg.norm(between_m, axis=1) >= self._held_m(hands_m[1]) - PLUG_M
        return float(shares[np.argmax(taut), 0]) if taut.any() else 1.0

    def _held_m(self, pinch_m: Floats) -> float:
        """Return the length from the start to the first strand that the second hand may hold."""
        arcs_m = arc_lengths(self.line_m)
        near = np.linalg.norm(self.line_m - pinch_m, axis=1) < FINGERS_M
        beyond_m = arcs_m[near & (arcs_m > self.cage_m + FINGERS_M)]
        return float(min(beyond_m.min(initial=np.inf), self.pinch_m))

    def hands(self, ends: Ends) -> tuple[ImaginedHand, ImaginedHand]:
        """Return what both hands do that go to these places."""
        length_m = float(arc_lengths(self.line_m)[-1])
        role: Literal["cage", "pinch"] = "cage" if self.slides(ends) else "pinch"
        first = ImaginedHand(role, self.cage_m / length_m, ends[0], self.lets_go(ends))
        return first, ImaginedHand("pinch", self.pinch_m / length_m, ends[1])

    def predicted(self, ends: Ends) -> Floats:
        """Return the line that is left when both hands have gone to these places."""
        until_pinch = self._slid(ends) if self.slides(ends) else self._taken_along(ends)
        rest = self._piece(self.pinch_m, float(arc_lengths(self.line_m)[-1]))
        return np.vstack([until_pinch, followed(rest, ends[1])[1:]])

    def _slid(self, ends: Ends) -> Floats:
        """Return the line up to the second hand where the cable slid through the first one."""
        span_m, drawn_m = float(np.linalg.norm(ends[1] - ends[0])), self.drawn_m(ends)
        # What was let go ends where it is straight behind the second hand.
        begin_m = ends[1] + (ends[0] - ends[1]) * min(1.0, self.pinch_m / span_m)
        middle: Floats = np.linspace(begin_m, ends[1], max(int(span_m / STEP_M), 1) + 1)
        if drawn_m >= self.cage_m:
            return middle
        tail = followed(self._piece(drawn_m, self.cage_m)[::-1], ends[0])[::-1]
        return np.vstack([tail[:-1], middle])

    def _taken_along(self, ends: Ends) -> Floats:
        """Return the line up to the second hand where the first one has not let it slide."""
        tail = followed(self._piece(0.0, self.cage_m)[::-1], ends[0])[::-1]
        between = self._piece(self.cage_m, self.pinch_m)
        middle = followed(followed(between, ends[0])[::-1], ends[1])[::-1]
        return np.vstack([tail[:-1], middle])

    def _piece(self, begin_m: float, end_m: float) -> Floats:
        steps = max(round((end_m - begin_m) / STEP_M), 1)
        at_m = np.linspace(begin_m, end_m, steps + 1)
        piece: Floats = point_at(self.line_m, arc_lengths(self.line_m), at_m)
        return piece

    def cost(self, ends: Ends) -> float:
        """Return how bad it is to leave the cable as it is predicted, in crossings."""
        return tangle_cost(self.predicted(ends)) + self.left_cost(ends)

    def left_cost(self, ends: Ends) -> float:
        """Return how bad it is that this much of the tail is left, in crossings."""
        left_m = self.left_m(ends)
        return TAIL_COST * left_m + (LEFT_COST if left_m > 0.0 else 0.0)


def crossings_of(line_m: Floats) -> int:
    """Return how often a line crosses itself."""
    return len(self_intersections(line_m)[0])


def tangle_cost(line_m: Floats) -> float:
    """Return how hard a line is to understand: crossings, what lies beside it, or off the table."""
    crossings = crossings_of(line_m)
    gaps_m = np.linalg.norm(line_m[:, None] - line_m[None], axis=2)
    apart = np.abs(np.subtract.outer(np.arange(len(line_m)), np.arange(len(line_m)))) > 4
    beside = float(((gaps_m < BESIDE_M) & apart).sum()) / 2.0
    return crossings + BESIDE_COST * beside + OFF_COST * _steps_off(line_m)


def _steps_off(line_m: Floats) -> float:
    """Return how much of a line lies off the table or at its rim, in steps of `STEP_M`."""
    half_m = 0.5 * np.array(TABLE_SIZE_M) - RIM_M
    return float((np.abs(line_m) > half_m).any(axis=1).mean() * arc_lengths(line_m)[-1] / STEP_M)


def followed(line_m: Floats, to_m: Floats) -> Floats:
    """Return where a line lies when its first point has been drawn to a place.

    Every point follows the one before it as soon as that is too far away (a tractrix), as a
    cable does that friction holds everywhere.
    """
    xs, ys = line_m.T.tolist()  # plain numbers: each point waits for the one before it
    lengths = np.linalg.norm(np.diff(line_m, axis=0), axis=1).tolist()
    for share in np.arange(1, PARTS + 1) / PARTS:
        xs[0], ys[0] = ((1.0 - share) * line_m[0] + share * to_m).tolist()
        for k, length in enumerate(lengths, start=1):
            x, y = xs[k] - xs[k - 1], ys[k] - ys[k - 1]
            gap = hypot(x, y)
            if gap <= length:
                break
            xs[k], ys[k] = xs[k - 1] + x * (length / gap), ys[k - 1] + y * (length / gap)
    return np.column_stack([xs, ys])


def places(left_holds_cage: bool) -> Iterator[Ends]:
    """Yield places for cage and pinch hand within reach, arms not crossed."""
    for span_m, angle, x_m, y_m in product(SPANS_M, ANGLES_RAD, MIDDLES_X_M, MIDDLES_Y_M):
        half = 0.5 * span_m * np.array([np.cos(angle), np.sin(angle)])
        left, right = np.array([x_m, y_m]) - half, np.array([x_m, y_m]) + half
        if right[0] - left[0] >= ABREAST_M and _in_reach(left) and _in_reach(right):
            yield (left, right) if left_holds_cage else (right, left)


def _in_reach(point_m: Floats) -> bool:
    return bool(abs(point_m[0]) <= REACH_X_M + 1e-9 and REACH_Y_M[0] <= point_m[1] <= REACH_Y_M[1])


def best_places(pull: Pull, left_holds_cage: bool, count: int) -> Sequence[Ends]:
    """Return places for both hands, the best first; the first hand slides for all or for none.

    Args:
        pull: What is held.
        left_holds_cage: Whether the left hand does.
        count: How many to return.

    Returns:
        Places that should leave no more crossings than there are; none where all leave more, or
        where the pinch is not farther along than the cage.
    """
    if pull.pinch_m <= pull.cage_m:
        return []
    ends, present = list(places(left_holds_cage)), crossings_of(pull.line_m)
    least = np.array([pull.left_cost(pair) for pair in ends])
    costs = dict[int, float]()
    for k in np.argsort(least, kind="stable").tolist():
        # Crossings only add to what is left of the tail: no later place can be among the best.
        if len(costs) >= count and least[k] > sorted(costs.values())[count - 1]:
            break
        line_m = pull.predicted(ends[k])
        if crossings_of(line_m) <= present:
            costs[k] = tangle_cost(line_m) + pull.left_cost(ends[k])
    best = [ends[k] for k in sorted(costs, key=lambda k: (costs[k], k))]
    return [pair for pair in best if pull.slides(pair) == pull.slides(best[0])][:count]
