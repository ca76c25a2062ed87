"""A pace holds a run to real time, and never makes it faster to catch up."""

from itertools import pairwise

import pytest

from executive.engine.running.pace import Pace
from executive.engine.ticks import Tick

PERIOD_S = 0.1


class Machine:
    """A machine whose clock goes on by what is slept and by what ticks take."""

    def __init__(self):
        self.now_s = 100.0

    def sleep(self, time_s):
        assert time_s > 0.0
        self.now_s += time_s


def run(speed, took_s):
    """Return when each tick was over [s], for what each took on the machine."""
    machine, over_s = Machine(), []
    pace = Pace(speed, now_s=lambda: machine.now_s, sleep=machine.sleep)
    for number, one_s in enumerate(took_s):
        machine.now_s += one_s
        pace.on_tick(Tick(number, number * PERIOD_S, one_s))
        over_s.append(machine.now_s)
    return over_s


@pytest.mark.parametrize("speed", [0.5, 1.0, 4.0])
def test_ticks_that_are_faster_come_at_the_speed(speed):
    over_s = run(speed, [0.001] * 50)
    gaps_s = [late - early for early, late in pairwise(over_s)]
    assert gaps_s == pytest.approx([PERIOD_S / speed] * 49)


def test_one_slow_tick_is_not_made_up_for():
    over_s = run(1.0, [0.001, 0.001, 2.0, 0.001, 0.001])
    assert over_s[2] - over_s[1] == pytest.approx(2.0)
    assert over_s[4] - over_s[2] == pytest.approx(2 * PERIOD_S)


def test_ticks_that_are_slower_are_not_waited_for():
    assert run(1.0, [0.3] * 10)[-1] == pytest.approx(100.0 + 3.0)
