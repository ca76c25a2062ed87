"""The thesis's tiers of tangled cables (section 4.2): which knots, and how many crossings."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from simulation.cable.configurations import starting_configuration
from simulation.cable.knot_names import KnotName, TierName
from simulation.cable.layout import Area
from simulation.cable.parameters import RodParameters
from simulation.cable.rules import ConfigurationRules

Floats = NDArray[np.float64]

PLAIN: tuple[KnotName, ...] = ("overhand", "figure_8", "overhand_honda")
INVOLVED: tuple[KnotName, ...] = ("bowline", "linked_overhand", "figure_8_honda")
# What the camera sees of the table beyond arms at home, and where free ends may lie on it.
VIEW = Area((-0.49, -0.33), (0.49, 0.37))
TAILS = Area((-0.45, -0.30), (0.45, 0.25))
# "All knots are upward of 10 cm in diameter"; the arms' reach sets the upper limit.
RULES = ConfigurationRules(
    diameter_m=(0.10, 0.20), place=(0.2, 0.8), tails=TAILS, shortest_end_m=0.2, drop_m=0.02
)
# One cable in so many leaves the view with one end: thrice as long as the table is wide, "many"
# of the thesis's do.
LEAVES_SHARE = 0.4


@dataclass(frozen=True, slots=True)
class Tier:
    """A level of difficulty.

    Attributes:
        classes: The knots to choose from, of each knot in turn; they come in any order.
        crossings: Least and most crossings of the whole cable.
    """

    classes: tuple[tuple[KnotName, ...], ...]
    crossings: tuple[int, int]


TIERS: dict[TierName, Tier] = {
    "C1": Tier((PLAIN,), (3, 6)),
    "C2": Tier((INVOLVED,), (6, 9)),
    "C3": Tier((INVOLVED, PLAIN), (10, 14)),
}
# A choice of knots, and of an end that leaves, is given up after so many plans.
PLANS = 400
CHOICES = 40


@dataclass(frozen=True, slots=True, eq=False)
class TierCable:
    """A cable of a tier.

    Attributes:
        nodes_m: Centre line at rest, shape (N, 3), world frame.
        knots: Its knots, in the order of the nodes.
        leaves_view: Whether one end is out of the view.
    """

    nodes_m: Floats
    knots: tuple[KnotName, ...]
    leaves_view: bool


def tier_cable(
    tier: TierName,
    rng: np.random.Generator,
    knots: Sequence[KnotName] = (),
    leaves_view: bool | None = None,
    parameters: RodParameters | None = None,
) -> TierCable:
    """Return a cable of a tier, dropped and settled.

    Args:
        tier: Which tier.
        rng: Source of all randomness: an equal state gives an equal cable.
        knots: Its knots, in the order of the cable; drawn where none are given.
        leaves_view: Whether one end leaves the view; drawn where it is None.
        parameters: What the cable is made of.

    Raises:
        InputError: No such cable was found.
    """
    chosen = TIERS[tier]
    rules = replace(RULES, least_crossings=chosen.crossings[0], most_crossings=chosen.crossings[1])
    names = tuple(knots) or _drawn(chosen, rng)
    leaves = bool(rng.random() < LEAVES_SHARE) if leaves_view is None else leaves_view
    if leaves:
        rules = replace(rules, view=VIEW)
    nodes_m = starting_configuration(names, rng, parameters, rules, plans=PLANS * CHOICES)
    return TierCable(nodes_m, names, leaves)


def _drawn(tier: Tier, rng: np.random.Generator) -> tuple[KnotName, ...]:
    names = [group[int(rng.integers(len(group)))] for group in tier.classes]
    return tuple(names[k] for k in rng.permutation(len(names)))
