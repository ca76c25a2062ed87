"""What to do next: from plans that may find the target to those that just make room."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from perception.shelf.planning.contacts import contact_beside
from perception.shelf.planning.exploring import unseen_things
from perception.shelf.planning.looking_ahead import LEAST_FOUND, Depth, Situation, look_ahead
from perception.shelf.planning.moves import Plan
from perception.shelf.planning.outlook import COARSE, FINE
from perception.shelf.planning.proofs import hopeless
from perception.shelf.types import Bools

# What was met this close to where it would touch an object now still stops that object.
TOUCHING_M = 0.004
# Where nothing else helps, ends of pushes and places are tried so closely.
FINE_STEPS_M = (0.015, 0.02, 0.03)


def best_plan(situation: Situation, depth: Depth | None = None, enough: float = 0.0) -> Plan | None:
    """Return what to do; None when nothing can be moved, or it is proved that nothing helps.

    Plans that may show enough of the target come first. Where there is none, a glimpse of it is
    worth a try, through a slit, too; then what shows something that has not been seen; then
    whatever makes room.

    Args:
        situation: What is known.
        depth: How far to look; None for the defaults.
        enough: The share of the target that is to show; less than can be told apart is a glimpse.
    """
    rough = look_ahead(situation, depth, COARSE.showing(enough))
    if rough is not None and rough.finds > LEAST_FOUND:
        return rough
    for plan in _other_plans(situation, depth, enough):
        if plan is not None and plan.finds > LEAST_FOUND:
            return plan
    if not situation.reach.suction and hopeless(situation):
        return None
    again = next((plan for plan in _tried_again(situation, depth) if plan is not None), None)
    # What has failed where nothing has changed since comes last of all.
    return rough or again or look_ahead(replace(forgetful(situation), barred=()), depth)


def _other_plans(situation: Situation, depth: Depth | None, enough: float) -> Iterator[Plan | None]:
    if enough > COARSE.shown:
        yield look_ahead(situation, depth)
    yield look_ahead(situation, depth, FINE)
    unseen = unseen_things(situation)
    if unseen is not None:
        plan = look_ahead(unseen, depth)
        yield None if plan is None else replace(plan, shows=0.0)
    yield from _tried_again(situation, depth)


def _tried_again(situation: Situation, depth: Depth | None) -> Iterator[Plan | None]:
    """Yield plans of what has been tried, since the shelf has changed; then of finer moves."""
    again = forgetful(situation)
    yield look_ahead(again, depth)
    yield look_ahead(again, replace(depth or Depth(), steps_m=FINE_STEPS_M))


def forgetful(situation: Situation) -> Situation:
    """Return a situation without where things have been, and but for what still blocks them."""
    return replace(situation, been=(), met=situation.met[_touching(situation)])


def _touching(situation: Situation) -> Bools:
    beside = [contact_beside(box, sign) for box in situation.boxes for sign in (-1, 1)]
    sides = np.array(beside).reshape(-1, 4)
    apart = np.abs(situation.met[:, None] - sides[None]).max(axis=2)
    return np.asarray((apart < TOUCHING_M).any(axis=1))
