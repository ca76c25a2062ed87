"""Two arms as skills see them, on a driver that tracks perfectly."""

import coal
import numpy as np
import pinocchio as pin
import pytest
from fake_arms import FakeArms

from robots.dual_arm import PlannedDualArm
from robots.interfaces import ARMS, DualArm, MotionFailure, TcpGoal
from robots.motion.collision import CollisionModel
from robots.motion.planner import PlannerSettings
from robots.motion.verify import sample
from robots.placement import HOME_RAD, PlanningScene, StaticBox, table_scene

CAMERA_HEIGHT_M = 1.2


def goal(x, y, z=0.01, yaw=0.4, **more):
    return TcpGoal(np.array([x, y, z]), yaw, **more)


@pytest.fixture
def driver():
    return FakeArms(HOME_RAD)


@pytest.fixture
def arms(driver):
    return PlannedDualArm(driver, seed=0)


def run(arms, driver, trajectory):
    assert not isinstance(trajectory, MotionFailure), trajectory
    arms.start(trajectory)
    driver.finish()


def tools(robot, trajectory, arm):
    _, q, _, _ = sample(trajectory)
    return [robot.tcp_pose(arm, row).copy() for row in q]


def test_it_is_a_dual_arm(arms):
    assert isinstance(arms, DualArm)


def test_plan_ends_at_the_goal_and_leaves_the_other_arm_alone(arms, driver):
    before = arms.tcp_position("right")
    run(arms, driver, arms.plan({"left": goal(-0.2, 0.05)}))
    assert arms.tcp_position("left") == pytest.approx([-0.2, 0.05, 0.01], abs=1e-4)
    assert arms.tcp_position("right") == pytest.approx(before, abs=1e-9)


def test_plans_are_free_of_collisions_all_the_way(arms, driver, collision):
    collision.set_openings(driver.openings_m)
    rng = np.random.default_rng(3)
    for _ in range(6):
        x, y = rng.uniform([0.06, -0.15], [0.25, 0.1])
        yaws = rng.uniform(0, np.pi, 2)
        plan = arms.plan({"left": goal(-x, y, yaw=yaws[0]), "right": goal(x, -y, yaw=yaws[1])})
        _, q, _, _ = sample(plan, 0.002)
        assert not any(collision.collides(row) for row in q)
        run(arms, driver, plan)


def test_arms_at_their_own_pace_keep_apart_and_are_no_slower(arms, driver, robot, collision):
    collision.set_openings(driver.openings_m)
    rng = np.random.default_rng(5)
    for _ in range(5):
        x, y = rng.uniform([0.05, -0.15], [0.25, 0.1])
        goals = {"left": goal(-x, y, yaw=rng.uniform(0, 3)), "right": goal(x, -y, yaw=0.3)}
        in_step, own = arms.plan(goals), arms.plan_at_own_pace(goals)
        _, q, velocity, acceleration = sample(own, 0.001)
        assert not any(collision.collides(row) for row in q)
        assert np.all(np.abs(velocity) <= robot.limits.velocity * 1.001)
        assert np.all(np.abs(acceleration) <= robot.limits.acceleration * 1.001)
        assert own.duration_s <= 1.1 * in_step.duration_s
        run(arms, driver, own)
        for arm, asked in goals.items():
            assert arms.tcp_position(arm) == pytest.approx(asked.position_m, abs=1e-4)


def test_an_arm_waits_while_the_other_crosses_its_way(arms, driver, robot, collision):
    """Both arms swap sides over the middle: one has to let the other pass."""
    collision.set_openings(driver.openings_m)
    run(arms, driver, arms.plan({"left": goal(0.06, -0.1), "right": goal(0.3, 0.05)}))
    plan = arms.plan_at_own_pace({"left": goal(-0.3, 0.05), "right": goal(0.0, -0.05, z=0.03)})
    assert not isinstance(plan, MotionFailure), plan
    assert not any(collision.collides(row) for row in sample(plan, 0.002)[1])


def test_the_same_seed_plans_the_same(driver):
    def motion():
        arms = PlannedDualArm(FakeArms(HOME_RAD), seed=5)
        plan = arms.plan({"left": goal(-0.1, 0.1), "right": goal(0.15, 0.0)})
        return sample(plan)

    for one, other in zip(motion(), motion(), strict=True):
        assert np.array_equal(one, other)


@pytest.mark.parametrize("arm", ARMS)
def test_free_motions_pass_over_what_lies_on_the_table(robot, arm):
    scene = table_scene()
    full = PlanningScene(scene.placement, (*scene.boxes, *scene.kept_clear))
    driver = FakeArms(HOME_RAD)
    arms, room = PlannedDualArm(driver, seed=0), CollisionModel(robot, full)
    rng = np.random.default_rng(11)
    planned = 0
    for _ in range(30):
        x, y = rng.uniform([-0.35, -0.15], [0.35, 0.1])
        plan = arms.plan({arm: goal(x, y, z=0.07, yaw=rng.uniform(0, np.pi))})
        if isinstance(plan, MotionFailure):
            continue  # that arm does not reach so far
        planned += 1
        assert not any(room.collides(row) for row in sample(plan, 0.01)[1])
        run(arms, driver, plan)
    assert planned >= 10


def test_hands_among_what_lies_on_the_table_can_move(arms, driver):
    run(arms, driver, arms.plan({"left": goal(-0.2, 0.0, z=0.008)}))
    run(arms, driver, arms.plan({"right": goal(0.2, 0.0, z=0.07)}))
    run(arms, driver, arms.plan({"right": goal(0.2, 0.05, z=0.008)}))
    run(arms, driver, arms.plan_home())


def test_an_obstacle_is_gone_around(robot):
    wall = StaticBox("wall", (0.0, 0.0, 0.12), (0.02, 0.3, 0.24))
    scene = PlanningScene(table_scene().placement, (*table_scene().boxes, wall))
    driver = FakeArms(HOME_RAD)
    arms = PlannedDualArm(driver, seed=0, scene=scene)
    run(arms, driver, arms.plan({"left": goal(-0.12, 0.05, yaw=1.5)}))
    run(arms, driver, arms.plan({"left": goal(0.12, 0.0, z=0.05, yaw=1.5)}))
    assert arms.tcp_position("left")[0] == pytest.approx(0.12, abs=1e-4)
    assert any(pose.translation[2] > 0.2 for pose in tools(robot, driver.executed[-1], "left"))


def spheres(robot, q):
    """Yield centre and radius of balls that together cover the arms' shapes."""
    data, placed = robot.model.createData(), robot.geometry.createData()
    pin.updateGeometryPlacements(robot.model, data, robot.geometry, placed, q)
    for shape, pose in zip(robot.geometry.geometryObjects, placed.oMg, strict=True):
        solid = shape.geometry
        if isinstance(solid, coal.Capsule):
            for height in np.linspace(-solid.halfLength, solid.halfLength, 7):
                yield pose.act(np.array([0.0, 0.0, height])), solid.radius
        elif not shape.name.startswith("body"):
            yield pose.translation, np.linalg.norm(solid.halfSide)


def test_home_hides_the_robot_from_the_camera(robot):
    """Seen from above the table's middle, nothing shows above y = -0.28 of the table."""
    q = robot.complete(HOME_RAD, {"left": 0.05, "right": 0.05})
    for (x, y, z), radius in spheres(robot, q):
        y_seen = (y + radius) * CAMERA_HEIGHT_M / (CAMERA_HEIGHT_M - z - radius)
        x_seen = (abs(x) - radius) * CAMERA_HEIGHT_M / (CAMERA_HEIGHT_M - z)
        assert y_seen < -0.28 or x_seen > 0.53


def test_home_is_reached_from_anywhere(arms, driver):
    run(arms, driver, arms.plan({"left": goal(0.1, 0.0), "right": goal(0.25, -0.05)}))
    run(arms, driver, arms.plan_home())
    assert driver.positions_rad == pytest.approx(HOME_RAD, abs=1e-9)


def test_a_line_is_straight_and_keeps_the_orientation(arms, driver, robot):
    run(arms, driver, arms.plan({"left": goal(-0.25, 0.0, z=0.06, onward_m=())}))
    begin = robot.tcp_pose("left", driver.positions_rad)
    displacement = np.array([0.2, 0.08, 0.02])
    plan = arms.plan_line({"left": displacement})
    run(arms, driver, plan)
    axis = displacement / np.linalg.norm(displacement)
    for pose in tools(robot, plan, "left"):
        way = pose.translation - begin.translation
        assert np.linalg.norm(way - (way @ axis) * axis) < 5e-4
        assert np.linalg.norm(pin.log3(begin.rotation.T @ pose.rotation)) < 2e-3
    assert arms.tcp_position("left") == pytest.approx(begin.translation + displacement, abs=1e-4)


def test_lines_of_two_arms_run_in_step(arms, driver, robot):
    run(arms, driver, arms.plan({"left": goal(-0.08, 0.0, z=0.04), "right": goal(0.08, 0.0, 0.04)}))
    pulls = {"left": np.array([-0.2, 0.02, 0.0]), "right": np.array([0.1, -0.02, 0.0])}
    plan = arms.plan_line(pulls)
    run(arms, driver, plan)
    shares = []
    for arm, pull in pulls.items():
        poses = tools(robot, plan, arm)
        ways = np.array([pose.translation - poses[0].translation for pose in poses])
        shares.append(ways @ pull / (pull @ pull))
    assert np.abs(shares[0] - shares[1]).max() < 2e-3


def test_the_tool_keeps_the_speed_limit_of_lines(driver, robot):
    arms = PlannedDualArm(driver, seed=0, settings=PlannerSettings(line_speed_m_s=0.1))
    run(arms, driver, arms.plan({"left": goal(-0.25, 0.0, z=0.06)}))
    plan = arms.plan_line({"left": np.array([0.2, 0.0, 0.0])})
    times, q, _, _ = sample(plan)
    places = np.array([robot.tcp_pose("left", row).translation.copy() for row in q])
    speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) / np.diff(times)
    assert 0.09 < speeds.max() < 0.1005


def test_a_line_of_no_length_is_no_motion(arms, driver):
    before = driver.positions_rad.copy()
    run(arms, driver, arms.plan_line({"left": np.zeros(3)}))
    assert driver.positions_rad == pytest.approx(before, abs=1e-4)


def test_a_line_out_of_reach_says_how_far_it_goes(arms, driver):
    run(arms, driver, arms.plan({"left": goal(-0.25, 0.0, z=0.06)}))
    failure = arms.plan_line({"left": np.array([0.0, 0.6, 0.0])})
    assert (failure.code, failure.stage) == ("motion.unreachable", "line")
    assert "of the 0.600 m line" in failure.text


def test_a_line_into_the_table_names_the_table(arms, driver):
    run(arms, driver, arms.plan({"left": goal(-0.25, 0.0, z=0.06)}))
    failure = arms.plan_line({"left": np.array([0.0, 0.0, -0.1])})
    assert failure.code == "motion.collision"
    assert "table" in failure.pair


def test_arms_are_assigned_by_side(arms):
    left, right = goal(-0.15, 0.05), goal(0.15, 0.0)
    assert arms.assign((left, right)) == ("left", "right")
    assert arms.assign((right, left)) == ("right", "left")


def test_assigned_goals_can_be_planned_together(arms, driver):
    rng = np.random.default_rng(11)
    for _ in range(8):
        middle, turn = rng.uniform([-0.15, -0.1], [0.15, 0.08]), rng.uniform(0, np.pi)
        half = 0.07 * np.array([np.cos(turn), np.sin(turn)])
        pair = tuple(goal(*(middle + s * half), yaw=rng.uniform(0, np.pi)) for s in (1, -1))
        hands = arms.assign(pair)
        assert not isinstance(hands, MotionFailure), hands
        run(arms, driver, arms.plan(dict(zip(hands, pair, strict=True))))
        run(arms, driver, arms.plan_home())


def test_hands_that_cannot_share_a_place_are_not_assigned(arms):
    failure = arms.assign((goal(0.0, 0.0), goal(0.01, 0.0)))
    assert isinstance(failure, MotionFailure)
    assert failure.code == "motion.collision"


def test_reachable_tells_near_from_far(arms):
    assert arms.reachable("left", goal(-0.2, 0.0))
    assert arms.reachable("right", goal(0.2, 0.0, yaw=None))
    assert not arms.reachable("left", goal(0.0, 0.6))


def test_nothing_is_planned_while_arms_move(arms, driver):
    arms.start(arms.plan({"left": goal(-0.2, 0.05)}))
    assert arms.moving()
    for answer in (arms.plan_home(), arms.plan({}), arms.plan_line({})):
        assert isinstance(answer, MotionFailure)
        assert "still moving" in answer.text
    driver.finish()
    assert not arms.moving()


def test_grippers_and_stop_are_passed_on(arms, driver):
    arms.grip("left", "cage")
    assert driver.openings_m["left"] == pytest.approx(0.012)
    arms.start(arms.plan_line({arm: np.array([0.0, 0.0, 0.02]) for arm in ARMS}))
    arms.stop()
    assert not arms.moving()
