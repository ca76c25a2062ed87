"""Objects of which a part is seen: where they may be, by all that is seen, and by what is felt."""

from dataclasses import replace

import numpy as np
import pytest
from shelf_search import drawn_scenes

from perception.shelf.affinity import Origin, affinity_from_scores
from perception.shelf.beliefs import SeenObject
from perception.shelf.casting import BoxCaster
from perception.shelf.completing import completed
from perception.shelf.meeting import meeting, unexplained
from perception.shelf.planning.contacts import contact_beside
from perception.shelf.planning.room import Reach
from perception.shelf.reasoner import SearchReasoner
from perception.shelf.sightings import sightings
from perception.shelf.stock import Product, Stock
from perception.shelf.types import NOTHING, Box, Shelf, ShelfView, Sighting
from simulation.shelf.cameras import front_camera
from simulation.shelf.scenes import SceneRules
from simulation.shelf.taxonomy import shipped_domain, taxonomy_affinity
from simulation.shelf.world import ShelfWorld

SHELF = Shelf()
CAMERA = front_camera(SHELF)
CASTER = BoxCaster(CAMERA)
WIDE = Box(0.4, 0.25, (0.3, 0.1, 0.2))
# How well an image of 160 px tells where a side is.
PIXEL_M = 0.006


@pytest.fixture(scope="module")
def partly_seen():
    """Return sightings of which less than nine tenths show, with the truth."""
    found = []
    for scene in drawn_scenes("pharmacy", SceneRules(18, scale=1.0), range(60, 68)):
        world = ShelfWorld(scene, np.random.default_rng(0))
        sizes_m = {name: box.size_m for name, box in world.boxes.items()}
        seen = sightings(world.look(), SHELF, sizes_m, CASTER)
        found += [
            (sighting, world.boxes[sighting.label])
            for sighting in seen
            if world.visible_share(sighting.label) < 0.9
        ]
    return found


def test_most_objects_stand_where_they_are_said_to_or_as_far_beside_as_is_said(partly_seen):
    assert len(partly_seen) > 30
    beside_m = np.array(
        [
            (
                abs(one.box.x_m - box.x_m) - one.loose_m[0],
                abs(one.box.y_m - box.y_m) - one.loose_m[1],
            )
            for one, box in partly_seen
        ]
    )
    assert (beside_m < PIXEL_M).all(axis=1).mean() > 0.9


def test_half_of_what_is_not_known_is_far_from_a_whole_box(partly_seen):
    errors_m = np.array([abs(one.box.x_m - box.x_m) for one, box in partly_seen])
    assert np.median(errors_m) < PIXEL_M


def seen_from_the_left(*others):
    """Return a wide box of which a third shows, as one look alone has it, and what is seen."""
    shown = Sighting("wide", np.zeros((120, 160), dtype=bool), WIDE.at(0.35, 0.25),
                     Box(0.3, 0.25, (0.1, 0.1, 0.2)))  # fmt: skip
    nothing = np.full((120, 160), NOTHING, dtype=np.int16)
    view = ShelfView(np.full((120, 160), 0.5, dtype=np.float32), nothing, ("wide",), CAMERA)
    more = [Sighting(f"{box.x_m:g}", shown.mask, box, box) for box in others]
    return [shown, *more], view


def test_an_object_is_in_the_middle_of_where_it_may_be():
    found, view = seen_from_the_left()
    # All depth is nearer than the box: nothing speaks against any place.
    (one,) = completed(found, view, SHELF, CASTER)
    assert one.box.x_m == pytest.approx(0.3, abs=0.005)
    assert one.loose_m[0] == pytest.approx(0.1, abs=0.005)


def test_it_stands_on_no_other_object():
    found, view = seen_from_the_left(Box(0.2, 0.25, (0.08, 0.1, 0.2)))
    one = completed(found, view, SHELF, CASTER)[0]
    assert one.box.low_m[0] > 0.24 - 0.012
    assert one.loose_m[0] < 0.06


def test_it_is_nowhere_where_more_of_it_would_show():
    found, view = seen_from_the_left()
    through = view.depth_m.copy()
    through[:, 85:] = 2.0
    (one,) = completed(found, replace(view, depth_m=through), SHELF, CASTER)
    assert one.box.high_m[0] < 0.48
    assert one.loose_m[0] < 0.1


def thing(label, box, loose_m):
    return SeenObject(label, 1.0, np.ones(1), box, box, (loose_m, 0.0), box, 0, 0.5, 0.5)


def belief_of(*objects):
    domain = shipped_domain("pharmacy")
    affinity = affinity_from_scores(domain.names, taxonomy_affinity(domain), Origin("taxonomy"))
    products = tuple(Product(name, (0.06, 0.06, 0.1), (0, 0, 0)) for name in domain.names)
    search = SearchReasoner(Stock("pharmacy", SHELF, products), affinity, Reach(), CAMERA)
    return replace(search.begin(domain.names[0]), objects=objects)


def test_what_a_push_meets_is_an_object_that_may_stand_there():
    pushed = Box(0.2, 0.15, (0.1, 0.1, 0.2))
    loose = Box(0.36, 0.16, (0.1, 0.1, 0.2))
    row = contact_beside(pushed, 1)
    belief = meeting(belief_of(thing("a", loose, 0.08)), row[None], felt=True)
    assert belief.objects[0].box.low_m[0] == pytest.approx(pushed.high_m[0], abs=0.003)
    assert belief.objects[0].loose_m[0] == 0.0
    assert (belief.plausible == 1.0).all()
    assert len(unexplained(belief)) == 0


@pytest.mark.parametrize("loose_m", [0.0, 0.03])
def test_what_cannot_be_explained_may_be_the_target(loose_m):
    pushed, far = Box(0.2, 0.15, (0.1, 0.1, 0.2)), Box(0.36, 0.16, (0.1, 0.1, 0.2))
    row = contact_beside(pushed, 1)
    belief = meeting(belief_of(thing("a", far, loose_m)), row[None], felt=True)
    assert belief.objects[0].box == far
    near = np.abs(belief.places_m - (0.275, 0.15)).max(axis=1) < 0.015
    assert belief.plausible[near].min() > 2.0 * np.median(belief.plausible)
    assert len(unexplained(belief)) == 1
    again = meeting(belief, row[None], felt=True)
    assert np.array_equal(again.plausible, belief.plausible)
