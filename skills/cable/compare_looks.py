"""Hold a look against another one at the same cable before anything is claimed."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.types import Crossing, Trace

_Look = tuple[Trace, tuple[Crossing, ...]]


class CompareLooks(Skill):
    """Compare the diagrams that two looks at a cable gave while it lay still.

    Two looks differ in noise, and in the end that the cable was followed from. What only one of
    them sees is not there, or was missed by the other.

    SUCCESS: both show the same, but for twists and ends that lie upon strands;
        `knotted_probability` is the larger of both beliefs.
    FAILURE: `looks.disagree` when they do not.
    """

    OUT = {"knotted_probability": Port(float, "belief that a knot is left, by both looks")}
    REASONS = frozenset({"looks.disagree"})

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
        other = (other_trace, other_crossings)
        difference = yield from self._worker.run(_difference, (trace, crossings), other)
        if difference is not None:
            return failure("looks.disagree", difference)
        return success(knotted_probability=max(knotted, other_knotted))


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
