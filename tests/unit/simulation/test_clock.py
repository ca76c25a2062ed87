import pytest

from executive.core.clock import Clock
from simulation.clock import SimClock


@pytest.fixture
def steps():
    return []


@pytest.fixture
def clock(steps):
    return SimClock(1 / 240, steps.append)


def test_is_a_clock(clock):
    assert isinstance(clock, Clock)


def test_waiting_steps_the_world_until_the_time_has_come(clock, steps):
    clock.sleep_until(0.1)
    assert sum(steps) == 24
    assert clock.now_s() == pytest.approx(0.1)


def test_never_stops_short_of_the_time(clock):
    for time_s in (0.001, 0.0129, 0.3, 1 / 3, 7.77):
        clock.sleep_until(time_s)
        assert clock.now_s() >= time_s - 1e-9
        assert clock.now_s() < time_s + 1 / 240


def test_a_past_time_costs_nothing(clock, steps):
    clock.sleep_until(1.0)
    steps.clear()
    clock.sleep_until(0.5)
    clock.sleep_until(1.0)
    assert steps == []


def test_many_small_waits_add_up_without_rounding(clock, steps):
    for tick in range(1, 36_001):
        clock.sleep_until(tick * 0.1)
    assert sum(steps) == 36_000 * 24
