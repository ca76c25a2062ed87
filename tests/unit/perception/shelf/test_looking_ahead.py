"""Looking ahead: its compiled rules are those of `room`, its columns those of images."""

from dataclasses import replace

import numpy as np
import pytest

from perception.shelf.casting import BoxCaster
from perception.shelf.planning.kernels import moves_from, rising
from perception.shelf.planning.lifting import slip_chance, tries
from perception.shelf.planning.looking_ahead import (
    ANYHOW,
    BY_CUP,
    FIXED,
    Situation,
    kernel_inputs,
    look_ahead,
    open_moves,
)
from perception.shelf.planning.moves import Place, Push, moved_box
from perception.shelf.planning.outlook import COARSE, Grain, outlook, shares_shown
from perception.shelf.planning.room import Reach, blade_fits, footprints, push_room_m, way_out
from perception.shelf.planning.ways_out import freeing_move
from perception.shelf.rendering import ShelfRenderer
from perception.shelf.types import Box, Shelf, corners
from simulation.shelf.cameras import front_camera
from simulation.shelf.scenes import SceneRules, draw_scene
from simulation.shelf.taxonomy import shipped_domain

SHELF = Shelf()
CAMERA = front_camera(SHELF)
WIDE = (0.12, 0.08, 0.16)
SMALL = (0.05, 0.05, 0.08)


def situation(boxes, target, reach=None, movable=None, **changes):
    """Return a situation in which the target's place is known."""
    made = Situation(
        shelf=SHELF,
        reach=reach or Reach(),
        camera=CAMERA,
        labels=tuple(f"box {number}" for number in range(len(boxes))),
        boxes=tuple(boxes),
        movable=np.array(movable or [ANYHOW] * len(boxes)),
        met=np.zeros((0, 4)),
        floor=np.ones((80, 35), dtype=bool),
        cell_m=0.01,
        target_m=target.size_m,
        places_m=np.array([[target.x_m, target.y_m]]),
        weights=np.ones(1),
    )
    return replace(made, **changes)


def drawn(seed, count=12):
    scene = draw_scene(
        shipped_domain("pharmacy"), SceneRules(count=count), np.random.default_rng(seed)
    )
    target = scene.boxes[scene.names.index(scene.target)]
    others = [
        box for name, box in zip(scene.names, scene.boxes, strict=True) if name != scene.target
    ]
    return others, target


def all_moves(made):
    inputs = kernel_inputs(made)
    return moves_from(
        inputs.boxes, made.movable, inputs.met, inputs.shelf_m, inputs.reach, inputs.steps_m,
        inputs.floor, made.cell_m,
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("reach", [Reach(), Reach(blade_m=0.0, suction=False)])
def test_compiled_pushes_are_those_that_there_is_room_for(seed, reach):
    boxes, target = drawn(seed)
    made = situation(boxes, target, reach)
    moved, by_cup, ends = all_moves(made)
    rows = footprints(boxes)
    for index in range(len(boxes)):
        others = np.delete(rows, index, axis=0)
        mine = (moved == index) & (by_cup == 0)
        for sign in (-1, 1):
            shifts = sign * (ends[mine, 0] - rows[index, 0])
            room_m = push_room_m(rows[index], others, sign, SHELF, reach)
            fits = blade_fits(rows[index], others, sign, SHELF, reach)
            expected = room_m if fits and room_m >= 0.01 else 0.0
            assert max(shifts.max(initial=0.0), 0.0) == pytest.approx(expected)
        if not way_out(rows[index], others):
            assert not ((moved == index) & (by_cup == 1)).any()


@pytest.mark.parametrize("seed", range(6))
def test_what_shows_by_columns_is_what_shows_in_the_image(seed):
    boxes, target = drawn(seed)
    rng = np.random.default_rng(seed)
    renderer = ShelfRenderer(BoxCaster(CAMERA), SHELF)
    agreed = 0
    for _ in range(20):
        index = int(rng.integers(len(boxes)))
        gone = [box for number, box in enumerate(boxes) if number != index]
        share = renderer.visible_shares([*gone, target])[-1]
        made = situation(gone, target)
        view = outlook(CAMERA, made.places_m, target.size_m, Grain(shown=0.05))
        inputs = kernel_inputs(made)
        rises = rising(
            inputs.boxes, view.slopes, view.eye, view.column, view.depth, view.top, view.start,
            made.weights,
        )  # fmt: skip
        # Between these shares a pixel more or less decides.
        if share == 0.0 or share > 0.12:
            assert bool(rises[0] >= view.shows[0]) == (share > 0.12)
            agreed += 1
    assert agreed > 10


def test_one_box_before_the_target_is_moved_aside():
    plan = look_ahead(situation([Box(0.4, 0.12, WIDE)], Box(0.4, 0.28, SMALL)))
    assert plan.shows == pytest.approx(1.0)
    assert plan.expected_moves == pytest.approx(1.0, abs=0.01)


def test_a_box_that_is_shut_in_is_freed_first():
    """The middle box cannot be pushed until a neighbour has made room."""
    row = [Box(x_m, 0.12, WIDE) for x_m in (0.277, 0.4, 0.523)]
    pushes = Reach(blade_m=0.0, suction=False)
    plan = look_ahead(situation(row, Box(0.4, 0.28, SMALL), pushes))
    first, second = plan.moves[:2]
    assert (first.label, second.label) in {("box 0", "box 1"), ("box 2", "box 1")}
    assert isinstance(first, Push)
    assert plan.shows == 0.0


def test_what_is_fixed_is_not_moved_and_nothing_to_move_is_no_plan():
    target = Box(0.4, 0.28, SMALL)
    boxes = [Box(0.4, 0.12, WIDE)]
    assert look_ahead(situation(boxes, target, movable=[FIXED])) is None


def test_no_object_is_brought_back_to_where_it_was():
    home = Box(0.45, 0.12, WIDE)
    made = situation([Box(0.4, 0.12, WIDE)], Box(0.4, 0.28, SMALL), been=(("box 0", home),))
    plan = look_ahead(made)
    shift_m = plan.moves[0].shift_m if isinstance(plan.moves[0], Push) else 1.0
    assert abs(0.4 + shift_m - home.x_m) > 0.01


def test_the_way_out_of_an_object_is_freed():
    boxes = [Box(0.4, 0.25, SMALL), Box(0.4, 0.1, WIDE)]
    made = situation(boxes, Box(0.7, 0.3, SMALL), movable=[FIXED, ANYHOW])
    move = freeing_move(made, "box 0")
    assert move.label == "box 1"
    x_m = 0.4 + move.shift_m if isinstance(move, Push) else move.x_m
    assert abs(x_m - 0.4) >= 0.085 - 1e-6 or (isinstance(move, Place) and move.y_m > 0.28)
    assert freeing_move(situation(boxes[:1], boxes[0]), "box 0") is None


def test_what_is_shut_in_before_an_object_is_freed_first_and_never_brought_back():
    """By pushes alone the blocker moves only once a neighbour of it has made room."""
    behind = Box(0.4, 0.3, SMALL)
    row = [Box(x_m, 0.12, WIDE) for x_m in (0.277, 0.4, 0.523)]
    pushes = Reach(blade_m=0.0, suction=False)
    made = situation([behind, *row], behind, pushes, [FIXED, ANYHOW, ANYHOW, ANYHOW])
    been = []
    for _ in range(6):
        move = freeing_move(replace(made, been=tuple(been)), "box 0")
        if move is None:
            break
        index = made.labels.index(move.label)
        boxes = list(made.boxes)
        been.append((move.label, boxes[index]))
        boxes[index] = boxes[index].at(boxes[index].x_m + move.shift_m, boxes[index].y_m)
        made = replace(made, boxes=tuple(boxes))
    assert been[0][0] != "box 2"
    rows = footprints(list(made.boxes))
    assert way_out(rows[0], rows[1:])


def test_corners_and_footprints_agree():
    boxes, _ = drawn(1)
    low_m, high_m = corners(boxes)
    assert np.allclose(footprints(boxes), np.hstack([low_m[:, :2], high_m[:, :2]]))


@pytest.mark.parametrize("enough", [0.1, 0.5, 0.9])
def test_as_much_of_the_target_shows_as_is_asked_for(enough):
    front, target = Box(0.4, 0.1, WIDE), Box(0.4, 0.25, SMALL)
    plan = look_ahead(
        situation([front], target, Reach(suction=False)), grain=COARSE.showing(enough)
    )
    boxes = [moved_box(plan.moves[0], front), target]
    shares = ShelfRenderer(BoxCaster(CAMERA), SHELF).visible_shares(boxes)
    assert shares[1] >= enough


def test_it_takes_no_longer_push_to_show_less():
    front, target = Box(0.4, 0.1, WIDE), Box(0.4, 0.25, SMALL)
    made = situation([front], target, Reach(suction=False))
    plans = [look_ahead(made, grain=COARSE.showing(enough)) for enough in (0.1, 0.4, 0.8)]
    shifts = [abs(plan.moves[0].shift_m) for plan in plans]
    assert shifts == sorted(shifts)
    assert shifts[0] < shifts[-1]


def test_what_cannot_be_pushed_that_way_is_pushed_the_other_way():
    front, target = Box(0.3, 0.1, WIDE), Box(0.3, 0.25, SMALL)
    made = situation([front], target, Reach(suction=False))
    shift_m = look_ahead(made).moves[0].shift_m
    sign = 1 if shift_m > 0.0 else -1
    other = look_ahead(replace(made, barred=(("box 0", sign),)))
    assert other.moves[0].shift_m * sign < 0.0
    assert look_ahead(replace(made, barred=(("box 0", 1), ("box 0", -1)))) is None


def test_heavy_things_slip_and_are_pushed_where_that_is_as_good():
    cup = Reach(lift_kg=0.6, lift_nm=0.4)
    chances = [slip_chance((side_m, side_m, side_m), cup) for side_m in (0.05, 0.1, 0.12, 0.2)]
    assert chances == sorted(chances)
    assert chances[0] == 0.0
    assert chances[-1] == 1.0
    assert tries((0.05, 0.05, 0.05), cup) == 1.0
    front, target = Box(0.4, 0.06, (0.12, 0.12, 0.16)), Box(0.4, 0.25, SMALL)
    weak = look_ahead(situation([front], target, Reach(lift_kg=0.6, lift_nm=0.4)))
    assert isinstance(weak.moves[0], Push)


def test_what_stands_on_another_goes_first_and_the_other_one_then():
    low, upper = Box(0.4, 0.06, (0.1, 0.08, 0.1)), Box(0.4, 0.06, SMALL, 0.1)
    walls = [Box(0.225, 0.06, (0.24, 0.1, 0.2)), Box(0.575, 0.06, (0.24, 0.1, 0.2))]
    target = Box(0.4, 0.25, (0.05, 0.05, 0.12))
    made = situation(
        [low, upper, *walls], target, movable=[ANYHOW, BY_CUP, FIXED, FIXED],
        labels=("low", "upper", "left", "right"),
    )  # fmt: skip
    plan = look_ahead(made, grain=COARSE.showing(0.5))
    assert [move.label for move in plan.moves] == ["upper", "low"]
    assert all(isinstance(move, Place) for move in plan.moves)
    assert plan.finds == pytest.approx(1.0)


def test_a_pushed_object_takes_along_what_stands_on_it_and_shows_what_both_hid():
    low, upper = Box(0.4, 0.1, WIDE), Box(0.4, 0.1, SMALL, WIDE[2])
    target = Box(0.4, 0.25, (0.05, 0.05, 0.2))
    made = situation([low, upper], target, Reach(suction=False), movable=[ANYHOW, BY_CUP])
    plan = look_ahead(made, grain=COARSE.showing(0.9))
    assert [move.label for move in plan.moves] == ["box 0"]
    assert plan.finds == pytest.approx(1.0)


def test_no_arrangement_that_showed_nothing_is_made_again():
    """Neither box went back alone: only both together are where they were."""
    boxes = [Box(0.4, 0.12, WIDE), Box(0.1, 0.12, SMALL)]
    made = situation(boxes, Box(0.4, 0.28, SMALL))
    inputs = kernel_inputs(made)
    moved = np.array([0, 0, 1])
    lows_m = inputs.boxes[:, :2]
    corners = np.array([lows_m[0] + [0.1, 0.0], lows_m[0] + [0.05, 0.0], lows_m[1] + [0.2, 0.0]])
    moves = moved, np.zeros(3, dtype=np.int64), corners
    assert open_moves(made, inputs.boxes, moves).all()
    once = replace(made, before=[("box 0", boxes[0].at(0.5, 0.12))])
    assert open_moves(once, inputs.boxes, moves).tolist() == [False, True, True]
    twice = replace(once, before=[*once.before, ("box 1", boxes[1].at(0.3, 0.12))])
    assert open_moves(twice, inputs.boxes, moves).tolist() == [True, True, False]


def test_where_the_target_should_have_shown_more_of_it_must_show():
    """The same box is pushed farther when a look has belied that so little would do."""
    made = situation([Box(0.4, 0.12, WIDE)], Box(0.4, 0.28, SMALL), Reach(suction=False))
    far_m = [
        abs(look_ahead(replace(made, belied=np.array([belied]))).moves[0].shift_m)
        for belied in (0.0, 0.55)
    ]
    assert far_m[1] > far_m[0]


def test_what_should_be_in_view_already_is_still_looked_for():
    """A hair of the target should show beside the box, and no look has shown it."""
    target = Box(0.4, 0.28, SMALL)
    beside = next(
        x_m
        for x_m in np.arange(0.4, 0.5, 0.002)
        if shares_shown(np.array([[0.4, 0.28]]), SMALL, [Box(x_m, 0.12, WIDE)], CAMERA)[0] > 0.05
    )
    plan = look_ahead(situation([Box(beside, 0.12, WIDE)], target))
    assert plan is not None
    assert plan.finds == pytest.approx(1.0)


def test_a_way_is_only_taken_to_be_wider_when_that_is_asked_for():
    """What stands 5 mm beside the way may be in it, and need not be."""
    boxes = [Box(0.4, 0.28, SMALL), Box(0.49, 0.1, WIDE)]
    made = situation(boxes, boxes[0], movable=[FIXED, ANYHOW])
    assert freeing_move(made, "box 0") is not None
    assert freeing_move(made, "box 0", wider_m=0.0) is None
