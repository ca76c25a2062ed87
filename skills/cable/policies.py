"""Ways to untangle a cable as sets of parameters of one tree: ours, the thesis's, and less.

`tusk` is the thesis's system (section 3.5), `no_cancellation` and `analytic` are its ablations,
`sgtm2` is what it compares with. `no_interactive` is ours without any move that only helps to see,
`no_planning` without a thought of where the cable will lie.
"""

from dataclasses import dataclass
from typing import Literal, get_args

PolicyName = Literal[
    "default", "tusk", "sgtm2", "no_cancellation", "analytic", "no_interactive", "no_planning"
]
POLICY_NAMES: tuple[PolicyName, ...] = get_args(PolicyName)
VisionName = Literal["best", "classic", "learned"]
VISION_NAMES: tuple[VisionName, ...] = get_args(VisionName)
ClaimBy = Literal["belief", "rule"]
HoldAt = Literal["searched", "given"]


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
        reveals: Whether cable that leaves the view is pulled in.
        disambiguates: Whether it moves cable only to understand it: loosens what cannot be
            traced, frees ends, parts strands.
    """

    vision: str | None = None
    claim_by: ClaimBy = "belief"
    hold_at: HoldAt = "searched"
    plans: bool = True
    reveals: bool = True
    disambiguates: bool = True


POLICIES: dict[PolicyName, Policy] = {
    "default": Policy(),
    "tusk": Policy("tusk", "rule", "given", plans=False),
    "sgtm2": Policy("sgtm2", "rule", "given", plans=False, reveals=False),
    "no_cancellation": Policy("tusk_uncancelled", "rule", "given", plans=False),
    "analytic": Policy("tusk_analytic", "rule", "given", plans=False),
    "no_interactive": Policy(reveals=False, disambiguates=False),
    "no_planning": Policy(plans=False),
}
