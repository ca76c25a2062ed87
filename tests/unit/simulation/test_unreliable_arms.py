"""Arms that miss, let slip and stop: as often as they are told, and the same for the same seed."""

from types import SimpleNamespace

import numpy as np
import pytest

from robots.interfaces import ArmsDriver
from simulation.unreliable_arms import SLIP_AFTER_S, ArmFaults, UnreliableArms


class Obedient:
    """A driver that does as it is told, at once."""

    def __init__(self):
        self.now_s, self.grips, self.stops, self.executed = 0.0, {}, 0, []

    def state(self):
        return SimpleNamespace(stamp_s=self.now_s, moving=False)

    def execute(self, trajectory):
        self.executed.append(trajectory)

    def grip(self, arm, grip):
        self.grips[arm] = grip

    def gripping(self, arm):
        return False

    def holds(self, arm):
        return self.grips.get(arm, "open") != "open"

    def stop(self):
        self.stops += 1

    def hold(self):
        pass

    go_on = emergency_stop = hold

    def held(self):
        return False


def arms(seed=0, **rates):
    driver = Obedient()
    return driver, UnreliableArms(driver, ArmFaults(**rates), np.random.default_rng(seed))


def test_it_is_a_driver():
    assert isinstance(arms()[1], ArmsDriver)
    assert not ArmFaults().any()
    assert ArmFaults(stop_rate=0.1).any()


def test_nothing_goes_wrong_without_faults():
    driver, unreliable = arms()
    for _ in range(50):
        unreliable.grip("left", "pinch")
        unreliable.execute(SimpleNamespace(duration_s=1.0))
        driver.now_s += 10.0
        unreliable.state()
        assert unreliable.holds("left")
    assert driver.stops == 0


@pytest.mark.parametrize("rate", [0.2, 0.7])
def test_as_many_closings_miss_as_are_asked_for(rate):
    _, unreliable = arms(miss_rate=rate)
    missed = 0
    for _ in range(400):
        unreliable.grip("left", "cage")
        missed += not unreliable.holds("left")
        unreliable.grip("left", "open")
    assert missed / 400 == pytest.approx(rate, abs=0.08)


def test_a_cable_slips_out_of_a_hand_some_time_after_it_was_taken():
    driver, unreliable = arms(slip_rate=1.0)
    unreliable.grip("right", "pinch")
    assert unreliable.holds("right")
    driver.now_s = SLIP_AFTER_S[1] + 0.01
    assert not unreliable.holds("right")


def test_a_hand_that_has_let_go_drops_nothing_later():
    driver, unreliable = arms(slip_rate=1.0)
    unreliable.grip("right", "pinch")
    unreliable.grip("right", "open")
    unreliable.grip("left", "pinch")
    driver.now_s = 60.0
    unreliable.state()
    assert driver.grips == {"right": "open", "left": "open"}


def test_a_motion_ends_on_its_way_and_the_next_one_does_not_inherit_that():
    driver, unreliable = arms(stop_rate=1.0)
    unreliable.execute(SimpleNamespace(duration_s=2.0))
    driver.now_s = 2.0
    unreliable.state()
    unreliable.state()
    assert driver.stops == 1


def test_what_goes_wrong_next_can_be_remembered():
    _, one = arms(seed=5, miss_rate=0.5)
    memento = one.memento()

    def closings(unreliable):
        found = []
        for _ in range(20):
            unreliable.grip("left", "pinch")
            found.append(unreliable.holds("left"))
        return found

    first = closings(one)
    _, other = arms(seed=9, miss_rate=0.5)
    other.recall(memento)
    assert closings(other) == first
