"""Cage and pinch where there is room for two fingers.

The pinch lies on the strand that closes the knot on top, the cage on the strand that opens
it below. Both are looked for between undercrossings, as in the thesis (section 3.4), at lonely
cable: away from crossings, and with room on both sides.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from perception.cable.grasp_points import CagePinch, GraspConfig, GraspFlaw, HeldStrand
from perception.cable.types import Points

STEP_PX = 4.0


@dataclass(frozen=True, slots=True)
class RoomPolicy:
    """Takes the roomiest place of a region, else goes on beyond it."""

    config: GraspConfig

    def choose(self, strand: HeldStrand, begin_px: float, end_px: float) -> CagePinch:
        """Return the best points of a knot; see `GraspPolicy.choose`."""
        pinch_px = self._pinch(strand, begin_px, end_px)
        cage_px = self._cage(strand, begin_px, end_px, pinch_px)
        return CagePinch(cage_px, pinch_px, self._flaw(strand, cage_px, pinch_px))

    def _flaw(self, strand: HeldStrand, cage_px: float, pinch_px: float) -> GraspFlaw | None:
        if strand.clearance_px(pinch_px, self.config) < self.config.room_px:
            return GraspFlaw.PINCH_CROWDED
        if strand.clearance_px(cage_px, self.config) < self.config.room_px:
            return GraspFlaw.CAGE_CROWDED
        close = strand.apart_px(cage_px, pinch_px) < self.config.apart_px
        return GraspFlaw.TOO_CLOSE if close else None

    def _pinch(self, strand: HeldStrand, begin_px: float, end_px: float) -> float:
        """Search between the last undercrossing of the knot and the next one after it."""
        inside, unders_px = unders_inside(strand, begin_px, end_px), strand.unders_px
        low = float(inside.max(initial=begin_px))
        high = float(unders_px[unders_px > end_px].min(initial=strand.length_px))
        return self._most_graspable(strand, (low, high), end_px, lambda _: True)

    def _cage(self, strand: HeldStrand, begin_px: float, end_px: float, pinch_px: float) -> float:
        """Search from the first undercrossing to the next one inside the knot."""
        high = float(unders_inside(strand, begin_px, end_px).min(initial=end_px))

        def is_apart(at_px: float) -> bool:
            return strand.apart_px(at_px, pinch_px) >= self.config.apart_px

        return self._most_graspable(strand, (begin_px, high), begin_px, is_apart)

    def _most_graspable(
        self,
        strand: HeldStrand,
        region_px: tuple[float, float],
        near_px: float,
        allowed: Callable[[float], bool],
    ) -> float:
        """Return the roomiest place of a region, or a good one beyond, or the best of all."""
        low, high = region_px
        best: tuple[float, float] | None = None
        for first, last in ((low, high), (high, high + self.config.farther_px)):
            places = np.arange(first, last, STEP_PX)
            rated = [
                (self._rating(strand, at, near_px), float(at))
                for at in places[(places >= 0.0) & (places <= strand.length_px)]
                if allowed(at)
            ]
            best = max([*rated, *([best] if best else [])], default=None)
            if best and strand.clearance_px(best[1], self.config) >= self.config.room_px:
                break
        return best[1] if best else near_px

    def _rating(self, strand: HeldStrand, at_px: float, near_px: float) -> float:
        room_px = min(strand.clearance_px(at_px, self.config), self.config.room_px)
        return room_px - 0.01 * abs(at_px - near_px)


def unders_inside(strand: HeldStrand, begin_px: float, end_px: float) -> Points:
    """Return the undercrossings of a knot behind the one that it begins with."""
    unders_px = strand.unders_px
    inside: Points = unders_px[(unders_px > begin_px + 1.0) & (unders_px < end_px)]
    return inside
