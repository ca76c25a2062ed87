"""Sharpen unsure names by what stands beside them."""

from typing import Annotated

from executive.core.outcome import success
from executive.core.skill import In, Port, Skill, SkillRun
from perception.shelf.detections import Detections
from perception.shelf.interfaces import ShelfReasoning


class RefineNames(Skill):
    """Weigh unsure readings by the affinity to their sure neighbours (thesis, section 6.2).

    SUCCESS: `detections` has the same objects; sure readings stay what they were.
    """

    OUT = {"detections": Port(Detections, "objects in the frame and what they may be")}

    def __init__(self, search: ShelfReasoning) -> None:
        """Bind who reasons."""
        self._search = search

    def run(
        self, detections: Annotated[Detections, In("objects and what they may be")]
    ) -> SkillRun:
        """Refine."""
        yield from ()
        return success(detections=self._search.refine(detections))
