"""Boxes on boxes, by real contact: what a push takes along, and what the cups take down."""

from dataclasses import replace

import pytest
from shelf_rigs import Rig, heavy

from robots.shelf_tool import PushAlong, PutElsewhere

LOW_M, UPPER_M = (0.12, 0.1, 0.1), (0.06, 0.06, 0.08)


def stack() -> Rig:
    upper = heavy("upper", (0.41, 0.15), UPPER_M, mass_kg=0.1)
    on_top = replace(upper, box=replace(upper.box, bottom_m=LOW_M[2]))
    return Rig(heavy("low", (0.4, 0.15), LOW_M), on_top)


def test_what_stands_on_a_box_rides_along_when_that_is_pushed() -> None:
    rig = stack()
    before = rig.pose("upper") - rig.pose("low")
    result = rig.do(PushAlong(rig.thing("low"), 0.1))
    assert result.failure is None
    assert result.moved_m == pytest.approx(0.1, abs=0.003)
    assert rig.pose("upper") - rig.pose("low") == pytest.approx(before, abs=0.005)
    assert rig.lean("upper") > 0.999


def test_cups_take_the_upper_box_down_to_the_floor() -> None:
    rig = stack()
    low = rig.pose("low")
    thing = replace(rig.thing("upper"), bottom_m=LOW_M[2])
    result = rig.do(PutElsewhere(thing, 0.2, 0.12))
    assert result.failure is None
    assert rig.pose("upper")[:3] == pytest.approx([0.2, 0.12, 0.5 * UPPER_M[2]], abs=0.012)
    assert rig.lean("upper") > 0.999
    assert rig.pose("low")[:3] == pytest.approx(low[:3], abs=0.004)
