"""Distribution Area Reduction, and the moves that it chooses among."""

import numpy as np
import pytest
from shelf_search import drawn_scenes

from benchmarks.search_trials import Way, WaySearcher
from perception.shelf.planning.contacts import Contacts, push_sign
from perception.shelf.planning.moves import Place
from perception.shelf.planning.options import options
from perception.shelf.planning.room import (
    Reach,
    blade_fits,
    fits_at,
    footprints,
    push_room_m,
    way_out,
)
from perception.shelf.types import Box, Shelf
from simulation.shelf.scenes import Scene, SceneRules
from simulation.shelf.world import ShelfWorld

SHELF = Shelf()
NOTHING_MET = np.zeros((0, 4))


def looking_at(*boxes, reach=Reach(), target=(0.04, 0.04, 0.06)):  # noqa: B008 - frozen
    """Return a searcher of a scene whose target is the last, hidden box."""
    names = (*(f"thing {index}" for index in range(len(boxes))), "target")
    behind = Box(boxes[0].x_m, boxes[0].high_m[1] + 0.5 * target[1] + 0.01, target)
    scene = Scene(SHELF, names, (*boxes, behind), "target")
    searcher = WaySearcher(scene, Way(reach=reach))
    searcher.look()
    return searcher, searcher.view, searcher.seen


def choice(searcher, view, seen, heat=None):
    heat = searcher.occupancy(view, seen) if heat is None else heat
    return searcher.policy.choose(heat, view, seen, NOTHING_MET)


def test_what_covers_most_is_moved_to_where_it_covers_less():
    tall, small = Box(0.38, 0.08, (0.14, 0.05, 0.2)), Box(0.65, 0.08, (0.06, 0.05, 0.09))
    searcher, view, seen = looking_at(tall, small)
    move = choice(searcher, view, seen)
    assert move.label == "thing 0"
    heat = searcher.occupancy(view, seen)
    before = heat[seen[0].mask].sum()
    after = [option for option in options(
        seen[0], seen, view, SHELF, searcher.caster, Reach(), NOTHING_MET
    ) if option.move == move]  # fmt: skip
    shown = searcher.caster.cast(np.array([after[0].box.low_m]), np.array([after[0].box.high_m]))
    assert heat.ravel()[shown.pixel].sum() < 0.5 * before


def test_the_distribution_decides_and_not_the_size():
    tall, small = Box(0.38, 0.08, (0.14, 0.05, 0.2)), Box(0.65, 0.08, (0.06, 0.05, 0.09))
    searcher, view, seen = looking_at(tall, small)
    heat = np.zeros(view.depth_m.shape)
    heat[seen[1].mask] = 1.0
    assert choice(searcher, view, seen, heat).label == "thing 1"
    assert choice(searcher, view, seen, np.zeros_like(heat)) is None


def test_where_nothing_can_be_moved_the_search_is_stuck():
    row = [Box(0.1 + 0.2 * i, 0.1, (0.199, 0.15, 0.2)) for i in range(4)]
    searcher, view, seen = looking_at(*row, reach=Reach(suction=False))
    assert choice(searcher, view, seen) is None


def test_what_was_met_is_not_run_into_again():
    searcher, view, seen = looking_at(
        Box(0.3, 0.1, (0.1, 0.08, 0.2)), reach=Reach(blade_m=0.0, suction=False)
    )
    contacts = Contacts()
    signs = []
    for _ in range(2):
        move = searcher.policy.choose(
            searcher.occupancy(view, seen), view, seen, contacts.footprints
        )
        signs.append(push_sign(move))
        contacts.push_stopped(seen[0].box, push_sign(move))
    assert sorted(signs) == [-1, 1]
    heat = searcher.occupancy(view, seen)
    assert searcher.policy.choose(heat, view, seen, contacts.footprints) is None
    assert push_sign(Place("thing 0", 0.1, 0.1)) == 0


def test_each_kind_of_contact_stops_the_move_that_met_it():
    box, own = Box(0.3, 0.1, (0.1, 0.08, 0.2)), np.array([0.25, 0.06, 0.35, 0.14])
    contacts = [Contacts() for _ in range(4)]
    contacts[0].push_stopped(box, 1)
    contacts[1].blade_stopped(box, 1)
    contacts[2].way_blocked(box)
    contacts[3].place_taken(box)
    stopped = [one.footprints for one in contacts]
    reach = Reach()
    assert push_room_m(own, stopped[0], 1, SHELF, reach) == 0.0
    assert push_room_m(own, stopped[0], -1, SHELF, reach) > 0.2
    assert not blade_fits(own, stopped[1], 1, SHELF, reach)
    assert blade_fits(own, stopped[1], -1, SHELF, reach)
    assert not way_out(own, stopped[2])
    assert all(way_out(own, met) for met in stopped[:2])
    assert not fits_at(own[None], stopped[3], SHELF)[0]


def test_options_are_possible_where_everything_is_seen():
    boxes = [Box(0.15, 0.1, (0.06, 0.06, 0.1)), Box(0.4, 0.2, (0.1, 0.06, 0.12)),
             Box(0.65, 0.05, (0.06, 0.04, 0.08))]  # fmt: skip
    names = ("a", "b", "c")
    scene, tried = Scene(SHELF, names, tuple(boxes), "a"), 0
    searcher = WaySearcher(scene, Way())
    searcher.look()
    view, seen = searcher.view, searcher.seen
    for sighting in seen:
        for option in options(sighting, seen, view, SHELF, searcher.caster, Reach(), NOTHING_MET):
            world = ShelfWorld(scene, np.random.default_rng(0))
            assert world.act(option.move).failure is None
            after = world.boxes[sighting.label]
            assert after.x_m == pytest.approx(option.box.x_m, abs=0.012)
            tried += 1
    assert tried > 50


@pytest.mark.parametrize("seed", range(6))
def test_room_agrees_with_trying_it_in_small_steps(seed):
    rng = np.random.default_rng(seed)
    scene = drawn_scenes("pharmacy", SceneRules(15), [seed])[0]
    rows = footprints(scene.boxes)
    index = int(rng.integers(len(rows)))
    own, others = rows[index], np.delete(rows, index, 0)
    for sign in (-1, 1):
        room = push_room_m(own, others, sign, SHELF, Reach(gap_m=0.0))
        step = sign * np.array([1.0, 0.0, 1.0, 0.0])
        free = own + (room - 1e-6) * step
        assert not _hits(free, others)
        assert _hits(own + (room + 1e-4) * step, others)


def _hits(own, others):
    low, high = np.maximum(own[:2], others[:, :2]), np.minimum(own[2:], others[:, 2:])
    outside = own[0] < -1e-9 or own[2] > SHELF.width_m + 1e-9
    return outside or bool((high - low > 1e-9).all(axis=1).any())


def test_the_tool_needs_its_lanes():
    own = np.array([0.3, 0.1, 0.4, 0.2])
    before = np.array([[0.35, 0.0, 0.38, 0.05]])
    beside = np.array([[0.295, 0.05, 0.299, 0.3]])
    beyond = np.array([[0.295, 0.13, 0.299, 0.3]])
    assert not way_out(own, before)
    assert way_out(own, beside)
    assert blade_fits(own, before, 1, SHELF, Reach())
    assert not blade_fits(own, beside, 1, SHELF, Reach())
    assert blade_fits(own, beside, -1, SHELF, Reach())
    # The blade needs to reach along a part of the side only.
    assert blade_fits(own, beyond, 1, SHELF, Reach())
    assert blade_fits(own, beside, 1, SHELF, Reach(blade_m=0.0))
    at_wall = np.array([0.004, 0.1, 0.1, 0.2])
    assert not blade_fits(at_wall, before, 1, SHELF, Reach())
    places = own + np.array([[0.0, 0.0, 0.0, 0.0], [0.2, 0.0, 0.2, 0.0], [0.5, 0.0, 0.5, 0.0]])
    assert fits_at(places, before, SHELF).tolist() == [False, True, False]
