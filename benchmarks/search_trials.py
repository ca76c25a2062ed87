"""Searches as the thesis has them, and ways between its and ours, without a tree.

Detection is perfect, sizes of the stock are known, and the target counts as found when 1 % of it
shows, as in the thesis's simulations (section 7.4). Nothing else of the scene is known to it.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from benchmarks.searching import SHORT_M, SHOWN, SearchedShelf, Trial, search
from perception.shelf.affinity import AffinityMatrix
from perception.shelf.casting import BoxCaster
from perception.shelf.hidden_poses import HiddenPoses, PoseBelief
from perception.shelf.learned_occupancy import LearnedOccupancy
from perception.shelf.organisation import organisation_of
from perception.shelf.original import OriginalScene
from perception.shelf.planning.clearing import ReductionWithClearing
from perception.shelf.planning.contacts import Contacts, push_sign
from perception.shelf.planning.dar import DistributionAreaReduction
from perception.shelf.planning.free_floor import CELL_M, free_cells
from perception.shelf.planning.looking_ahead import ANYHOW, Situation, look_ahead
from perception.shelf.planning.moves import Move, Place
from perception.shelf.planning.room import Reach
from perception.shelf.semantic import column_semantics, floor_semantics, image_semantics
from perception.shelf.sightings import sightings
from perception.shelf.spatial import RunningMinimum, along_shelf, mask_occupancy
from perception.shelf.types import Box, Floats, ShelfView, Sighting
from simulation.shelf.cameras import front_camera
from simulation.shelf.contents import MoveFailure, MoveResult
from simulation.shelf.scenes import Scene
from simulation.shelf.world import ShelfWorld

Seen = tuple[Sighting, ...]


@dataclass(frozen=True, slots=True)
class Way:
    """How to search.

    Attributes:
        spatial: `belief` (what any view has ruled out), `minimum` (of exact occupancy over time,
            in the image), `network` (the same of what the spatial network tells) or `masks` (the
            thesis's heuristic).
        affinity: Semantics, or None for none.
        product: Where semantics are multiplied in: per `pose`, or as in the thesis per `column`, or
            in the `image` by distance in pixels, as in its physical experiments.
        calibrated: Whether affinities are mixed by the estimated degree of organisation.
        flat: Whether the distribution is reduced to one along the shelf.
        policy: `dar` as published, `clearing` (the same, which clears its way) or `ahead` (ours).
        reach: What the tool can do.
    """

    spatial: str = "belief"
    affinity: AffinityMatrix | None = None
    product: str = "column"
    calibrated: bool = False
    flat: bool = False
    policy: str = "dar"
    reach: Reach = Reach()  # noqa: RUF009 - frozen


class WaySearcher:
    """Knows names, sizes of known objects and what it sees; nothing else about the scene.

    Attributes:
        view: The latest look.
        seen: Objects in it.
    """

    view: ShelfView
    seen: Seen

    def __init__(
        self,
        scene: Scene,
        way: Way,
        world: SearchedShelf | None = None,
        poses: HiddenPoses | None = None,
        enough: float = SHOWN,
    ) -> None:
        """Begin before the first look.

        Args:
            scene: What is searched.
            way: How to search.
            world: What is looked into and acted on; None for one without physics.
            poses: Of the scene's target, which searches may share.
            enough: The share of the target that has to show.
        """
        self.way, self.target, self.shelf = way, scene.target, scene.shelf
        self.world: SearchedShelf = world or ShelfWorld(
            scene, np.random.default_rng(0), reach=way.reach
        )
        self.sizes = {name: box.size_m for name, box in zip(scene.names, scene.boxes, strict=True)}
        self.poses = poses or poses_of(scene)
        self.caster = self.poses.caster
        self.belief, self.minimum = PoseBelief(self.poses), RunningMinimum()
        self.original, self.contacts = OriginalScene(), Contacts()
        self.first: dict[str, Sighting] = {}
        self.been: list[tuple[str, Box]] = []
        self.enough = enough
        policy = ReductionWithClearing if way.policy == "clearing" else DistributionAreaReduction
        self.policy = policy(self.shelf, self.caster, way.reach)

    def shows(self) -> bool:
        """Ask the world whether the target counts as found."""
        return self.world.visible_share(self.target) >= self.enough

    def look(self) -> None:
        """Look, and take in what is seen."""
        self.view = self.world.look()
        self.seen = sightings(self.view, self.shelf, self.sizes, self.caster)
        self.original.update(self.seen)
        self.first = {sighting.label: sighting for sighting in self.seen} | self.first
        self.belief.update(self.view, self.seen)

    def choose(self) -> Move | None:
        """Choose the next move."""
        view, seen = self.view, self.seen
        if self.way.policy == "ahead":
            return self._look_ahead(view, seen)
        occupancy = self.occupancy(view, seen)
        return self.policy.choose(occupancy, view, seen, self.contacts.footprints)

    def occupancy(self, view: ShelfView, seen: Seen) -> Floats:
        """Return the occupancy distribution in the image."""
        if self.way.affinity is None:
            heat = self._spatial(view, seen)
        elif self.way.product == "pose":
            heat = self.belief.heat(self._semantics())
        elif self.way.product == "image":
            first = tuple(self.first.values())
            heat = self._spatial(view, seen) * image_semantics(first, self._affinity(), self.target)
        else:
            heat = self._spatial(view, seen) * column_semantics(
                view.camera, self.shelf, self.original.boxes, self._affinity(), self.target
            )
        return along_shelf(heat) if self.way.flat else heat

    def act(self, move: Move) -> MoveResult:
        """Act, and remember what the move has met, as a robot could by touch."""
        box = next(sighting.box for sighting in self.seen if sighting.label == move.label)
        self.been.append((move.label, box))
        result, sign = self.world.act(move), push_sign(move)
        if result.failure is MoveFailure.NO_BLADE:
            self.contacts.blade_stopped(box, sign)
        elif result.failure is MoveFailure.OBSTRUCTED:
            self.contacts.way_blocked(box)
        elif isinstance(move, Place):
            if result.failure is MoveFailure.NO_PLACE:
                self.contacts.place_taken(box.at(move.x_m, move.y_m))
            elif result.failure is not None:
                # What the cup does not take hold of is not asked of it again and again.
                self.contacts.way_blocked(box)
        elif result.failure is not None or result.short_m > SHORT_M:
            self.contacts.push_stopped(box.at(box.x_m + sign * result.moved_m, box.y_m), sign)
        return result

    def _look_ahead(self, view: ShelfView, seen: Seen) -> Move | None:
        weights = self.belief.left.astype(np.float64)
        if self.way.affinity is not None:
            weights = weights * self._semantics()
        plan = look_ahead(
            Situation(
                self.shelf, self.way.reach, view.camera,
                tuple(sighting.label for sighting in seen),
                tuple(sighting.box for sighting in seen),
                np.full(len(seen), ANYHOW), self.contacts.footprints,
                free_cells(view, self.shelf, self.caster), CELL_M,
                self.sizes[self.target], self.poses.places_m, weights / weights.sum(), self.been,
            )
        )  # fmt: skip
        return None if plan is None else plan.moves[0]

    def _semantics(self) -> Floats:
        places_m, boxes = self.poses.places_m, self.original.boxes
        return floor_semantics(places_m, boxes, self._affinity(), self.target)

    def _spatial(self, view: ShelfView, seen: Seen) -> Floats:
        if self.way.spatial == "masks":
            return self.minimum.update(mask_occupancy(seen, view.depth_m.shape))
        if self.way.spatial == "minimum":
            now = self.poses.feasible(view, seen).astype(float)
            return self.minimum.update(self.poses.heat(now))
        if self.way.spatial == "network":
            return self.minimum.update(
                learned_occupancy().heat(view, self.shelf, self.sizes[self.target])
            )
        return self.belief.heat()

    def _affinity(self) -> AffinityMatrix:
        affinity = self.way.affinity
        assert affinity is not None
        if not self.way.calibrated:
            return affinity
        return affinity.mixed(organisation_of(self.original.boxes, affinity))


@cache
def learned_occupancy() -> LearnedOccupancy:
    """Return the spatial network, read once in each process."""
    return LearnedOccupancy()


def poses_of(scene: Scene) -> HiddenPoses:
    """Return the poses of a scene's target, as large as it is."""
    size_m = scene.boxes[scene.names.index(scene.target)].size_m
    return HiddenPoses(size_m, scene.shelf, BoxCaster(front_camera(scene.shelf)))


def search_by(scene: Scene, way: Way | None = None, poses: HiddenPoses | None = None) -> Trial:
    """Search with at most 2 N actions (thesis, section 5.2), in a world without physics."""
    return search(WaySearcher(scene, way or Way(), poses=poses), 2 * len(scene.names))
