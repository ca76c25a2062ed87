"""Cups that hold, and cups that do not."""

import numpy as np
import pytest
from shelf_rigs import Rig, heavy

from robots.shelf_tool import Cuboid, PutElsewhere, TakeOut, ToolFailure
from simulation.shelf_cell.config import ToolConfig
from simulation.shelf_cell.suction import Vacuum, overloaded

BOX_M = (0.06, 0.06, 0.12)
CUPS_M = np.array([-0.024, -0.008, 0.008, 0.024])


def test_box_is_put_where_it_was_asked_for() -> None:
    rig = Rig(heavy("a", (0.4, 0.15), BOX_M))
    result = rig.do(PutElsewhere(rig.thing("a"), 0.55, 0.25))
    assert result.failure is None
    assert rig.pose("a")[:2] == pytest.approx((0.55, 0.25), abs=0.005)
    assert rig.lean("a") > 0.999
    assert not rig.world.driver.holds()


def test_target_is_handed_over_on_the_counter() -> None:
    rig = Rig(heavy("a", (0.3, 0.1), BOX_M))
    assert rig.do(TakeOut(rig.thing("a"))).failure is None
    x_m, y_m, z_m = rig.pose("a")[:3]
    assert x_m < -0.05
    assert 0.0 < y_m < 0.35
    assert z_m == pytest.approx(0.5 * BOX_M[2], abs=0.002)


def test_heavy_box_is_not_lifted() -> None:
    rig = Rig(heavy("a", (0.4, 0.15), BOX_M, mass_kg=2.5))
    result = rig.do(PutElsewhere(rig.thing("a"), 0.55, 0.25))
    assert result.failure is ToolFailure.MISSED
    assert rig.pose("a")[:2] == pytest.approx((0.4, 0.15), abs=0.01)
    assert rig.lean("a") > 0.999


def test_nothing_is_held_without_vacuum() -> None:
    rig = Rig(heavy("a", (0.4, 0.15), BOX_M), tool=ToolConfig(pressure_pa=0.0))
    result = rig.do(PutElsewhere(rig.thing("a"), 0.55, 0.25))
    assert result.failure is ToolFailure.MISSED


def test_cups_do_not_seal_on_an_edge() -> None:
    rig = Rig(heavy("a", (0.4, 0.15), BOX_M))
    thing = rig.thing("a")
    beside = Cuboid(thing.x_m + 0.5 * BOX_M[0], thing.y_m, thing.size_m)
    assert rig.do(PutElsewhere(beside, 0.6, 0.2)).failure is ToolFailure.MISSED


def test_what_stands_in_front_is_met() -> None:
    rig = Rig(heavy("a", (0.4, 0.28), BOX_M), heavy("b", (0.4, 0.1), BOX_M))
    result = rig.do(PutElsewhere(rig.thing("a"), 0.6, 0.2))
    assert result.failure is ToolFailure.OBSTRUCTED
    assert rig.lean("b") > 0.999


def test_box_comes_back_when_its_new_place_is_taken() -> None:
    rig = Rig(heavy("a", (0.4, 0.1), BOX_M), heavy("b", (0.6, 0.12), BOX_M, mass_kg=0.6))
    result = rig.do(PutElsewhere(rig.thing("a"), 0.6, 0.28))
    assert result.failure is ToolFailure.NO_PLACE
    assert rig.pose("a")[:2] == pytest.approx((0.4, 0.1), abs=0.008)


def test_more_weight_never_helps() -> None:
    vacuum, held = Vacuum(), []
    for mass_kg in np.linspace(0.1, 3.0, 30):
        weight_n = mass_kg * 9.81
        force_n, torque_nm = np.array([0.0, weight_n, 0.0]), np.array([-0.03 * weight_n, 0.0, 0.0])
        held.append(not overloaded(force_n, torque_nm, CUPS_M, vacuum))
    assert held[0]
    assert not held[-1]
    assert held == sorted(held, reverse=True)


def test_fewer_cups_and_less_pressure_hold_less() -> None:
    force_n, torque_nm = np.array([0.0, 4.0, 0.0]), np.array([-0.1, 0.0, 0.0])
    assert not overloaded(force_n, torque_nm, CUPS_M, Vacuum())
    assert overloaded(force_n, torque_nm, CUPS_M[:1], Vacuum())
    assert overloaded(force_n, torque_nm, CUPS_M, Vacuum(pressure_pa=10_000.0))


def test_straight_pull_is_held_up_to_pressure_times_area() -> None:
    most_n = 70_000.0 * np.pi * 0.005**2 * len(CUPS_M)
    for share, off in ((0.98, False), (1.02, True)):
        force_n = np.array([0.0, 0.0, share * most_n])
        assert overloaded(force_n, np.zeros(3), CUPS_M, Vacuum()) is off
