"""Pushes of several objects so that a target shows between them, and scenes where none help."""

import numpy as np
import pytest

from perception.shelf.planning.looking_ahead import ANYHOW, UNSEEN, Situation, look_ahead
from perception.shelf.planning.moves import moved_box
from perception.shelf.planning.proofs import pushes_may_show
from perception.shelf.planning.room import Reach, footprints, overlapping
from perception.shelf.types import Box, Shelf
from simulation.shelf.cameras import front_camera
from simulation.shelf.contents import ShelfContents
from simulation.shelf.scenes import Scene
from simulation.shelf.world import ShelfWorld

SHELF = Shelf()
PUSHES = Reach(blade_m=0.0, suction=False)
TARGET = Box(0.4, 0.3, (0.06, 0.06, 0.1))


def scene_of(*boxes):
    names = tuple(f"box {number}" for number in range(len(boxes)))
    return Scene(SHELF, (*names, "target"), (*boxes, TARGET), "target")


def situation(scene, movable=None):
    boxes = scene.boxes[:-1]
    return Situation(
        shelf=SHELF, reach=PUSHES, camera=front_camera(SHELF), labels=scene.names[:-1],
        boxes=boxes, movable=np.array(movable or [ANYHOW] * len(boxes)), met=np.zeros((0, 4)),
        floor=np.ones((80, 35), dtype=bool), cell_m=0.01, target_m=TARGET.size_m,
        places_m=np.array([[TARGET.x_m, TARGET.y_m]]), weights=np.ones(1),
    )  # fmt: skip


def may_show(*boxes):
    return pushes_may_show((*boxes, TARGET), len(boxes), SHELF, front_camera(SHELF), PUSHES.gap_m)


def packed(width_m, count, free_m, y_m=0.1):
    """Return a row of boxes; the room that they leave is at its right end."""
    step_m = (SHELF.width_m - free_m) / count
    return [
        Box((number + 0.5) * step_m, y_m, (min(width_m, step_m - 0.002), 0.08, 0.25))
        for number in range(count)
    ]


def carried_out(scene, reach=PUSHES):
    """Follow plans on the truth; returns how many pushes it took until the target showed."""
    world, contents, been = ShelfWorld(scene, np.random.default_rng(0), reach=reach), None, []
    for count in range(20):
        if world.visible_share("target") >= 0.01:
            return count
        boxes = tuple(world.boxes[name] for name in scene.names[:-1])
        made = situation(Scene(SHELF, scene.names, (*boxes, TARGET), "target"))
        plan = look_ahead(made)
        assert plan is not None
        contents = ShelfContents(Scene(SHELF, scene.names, (*boxes, TARGET), "target"), reach)
        result = contents.push(plan.moves[0].label, plan.moves[0].shift_m)
        assert result.failure is None
        assert result.short_m < 0.005
        been.append(plan.moves[0])
        world.act(plan.moves[0])
    return None


def test_a_full_row_is_parted_by_as_many_pushes_as_it_takes():
    scene = scene_of(*packed(0.2, 6, 0.12))
    assert carried_out(scene) == 3


def test_each_push_of_a_plan_has_room_when_its_turn_comes():
    scene = scene_of(*packed(0.2, 7, 0.15))
    plan = look_ahead(situation(scene))
    boxes = dict(zip(scene.names, scene.boxes, strict=True))
    for move in plan.moves:
        boxes[move.label] = moved_box(move, boxes[move.label])
        rows = footprints(list(boxes.values()))
        assert overlapping(rows[:, None], rows[None]).sum() == len(rows)


def test_no_plan_begins_with_what_is_out_of_view():
    scene = scene_of(*packed(0.2, 6, 0.12))
    plan = look_ahead(situation(scene, [ANYHOW] * 5 + [UNSEEN]))
    assert plan is None or plan.moves[0].label != "box 5"


def test_what_no_pushes_can_solve_is_proved():
    assert may_show(*packed(0.2, 6, 0.12))
    assert not may_show(*packed(0.2, 6, 0.0))


@pytest.mark.parametrize("aside", [-1, 1])
def test_order_is_kept_in_proofs(aside):
    # A wide box behind a narrow one can leave the target's ray to the side with room alone.
    wide = Box(0.4 + aside * 0.05, 0.2, (0.5, 0.06, 0.25))
    assert not may_show(wide, *packed(0.2, 6, 0.0))
    assert may_show(Box(0.4, 0.2, (0.3, 0.06, 0.25)))
