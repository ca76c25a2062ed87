"""Move any piece of cable, when nothing else is left to do."""

from typing import Annotated

from executive.core.outcome import failure
from executive.core.skill import In, SkillRun
from perception.camera import CameraFrame
from skills.cable.grasping import tangent_at
from skills.cable.shifting import Hold, ShiftSkill

# Shorter pieces lie between crossings that are too close for two fingers.
SHORTEST_PX = 60.0
MOST_PIECES = 12
# Strands that lie in a bundle are parted by more than an end needs to come free.
HALF_SQUARE_M = 0.12


class StirCable(ShiftSkill):
    """Grasp the middle of a random piece of cable and shift it into free space.

    SUCCESS: the cable was held, moved and laid down.
    FAILURE: `cable.gone` when there is none in view: it has fallen off, or hangs where the camera
        does not see it; `grasp.unreachable` when no arm reaches any piece; `grasp.missed` when the
        fingers closed on nothing; a motion reason.
    stop(): arms come to rest; a held cable stays held.
    """

    REASONS = ShiftSkill.REASONS | {"cable.gone"}

    def run(self, frame: Annotated[CameraFrame, In("overhead frame")]) -> SkillRun:
        """Hold a piece and shift it."""
        found = yield from self._worker.run(self._vision.pieces, frame.image)
        if not found:
            return failure("cable.gone", "no cable is in view")
        pieces = [piece for piece in found if len(piece) > SHORTEST_PX]
        order = self._rng.permutation(len(pieces))[:MOST_PIECES]
        holds = []
        for number in order:
            piece, middle = pieces[number], len(pieces[number]) // 2
            tangent = tangent_at(piece, middle, reach=4)
            holds.append(Hold(piece[middle], tangent, piece[middle][None]))
        return (yield from self.shift(frame, holds, HALF_SQUARE_M))
