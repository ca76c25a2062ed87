"""Objects on others: scenes, what moves, what is seen of them, and what is moved first."""

import numpy as np
import pytest
from shelf_rows import CUBE

from benchmarks.search_ours import OurSearcher
from benchmarks.searching import search
from executive.core.errors import InputError
from perception.shelf.casting import BoxCaster
from perception.shelf.planning.moves import Push
from perception.shelf.planning.room import Reach
from perception.shelf.rendering import ShelfRenderer
from perception.shelf.sightings import sightings
from perception.shelf.types import Box, Shelf, corners, stands_on
from simulation.shelf.cameras import front_camera
from simulation.shelf.contents import MoveFailure, ShelfContents
from simulation.shelf.scenes import Scene, SceneRules, draw_scene
from simulation.shelf.taxonomy import shipped_domain
from simulation.shelf.world import ShelfWorld

LOW, UPPER = Box(0.4, 0.15, (0.1, 0.08, 0.1)), Box(0.41, 0.16, CUBE, 0.1)
STACK = Scene(Shelf(), ("low", "upper"), (LOW, UPPER), "")


def drawn(seed, stacked=0.3, domain="pharmacy", count=15):
    rules = SceneRules(count, stacked=stacked)
    return draw_scene(shipped_domain(domain), rules, np.random.default_rng(seed))


def carriers(scene):
    return [
        [one for one in scene.boxes if stands_on(box, one)]
        for box in scene.boxes
        if box.bottom_m > 0.0
    ]


@pytest.mark.parametrize("domain", ["pharmacy", "kitchen", "office"])
def test_stacks_are_sound(domain):
    for seed in range(4):
        scene = drawn(seed, domain=domain)
        low_m, high_m = corners(scene.boxes)
        solid = (np.minimum(high_m[:, None], high_m) - np.maximum(low_m[:, None], low_m)) > 1e-6
        assert (solid.all(axis=2) == np.eye(len(scene.boxes), dtype=bool)).all()
        assert (high_m <= (0.8, 0.35, 0.57)).all()
        upper = [box for box in scene.boxes if box.bottom_m > 0.0]
        assert upper
        for box, on in zip(upper, carriers(scene), strict=True):
            assert len(on) == 1
            assert on[0].bottom_m == 0.0
            assert box.bottom_m == on[0].high_m[2]
            assert (np.array(box.low_m[:2]) >= np.array(on[0].low_m[:2]) - 1e-6).all()
            assert (np.array(box.high_m[:2]) <= np.array(on[0].high_m[:2]) + 1e-6).all()


def test_the_target_is_hidden_on_the_floor_with_nothing_on_it():
    for seed in range(6):
        scene = drawn(seed)
        target = scene.boxes[scene.names.index(scene.target)]
        assert target.bottom_m == 0.0
        assert not any(stands_on(box, target) for box in scene.boxes)
        renderer = ShelfRenderer(BoxCaster(front_camera(scene.shelf)), scene.shelf)
        assert renderer.visible_shares(scene.boxes)[scene.names.index(scene.target)] == 0.0


def test_the_more_stacks_are_asked_for_the_more_there_are():
    counts = [
        sum(len(carriers(drawn(seed, stacked))) for seed in range(5))
        for stacked in (0.0, 0.15, 0.4)
    ]
    assert counts[0] == 0
    assert counts[0] < counts[1] < counts[2]


def test_a_seed_gives_the_same_stacks_everywhere():
    assert drawn(7).digest[:16] == "41c38fe8c8111ee2"
    with pytest.raises(InputError, match=r"stacked: got 1\.5; expected 0 to 1"):
        drawn(7, stacked=1.5)


def test_a_push_takes_along_what_stands_on_an_object():
    contents = ShelfContents(STACK, Reach())
    assert contents.push("low", 0.1).failure is None
    apart = contents.boxes["upper"].x_m - contents.boxes["low"].x_m
    assert contents.boxes["upper"].x_m == pytest.approx(0.51)
    assert apart == pytest.approx(0.01)


def test_what_stands_on_another_is_taken_by_the_cup_alone_and_first():
    contents = ShelfContents(STACK, Reach())
    assert contents.push("upper", 0.05).failure is MoveFailure.NO_BLADE
    assert contents.place("low", 0.2, 0.15).failure is MoveFailure.OBSTRUCTED
    assert contents.take_out("low").failure is MoveFailure.OBSTRUCTED
    assert contents.place("upper", 0.2, 0.15).failure is None
    assert contents.boxes["upper"].bottom_m == 0.0
    assert contents.place("low", 0.6, 0.15).failure is None


def test_what_shows_higher_than_it_is_stands_on_another():
    world = ShelfWorld(STACK, np.random.default_rng(0))
    sizes = {"low": LOW.size_m, "upper": CUBE}
    found = sightings(world.look(), STACK.shelf, sizes, BoxCaster(world.camera))
    seen = {one.label: one.box for one in found}
    assert seen["low"].bottom_m == 0.0
    assert seen["upper"].bottom_m == pytest.approx(0.1, abs=0.01)
    assert stands_on(seen["upper"], seen["low"])


def moves(scene, reach, enough):
    searcher, made = OurSearcher(scene, None, reach, enough=enough), []
    act = searcher.act
    searcher.act = lambda move: made.append(move) or act(move)
    return search(searcher, 8), made


@pytest.mark.parametrize("reach", [Reach(), Reach(suction=False)])
def test_shelves_with_stacks_are_searched(reach):
    trials = [moves(drawn(300 + seed), reach, 0.01) for seed in range(4)]
    assert sum(trial.success for trial, _ in trials) >= 3
    for trial, made in trials:
        assert trial.refusals <= 2
        assert reach.suction or all(isinstance(move, Push) for move in made)
