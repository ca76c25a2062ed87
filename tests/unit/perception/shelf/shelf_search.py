"""A search without a tree: look, estimate, choose, act, until the target shows or time is up."""

from dataclasses import dataclass

import numpy as np

from perception.shelf.affinity import AffinityMatrix, Origin, affinity_from_scores
from perception.shelf.casting import BoxCaster
from perception.shelf.hidden_poses import HiddenPoses, PoseBelief
from perception.shelf.organisation import organisation_of
from perception.shelf.original import OriginalScene
from perception.shelf.planning.clearing import ReductionWithClearing
from perception.shelf.planning.contacts import Contacts, push_sign
from perception.shelf.planning.dar import DistributionAreaReduction
from perception.shelf.planning.room import Reach
from perception.shelf.semantic import column_semantics, floor_semantics
from perception.shelf.sightings import sightings
from perception.shelf.spatial import RunningMinimum, along_shelf, mask_occupancy
from simulation.shelf.contents import MoveFailure
from simulation.shelf.scenes import draw_scene
from simulation.shelf.taxonomy import shipped_domain, taxonomy_affinity
from simulation.shelf.world import ShelfWorld

# The thesis's rule: found when 1 % of the target shows (section 7.4).
SHOWN = 0.01
# A push that stops short by less has met what was seen.
SHORT_M = 0.01


@dataclass(frozen=True, slots=True)
class Way:
    """How to search.

    Attributes:
        spatial: `belief` (what any view ruled out), `minimum` (over time, in the image) or `masks`.
        affinity: Semantics, or None for none.
        product: Where semantics are multiplied in: per `pose`, or per `column` as in the thesis.
        calibrated: Whether affinities are mixed by the estimated degree of organisation.
        flat: Whether the distribution is reduced to one along the shelf.
        clearing: Whether a stuck search clears its way.
        reach: What the tool can do.
    """

    spatial: str = "belief"
    affinity: AffinityMatrix | None = None
    product: str = "column"
    calibrated: bool = False
    flat: bool = False
    clearing: bool = False
    reach: Reach = Reach()  # noqa: RUF009 - frozen


@dataclass(frozen=True, slots=True)
class Found:
    success: bool
    actions: int
    stuck: bool = False
    refusals: int = 0


class Searcher:
    """Knows names, sizes of known objects and what it sees; nothing else about the scene."""

    def __init__(self, scene, way):
        self.way, self.target, self.shelf = way, scene.target, scene.shelf
        self.world = ShelfWorld(scene, np.random.default_rng(0), reach=way.reach)
        self.sizes = {name: box.size_m for name, box in zip(scene.names, scene.boxes, strict=True)}
        self.caster = BoxCaster(self.world.camera)
        self.poses = HiddenPoses(self.sizes[scene.target], self.shelf, self.caster)
        self.belief, self.minimum = PoseBelief(self.poses), RunningMinimum()
        self.original, self.contacts = OriginalScene(), Contacts()
        policy = ReductionWithClearing if way.clearing else DistributionAreaReduction
        self.policy = policy(self.shelf, self.caster, way.reach)

    def shows(self):
        return self.world.visible_share(self.target) >= SHOWN

    def look(self):
        view = self.world.look()
        seen = sightings(view, self.shelf, self.sizes, self.caster)
        self.original.update(seen)
        self.belief.update(view, seen)
        return view, seen

    def occupancy(self, view, seen):
        if self.way.affinity is None:
            heat = self._spatial(view, seen)
        elif self.way.product == "pose":
            weights = floor_semantics(
                self.poses.places_m, self.original.boxes, self._affinity(), self.target
            )
            heat = self.belief.heat(weights)
        else:
            heat = self._spatial(view, seen) * column_semantics(
                view.camera, self.shelf, self.original.boxes, self._affinity(), self.target
            )
        return along_shelf(heat) if self.way.flat else heat

    def _spatial(self, view, seen):
        if self.way.spatial == "masks":
            return self.minimum.update(mask_occupancy(seen, view.depth_m.shape))
        if self.way.spatial == "minimum":
            now = self.poses.feasible(view, seen).astype(float)
            return self.minimum.update(self.poses.heat(now))
        return self.belief.heat()

    def _affinity(self):
        if not self.way.calibrated:
            return self.way.affinity
        share = organisation_of(self.original.boxes, self.way.affinity)
        return self.way.affinity.mixed(share)

    def act(self, move, seen):
        """Act, and remember what the move has met, as a robot could by touch."""
        box = next(sighting.box for sighting in seen if sighting.label == move.label)
        result, sign = self.world.act(move), push_sign(move)
        if result.failure is MoveFailure.NO_BLADE:
            self.contacts.blade_stopped(box, sign)
        elif result.failure is MoveFailure.OBSTRUCTED:
            self.contacts.way_blocked(box)
        elif result.failure is MoveFailure.NO_PLACE:
            self.contacts.place_taken(box.at(move.x_m, move.y_m))
        elif result.failure is MoveFailure.NO_ROOM or result.short_m > SHORT_M:
            self.contacts.push_stopped(box.at(box.x_m + sign * result.moved_m, box.y_m), sign)
        return result


def search(scene, way=None):
    """Search with at most 2 N actions (thesis, section 5.2)."""
    searcher, refusals = Searcher(scene, way or Way()), 0
    for actions in range(2 * len(scene.names) + 1):
        if searcher.shows():
            return Found(True, actions, refusals=refusals)
        view, seen = searcher.look()
        occupancy = searcher.occupancy(view, seen)
        move = searcher.policy.choose(occupancy, view, seen, searcher.contacts.footprints)
        if move is None:
            return Found(False, actions, stuck=True, refusals=refusals)
        refusals += searcher.act(move, seen).failure is not None
    return Found(False, 2 * len(scene.names), refusals=refusals)


def drawn_scenes(domain_name, rules, seeds):
    domain = shipped_domain(domain_name)
    return [draw_scene(domain, rules, np.random.default_rng(seed)) for seed in seeds]


def guessed_affinity(domain, rng, right=0.7, spread=0.6):
    """A flawed oracle: the taxonomy's categories blurred, and each pair wrong by a random factor.

    It stands for a language model that nobody has asked yet: `right` of each row is on the object's
    category, the rest on all others alike, and each logarithm is off by `spread`.
    """
    count = len(domain.names)
    true = taxonomy_affinity(domain)
    np.fill_diagonal(true, 0.0)
    true = true / np.maximum(true.sum(axis=1, keepdims=True), 1e-9)
    scores = right * true + (1.0 - right) / count
    scores = scores * np.exp(spread * rng.standard_normal(scores.shape))
    return affinity_from_scores(domain.names, scores, Origin("blurred taxonomy"))
