"""Weigh what a look says against what was believed before it."""

from typing import Annotated

from executive.core.outcome import success
from executive.core.skill import In, Port, Skill, SkillRun

# A look alone is never surer than this: what it takes for cable, trace and crossings can be wrong
# in ways that its own belief knows nothing of, as in a knot drawn so small that strands merge.
SUREST = 0.98
# How likely a knot is still there after a pull that may have undone it, and after other moves of
# the cable; and that one has come about.
LEFT_BY_PULL, LEFT_BY_MOVE, TIED = 0.6, 0.95, 0.01


class WeighLook(Skill):
    """Carry the belief in a knot through a move of the cable and a look (a Bayes filter).

    Most moves cannot undo a knot. A look that sees none where one was seen just before is
    believed less than the same look after a pull at the knot, and another one decides.

    SUCCESS: `knotted_probability` is what is believed now.
    """

    OUT = {"knotted_probability": Port(float, "belief that a knot is left")}

    def run(
        self,
        before: Annotated[float, In("belief in a knot before the last move")],
        pulled: Annotated[bool, In("whether that move may have undone it")],
        seen: Annotated[float, In("belief that this look alone gives")],
    ) -> SkillRun:
        """Predict, then correct."""
        yield from ()
        return success(knotted_probability=weighed(expected(before, pulled), seen))


def expected(before: float, pulled: bool) -> float:
    """Return the belief in a knot after a move, in [0, 1]."""
    return before * (LEFT_BY_PULL if pulled else LEFT_BY_MOVE) + (1.0 - before) * TIED


def weighed(before: float, seen: float) -> float:
    """Return the belief after a look by Bayes' rule; 0.5 in either leaves the other as it is."""
    seen = min(max(seen, 1.0 - SUREST), SUREST)
    knotted, untied = before * seen, (1.0 - before) * (1.0 - seen)
    return knotted / (knotted + untied)
