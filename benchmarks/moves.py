"""Plans of moves on a cable: how long they are, and whether what they predict comes true.

The cable physics is the judge. A cable at rest is seen without error; the first move of its
plan is made by two hands that reach everywhere on a large table; when the cable rests again,
its diagram is held against the predicted one. Milliseconds of planning are those of the process.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.harness import Row, mean, median, percentile_95, share
from perception.cable.planning import (
    Agreement,
    Plan,
    PlannerConfig,
    PlanStep,
    agreement,
    open_diagram,
    plan_moves,
)
from perception.cable.topology import Strand, curve_crossings
from simulation.cable.carrying import Carried, carry
from simulation.cable.configurations import starting_configuration
from simulation.cable.knots import KNOT_NAMES, KnotName
from simulation.cable.layout import Area
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod
from simulation.cable.rules import ConfigurationRules

Floats = NDArray[np.float64]

SEED = 990_001
# As an overhead camera sees a table of 1.1 m.
PX_PER_M = 900.0
TABLE = RodParameters(table_size_m=(8.0, 8.0))
RULES = ConfigurationRules(
    length_m=2.0,
    diameter_m=(0.12, 0.25),
    area=Area((-0.45, -0.32), (0.45, 0.32)),
    most_crossings=10,
)
LONGEST_REST_S = 4.0
CONFIG = PlannerConfig(least_room=0.0)
MOST_MOVES = 10


@dataclass(frozen=True, slots=True)
class Outcome:
    """How one move went.

    Attributes:
        held: Whether every hand had taken the cable.
        agreement: How alike the diagram afterwards is to the predicted one.
        fewer: Whether there are fewer crossings than before.
    """

    held: bool
    agreement: Agreement
    fewer: bool


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Plan for cables at rest with every knot, make the first moves, and undo some for good."""
    per_knot, undone = (1, 1) if quick else (6, 3)
    rows, milliseconds, firsts = [], list[float](), list[Outcome]()
    tries = list[int | None]()
    for name in KNOT_NAMES:
        steps = []
        for k in range(per_knot):
            nodes_m = _cable(name, [SEED, seed, k])
            began_s = time.process_time()
            plan = plan_moves(seen(nodes_m), CONFIG)
            milliseconds.append(1e3 * (time.process_time() - began_s))
            steps.append(len(plan.steps))
            if plan.steps:
                firsts.append(judge(Rod(nodes_m, TABLE), plan))
            if name != "none" and k < undone:
                tries.append(undo(nodes_m))
        rows.append(mean(f"plan_steps_{name}", steps, "1"))
    done = [count for count in tries if count is not None]
    return [
        *rows,
        median("plan_ms", milliseconds, "ms"),
        percentile_95("plan_ms_p95", milliseconds, "ms"),
        *_shares(firsts),
        share("unknotted_by_ideal_hands", len(done), len(tries)),
        *([mean("moves_to_unknotted", done, "1")] if done else []),
    ]


def _cable(name: KnotName, seed: list[int]) -> Floats:
    return starting_configuration(name, np.random.default_rng(seed), TABLE, RULES)


def _shares(outcomes: Sequence[Outcome]) -> list[Row]:
    n = len(outcomes)
    twists = (Agreement.SAME, Agreement.BUT_FOR_TWISTS)
    ends = (*twists, Agreement.BUT_FOR_ENDS)
    return [
        share("hands_took_hold", sum(o.held for o in outcomes), n),
        share("came_true_exactly", sum(o.agreement is Agreement.SAME for o in outcomes), n),
        share("came_true_but_for_twists", sum(o.agreement in twists for o in outcomes), n),
        share("came_true", sum(o.agreement in ends for o in outcomes), n),
        share("fewer_crossings", sum(o.fewer for o in outcomes), n),
    ]


def seen(nodes_m: Floats) -> Strand:
    """Return a cable as it is seen from above without error, in pixels."""
    return curve_crossings(nodes_m * (PX_PER_M, PX_PER_M, 1.0))


def judge(rod: Rod, plan: Plan) -> Outcome:
    """Make the first move of a plan, and hold what is seen then against what was predicted."""
    step = plan.steps[0]
    held = make(rod, step)
    after = open_diagram(seen(rod.positions_m))
    return Outcome(held, agreement(step.predicted, after), len(after) < len(plan.seen))


def undo(nodes_m: Floats) -> int | None:
    """Plan and make first moves until no knot is left.

    Returns:
        How many moves it took; None where no plan was found, or too many moves did not do.
    """
    config, rod = replace(CONFIG, goal="unknotted"), Rod(nodes_m, TABLE)
    for count in range(MOST_MOVES + 1):
        plan = plan_moves(seen(rod.positions_m), config)
        if not plan.steps:
            return count if plan.failure is None else None
        make(rod, plan.steps[0])
    return None


def make(rod: Rod, step: PlanStep) -> bool:
    """Make a move with hands that reach everywhere; say whether all of them took hold."""
    parts = [
        Carried(grasp.role, grasp.point / PX_PER_M, grasp.direction, grasp.to / PX_PER_M)
        for grasp in step.grasps
    ]
    return carry(rod, parts, LONGEST_REST_S)
