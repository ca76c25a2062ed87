"""Hold a look against another one at the same cable before anything is claimed."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.types import Crossing, Trace
from skills.cable.connectors import NOTHING_KNOWN

# A look that is less sure of having followed the cable confirms nothing.
LEAST_FOLLOWED = 0.7

_Look = tuple[Trace, tuple[Crossing, ...]]


class CompareLooks(Skill):
    """Compare the diagrams that two looks at a cable gave while it lay still.

    Two looks differ in noise, and in the end that the cable was followed from. What only one of
    them sees is not there, or was missed by the other.

    That the other look is not quite sure of its path matters no more once both have come to the
    same one from both ends; what it doubts of crossings does.

    SUCCESS: both show the same, but for twists and ends that lie upon strands;
        `knotted_probability` is the larger of both beliefs.
    FAILURE: `looks.disagree` when they do not; `looks.unsure` when the other one may well have
        followed something else.
    """

    OUT = {"knotted_probability": Port(float, "belief that a knot is left, by both looks")}
    REASONS = frozenset({"looks.disagree", "looks.unsure"})

    def __init__(self, worker: Worker) -> None:
        """Bind who has the time for it."""
        self._worker = worker

    def run(
        self,
        trace: Annotated[Trace, In("path of the cable in one look")],
        crossings: Annotated[tuple[Crossing, ...], In("its crossings")],
        knotted: Annotated[float, In("belief in a knot by it and all before")],
        other_trace: Annotated[Trace, In("path of the cable in the other look")],
        other_crossings: Annotated[tuple[Crossing, ...], In("its crossings")],
        other_knotted: Annotated[float, In("belief in a knot by that look alone")],
    ) -> SkillRun:
        """Compare."""
        followed = other_trace.probability
        if followed < LEAST_FOLLOWED:
            text = f"the other look follows the cable with {followed:.2f} only"
            return failure("looks.unsure", text, followed=followed)
        other = (other_trace, other_crossings)
        difference = yield from self._worker.run(_difference, (trace, crossings), other)
        if difference is not None:
            return failure("looks.disagree", difference)
        of_crossings = other_knotted - NOTHING_KNOWN * (1.0 - followed)
        return success(knotted_probability=max(knotted, of_crossings))


def _difference(one: _Look, other: _Look) -> str | None:
    """Say how the diagrams of two looks differ; None where they do not, or by nothing."""
    # Slow to load, and a tree is checked without it.
    from perception.cable.crossings import strand_of
    from perception.cable.planning import agreement, agrees, open_diagram

    first, second = (open_diagram(strand_of(path, 0, own)) for path, own in (one, other))
    if agrees(first, second):
        return None
    alike = agreement(first, second).value
    return f"one look shows {len(first)} crossings, another {len(second)}: {alike}"
