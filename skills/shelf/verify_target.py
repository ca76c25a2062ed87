"""Say whether the target has been found."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from perception.shelf.beliefs import ShelfBelief


class VerifyTarget(Skill):
    """Check that something in view is the target, surely enough.

    SUCCESS: the target is in view; `label` and `certainty` say as what.
    FAILURE: `target.hidden` when nothing in view has its name; `target.unsure` when something
        has, but not surely enough.
    """

    OUT = {
        "label": Port(str, "name of the object that is the target"),
        "certainty": Port(float, "probability that it is"),
    }
    REASONS = frozenset({"target.hidden", "target.unsure"})

    def run(
        self,
        belief: Annotated[ShelfBelief, In("what is known of the shelf")],
        confidence: Annotated[float, In("probability that is needed")] = 0.8,
    ) -> SkillRun:
        """Compare."""
        yield from ()
        found = belief.found
        if found is None or found.share == 0.0:
            return failure("target.hidden", f"{belief.target} is not in view")
        if found.certainty < confidence:
            return failure(
                "target.unsure",
                f"something may be {belief.target}, but that is not sure enough",
                certainty=found.certainty,
            )
        return success(label=found.label, certainty=found.certainty)
