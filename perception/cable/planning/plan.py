"""Plan how a robot undoes a cable: the cheapest moves whose predicted diagrams end simple."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from types import MappingProxyType
from typing import Literal

import numpy as np

from perception.cable.crossings import strand_of
from perception.cable.grasp_points import GraspConfig
from perception.cable.planning.finder import MoveFinder, MoveRules
from perception.cable.planning.grasping import Grasp, Places
from perception.cable.planning.moves import End, Move, MoveKind
from perception.cable.planning.open_diagram import OpenDiagram, open_diagram
from perception.cable.planning.search import Found, Problem, cheapest
from perception.cable.topology import Knottedness, classify_diagram
from perception.cable.topology.curve import Strand
from perception.cable.types import Crossing, Points, Trace

# What a move costs before anything else, about the seconds that two arms need for it.
KIND_COSTS: Mapping[MoveKind, float] = MappingProxyType(
    {
        MoveKind.LIFT_END: 10.0,
        MoveKind.PULL_APART: 12.0,
        MoveKind.UNTWIST: 14.0,
        MoveKind.LAY_OVER: 14.0,
        MoveKind.DRAW_OUT: 16.0,
        MoveKind.PULL_OUT: 16.0,
        MoveKind.DILATE: 20.0,
    }
)

# Where the cheapest plan is too far to search for, crossings that are left weigh so much more.
HASTE = 3.0


@dataclass(frozen=True, slots=True)
class MoveCosts:
    """What moves cost beside what their kind does.

    Attributes:
        per_visit: For each visit that is undone or laid elsewhere.
        per_below: For each of these that runs under a strand, which rubs.
        whole_cable: For drawing the whole cable along; a piece of it costs its share.
        crowded: For taking the cable where fingers have no room at all, each hand.
    """

    per_visit: float = 1.0
    per_below: float = 2.0
    whole_cable: float = 20.0
    crowded: float = 4.0


@dataclass(frozen=True, slots=True)
class PlannerConfig:
    """Settings of the planner.

    Attributes:
        goal: Whether to end without crossings, or as soon as it is proved that no knot is left.
        rules: What the robot may do.
        costs: What it costs.
        grasps: How much room hands need.
        least_room: The share of that room below which fingers cannot take hold at all.
        states: How many diagrams are looked at for the cheapest plan, and if that was not
            enough, as many again for any good one.
    """

    goal: Literal["uncrossed", "unknotted"] = "uncrossed"
    rules: MoveRules = field(default_factory=MoveRules)
    costs: MoveCosts = field(default_factory=MoveCosts)
    grasps: GraspConfig = field(default_factory=GraspConfig)
    least_room: float = 0.3
    states: int = 300


class PlanFailure(StrEnum):
    """Why there is no plan."""

    NOT_PLANAR = "over and under, or the trace, are wrong: no cable on a table looks like this"
    ENDS_FIXED = "it is knotted, and no end can be moved"
    NO_ROOM = "fingers have no room at any place that the next move needs"
    NO_MOVES = "no move leads on"
    BUDGET = "not found among as many diagrams as may be looked at"


@dataclass(frozen=True, slots=True, eq=False)
class PlanStep:
    """One move of a plan.

    Attributes:
        kind: What is done.
        end: Which end of the trace is moved; None for none.
        interval: Arc positions between which the cable is moved.
        grasps: What each hand does; those of a dilation are cage and pinch.
        predicted: The diagram that should be left.
        cost: What it costs, about seconds.
    """

    kind: MoveKind
    end: End | None
    interval: tuple[float, float]
    grasps: tuple[Grasp, ...]
    predicted: OpenDiagram
    cost: float


@dataclass(frozen=True, slots=True, eq=False)
class Plan:
    """How to undo a cable.

    Attributes:
        seen: The diagram that was planned from.
        steps: Moves, in order; none where nothing is left to do, or no plan was found.
        states: How many diagrams were looked at.
        failure: Why no plan was found; None where one was.
    """

    seen: OpenDiagram
    steps: tuple[PlanStep, ...]
    states: int
    failure: PlanFailure | None

    @property
    def cost(self) -> float:
        """What all steps cost together."""
        return sum(step.cost for step in self.steps)


def plan_trace(
    trace: Trace,
    index: int,
    crossings: Sequence[Crossing],
    config: PlannerConfig | None = None,
) -> Plan:
    """Plan on what was seen in an image.

    Args:
        trace: The cable.
        index: Its number in the crossings.
        crossings: Crossings of all traces.
        config: Settings.

    Returns:
        The plan, its grasp points in pixels of the image.
    """
    plan = plan_moves(strand_of(trace, index, crossings), config)
    steps = (replace(s, grasps=tuple(map(_in_image, s.grasps))) for s in plan.steps)
    return replace(plan, steps=tuple(steps))


def _in_image(grasp: Grasp) -> Grasp:
    """Knot theory's y points up, that of images down."""

    def turned(point: Points) -> Points:
        return point * np.array([1.0, -1.0])

    point, direction, to = map(turned, (grasp.point, grasp.direction, grasp.to))
    return replace(grasp, point=point, direction=direction, to=to)


def plan_moves(strand: Strand, config: PlannerConfig | None = None) -> Plan:
    """Return the cheapest moves that undo a cable.

    Args:
        strand: The cable with its crossings, in pixels.
        config: Settings.

    Returns:
        The plan, its grasp points in the coordinates of the strand; or why there is none.
    """
    planner = _Planner(strand, config or PlannerConfig())
    return planner.plan()


class _Planner:
    """Plans for one strand."""

    def __init__(self, strand: Strand, config: PlannerConfig) -> None:
        self._config = config
        self._seen = open_diagram(strand)
        self._places = Places(strand, self._seen, config.grasps)
        self._finder = MoveFinder(config.rules)
        self._cramped = False

    def plan(self) -> Plan:
        """Search, and say how it went."""
        if not self._seen.is_planar():
            return Plan(self._seen, (), 0, PlanFailure.NOT_PLANAR)
        if not any(self._config.rules.free_ends) and self._is_knotted():
            return Plan(self._seen, (), 0, PlanFailure.ENDS_FIXED)
        problem = Problem(self._priced, self._left, self._is_goal)
        found = cheapest(self._seen, problem, self._config.states)
        if found.moves is None and not found.exhausted:
            hasty = replace(problem, left=lambda diagram: HASTE * self._bound(diagram))
            found = cheapest(self._seen, hasty, self._config.states)
        if found.moves is None:
            return Plan(self._seen, (), found.states, self._why_not(found))
        return Plan(self._seen, tuple(map(self._step, found.moves)), found.states, None)

    def _why_not(self, found: Found) -> PlanFailure:
        if not found.exhausted:
            return PlanFailure.BUDGET
        return PlanFailure.NO_ROOM if self._cramped else PlanFailure.NO_MOVES

    def _is_knotted(self) -> bool:
        return classify_diagram(self._seen.closed()).state is Knottedness.KNOTTED

    def _is_goal(self, diagram: OpenDiagram) -> bool:
        if self._config.goal == "uncrossed" or not diagram.visits:
            return not diagram.visits
        if self._finder.polynomial(diagram) != (1,):
            return False
        return classify_diagram(diagram.closed()).state is Knottedness.UNKNOT

    def _left(self, diagram: OpenDiagram) -> float:
        """Return no more than what is still to be paid; to unknot may take a single move."""
        return self._bound(diagram) if self._config.goal == "uncrossed" else 0.0

    def _bound(self, diagram: OpenDiagram) -> float:
        """Return the least that it costs to undo all crossings: each of them is passed once."""
        if not diagram.visits:
            return 0.0
        return min(KIND_COSTS.values()) + self._config.costs.per_visit * len(diagram)

    def _priced(self, diagram: OpenDiagram) -> list[tuple[Move, float]]:
        moves = self._finder.moves(diagram)
        if diagram == self._seen:
            # Only the next move is made where the cable lies now.
            roomy = [move for move in moves if self._has_room(move)]
            self._cramped = bool(moves) and not roomy
            moves = roomy
        return [(move, self._cost(move)) for move in moves]

    def _has_room(self, move: Move) -> bool:
        return all(self._places.best(hold)[1] >= self._config.least_room for hold in move.holds)

    def _cost(self, move: Move) -> float:
        costs = self._config.costs
        return (
            KIND_COSTS[move.kind]
            + costs.per_visit * move.passed
            + costs.per_below * move.below
            + costs.whole_cable * (move.interval[1] - move.interval[0])
            + costs.crowded * self._places.crowding(move)
        )

    def _step(self, move: Move) -> PlanStep:
        grasps = self._places.grasps(move)
        return PlanStep(
            move.kind, move.end, move.interval, grasps, move.predicted, self._cost(move)
        )
