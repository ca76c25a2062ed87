"""From a grey image to a scene: accuracy floors, and what must not depend on the view."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic_cable import Drawing, evenly, figure_8, laid_down, overhand, render, wander

from perception.cable.classifiers.continuity import ContinuityClassifier
from perception.cable.classifiers.edges import EdgeClassifier
from perception.cable.crossings import CrossingSite, find_sites
from perception.cable.draw import draw_scene
from perception.cable.interfaces import CableVision, CrossingClassifier, Tracer
from perception.cable.mask import find_mask
from perception.cable.observation import observe
from perception.cable.parts import CLASSIFIERS, TRACERS
from perception.cable.topology import curve_crossings
from perception.cable.tracers.analytic import AnalyticTracer
from perception.cable.tracers.skeleton import SkeletonTracer
from perception.cable.types import Trace, TraceEnd, TraceStart
from perception.cable.vision import GreyImageVision, VisionConfig

WANDER_SEEDS = (1, 4, 5, 6, 8, 9)


def image_of(drawing: Drawing, seed: int = 0, **settings: float) -> np.ndarray:
    return render(drawing, np.random.default_rng(seed), **settings)


@pytest.fixture(scope="module")
def knotted() -> tuple[Drawing, np.ndarray]:
    drawing = overhand()
    return drawing, image_of(drawing)


@pytest.fixture(scope="module")
def wanderings() -> list[tuple[Drawing, np.ndarray]]:
    drawings = [wander(np.random.default_rng(seed)) for seed in WANDER_SEEDS]
    return [(drawing, image_of(drawing, seed)) for seed, drawing in enumerate(drawings)]


def farthest_px(trace: Trace, drawing: Drawing) -> float:
    """How far the trace and the true centre line are apart anywhere, both ways."""
    a, b = evenly(trace.points_px), drawing.points_px
    gaps = np.linalg.norm(a[:, None] - b[None], axis=2)
    return max(gaps.min(axis=1).max(), gaps.min(axis=0).max())


def follows(trace: Trace, drawing: Drawing) -> bool:
    """Whether the trace runs along the whole cable in order, from either end."""
    truth, points = evenly(drawing.points_px, 4.0), evenly(trace.points_px, 4.0)
    if np.linalg.norm(points[0] - truth[0]) > np.linalg.norm(points[0] - truth[-1]):
        points = points[::-1]
    share = np.linspace(0.0, 1.0, 80)
    pairs = [
        np.stack([np.interp(share, np.linspace(0, 1, len(p)), p[:, k]) for k in (0, 1)], 1)
        for p in (truth, points)
    ]
    return bool(np.linalg.norm(pairs[0] - pairs[1], axis=1).max() < 25.0)


def over_of(drawing: Drawing) -> list[tuple[np.ndarray, float]]:
    """True crossings: where, and on which share of the cable the upper visit lies."""
    places = []
    for crossing in curve_crossings(drawing.nodes).crossings:
        upper = crossing.first if crossing.first_over else crossing.second
        index = np.arange(len(drawing.nodes))
        where = [np.interp(crossing.first, index, drawing.nodes[:, axis]) for axis in (0, 1)]
        places.append((np.array(where), upper / index[-1]))
    return places


def test_the_mask_shows_the_cable_and_little_else(knotted):
    drawing, image = knotted
    mask = find_mask(image)
    y, x = np.argwhere(mask.cable).T
    gaps = np.linalg.norm(np.stack([x, y], 1)[:, None] - drawing.points_px[None, ::2], axis=2)
    assert (gaps.min(axis=1) < 6.0).mean() > 0.93  # the rest are the connectors
    rows, columns = np.rint(drawing.points_px[:, 1]), np.rint(drawing.points_px[:, 0])
    assert mask.cable[rows.astype(int), columns.astype(int)].mean() > 0.98
    assert mask.width_px == pytest.approx(7.0, abs=1.5)


def test_an_empty_table_shows_no_cable():
    noise = np.random.default_rng(0).normal(60.0, 5.0, (773, 1032))
    image = np.clip(noise, 0, 255).astype(np.uint8)
    assert find_mask(image) is None
    scene = GreyImageVision().scene(image)
    assert (scene.traces, scene.endpoints, scene.crossings, scene.knots) == ((), (), (), ())
    assert scene.knotted_probability == 0.5


def test_arms_in_the_lowest_rows_are_clutter(knotted):
    _, image = knotted
    with_arms = image.copy()
    with_arms[690:, 80:380] = 150
    with_arms[650:, 640:1000] = 200
    plain, cluttered = find_mask(image), find_mask(with_arms)
    assert (plain.cable[:620] == cluttered.cable[:620]).mean() > 0.9995
    assert not cluttered.cable[700:].any()


@pytest.mark.parametrize(
    "light", [{"cloth": 25.0, "cable": 90.0}, {"cloth": 110.0, "cable": 235.0}]
)
@pytest.mark.parametrize("width_px", [5.0, 9.0])
def test_light_and_width_do_not_matter(light, width_px):
    drawing = figure_8()
    image = image_of(drawing, width_px=width_px, noise=3.0, **light)
    scene = GreyImageVision().scene(image)
    assert len(scene.endpoints) == 2
    assert len(scene.crossings) == len(over_of(drawing))
    assert scene.knotted_probability > 0.8


def test_ends_lie_where_the_cable_ends_and_point_into_it(knotted):
    drawing, image = knotted
    ends = GreyImageVision().endpoints(image)
    assert len(ends) == 2
    for truth, inner in ((0, 8), (-1, -9)):
        place = drawing.points_px[truth]
        end = min(ends, key=lambda e: np.linalg.norm(e.position_px - place))
        assert np.linalg.norm(end.position_px - place) < 10.0
        way = drawing.points_px[inner] - place
        assert end.direction @ way / np.linalg.norm(way) > 0.9
        assert end.probability > 0.9


def test_cable_that_leaves_the_view_has_no_end_there():
    line = np.stack([np.linspace(-30.0, 500.0, 200), 300.0 + 40.0 * np.sin(np.arange(200) / 30)], 1)
    image = image_of(Drawing(np.c_[line, np.zeros(200)]))
    vision = GreyImageVision()
    (end,) = vision.endpoints(image)
    assert end.position_px[0] > 400.0
    trace = vision.trace(image, end.position_px[None], (end,))
    assert trace.end is TraceEnd.EDGE


def test_start_points_are_six_clear_steps(knotted):
    _, image = knotted
    vision = GreyImageVision()
    for end in vision.endpoints(image):
        points = vision.start_points(image, end)
        assert points.shape == (7, 2)
        lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
        assert 80.0 < lengths.sum() < 200.0
        assert (points[1] - points[0]) @ end.direction > 0.0


def test_there_is_no_start_beside_the_cable(knotted):
    _, image = knotted
    far_off = np.array([[900.0, 700.0]])
    for tracer in (SkeletonTracer(), AnalyticTracer()):
        assert tracer.trace(image, far_off, ()) is None


def test_the_default_tracer_follows_every_wandering(wanderings):
    vision = GreyImageVision()
    right = 0
    for drawing, image in wanderings:
        scene = vision.scene(image)
        if len(scene.traces) == 1 and follows(scene.traces[0], drawing):
            assert scene.traces[0].end is TraceEnd.ENDPOINT
            assert farthest_px(scene.traces[0], drawing) < 12.0
            right += 1
    assert right == len(wanderings)


def test_the_analytic_tracer_follows_an_easy_knot(knotted):
    drawing, image = knotted
    vision = GreyImageVision(VisionConfig(tracer="analytic"))
    (trace,) = vision.scene(image).traces
    assert trace.end is TraceEnd.ENDPOINT
    assert farthest_px(trace, drawing) < 25.0


@pytest.mark.parametrize("classifier", ["edges", "continuity"])
def test_classifiers_read_every_crossing(classifier, wanderings):
    vision = GreyImageVision(VisionConfig(classifier=classifier))
    right = total = 0
    for drawing, image in wanderings:
        trace = Trace(drawing.points_px, TraceEnd.ENDPOINT, 1.0)
        crossings = vision.crossings(image, (trace,))
        for where, upper in over_of(drawing):
            total += 1
            crossing = min(crossings, key=lambda c: np.linalg.norm(c.position_px - where))
            assert np.linalg.norm(crossing.position_px - where) < 8.0
            right += abs(crossing.arc_over - upper) < 0.01
    assert right >= 0.95 * total
    assert total > 20


@pytest.mark.parametrize("kind", [EdgeClassifier, ContinuityClassifier])
def test_exchanging_the_strands_changes_the_sign(kind, knotted):
    drawing, image = knotted
    classifier, mask = kind(), observe(image).mask
    for site in find_sites((Trace(drawing.points_px, TraceEnd.ENDPOINT, 1.0),), mask.width_px):
        swapped = CrossingSite(
            site.position_px,
            site.traces,
            site.arcs[::-1],
            site.directions[::-1],
            -site.turn,
            site.paths[::-1],
        )
        assert classifier.evidence(image, mask, swapped) == pytest.approx(
            -classifier.evidence(image, mask, site)
        )


def test_walking_the_other_way_meets_the_same_crossings(knotted):
    drawing, image = knotted
    vision = GreyImageVision()
    there, back = (
        vision.crossings(image, (Trace(points, TraceEnd.ENDPOINT, 1.0),))
        for points in (drawing.points_px, drawing.points_px[::-1])
    )
    assert len(there) == len(back) == 4
    for crossing in there:
        other = min(back, key=lambda c: np.linalg.norm(c.position_px - crossing.position_px))
        assert other.arc_over == pytest.approx(1.0 - crossing.arc_over, abs=0.005)
        assert other.probability == pytest.approx(crossing.probability, abs=0.02)


@pytest.mark.parametrize(
    "view",
    [lambda image: image[:, ::-1], lambda image: image[::-1], np.rot90, lambda i: np.rot90(i, 2)],
    ids=["left-right", "up-down", "quarter turn", "half turn"],
)
def test_turned_and_mirrored_images_are_read_alike(view):
    image = image_of(figure_8())
    vision = GreyImageVision()
    plain, seen = vision.scene(image), vision.scene(np.ascontiguousarray(view(image)))
    assert len(seen.crossings) == len(plain.crossings) == 5
    assert len(seen.endpoints) == len(plain.endpoints) == 2
    assert len(seen.knots) == len(plain.knots) == 1
    assert seen.knotted_probability == pytest.approx(plain.knotted_probability, abs=0.05)


@pytest.mark.parametrize("tie", [overhand, figure_8])
def test_knots_are_told_from_the_same_curve_laid_down(tie):
    vision = GreyImageVision()
    knot = vision.scene(image_of(tie()))
    assert knot.knotted_probability > 0.95
    assert len(knot.knots) == 1
    fake = vision.scene(image_of(laid_down(tie())))
    assert fake.knotted_probability < 0.05
    assert fake.knots == ()


def test_grasp_points_lie_on_lonely_cable(knotted):
    drawing, image = knotted
    scene = GreyImageVision().scene(image)
    (knot,) = scene.knots
    assert np.linalg.norm(knot.cage_px - knot.pinch_px) >= 60.0
    for place, way in (
        (knot.cage_px, knot.cage_direction),
        (knot.pinch_px, knot.pinch_direction),
    ):
        assert np.linalg.norm(drawing.points_px - place, axis=1).min() < 3.0
        assert np.linalg.norm(way) == pytest.approx(1.0)
        assert min(np.linalg.norm(c.position_px - place) for c in scene.crossings) > 15.0


def test_the_same_image_gives_the_same_scene(knotted):
    _, image = knotted
    first, second = (GreyImageVision().scene(image.copy()) for _ in range(2))
    assert np.array_equal(first.traces[0].points_px, second.traces[0].points_px)
    assert first.knotted_probability == second.knotted_probability


def test_a_given_start_is_where_the_trace_begins(knotted):
    drawing, image = knotted
    start = drawing.points_px[30:36]
    scene = GreyImageVision().scene(image, start)
    (trace,) = scene.traces
    assert np.linalg.norm(trace.points_px[0] - start[0]) < 4.0
    assert (trace.points_px[5] - trace.points_px[0]) @ (start[-1] - start[0]) > 0.0


class _Undecided(SkeletonTracer):
    """Knows of two ways: where the cable goes, and straight on."""

    def hypotheses(self, image, start_px, endpoints):
        right = self.trace(image, start_px, endpoints)
        line = np.linspace(start_px[0], start_px[0] + 200.0, 20)
        straight = Trace(line, TraceEnd.LOST, 0.6)
        return straight, replace(right, probability=0.4)


class _Doubter(EdgeClassifier):
    """Doubts what is lost."""

    def doubted(self, image, traces):
        told = [
            replace(t, probability=0.1 * t.probability) if t.end is TraceEnd.LOST else t
            for t in traces
        ]
        return tuple(sorted(told, key=lambda trace: -trace.probability))


def test_the_way_is_taken_that_crossings_leave_most_belief_in(knotted, monkeypatch):
    _, image = knotted
    monkeypatch.setitem(TRACERS, "analytic", lambda eye: _Undecided(observe=eye.observe))
    monkeypatch.setitem(CLASSIFIERS, "continuity", lambda _: _Doubter())
    chosen = {}
    for classifier in ("edges", "continuity"):
        vision = GreyImageVision(VisionConfig(tracer="analytic", classifier=classifier))
        end = vision.endpoints(image)[0]
        start_px = TraceStart.at(end).points_px
        trace = vision.trace(image, start_px, vision.endpoints(image))
        assert vision.scene(image, start_px).traces[0].end is trace.end
        chosen[classifier] = trace.end, trace.probability
    assert chosen["edges"] == (TraceEnd.LOST, 0.6)
    assert chosen["continuity"] == (TraceEnd.ENDPOINT, 0.4)


class _OneSided(SkeletonTracer):
    """Believes in a cable more from its right end."""

    def trace(self, image, start_px, endpoints):
        found = super().trace(image, start_px, endpoints)
        rightwards = found.points_px[-1, 0] > found.points_px[0, 0]
        return replace(found, probability=0.2 if rightwards else 0.7)


def test_a_cable_hardly_believed_in_is_traced_from_its_other_end(knotted, monkeypatch):
    _, image = knotted
    monkeypatch.setitem(TRACERS, "analytic", lambda eye: _OneSided(observe=eye.observe))
    scene = GreyImageVision(VisionConfig(tracer="analytic")).scene(image)
    (trace,) = scene.traces
    assert trace.probability == 0.7


def test_drawing_shows_the_scene_and_leaves_the_image_alone(knotted):
    _, image = knotted
    before = image.copy()
    scene = GreyImageVision().scene(image)
    picture = draw_scene(image, scene)
    assert picture.shape == (*image.shape, 3)
    assert picture.dtype == np.uint8
    assert np.array_equal(image, before)
    x, y = np.rint(scene.traces[0].points_px[len(scene.traces[0].points_px) // 4]).astype(int)
    assert np.ptp(picture[y, x].astype(int)) > 60  # coloured, unlike the grey cable


def test_implementations_keep_the_contracts():
    assert isinstance(GreyImageVision(), CableVision)
    for tracer in (SkeletonTracer(), AnalyticTracer()):
        assert isinstance(tracer, Tracer)
    for classifier in (EdgeClassifier(), ContinuityClassifier()):
        assert isinstance(classifier, CrossingClassifier)
