"""Distribution Area Reduction: the search policy of LAX-RAY that the thesis uses (section 5.1).

It first takes the object whose mask overlaps the occupancy distribution most, and moves it to
where it overlaps least. Where that object cannot be moved to less, the next one is taken.
"""

from collections.abc import Callable, Sequence

import numpy as np

from perception.shelf.casting import BoxCaster
from perception.shelf.planning.moves import Move
from perception.shelf.planning.options import Option, options
from perception.shelf.planning.room import Reach
from perception.shelf.types import Floats, Shelf, ShelfView, Sighting, corners

# A move must uncover at least this share of what its object covers.
LEAST_GAIN = 0.05
# Of two moves that leave the same overlap, the shorter one: this much of the overlap a metre.
HASTE_1_M = 1e-3


class DistributionAreaReduction:
    """Chooses moves greedily; it has no memory."""

    def __init__(self, shelf: Shelf, caster: BoxCaster, reach: Reach) -> None:
        """Take what stays the same.

        Args:
            shelf: The shelf.
            caster: Rays of the camera.
            reach: What the tool needs.
        """
        self._shelf, self._caster, self._reach = shelf, caster, reach

    def choose(
        self,
        occupancy: Floats,
        view: ShelfView,
        seen: Sequence[Sighting],
        met: Floats,
    ) -> Move | None:
        """Choose the next move.

        Args:
            occupancy: Where the target may be, shape (height, width), not negative.
            view: What is seen.
            seen: The objects in it.
            met: Footprints of what is in the way unseen, shape (M, 4); see `Contacts`.

        Returns:
            A move, or None when no object can be moved to where it covers less: the search is
            stuck.
        """

        def moves_of(index: int) -> list[Option]:
            return options(seen[index], seen, view, self._shelf, self._caster, self._reach, met)

        return self.reduce(occupancy, seen, moves_of)

    def reduce(
        self,
        occupancy: Floats,
        seen: Sequence[Sighting],
        moves_of: Callable[[int], Sequence[Option]],
    ) -> Move | None:
        """Choose among given moves; see `choose`.

        Args:
            occupancy: Where the target may be, shape (height, width), not negative.
            seen: The objects in view.
            moves_of: Moves of an object, by its index in `seen`; asked only where needed.
        """
        covers = np.array([float(occupancy[sighting.mask].sum()) for sighting in seen])
        for index in np.argsort(-covers, kind="stable").tolist():
            if covers[index] > 0.0:
                best = self._best(moves_of(index), covers[index], occupancy)
                if best is not None:
                    return best
        return None

    def _best(self, found: Sequence[Option], cover: float, occupancy: Floats) -> Move | None:
        if not found:
            return None
        left = self.overlaps(found, occupancy)
        costs = left + HASTE_1_M * cover * np.array([option.far_m for option in found])
        pick = int(np.argmin(costs))
        return found[pick].move if left[pick] <= (1.0 - LEAST_GAIN) * cover else None

    def overlaps(self, found: Sequence[Option], occupancy: Floats) -> Floats:
        """Return how much of an occupancy each object would cover where it would stand, (K,)."""
        if not found:
            return np.zeros(0)
        shown = self._caster.cast(*corners([option.box for option in found]))
        return shown.sums(occupancy.ravel()[shown.pixel])
