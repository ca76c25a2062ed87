"""Ways to untangle a cable as sets of parameters of one tree: ours, the thesis's, and less.

`tusk` is the thesis's system (section 3.5), `no_cancellation` and `analytic` are its ablations,
`sgtm2` is what it compares with. The others are ours with less: `no_interactive` without any move
that only helps to see, `no_planning` without a thought of where the cable will lie, `no_belief`
ends after one look, `no_certificates` has the thesis's rule in the place of proofs, and each of
`no_exposing` to `no_opening` is without one sort of move.
"""

from dataclasses import dataclass
from typing import Literal, get_args

PolicyName = Literal[
    "default",
    "tusk",
    "sgtm2",
    "no_cancellation",
    "analytic",
    "no_interactive",
    "no_planning",
    "no_belief",
    "no_certificates",
    "no_exposing",
    "no_loosening",
    "no_perturbing",
    "no_spreading",
    "no_opening",
]
POLICY_NAMES: tuple[PolicyName, ...] = get_args(PolicyName)
VisionName = Literal["best", "classic", "learned"]
VISION_NAMES: tuple[VisionName, ...] = get_args(VisionName)
ClaimBy = Literal["belief", "rule"]
HoldAt = Literal["searched", "given"]
# Sorts of moves that not every way makes; pulls at knots are made by all.
Move = Literal["expose", "loosen", "perturb", "spread", "open"]
MOVES: tuple[Move, ...] = get_args(Move)


@dataclass(frozen=True, slots=True)
class Policy:
    """One way.

    Attributes:
        vision: Name of the perception that it looks with; None for the one that is asked for.
        claim_by: Whether the mission ends on a belief, with the whole cable accounted for, or as
            soon as the knot rule finds nothing.
        hold_at: Whether hands take the best places that they reach, or those that perception
            gives for a knot.
        plans: Whether pulls go to where the cable is predicted to lie best, or straight apart.
        moves: What else it does: `expose`, pull in what leaves the view; `loosen` what cannot be
            traced; `perturb`, free ends and part strands that are doubted; `spread`, draw ends
            apart or stir where nothing else could be done; `open` knots without room for hands.
    """

    vision: str | None = None
    claim_by: ClaimBy = "belief"
    hold_at: HoldAt = "searched"
    plans: bool = True
    moves: tuple[Move, ...] = MOVES


def _without(*left_out: Move) -> tuple[Move, ...]:
    return tuple(move for move in MOVES if move not in left_out)


POLICIES: dict[PolicyName, Policy] = {
    "default": Policy(),
    "tusk": Policy("tusk", "rule", "given", plans=False),
    "sgtm2": Policy("sgtm2", "rule", "given", plans=False, moves=_without("expose")),
    "no_cancellation": Policy("tusk_uncancelled", "rule", "given", plans=False),
    "analytic": Policy("tusk_analytic", "rule", "given", plans=False),
    "no_interactive": Policy(moves=("open",)),
    "no_planning": Policy(plans=False),
    "no_belief": Policy(claim_by="rule"),
    "no_certificates": Policy("ruled"),
    "no_exposing": Policy(moves=_without("expose")),
    "no_loosening": Policy(moves=_without("loosen")),
    "no_perturbing": Policy(moves=_without("perturb")),
    "no_spreading": Policy(moves=_without("spread")),
    "no_opening": Policy(moves=_without("open")),
}
