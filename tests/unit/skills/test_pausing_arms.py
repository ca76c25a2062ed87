"""A skill that moves simulated arms, paused in the middle of it."""

import numpy as np
import pytest
from cell_fakes import ArrivingArms, finished, frame, overhand

from executive.core.outcome import Status
from executive.core.work import InlineWorker, ThreadWorker
from robots.dual_arm import PlannedDualArm
from robots.interfaces import TcpGoal
from robots.motion.planner import PlannerSettings
from robots.placement import HOME_RAD
from simulation.table_world import TableWorld
from skills.cable.dilate_knot import DilateKnot
from skills.motion.go_home import GoHome

TICK_STEPS = 24


@pytest.fixture(scope="module")
def world():
    nodes_m = np.column_stack([np.linspace(-0.1, 0.1, 21), np.full(21, 0.3), np.full(21, 0.004)])
    world = TableWorld(nodes_m, 240)
    yield world
    world.body.close()


@pytest.fixture(scope="module")
def arms(world):
    # Slow enough for a pause to come in the middle of a motion.
    return PlannedDualArm(world.driver, seed=0, settings=PlannerSettings(speed_scale=0.5))


def go_away(world, arms):
    places_m = {"left": (-0.2, 0.05, 0.1), "right": (0.2, 0.05, 0.1)}
    arms.start(arms.plan({arm: TcpGoal(np.array(place)) for arm, place in places_m.items()}))
    while arms.moving():
        world.advance(TICK_STEPS)


@pytest.mark.parametrize("worker", [InlineWorker(), ThreadWorker()], ids=["inline", "thread"])
def test_a_motion_that_is_paused_rests_half_way_and_arrives_after_the_pause(world, arms, worker):
    go_away(world, arms)
    skill = GoHome(arms, worker)
    skill.start({})
    while arms.resting():
        assert skill.step().status is Status.RUNNING
        world.advance(TICK_STEPS)
    skill.on_pause()
    for _ in range(20):
        world.advance(TICK_STEPS)
    assert skill.resting()
    half_way_rad = world.driver.state().positions_rad
    assert np.abs(half_way_rad - HOME_RAD).max() > 0.05
    skill.on_resume()
    while (outcome := skill.step()).status is Status.RUNNING:
        world.advance(TICK_STEPS)
    assert outcome.status is Status.SUCCESS
    assert world.driver.state().positions_rad == pytest.approx(HOME_RAD, abs=1e-3)


def test_a_skill_that_takes_over_waits_until_the_arms_rest(world, arms):
    go_away(world, arms)
    first, second = GoHome(arms, InlineWorker()), GoHome(arms, InlineWorker())
    first.start({})
    while arms.resting():
        first.step()
        world.advance(TICK_STEPS)
    first.halt()
    assert arms.moving()
    second.start({})
    while (outcome := second.step()).status is Status.RUNNING:
        world.advance(TICK_STEPS)
    assert outcome.status is Status.SUCCESS
    assert world.driver.state().positions_rad == pytest.approx(HOME_RAD, abs=1e-3)


def test_plans_are_never_made_in_the_step_that_asks_for_them():
    arms, steps = ArrivingArms(), []

    class Elsewhere(ThreadWorker):
        def begin(self, token, call):
            steps.append(call)
            return super().begin(token, call)

    trace, crossings, knot = overhand()
    inputs = {"frame": frame(), "trace": trace, "crossings": crossings, "knots": (knot,)}
    assert finished(DilateKnot(arms, Elsewhere()), inputs, 10_000_000)[0].status is Status.SUCCESS
    moves = [entry for entry in arms.log if entry[0] == "move"]
    assert len(steps) == len(moves) + 1  # and the choice of sites
