"""Connectors that touch, cover or lie beside other strands, and traces that leave cable out."""

import numpy as np
import pytest
from synthetic_cable import SHAPE, Drawing, evenly, render

from perception.cable.graph import Edge, SkeletonGraph, arms_of
from perception.cable.observation import observe
from perception.cable.plug_ends import with_plugs
from perception.cable.plugs import Plug, find_plugs
from perception.cable.polyline import arc_lengths
from perception.cable.types import Trace, TraceEnd
from perception.cable.vision import GreyImageVision
from perception.cable.wholeness import wholeness

WIDTH_PX = 7.0
PLUG_PX = 16.0


def cable_to(tip: tuple[float, float], way_rad: float) -> Drawing:
    """A cable that goes round in a wide loop, crosses (600, 400) upwards and ends at a tip."""
    way = np.array([np.cos(way_rad), np.sin(way_rad)])
    end = np.array(tip) - PLUG_PX * way
    t = np.linspace(0.0, 1.0, 60)[:, None]
    column = np.c_[np.full(60, 600.0), np.linspace(640.0, 200.0, 60)]
    t_arc = np.linspace(0.0, np.pi, 60)
    arc = np.c_[450.0 + 150.0 * np.cos(t_arc), 200.0 - 120.0 * np.sin(t_arc)]
    start, far = arc[-1], np.array([0.0, 1.0])
    reach = 1.2 * np.linalg.norm(end - start)
    lead = (
        (1.0 + 2.0 * t) * (1.0 - t) ** 2 * start
        + t * (1.0 - t) ** 2 * reach * far
        + t**2 * (3.0 - 2.0 * t) * end
        - t**2 * (1.0 - t) * reach * way
    )
    points = np.vstack([column, arc[1:], lead[1:]])
    return Drawing(evenly(np.c_[points, np.linspace(0.0, 4.0, len(points))]))


# Where the connector's tip lies and which way it points: on the strand, just across it,
# against it, and beside it.
TOUCHES = {
    "upon": ((606.0, 400.0), 0.0),
    "across": ((616.0, 380.0), -0.3),
    "against": ((594.0, 400.0), 0.2),
    "beside": ((590.0, 420.0), 1.35),
}


@pytest.fixture(scope="module", params=TOUCHES)
def touching(request: pytest.FixtureRequest) -> tuple[Drawing, np.ndarray]:
    drawing = cable_to(*TOUCHES[request.param])
    return drawing, render(drawing, np.random.default_rng(3), width_px=WIDTH_PX)


def test_both_connectors_are_ends(touching):
    drawing, image = touching
    ends = GreyImageVision().endpoints(image)
    assert len(ends) == 2
    for at, inner in ((0, 6), (-1, -7)):
        place = drawing.points_px[at]
        end = min(ends, key=lambda end: np.linalg.norm(end.position_px - place))
        assert np.linalg.norm(end.position_px - place) < 15.0
        way = drawing.points_px[inner] - place
        assert end.direction @ way / np.linalg.norm(way) > 0.8


def test_traces_pass_a_connector_and_end_at_it(touching):
    drawing, image = touching
    vision = GreyImageVision()
    (trace,) = vision.scene(image).traces
    assert trace.end is TraceEnd.ENDPOINT
    truth = arc_lengths(drawing.points_px)[-1]
    assert arc_lengths(trace.points_px)[-1] == pytest.approx(truth, abs=40.0)
    gaps = np.linalg.norm(trace.points_px[:, None] - drawing.points_px[None], axis=2)
    assert gaps.min(axis=1).max() < 12.0
    assert gaps.min(axis=0).max() < 25.0


def test_two_strands_side_by_side_are_no_connector():
    drawing = cable_to((300.0, 500.0), 1.57)
    beside = Drawing(drawing.nodes + np.array([WIDTH_PX + 1.0, 0.0, 0.0]))
    rng = np.random.default_rng(0)
    image = np.maximum(
        render(drawing, rng, width_px=WIDTH_PX, connectors=False, noise=2.0),
        render(beside, rng, width_px=WIDTH_PX, connectors=False, noise=2.0),
    )
    assert find_plugs(image, observe(image).mask) == ()


def test_an_empty_table_has_no_ends():
    image = np.random.default_rng(0).normal(60.0, 4.0, SHAPE).astype(np.uint8)
    assert GreyImageVision().endpoints(image) == ()


def test_belief_in_a_trace_falls_with_the_cable_that_it_leaves_out(touching):
    drawing, image = touching
    observation = observe(image)
    beliefs = [
        wholeness(observation, drawing.points_px[: round(share * len(drawing.points_px))])
        for share in (1.0, 0.9, 0.5)
    ]
    assert beliefs[0] == 1.0
    assert beliefs[0] > beliefs[1] >= beliefs[2] == 0.0


def test_half_a_cable_never_gives_a_verdict(touching):
    drawing, image = touching
    half = drawing.points_px[: len(drawing.points_px) // 2]
    sure = wholeness(observe(image), half)
    trace = Trace(half, TraceEnd.ENDPOINT, sure)
    assert GreyImageVision().knotted_probability((trace,), ()) == pytest.approx(0.5)


def test_a_cable_along_the_border_of_the_image_is_no_error():
    """A smoothed centre line may lie half a pixel outside."""
    height, width = 60, 200
    along = np.linspace(60.0, 190.0, 131)
    line = np.column_stack([along, np.full_like(along, height - 0.4)])
    edge = Edge(line, np.full(len(line), 3.0), (0, 1))
    graph = SkeletonGraph((edge,), line[[0, -1]], arms_of((edge,), 2))
    body = np.zeros((height, width), dtype=bool)
    body[height - 12 :, 36:58] = True
    plug = Plug(np.array([47.0, height - 6.0]), np.array([1.0, 0.0]), 11.0, body)
    assert len(with_plugs(graph, [plug], 6.0).plugs) == 1
