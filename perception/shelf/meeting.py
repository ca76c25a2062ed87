"""What moves meet without its being seen: something known whose place is loose, or else unknown."""

from dataclasses import replace

import numpy as np

from perception.shelf.beliefs import Refusal, SeenObject, ShelfBelief
from perception.shelf.planning.free_floor import CELL_M
from perception.shelf.planning.room import OUTSIDE_M, footprints, overlapping
from perception.shelf.types import Bools, Box, Floats

# How likely a look is to be mistaken that rules a place out. What is ruled out comes up again when
# nothing else is left: places of what is seen are known to some millimetres alone.
MISTAKEN = 1e-3
# What a push has met unseen is the target, or something else: places that do not touch it are less
# likely by this factor.
NOT_MET, TOUCHING_M = 0.3, 0.005
# What was met is explained by an object that ends well inside it, or by so much free floor.
SIDE_M, EXPLAINED_SHARE = 0.001, 0.95
# An object that may stand farther to a side by this may be what was met there.
LOOSE_M = 0.006
# So far inside of what was met it is then taken to begin.
INSIDE_M = 0.002
# What is moved this close to an object changes how that can be pushed.
NEAR_M = 0.06


def meeting(belief: ShelfBelief, met: Floats, *, felt: bool) -> ShelfBelief:
    """Add what was met.

    Args:
        belief: What was known.
        met: Its footprints, shape (M, 4).
        felt: Whether it was felt beside an object: it may then be the target, or an object of
            which it is not known well where it stands.
    """
    for row in met if felt else ():
        # What was met before at the same place tells nothing new.
        if not overlapping(row, belief.met).any():
            objects = _stopping(belief.objects, row)
            if objects is None:
                belief = replace(belief, plausible=rescaled(_touching(belief, row)))
            else:
                belief = replace(belief, objects=objects)
    return replace(belief, met=np.vstack([belief.met, met]))


def still_refused(refusals: tuple[Refusal, ...], before: Box, after: Box) -> tuple[Refusal, ...]:
    """Return what still cannot be moved after another move.

    That is what the cup has let go of, and what stands where nothing has changed.

    Args:
        refusals: What could not be moved.
        before: What was moved, where it stood.
        after: Where it stands.
    """
    changed = footprints([before, after]) + NEAR_M * np.array([-1.0, -1.0, 1.0, 1.0])
    return tuple(
        one for one in refusals if one.lasting or not overlapping(_needed(one), changed).any()
    )


def _needed(refusal: Refusal) -> Floats:
    """Return the footprint on which it depends whether an object can be moved, shape (4,)."""
    own = footprints([refusal.box])[0]
    return own if refusal.sign else np.array([own[0], OUTSIDE_M, own[2], own[3]])


def rescaled(plausible: Floats) -> Floats:
    """Return how plausible places are beside the most plausible one; none is ruled out for good."""
    scaled: Floats = np.maximum(plausible / plausible.max(), MISTAKEN**2)
    return scaled


def unexplained(belief: ShelfBelief) -> Floats:
    """Return what was met and is neither an object that is known by now nor free, shape (M, 4)."""
    known = footprints([one.box for one in belief.objects])
    kept = [
        not _begins_in(row, known) and _free_share(belief.floor, row) < EXPLAINED_SHARE
        for row in belief.met
    ]
    return belief.met[np.array(kept, dtype=bool)]


def _touching(belief: ShelfBelief, row: Floats) -> Floats:
    """Return how plausible each place is when what was met may be the target."""
    half_m = 0.5 * np.array(belief.target_m[:2]) + TOUCHING_M
    here = np.hstack([belief.places_m - half_m, belief.places_m + half_m])
    likely: Floats = belief.plausible * np.where(overlapping(row, here), 1.0, NOT_MET)
    return likely


def _stopping(objects: tuple[SeenObject, ...], row: Floats) -> tuple[SeenObject, ...] | None:
    """Return objects with the only one that may be what was met moved there; None without one."""
    shifts_m = [_shift_m(one, row) for one in objects]
    able = [index for index, shift_m in enumerate(shifts_m) if shift_m is not None]
    if len(able) != 1:
        return None
    one, shift_m = objects[able[0]], shifts_m[able[0]]
    assert shift_m is not None
    box = one.box.at(one.box.x_m + shift_m, one.box.y_m)
    there = replace(one, box=box, loose_m=(0.0, one.loose_m[1]))
    return (*objects[: able[0]], there, *objects[able[0] + 1 :])


def _shift_m(one: SeenObject, row: Floats) -> float | None:
    """Return how far along the shelf an object stands from where it was met, if it may be that."""
    own, loose_m = footprints([one.box])[0], one.loose_m[0]
    deep_m = min(own[3], row[3]) - max(own[1], row[1])
    if loose_m < LOOSE_M or deep_m <= 0.0:
        return None
    shifts_m = np.array([row[0] + INSIDE_M - own[0], row[2] - INSIDE_M - own[2]])
    shift_m = float(shifts_m[np.abs(shifts_m).argmin()])
    return shift_m if abs(shift_m) <= loose_m + LOOSE_M else None


def _begins_in(met: Floats, known: Floats) -> bool:
    """Say whether a side of an object lies in what was met; one that covers it stops nothing."""
    axis = int(np.argmin(met[2:] - met[:2]))
    sides = known[:, [axis, axis + 2]]
    inside = ((sides > met[axis] + SIDE_M) & (sides < met[axis + 2] - SIDE_M)).any(axis=1)
    return bool((inside & overlapping(met, known)).any())


def _free_share(floor: Bools, met: Floats) -> float:
    """Return the share of the cells in what was met that are known to be free."""
    low = np.maximum(np.ceil(met[:2] / CELL_M - 0.5).astype(int), 0)
    high = np.floor(met[2:] / CELL_M - 0.5).astype(int) + 1
    cells = floor[low[0] : high[0], low[1] : high[1]]
    return float(cells.mean()) if cells.size else 0.0
