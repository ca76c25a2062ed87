"""Turn the belief about the cable into the mission's claim."""

from typing import Annotated

from executive.core.outcome import success
from executive.core.skill import In, Port, Skill, SkillRun
from perception.cable.types import CableClaim


class StateClaim(Skill):
    """Say whether the cable is untangled, with the belief behind it.

    SUCCESS: `claim` is written.
    """

    OUT = {"claim": Port(CableClaim, "what the mission says about the cable")}

    def run(
        self,
        knotted_probability: Annotated[float, In("belief that a knot is left")],
        confidence: Annotated[float, In("P(no knot) that is needed to say untangled")],
    ) -> SkillRun:
        """Compare the belief with the confidence that is asked for."""
        yield from ()
        untangled = 1.0 - knotted_probability >= confidence
        return success(claim=CableClaim(untangled, knotted_probability))
