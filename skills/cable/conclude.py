"""Say how a look leaves the mission: done, knotted, or unsure."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Skill, SkillRun
from perception.cable.types import CableClaim

# From here on a knot is what is believed, and below it nothing is known.
LEAST_KNOTTED = 0.75


class Conclude(Skill):
    """End a round, and the mission with it where the cable is untangled.

    SUCCESS: the claim says that the cable is untangled.
    FAILURE: `cable.knotted` when a knot is believed to be left; `cable.unclear` when it cannot be
        told.
    """

    REASONS = frozenset({"cable.knotted", "cable.unclear"})

    def run(self, claim: Annotated[CableClaim, In("what is said about the cable")]) -> SkillRun:
        """Read the claim."""
        yield from ()
        if claim.untangled:
            return success()
        knotted = claim.knotted_probability
        if knotted >= LEAST_KNOTTED:
            text = f"a knot is left, P(knot) = {knotted:.2f}"
            return failure("cable.knotted", text, knotted_probability=knotted)
        text = f"cannot tell whether a knot is left, P(knot) = {knotted:.2f}"
        return failure("cable.unclear", text, knotted_probability=knotted)
