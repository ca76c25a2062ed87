"""Scenes to search: a domain's objects on a shelf, one of them hidden (thesis, section 7.2)."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from executive.core.errors import InputError
from perception.camera import CameraModel
from perception.shelf.casting import BoxCaster
from perception.shelf.rendering import ShelfRenderer
from perception.shelf.types import Bools, Box, Floats, Shelf, stands_on
from simulation.shelf.arranging import Leaf, shelf_places
from simulation.shelf.cameras import front_camera
from simulation.shelf.separating import separate
from simulation.shelf.stacking import put_on, stacks
from simulation.shelf.taxonomy import Domain, ShelfObject

# Positions and sizes are whole micrometres, so that scenes are the same wherever they are made.
DECIMALS = 6
ATTEMPTS = 200
# Cuboids that cover more of the floor than this are not tried: they hardly ever come apart.
FULL = 0.85


@dataclass(frozen=True, slots=True)
class SceneRules:
    """How scenes are made.

    Attributes:
        count: Objects on the shelf; the thesis has 12, 15, 18 and 21.
        organisation: Share of objects that stand where the taxonomy puts them, in [0, 1]; 0 is
            the thesis's RAND.
        scale: Factor on sizes; None takes the domain's.
        noise_m: Largest noise of a place at each cut of the shelf.
        stacked: Share of objects that stand on another one, as far as any can carry them.
    """

    count: int = 15
    organisation: float = 1.0
    scale: float | None = None
    noise_m: float = 0.02
    stacked: float = 0.0


@dataclass(frozen=True, slots=True)
class Scene:
    """A shelf with objects; all of it is truth.

    Attributes:
        shelf: The shelf.
        names: Names of the objects.
        boxes: Where they stand, in the order of `names`.
        target: Name of an object that cannot be seen from the camera at all; it stands on the
            floor, and nothing stands on it.
    """

    shelf: Shelf
    names: tuple[str, ...]
    boxes: tuple[Box, ...]
    target: str

    @property
    def digest(self) -> str:
        """SHA-256 of the scene in whole micrometres, for holding scenes to their seeds."""
        rows = [
            (name, *(round(1e6 * value) for value in _numbers(box)))
            for name, box in zip(self.names, self.boxes, strict=True)
        ]
        return hashlib.sha256(json.dumps([rows, self.target]).encode()).hexdigest()


def draw_scene(
    domain: Domain,
    rules: SceneRules,
    rng: np.random.Generator,
    shelf: Shelf | None = None,
    camera: CameraModel | None = None,
) -> Scene:
    """Draw scenes until one resolves its collisions and hides an object wholly.

    Args:
        domain: What may stand there.
        rules: How many, how well arranged.
        rng: Source of chance; the same state gives the same scene.
        shelf: The shelf; None for the thesis's.
        camera: From where the target must be hidden; None for `front_camera`.

    Raises:
        InputError: The rules ask for what cannot be, or no scene came out in many attempts.
    """
    _check(domain, rules)
    shelf = shelf or Shelf()
    renderer = ShelfRenderer(BoxCaster(camera or front_camera(shelf)), shelf)
    for _ in range(ATTEMPTS):
        picked = rng.choice(len(domain.objects), size=rules.count, replace=False)
        things = [domain.objects[index] for index in picked]
        boxes = _stand(things, domain, rules, shelf, rng)
        if boxes is None:
            continue
        hidden = np.flatnonzero((renderer.visible_shares(boxes) == 0.0) & ~_in_stacks(boxes))
        if len(hidden):
            target = things[int(hidden[rng.integers(len(hidden))])].name
            return Scene(shelf, tuple(thing.name for thing in things), boxes, target)
    raise InputError(
        f"scenes of {domain.name}: no scene of {rules.count} objects came out in {ATTEMPTS} "
        f"attempts; got objects that overlap or none that is hidden; try: another count, or a "
        f"smaller scale than {rules.scale or domain.scale:g}"
    )


def _stand(
    things: Sequence[ShelfObject],
    domain: Domain,
    rules: SceneRules,
    shelf: Shelf,
    rng: np.random.Generator,
) -> tuple[Box, ...] | None:
    """Place objects on the shelf, or None where they cannot be moved apart."""
    scale = domain.scale if rules.scale is None else rules.scale
    sizes = np.round([thing.draw_size(scale, rng) for thing in things], DECIMALS)
    if (sizes.max(axis=0) > (shelf.width_m, shelf.depth_m, shelf.height_m)).any():
        return None
    if sizes[:, :2].prod(axis=1).sum() > FULL * shelf.width_m * shelf.depth_m:
        return None
    leaves = [
        Leaf(index, thing.category, _size(sizes[index])) for index, thing in enumerate(things)
    ]
    meant = shelf_places(leaves, shelf, rules.organisation, rules.noise_m, rng)
    # Nothing is drawn for shelves without stacks: their seeds give what they have always given.
    carriers = stacks(meant, sizes, rules.stacked, shelf, rng) if rules.stacked > 0.0 else {}
    low = np.array([index for index in range(len(sizes)) if index not in carriers])
    places = separate(meant[low], sizes[low, :2], shelf)
    if places is None:
        return None
    standing = {
        index: Box(float(x), float(y), leaves[index].size_m)
        for index, (x, y) in zip(low.tolist(), np.round(places, DECIMALS), strict=True)
    }
    for index, carrier in carriers.items():
        standing[index] = put_on(leaves[index].size_m, standing[carrier], rng, DECIMALS)
    return tuple(standing[index] for index in range(len(sizes)))


def _numbers(box: Box) -> tuple[float, ...]:
    numbers = (box.x_m, box.y_m, *box.size_m)
    return (*numbers, box.bottom_m) if box.bottom_m else numbers


def _in_stacks(boxes: Sequence[Box]) -> Bools:
    """Say which boxes carry another one, or are carried, shape (N,)."""
    return np.array(
        [one.bottom_m > 0.0 or any(stands_on(other, one) for other in boxes) for one in boxes]
    )


def _size(row: Floats) -> tuple[float, float, float]:
    return (float(row[0]), float(row[1]), float(row[2]))


def _check(domain: Domain, rules: SceneRules) -> None:
    most = len(domain.objects)
    if not 2 <= rules.count <= most:
        raise InputError(
            f"scenes of {domain.name}: count: got {rules.count}; expected 2 to {most} objects"
        )
    if not 0.0 <= rules.organisation <= 1.0:
        raise InputError(
            f"scenes of {domain.name}: organisation: got {rules.organisation:g}; expected 0 to 1"
        )
    if not 0.0 <= rules.stacked <= 1.0:
        raise InputError(
            f"scenes of {domain.name}: stacked: got {rules.stacked:g}; expected 0 to 1"
        )
    if rules.scale is not None and not 0.0 < rules.scale <= 1.0:
        raise InputError(f"scenes of {domain.name}: scale: got {rules.scale:g}; expected in (0, 1]")
