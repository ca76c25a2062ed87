"""Turn what is known at the end of a search into the mission's claim."""

from typing import Annotated

from executive.core.outcome import success
from executive.core.skill import In, Port, Skill, SkillRun
from perception.shelf.beliefs import SearchClaim

# What a probability is said to.
DECIMALS = 4


class StateSearch(Skill):
    """Say whether the target was found and taken out.

    SUCCESS: `claim` is written.
    """

    OUT = {"claim": Port(SearchClaim, "what the mission says at its end")}

    def run(
        self,
        target: Annotated[str, In("name of what is searched for")],
        certainty: Annotated[float, In("probability that it was seen")] = 0.0,
        found: Annotated[bool, In("whether it was seen")] = False,
        retrieved: Annotated[bool, In("whether it was taken out")] = False,
    ) -> SkillRun:
        """State it."""
        yield from ()
        return success(claim=SearchClaim(target, found, retrieved, round(certainty, DECIMALS)))
