"""What is drawn of a plan: the image stays as large, and the words say what the plan is."""

from dataclasses import replace

import numpy as np
import pytest
from exact_sight import seen_exactly
from synthetic_cable import laid_down, overhand

from perception.cable.planning import PlannerConfig, plan_trace
from perception.cable.planning.draw_plan import MOVED, ROLE_COLOURS, caption, draw_plan


@pytest.fixture(scope="module")
def planned():
    trace, crossings, pixels = seen_exactly(overhand())
    image = np.where(pixels.cable, 200, 60).astype(np.uint8)
    return image, trace, crossings, plan_trace(trace, 0, crossings)


def _shows(canvas, colour):
    return (np.abs(canvas.astype(int) - colour).max(axis=2) <= 12).sum()


def test_hands_and_the_moved_cable_are_drawn_over_the_image(planned):
    image, trace, _, plan = planned
    canvas = draw_plan(image, trace.points_px, plan)
    assert canvas.shape == (*image.shape, 3)
    for colour in (MOVED, *ROLE_COLOURS.values()):
        assert _shows(canvas, colour) > 50
    assert np.array_equal(canvas, draw_plan(image, trace.points_px, plan))


def test_grasps_of_a_traced_cable_lie_on_it_in_the_image(planned):
    _, trace, _, plan = planned
    for grasp in plan.steps[0].grasps:
        assert np.linalg.norm(trace.points_px - grasp.point, axis=1).min() < 3.0


def test_the_words_say_what_is_done_and_what_should_be_left(planned):
    _, trace, crossings, plan = planned
    first = plan.steps[0]
    assert caption(plan).startswith(f"dilate {first.end}: 4 -> {len(first.predicted)} crossing")
    assert caption(replace(plan, steps=())) == "4 crossings: nothing to do"
    none = plan_trace(trace, 0, crossings, PlannerConfig(states=1))
    assert caption(none) == f"4 crossings: no plan: {none.failure}"


def test_a_cable_that_was_laid_down_needs_no_dilation():
    trace, crossings, _ = seen_exactly(laid_down(overhand()))
    plan = plan_trace(trace, 0, crossings)
    assert plan.failure is None
    assert "dilate" not in caption(plan)
