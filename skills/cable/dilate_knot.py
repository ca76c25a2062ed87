"""Loosen or undo a knot: one hand cages the cable, the other pinches it, both pull apart."""

from collections.abc import Generator, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, SkillRun
from executive.core.work import Worker
from perception.cable.grasp_sites import GraspSite
from perception.cable.interfaces import Foresight
from perception.cable.polyline import arc_lengths
from perception.cable.types import Crossing, Knot, Trace
from perception.camera import CameraFrame
from robots.interfaces import Arm, DualArm, Floats, MotionFailure, TcpGoal
from skills.cable.grasping import CLEARANCE_M, LIFT_M, carried, grasp_goal
from skills.cable.imagining import best_imagined
from skills.cable.knot_sites import REACH_X_M, REACH_Y_M, Pair, given_pairs, searched_pairs
from skills.cable.laying_out import Ends, Pull, best_places, crossings_of
from skills.cable.policies import HoldAt
from skills.motion.arm_skill import MOTION_REASONS, ArmSkill
from skills.motion.goals import above

# The hand that cages and the one that pinches.
_Hands = tuple[Arm, Arm]

MOST_PAIRS = 60
# Where the whole way apart is out of reach, these parts of it are tried in turn.
SHARES_OF_TRAVEL = (1.0, 0.8, 0.6, 0.4, 0.2)
# How many of the best places are tried before that.
MOST_ENDS = 8
# So many pairs of sites in reach are tried for a way to such a place, each for so many places: to
# find that two arms are in each other's way takes seconds. Places that lie this near are alike.
MOST_PULLS, MOST_TRIES, ALIKE_M = 2, 2, 0.1
# Where pulls can be imagined, so many pairs that are so far apart along the trace are held against
# each other, each with so many places out of as many.
IMAGINED_PULLS, APART_ARC, IMAGINED_PLACES, IMAGINED_OF = 4, 0.015, 3, 30

NOWHERE = MotionFailure(
    "motion.unreachable", "ik", "no two sites around the knot are apart and in reach"
)
REFUSED = MotionFailure(
    "pull.refused", "plan", "wherever the hands could go, more crossings than now should be left"
)
UP_M = (np.array([0.0, 0.0, CLEARANCE_M]),)
# A taut cable is thrown when a hand lets it go. Hands first come nearer by so much each: cable
# of 1 m gives 2 mm before it slips out of the fingers.
SLACK_M = 0.006


@dataclass(frozen=True, slots=True, eq=False)
class _Grip:
    """A way to hold a knot.

    Attributes:
        hands: The hand that cages and the one that pinches.
        goals: Where each of them takes hold.
        pull: The same on the trace.
        ends_m: Places for both to go to, the best first; none for straight apart.
        onward_m: Straight motions of each from where it takes hold.
        foreseen: How many crossings should be left at the first places, where that was imagined.
    """

    hands: _Hands
    goals: tuple[TcpGoal, TcpGoal]
    pull: Pull
    ends_m: Sequence[Ends] = ()
    onward_m: tuple[tuple[Floats, ...], tuple[Floats, ...]] = (UP_M, UP_M)
    foreseen: int | None = None

    def left_by(self, ends: Ends) -> int:
        """Return how many crossings should be left when the hands have gone to these places."""
        if self.foreseen is not None and ends is self.ends_m[0]:
            return self.foreseen
        return crossings_of(self.pull.predicted(ends))


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """What is seen of the cable.

    Attributes:
        frame: Overhead frame.
        trace: Path of the cable.
        over: Arc positions where it lies on top of itself.
    """

    frame: CameraFrame
    trace: Trace
    over: tuple[float, ...]


class DilateKnot(ArmSkill):
    """Pull a knot open with a caging and a pinching gripper (thesis, section 3.5).

    The cable slides through the cage, so that the loop grows and the tail is drawn out of it,
    while the pinch keeps other knots in series from running together.

    SUCCESS: both hands held the cable, moved apart and laid it down; `predicted` is how many
        crossings should be left where the hands have gone.
    FAILURE: `knot.none` when there is no knot to dilate; `pull.refused` when wherever the hands
        could go, more crossings than now should be left; a motion reason when no pair of
        sites suits both arms; `grasp.missed` when a hand closed on nothing.
    stop(): arms come to rest; a held cable stays held.
    """

    OUT = {"predicted": Port(int, "crossings that should be left")}
    REASONS = MOTION_REASONS | {"knot.none", "pull.refused", "grasp.missed"}

    def __init__(self, arms: DualArm, worker: Worker, foresight: Foresight | None = None) -> None:
        """Bind the arms, who plans for them, and who can imagine what pulls would do."""
        super().__init__(arms, worker)
        self._foresight = foresight

    def run(
        self,
        frame: Annotated[CameraFrame, In("overhead frame")],
        trace: Annotated[Trace, In("path of the cable")],
        crossings: Annotated[tuple[Crossing, ...], In("crossings of the trace")],
        knots: Annotated[tuple[Knot, ...], In("knots of the trace")],
        travel_m: Annotated[float, In("how much farther apart the hands move", "m")] = 0.5,
        hold_at: Annotated[HoldAt, In("best places in reach, or the knot's")] = "searched",
        planned: Annotated[bool, In("go to where the cable should lie best instead")] = False,
        behind: Annotated[bool, In("hold it behind the knot where there is no room in it")] = True,
    ) -> SkillRun:
        """Take hold with both hands, lift, pull apart, lay down, rise."""
        if not knots:
            return failure("knot.none", "no knot was found to dilate")
        if hold_at == "searched":
            pairs = searched_pairs(trace, crossings, knots[0], frame, behind)
        else:
            pairs = given_pairs(trace, knots[0], frame)
        seen = _Seen(frame, trace, tuple(c.arc_over for c in crossings if _is_own(c)))
        found = yield from self._reach_down(seen, pairs[:MOST_PAIRS], planned)
        if isinstance(found, MotionFailure):
            return failure(found.code, found.text, stage=found.stage)
        hands = found.hands
        slides = not found.ends_m or found.pull.slides(found.ends_m[0])
        yield from self._set_grips({hands[0]: "cage" if slides else "pinch", hands[1]: "pinch"})
        missed = [arm for arm in hands if not self._arms.holds(arm)]
        gone: Ends | MotionFailure | None = None
        if not missed:
            gone = yield from self._pull_apart(found, travel_m if slides else 0.0)
        risen = yield from self._release(hands, CLEARANCE_M)
        if missed or gone is None:
            return failure("grasp.missed", f"closed on nothing: {', '.join(missed)}")
        if isinstance(gone, MotionFailure):
            return failure(gone.code, gone.text, stage=gone.stage)
        if risen is not None:
            return failure(risen.code, risen.text, stage=risen.stage)
        return success(predicted=found.left_by(gone))

    def _reach_down(
        self, seen: "_Seen", ranked: Sequence[Pair], planned: bool
    ) -> Generator[None, None, "_Grip | MotionFailure"]:
        """Put both hands around the cable at the best pair of sites that they can reach.

        Returns:
            How the cable is held, or why the last pair that was tried failed.
        """
        grips = self._grips(seen, ranked, planned)
        failed = NOWHERE
        while True:
            found = yield from self._worker.run(next, grips, failed)
            if isinstance(found, MotionFailure):
                return found
            goals = dict(zip(found.hands, found.goals, strict=True))
            onward_m = dict(zip(found.hands, found.onward_m, strict=True))
            blocked = yield from self._descend(goals, CLEARANCE_M, onward_m)
            if blocked is None:
                return found
            failed = blocked

    def _grips(
        self, seen: "_Seen", ranked: Sequence[Pair], planned: bool
    ) -> Iterator["_Grip | MotionFailure"]:
        """Yield ways to hold that both hands can come down to, those first that can go on.

        The last is a failure where none of them can go anywhere without making more crossings.
        """
        without, refused = list[_Grip](), 0
        foreseen = planned and self._foresight is not None
        most = IMAGINED_PULLS if foreseen else MOST_PULLS
        for pair in _apart(ranked) if foreseen else ranked:
            goals = (_goal(seen.frame, pair[0]), _goal(seen.frame, pair[1]))
            hands = self._arms.assign((above(goals[0], CLEARANCE_M), above(goals[1], CLEARANCE_M)))
            if isinstance(hands, MotionFailure):
                continue
            grip = _Grip(hands, goals, held_pull(seen.frame, seen.trace, *pair))
            if not planned:
                yield grip
                continue
            left_first = hands[0] == "left"
            count = IMAGINED_OF if foreseen else MOST_ENDS
            ends_m = tuple(best_places(grip.pull, left_first, count))
            if not ends_m and grip.pull.pinch_m > grip.pull.cage_m:
                refused += 1
            else:
                without.append(replace(grip, ends_m=ends_m))
                if not foreseen:
                    yield from self._with_places(without[-1], unlike(ends_m)[:MOST_TRIES])
            if len(without) + refused == most:
                break
        if foreseen and self._foresight is not None:
            pulls = [(grip.pull, unlike(grip.ends_m)[:IMAGINED_PLACES]) for grip in without]
            for found in best_imagined(self._foresight, pulls, seen.over):
                grip = replace(without[found.pull], foreseen=found.crossings)
                yield from self._with_places(grip, [found.ends])
        yield from without
        if refused and not without:
            yield REFUSED

    def _with_places(self, grip: "_Grip", places: Sequence[Ends]) -> Iterator["_Grip"]:
        """Yield the way to hold with the first places to go to that both hands can make."""
        for ends in places:
            shares = (grip.pull.lets_go(ends), 1.0)
            onward_m = tuple(
                carried(share * np.append(end_m - goal.position_m[:2], 0.0))
                for end_m, goal, share in zip(ends, grip.goals, shares, strict=True)
            )
            hovers = tuple(
                above(goal, CLEARANCE_M, *onward)
                for goal, onward in zip(grip.goals, onward_m, strict=True)
            )
            if self._arms.assign((hovers[0], hovers[1])) == grip.hands:
                rest = [other for other in grip.ends_m if other is not ends]
                onward = (onward_m[0], onward_m[1])
                yield replace(grip, ends_m=(ends, *rest), onward_m=onward)
                return

    def _pull_apart(
        self, grip: "_Grip", travel_m: float
    ) -> Generator[None, None, "Ends | MotionFailure"]:
        """Lift, move apart, lay down: to the first places that the arms reach, else straight apart.

        Args:
            grip: How the cable is held, and where the hands may go.
            travel_m: How much farther apart they move where no place is reached; 0 for not at all.

        Returns:
            The places on the table where the hands went, or why they could not.
        """
        up_m = np.array([0.0, 0.0, LIFT_M])
        failed = yield from self._move_by(dict.fromkeys(grip.hands, up_m))
        if failed is not None:
            return failed
        tips_m = {arm: self._arms.tcp_position(arm) for arm in grip.hands}
        gone: Ends | MotionFailure = (tips_m[grip.hands[0]][:2], tips_m[grip.hands[1]][:2])
        holding: tuple[Arm, ...] = grip.hands
        for way_m, share, ends in _ways(grip, tips_m, travel_m):
            failed = yield from self._move_by({arm: share * way_m[arm] for arm in grip.hands})
            gone = failed or ends
            if failed is None:
                if share < 1.0:
                    onward_m = (1.0 - share) * way_m[grip.hands[1]]
                    holding = yield from self._draw_out(grip.hands, onward_m)
                break
        if len(holding) > 1:
            yield from self._slacken(grip.hands)
        # Where hands cannot lay it down at the end of their way, the cable falls these 3 cm.
        yield from self._move_by(dict.fromkeys(holding, -up_m))
        return gone

    def _draw_out(self, hands: _Hands, way_m: Floats) -> Generator[None, None, tuple[Arm, ...]]:
        """Let the first hand go, before the plug comes to it; the second draws the end out of it.

        A way that cannot be gone on is left out: the tail is through by then.

        Returns:
            Who still holds the cable.
        """
        yield from self._slacken(hands)
        yield from self._set_grips({hands[0]: "open"})
        yield from self._move_by({hands[1]: way_m})
        return hands[1:]

    def _slacken(self, hands: _Hands) -> Generator[None, None, None]:
        """Bring the hands a little nearer to each other, so that the cable is not taut."""
        first_m, second_m = (self._arms.tcp_position(arm) for arm in hands)
        level_m = (second_m - first_m) * [1.0, 1.0, 0.0]
        nearer_m = SLACK_M * level_m / max(float(np.linalg.norm(level_m)), 1e-9)
        yield from self._move_by({hands[0]: nearer_m, hands[1]: -nearer_m})


def _apart(pairs: Sequence[Pair]) -> Iterator[Pair]:
    """Yield those pairs of sites that are not much the same as earlier ones."""
    kept = list[Floats]()
    for pair in pairs:
        arcs = np.array([site.arc for site in pair])
        if all(np.abs(arcs - other).max() > APART_ARC for other in kept):
            kept.append(arcs)
            yield pair


def _is_own(crossing: Crossing) -> bool:
    """Return whether the first trace crosses itself there."""
    return crossing.trace_over == crossing.trace_under == 0


def unlike(ends_m: Sequence[Ends]) -> list[Ends]:
    """Return those places that are not much the same as better ones."""
    kept = list[Ends]()
    for ends in ends_m:
        gaps_m = [np.linalg.norm(np.subtract(ends, other), axis=1).max() for other in kept]
        if min(gaps_m, default=np.inf) > ALIKE_M:
            kept.append(ends)
    return kept


def held_pull(frame: CameraFrame, trace: Trace, cage: GraspSite, pinch: GraspSite) -> Pull:
    """Return a trace on the table with both hands on it."""
    line_m = frame.camera.on_plane(trace.points_px)[:, :2]
    length_m = float(arc_lengths(line_m)[-1])
    return Pull(line_m, cage.arc * length_m, pinch.arc * length_m)


def _ways(
    grip: _Grip, tips_m: Mapping[Arm, Floats], travel_m: float
) -> Iterator[tuple[dict[Arm, Floats], float, Ends]]:
    """Yield displacements of hands at the height where they are, and where these lead.

    With each comes the share of it after which the first hand is to let go: 1 for never.
    """
    for ends in grip.ends_m:
        way_m = {
            arm: np.append(end_m - tips_m[arm][:2], 0.0)
            for arm, end_m in zip(grip.hands, ends, strict=True)
        }
        yield way_m, grip.pull.lets_go(ends), ends
    for way_m in _ways_apart(tips_m, travel_m):
        first_m, second_m = (tips_m[arm][:2] + way_m[arm][:2] for arm in grip.hands)
        yield way_m, 1.0, (first_m, second_m)


def _ways_apart(tips_m: Mapping[Arm, Floats], travel_m: float) -> Iterator[dict[Arm, Floats]]:
    """Yield displacements that move the hands apart, ever less far; none for no travel."""
    if travel_m == 0.0:
        return
    present_m = float(np.linalg.norm(tips_m["left"] - tips_m["right"]))
    for share in SHARES_OF_TRAVEL:
        yield apart(tips_m, min(present_m + share * travel_m, 2.0 * REACH_X_M))


def apart(tips_m: Mapping[Arm, Floats], span_m: float) -> dict[Arm, Floats]:
    """Return displacements that put the hands `span_m` apart along the table's long side.

    The long side has the reach for it; the middle between the hands moves only as far as the
    reach demands.
    """
    middle_m = (tips_m["left"] + tips_m["right"]) / 2.0
    most_m = max(0.0, REACH_X_M - span_m / 2.0)
    middle_x_m = float(np.clip(middle_m[0], -most_m, most_m))
    middle_y_m = float(np.clip(middle_m[1], REACH_Y_M[0] + 0.03, REACH_Y_M[1] - 0.03))
    ends_m = {"left": middle_x_m - span_m / 2.0, "right": middle_x_m + span_m / 2.0}
    return {
        arm: np.array([ends_m[arm], middle_y_m, tips_m[arm][2]]) - tips_m[arm] for arm in tips_m
    }


def _goal(frame: CameraFrame, site: GraspSite) -> TcpGoal:
    return grasp_goal(frame, site.point_px, site.direction)
