"""Collisions: the fast answer is the pairwise answer, pairs have names, margins hold."""

import numpy as np
import pinocchio as pin
import pytest

from executive.core.errors import DeviceError
from robots.interfaces import ARMS
from robots.motion.collision import CollisionModel
from robots.motion.grasp import pointing_down
from robots.motion.ik import solve_pose
from robots.placement import HOME_RAD, StaticBox, table_scene


def reaching(robot, arm, position_m, rotation):
    """Return a configuration with one tool at a pose and the other arm at home."""
    q = HOME_RAD.copy()
    joints = robot.joints_of(arm)
    target = pin.SE3(rotation, np.array(position_m))
    q[joints] = solve_pose(robot.kinematics[arm], target, q[joints], max_steps=200)
    return q


def test_broad_phase_agrees_with_the_pairwise_test(collision, rng):
    assert collision.disagreements(rng, 1000) == 0


def test_a_broad_phase_that_misses_collisions_is_refused(collision, rng, monkeypatch):
    monkeypatch.setattr(collision, "collides", lambda _: False)
    with pytest.raises(DeviceError, match="broad phase disagrees"):
        collision.demand_agreement(rng, 100)


def test_distances_are_those_of_the_named_bodies(robot, collision):
    q = reaching(robot, "left", [-0.2, 0.0, 0.1], pointing_down(0.3))
    apart = collision.distance_m(("left_finger_a", "table"), q)
    lower = reaching(robot, "left", [-0.2, 0.0, 0.05], pointing_down(0.3))
    assert collision.distance_m(("left_finger_a", "table"), lower) == pytest.approx(
        apart - 0.05, abs=1e-4
    )


def test_broad_phase_agrees_while_a_pair_is_excused(robot, collision, rng):
    touching = reaching(robot, "left", [-0.2, 0.0, 0.004], pointing_down(0.0))
    collision.excuse(touching)
    assert collision.disagreements(rng, 300) == 0


def test_home_is_free_with_open_and_shut_grippers(collision):
    for opening_m in (0.0, 0.05):
        collision.set_openings(dict.fromkeys(ARMS, opening_m))
        assert collision.colliding_pair(HOME_RAD) is None


@pytest.mark.parametrize("opening_m", [0.0, 0.05])
def test_fingertips_come_down_to_a_cable_on_the_table_but_not_into_it(robot, collision, opening_m):
    collision.set_openings({"left": opening_m})
    straddling = reaching(robot, "left", [-0.2, 0.0, 0.008], pointing_down(0.3))
    assert not collision.collides(straddling)
    digging = reaching(robot, "left", [-0.2, 0.0, 0.0055], pointing_down(0.3))
    pair = collision.colliding_pair(digging)
    assert pair is not None
    assert pair[0].startswith("left_finger_")
    assert pair[1] == "table"


def test_a_hand_that_leans_about_its_opening_axis_still_comes_down(robot, collision):
    collision.set_openings({"left": 0.05})
    lean = pin.AngleAxis(0.5, np.array([1.0, 0.0, 0.0])).toRotationMatrix()
    q = reaching(robot, "left", [-0.2, 0.05, 0.008], lean @ pointing_down(0.0))
    assert not collision.collides(q)


def test_arms_that_meet_are_named(robot, collision):
    down = pointing_down(np.pi / 2)
    q = reaching(robot, "left", [0.0, 0.0, 0.1], down)
    q[7:] = reaching(robot, "right", [0.02, 0.0, 0.1], down)[7:]
    first, second = collision.colliding_pair(q)
    assert first.startswith("left_")
    assert second.startswith("right_")


def test_an_arm_alone_ignores_the_other(robot):
    alone = CollisionModel(robot, table_scene(), arms=("left",))
    down = pointing_down(np.pi / 2)
    q = reaching(robot, "left", [0.0, 0.0, 0.1], down)
    q[7:] = reaching(robot, "right", [0.02, 0.0, 0.1], down)[7:]
    assert not alone.collides(q)


def test_boxes_of_the_scene_are_obstacles(robot):
    scene = table_scene()
    post = StaticBox("post", (-0.2, 0.0, 0.1), (0.05, 0.05, 0.2))
    model = CollisionModel(robot, type(scene)(scene.placement, (*scene.boxes, post)))
    q = reaching(robot, "left", [-0.2, 0.0, 0.15], pointing_down(0.0))
    assert model.colliding_pair(q)[1] == "post"


def test_an_excused_pair_may_part_but_not_come_closer(robot, collision):
    low, lower, high = (
        reaching(robot, "left", [-0.2, 0.0, z], pointing_down(0.0)) for z in (0.006, 0.005, 0.02)
    )
    assert collision.collides(low)
    collision.excuse(low)
    assert not collision.collides(low)
    assert collision.collides(lower)
    assert not collision.collides(high)
    collision.excuse(HOME_RAD)
    assert collision.collides(low)


def test_neighbours_are_no_pairs_but_distant_links_are(collision):
    names = collision.checked_bodies()
    assert ("left_link_1", "left_link_2") not in names
    assert ("left_finger_a", "left_finger_b") not in names
    assert ("left_gripper_base", "right_gripper_base") in names
    assert ("left_finger_a", "table") in names
    assert ("body", "table") not in names
