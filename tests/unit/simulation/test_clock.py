import pytest

from executive.core.clock import Clock
from simulation.clock import SimClock


class CountingWorld:
    step_s = 1 / 240

    def __init__(self):
        self.steps = 0

    def advance(self, steps):
        self.steps += steps


@pytest.fixture
def world():
    return CountingWorld()


@pytest.fixture
def clock(world):
    return SimClock(world)


def test_is_a_clock(clock):
    assert isinstance(clock, Clock)


def test_waiting_steps_the_world_until_the_time_has_come(clock, world):
    clock.sleep_until(0.1)
    assert world.steps == 24
    assert clock.now_s() == pytest.approx(0.1)


def test_never_stops_short_of_the_time(clock):
    for time_s in (0.001, 0.0129, 0.3, 1 / 3, 7.77):
        clock.sleep_until(time_s)
        assert clock.now_s() >= time_s - 1e-9
        assert clock.now_s() < time_s + 1 / 240


def test_a_past_time_costs_nothing(clock, world):
    clock.sleep_until(1.0)
    clock.sleep_until(0.5)
    clock.sleep_until(1.0)
    assert world.steps == 240


def test_many_small_waits_add_up_without_rounding(clock, world):
    for tick in range(1, 36_001):
        clock.sleep_until(tick * 0.1)
    assert world.steps == 36_000 * 24


def test_time_that_passed_before_an_interruption_counts(clock, world):
    def interrupted(steps):
        world.steps += 3
        raise KeyboardInterrupt

    world.advance = interrupted
    with pytest.raises(KeyboardInterrupt):
        clock.sleep_until(1.0)
    assert clock.now_s() == pytest.approx(3 / 240)
