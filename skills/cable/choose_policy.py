"""Set up perception and the tree's parameters for one way to untangle."""

from typing import Annotated

from executive.core.errors import InputError
from executive.core.outcome import failure, success
from executive.core.skill import In, Port, Skill, SkillRun
from executive.core.work import Worker
from perception.cable.selectable import SelectableVision
from skills.cable.policies import POLICIES, ClaimBy, HoldAt, Move, PolicyName, VisionName


class ChoosePolicy(Skill):
    """Look with the perception of a policy from now on, and say what else it does.

    SUCCESS: perception is chosen; the outputs are the policy's parameters.
    FAILURE: `vision.unavailable` when what that perception needs is not installed.
    """

    OUT = {
        "claim_by": Port(ClaimBy, "what a claim is made on"),
        "hold_at": Port(HoldAt, "where knots are held"),
        "plans": Port(bool, "whether pulls go to where the cable should lie best"),
        "moves": Port(list[Move], "what else it does than pull at knots"),
    }
    REASONS = frozenset({"vision.unavailable"})

    def __init__(self, vision: SelectableVision, worker: Worker) -> None:
        """Bind perception, and who has the time to load it."""
        self._vision, self._worker = vision, worker

    def run(
        self,
        policy: Annotated[PolicyName, In("which way to untangle")],
        vision: Annotated[VisionName, In("perception of policies that have none of their own")],
    ) -> SkillRun:
        """Choose."""
        chosen = POLICIES[policy]
        try:
            yield from self._worker.run(self._vision.select, chosen.vision or vision)
        except InputError as error:
            return failure("vision.unavailable", str(error))
        return success(
            claim_by=chosen.claim_by,
            hold_at=chosen.hold_at,
            plans=chosen.plans,
            moves=[*chosen.moves],
        )
