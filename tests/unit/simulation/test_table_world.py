"""Arms and cable together: what the hands do to the cable."""

import numpy as np
import pytest

from robots.dual_arm import PlannedDualArm
from robots.interfaces import TcpGoal, Trajectory
from simulation.table_world import TableWorld

STRAIGHT = np.column_stack([np.linspace(-0.35, 0.35, 71), np.zeros(71), np.full(71, 0.0033)])
ACROSS_RAD = 0.5 * np.pi  # fingers open across a cable that lies along x
LOW_M = 0.008  # of a tool over the table when it grasps
UP_M = np.array([0.0, 0.0, 0.06])


@pytest.fixture
def world():
    world = TableWorld(STRAIGHT, 240)
    yield world
    world.body.close()


@pytest.fixture
def arms(world):
    return PlannedDualArm(world.driver, seed=0)


def wait(world, arms):
    while arms.moving():
        world.advance(24)


def go(world, arms, trajectory):
    assert isinstance(trajectory, Trajectory), trajectory
    arms.start(trajectory)
    wait(world, arms)


def reach(world, arms, onward_m=(), **places_m):
    """Bring tools down to places (x, y) on the table, fingers across x."""
    down_m = np.array([0.0, 0.0, LOW_M - 0.08])
    goals = {
        arm: TcpGoal(np.array([x, y, 0.08]), ACROSS_RAD, onward_m=(down_m, *onward_m))
        for arm, (x, y) in places_m.items()
    }
    go(world, arms, arms.plan(goals))
    go(world, arms, arms.plan_line(dict.fromkeys(goals, down_m)))


def grip(world, arms, **grips):
    for arm, how in grips.items():
        arms.grip(arm, how)
    wait(world, arms)


def test_a_pinch_lifts_the_cable_and_lets_go_of_it(world, arms):
    reach(world, arms, left=(-0.2, 0.0))
    grip(world, arms, left="pinch")
    assert arms.holds("left")
    assert world.driver.state().openings_m["left"] == pytest.approx(0.0066, abs=1e-3)
    go(world, arms, arms.plan_line({"left": UP_M}))
    node = np.abs(world.rod.positions_m[:, 0] + 0.2).argmin()
    assert world.rod.positions_m[node, 2] == pytest.approx(LOW_M + 0.06, abs=0.01)
    grip(world, arms, left="open")
    assert not arms.holds("left")
    world.advance(240)
    assert world.rod.positions_m[:, 2].max() < 0.01


def test_a_miss_holds_nothing_and_shuts(world, arms):
    reach(world, arms, left=(-0.2, 0.05))
    grip(world, arms, left="pinch")
    assert not arms.holds("left")
    assert world.driver.state().openings_m["left"] == pytest.approx(0.0, abs=1e-4)
    go(world, arms, arms.plan_line({"left": UP_M}))
    assert world.rod.positions_m[:, 2].max() < 0.01


def test_the_cable_slides_through_a_cage_and_not_through_a_pinch(world, arms):
    apart_m = np.array([0.10, 0.0, 0.0])
    reach(world, arms, (UP_M, apart_m), left=(-0.15, 0.0), right=(0.15, 0.0))
    grip(world, arms, left="cage", right="pinch")
    assert arms.holds("left")
    assert arms.holds("right")
    before = {arm: world.rod.held_nodes(arm)[0] for arm in ("left", "right")}
    # Apart along the cable: the pinched side takes cable out of the cage.
    go(world, arms, arms.plan_line(dict.fromkeys(before, UP_M)))
    go(world, arms, arms.plan_line({"right": apart_m}))
    after = {arm: world.rod.held_nodes(arm)[0] for arm in before}
    assert abs(after["right"] - before["right"]) <= 1
    assert after["left"] <= before["left"] - 6


def test_closed_fingers_push_the_cable_aside(world, arms):
    push_m = np.array([0.0, -0.06, 0.0])
    reach(world, arms, (push_m,), left=(-0.2, 0.04))
    grip(world, arms, left="pinch")
    go(world, arms, arms.plan_line({"left": push_m}))
    pushed = world.rod.positions_m[np.abs(STRAIGHT[:, 0] + 0.2) < 0.02, 1]
    assert pushed.min() < -0.02


def test_closing_takes_as_long_as_the_fingers_need(world, arms):
    arms.grip("right", "cage")
    start_s = world.now_s()
    while world.driver.gripping("right"):
        world.advance(1)
    # 19 mm at two times 25 mm/s.
    assert world.now_s() - start_s == pytest.approx(0.019 / 0.05, abs=0.01)


def test_resting_arms_change_nothing_about_the_cable():
    lifted = STRAIGHT + np.array([0.0, 0.0, 0.02])
    in_one, in_steps = TableWorld(lifted, 240), TableWorld(lifted, 240)
    in_one.advance(240)
    for _ in range(240):
        in_steps.advance(1)
    assert in_one.now_s() == in_steps.now_s()
    assert in_one.rod.positions_m == pytest.approx(in_steps.rod.positions_m, abs=1e-3)
    in_one.body.close()
    in_steps.body.close()
