"""Cage and pinch as the thesis searches for them (section 3.4), in units of the cable's width.

A place is as graspable as few pixels of cable lie around it; near a crossing it counts as much
worse. The thesis works on one camera with windows of 20 px and a cable of about 5.5 px.
"""

from dataclasses import dataclass

import numpy as np

from perception.cable.grasp_points import CablePixels, CagePinch, GraspFlaw, HeldStrand
from perception.cable.grasp_room import unders_inside

# The thesis's pixels over its cable's width.
THESIS_WIDTH_PX = 5.5
WINDOW = 20.0 / THESIS_WIDTH_PX
CROSSING = 15.0 / THESIS_WIDTH_PX
APART = 30.0 / THESIS_WIDTH_PX
STEP = 12.0 / THESIS_WIDTH_PX
# Pixels of cable in the window at which a place is good enough, and what a crossing adds.
ACCEPTED = 120.0 / THESIS_WIDTH_PX**2
AT_CROSSING = 100.0 / THESIS_WIDTH_PX**2

# Graspability, the lower the better, and where.
_Rated = tuple[float, float]


@dataclass(frozen=True, slots=True)
class TuskPolicy:
    """Walks along the trace until a place is graspable; needs to know what is cable."""

    pixels: CablePixels

    def choose(self, strand: HeldStrand, begin_px: float, end_px: float) -> CagePinch:
        """Return the first graspable points of a knot; see `GraspPolicy.choose`."""
        pinch = self._pinch(strand, begin_px, end_px)
        cage = self._cage(strand, begin_px, end_px, pinch[1])
        return CagePinch(min(cage[1], strand.length_px), pinch[1], _flaw(cage, pinch))

    def _pinch(self, strand: HeldStrand, begin_px: float, end_px: float) -> _Rated:
        """Walk back into the knot and on out of it, each to the next undercrossing."""
        low = float(unders_inside(strand, begin_px, end_px).max(initial=begin_px))
        behind = strand.unders_px[strand.unders_px > end_px]
        high = float(behind.min(initial=strand.length_px))
        best = min(self._walk(strand, end_px, low), self._walk(strand, end_px, high))
        return best if best[0] <= ACCEPTED else min(best, self._walk(strand, low, 0.0))

    def _cage(self, strand: HeldStrand, begin_px: float, end_px: float, pinch_px: float) -> _Rated:
        """Walk on from the first undercrossing to the next, and beyond where that is no good."""
        high = float(unders_inside(strand, begin_px, end_px).min(initial=end_px))
        best = self._walk(strand, begin_px, high, pinch_px)
        if best[0] <= ACCEPTED:
            return best
        return min(best, self._walk(strand, high, strand.length_px, pinch_px))

    def _walk(
        self, strand: HeldStrand, from_px: float, to_px: float, apart_from_px: float | None = None
    ) -> _Rated:
        """Return the first place on a way that is good enough, else the best of them."""
        step_px = STEP * self.pixels.width_px * (1.0 if to_px > from_px else -1.0)
        best: _Rated = (np.inf, from_px)
        for at_px in np.arange(from_px, to_px, step_px):
            if apart_from_px is not None and self._is_close(strand, at_px, apart_from_px):
                continue
            best = min(best, (self.graspability(strand, float(at_px)), float(at_px)))
            if best[0] <= ACCEPTED:
                break
        return best

    def _is_close(self, strand: HeldStrand, at_px: float, other_px: float) -> bool:
        return strand.apart_px(at_px, other_px) < APART * self.pixels.width_px

    def graspability(self, strand: HeldStrand, at_px: float) -> float:
        """Return the cable around a place [cable widths squared]; the less, the better."""
        width_px, cable = self.pixels.width_px, self.pixels.cable
        low = np.round(strand.point(at_px) - WINDOW * width_px / 2.0).astype(int)
        high = low + max(round(WINDOW * width_px), 1)
        left, top = low.clip(0)
        window = cable[top : max(high[1], 0), left : max(high[0], 0)]
        near = strand.to_crossing_px(at_px) <= CROSSING * width_px
        return float(window.sum()) / width_px**2 + (AT_CROSSING if near else 0.0)


def _flaw(cage: _Rated, pinch: _Rated) -> GraspFlaw | None:
    if pinch[0] > ACCEPTED:
        return GraspFlaw.PINCH_CROWDED
    if not np.isfinite(cage[0]):
        return GraspFlaw.TOO_CLOSE
    return GraspFlaw.CAGE_CROWDED if cage[0] > ACCEPTED else None
