"""One arm with a tool before a shelf: level goals, pushes along a board, a box in the cup."""

import numpy as np
import pinocchio as pin
import pytest
from fake_arms import FakeArms

from executive.core.errors import InputError
from robots.descriptions.specs import kinova_spec, yumi_spec
from robots.interfaces import MotionFailure, PoseGoal, TcpGoal
from robots.motion.collision import CollisionModel
from robots.motion.verify import sample
from robots.placement import Placement, PlanningScene, StaticBox
from robots.single_arm import PlannedArm

# z of the tool into the shelf (+y), its y down: the blade stands upright.
LEVEL = pin.Quaternion(np.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]])).coeffs()
PLACEMENT = Placement((0.0, -0.95, -0.10), np.pi / 2)
WIDTH, DEPTH, HEIGHT, THICK = 0.8, 0.35, 0.57, 0.02
SHELF = (
    StaticBox("board", (0, DEPTH / 2, -THICK / 2), (WIDTH, DEPTH, THICK)),
    StaticBox("top", (0, DEPTH / 2, HEIGHT + THICK / 2), (WIDTH, DEPTH, THICK)),
    StaticBox("left wall", (-(WIDTH + THICK) / 2, DEPTH / 2, HEIGHT / 2), (THICK, DEPTH, HEIGHT)),
    StaticBox("right wall", ((WIDTH + THICK) / 2, DEPTH / 2, HEIGHT / 2), (THICK, DEPTH, HEIGHT)),
    StaticBox("back", (0, DEPTH + THICK / 2, HEIGHT / 2), (WIDTH, THICK, HEIGHT)),
)
SCENE = PlanningScene(PLACEMENT, SHELF)
READY = {
    7: np.radians([0.0, 180.0, 0.0, 60.0, 0.0, 180.0, 0.0]),
    6: np.radians([0.0, 180.0, 60.0, 0.0, 180.0, 0.0]),
}


def before(x, y, z, **more):
    return PoseGoal(np.array([x, y, z]), LEVEL, turns_rad=(0.0, np.pi), **more)


@pytest.fixture(params=[7, 6])
def joints(request):
    return request.param


@pytest.fixture
def driver(joints):
    return FakeArms(READY[joints], grippers=())


@pytest.fixture
def arm(driver, joints):
    return PlannedArm(driver, kinova_spec(joints), SCENE, READY[joints], seed=0)


def run(arm, driver, trajectory):
    assert not isinstance(trajectory, MotionFailure), trajectory
    arm.start(trajectory)
    driver.finish()


def free_all_the_way(arm, trajectory):
    model = CollisionModel(arm.robot, arm.scene)
    return not any(model.collides(q) for q in sample(trajectory, 0.002)[1])


def test_a_level_goal_is_reached_without_contact(arm, driver):
    plan = arm.plan(before(0.15, -0.08, 0.2))
    assert free_all_the_way(arm, plan)
    run(arm, driver, plan)
    position, quat = arm.tcp_pose()
    assert position == pytest.approx([0.15, -0.08, 0.2], abs=1e-4)
    into_the_shelf = pin.Quaternion(quat).toRotationMatrix()[:, 2]
    assert into_the_shelf == pytest.approx([0.0, 1.0, 0.0], abs=1e-4)


def test_into_the_shelf_along_it_and_out_again(arm, driver):
    ways = tuple(np.array(way) for way in ([0, 0.25, 0], [0.1, 0, 0], [0, -0.25, 0]))
    run(arm, driver, arm.plan(before(-0.15, -0.08, 0.2, onward_m=ways)))
    for way in ways:
        run(arm, driver, arm.plan_line(way))
    assert arm.tcp_pose()[0] == pytest.approx([-0.05, -0.08, 0.2], abs=1e-3)


def test_a_tool_that_points_down_is_one_orientation_among_others(arm, driver):
    run(arm, driver, arm.plan(TcpGoal(np.array([0.3, -0.5, 0.0]), None)))
    axis = pin.Quaternion(arm.tcp_pose()[1]).toRotationMatrix()[:, 2]
    assert axis[2] < np.cos(np.pi - 0.53)


def test_a_line_into_a_wall_names_it(arm, driver):
    run(arm, driver, arm.plan(before(-0.25, -0.08, 0.2)))
    run(arm, driver, arm.plan_line(np.array([0.0, 0.2, 0.0])))
    failure = arm.plan_line(np.array([-0.2, 0.0, 0.0]))
    assert failure.code == "motion.collision"
    assert "left wall" in failure.pair


def test_a_box_in_the_way_is_gone_around_until_it_may_be_touched(arm, driver):
    box = StaticBox("box", (0.15, 0.0, 0.2), (0.1, 0.1, 0.1))
    arm.set_obstacles((*SHELF, box))
    failure = arm.plan(before(0.15, 0.02, 0.2))
    assert failure.code == "motion.collision"
    assert "box" in failure.pair
    soft = StaticBox(*(box.name, box.centre_m, box.size_m), touched_by=("cup", "bluction"))
    arm.set_obstacles((*SHELF, soft))
    run(arm, driver, arm.plan(before(0.15, 0.02, 0.2)))


def test_a_box_turned_about_the_vertical_is_an_obstacle_where_it_is(arm):
    def of(box):
        return CollisionModel(arm.robot, PlanningScene(PLACEMENT, (box,)))

    tool = arm.tcp_pose()[0]
    half = np.sin(np.pi / 8)
    turned = (0.0, 0.0, half, np.sqrt(1 - half**2))
    aside = tuple(tool + np.array([0.2, 0.0, 0.0]))
    slim = (0.5, 0.01, 0.01)
    assert of(StaticBox("slim", aside, slim)).collides(READY[arm.robot.size])
    assert not of(StaticBox("slim", aside, slim, turned)).collides(READY[arm.robot.size])


def test_a_carried_box_keeps_away_from_the_shelf(arm, driver):
    run(arm, driver, arm.plan(before(0.1, -0.1, 0.3)))
    centre = arm.tcp_pose()[0] + [0.0, 0.021, 0.0]
    arm.attach(StaticBox("box", tuple(centre), (0.08, 0.04, 0.2), touched_by=("cup",)))
    down = arm.plan_line(np.array([0.0, 0.0, -0.25]))
    assert free_all_the_way(arm, down)
    failure = arm.plan_line(np.array([0.0, 0.15, -0.25]))
    assert failure.pair is not None
    assert "box" in failure.pair
    arm.detach()
    assert not isinstance(arm.plan_line(np.array([0.0, 0.0, 0.1])), MotionFailure)
    (left,) = (box for box in arm.scene.boxes if box.name == "box")
    assert left.centre_m == pytest.approx(centre, abs=1e-6)


def test_joints_that_turn_freely_take_the_shorter_way(arm, driver, joints):
    run(arm, driver, arm.plan(before(0.15, -0.08, 0.2)))
    turned = driver.positions_rad.copy()
    turned[-1] += 2 * np.pi if turned[-1] < 0 else -2 * np.pi
    driver.positions_rad = turned
    plan = arm.plan(before(0.15, -0.08, 0.22))
    assert np.abs(sample(plan)[1] - turned).max() < np.pi


def test_a_configuration_beyond_the_limits_names_the_joint(arm, joints):
    beyond = READY[joints].copy()
    beyond[1] = 0.1
    failure = arm.plan_configuration(beyond)
    assert (failure.code, failure.cause) == ("motion.unreachable", "joint_limit")
    assert failure.joint == "joint_2"
    assert failure.elapsed_ms > 0.0


def test_the_same_seed_plans_the_same(driver, joints):
    def motion():
        arm = PlannedArm(driver, kinova_spec(joints), SCENE, READY[joints], seed=5)
        return sample(arm.plan(before(-0.2, -0.05, 0.25)))

    for one, other in zip(motion(), motion(), strict=True):
        assert np.array_equal(one, other)


def test_a_robot_of_two_arms_is_refused():
    with pytest.raises(InputError, match="got 2 arms"):
        PlannedArm(FakeArms(np.zeros(14)), yumi_spec(), SCENE, np.zeros(14), seed=0)


def test_names_in_the_scene_are_unique(arm):
    with pytest.raises(InputError, match="two bodies are called 'board'"):
        arm.set_obstacles((SHELF[0], SHELF[0]))
