import itertools

import numpy as np
import pytest

pytest.importorskip("torch")
pytest.importorskip("safetensors.torch")

import safetensors.torch
import torch

from perception.cable.classifiers.continuity import ContinuityClassifier
from perception.cable.classifiers.edges import EdgeClassifier
from perception.cable.classifiers.learned import LearnedClassifier
from perception.cable.classifiers.passes import StrandPass, path_through
from perception.cable.classifiers.thesis import (
    ThesisClassifier,
    confidence,
    corrected,
)
from perception.cable.parts import CROSSING
from perception.cable.types import Trace, TraceEnd
from perception.models.crossing_ribbon_net import CrossingRibbonNet
from perception.models.store import FOLDER
from perception.models.thesis_crossing_net import ThesisCrossingNet
from perception.training.scenes import SceneConfig, lay_scene, make_scene

SCORES = np.linspace(0.0, 1.0, 12)
CONFIG = SceneConfig(
    extent=60.0, narrowest_px=6.0, widest_px=8.0, family="random", cables=2, bright=True
)


@pytest.fixture(params=["ribbons", "thesis"])
def classifier(request, tmp_path):
    """Return a classifier with random weights: what holds for all weights is what is tested."""
    torch.manual_seed(4)
    network, widths, make, name = {
        "ribbons": (CrossingRibbonNet, (8, 8, 16, 16, 16), LearnedClassifier, "crossing_ribbons"),
        "thesis": (ThesisCrossingNet, (8, 8, 16, 16), ThesisClassifier, "thesis_crossing"),
    }[request.param]
    safetensors.torch.save_file(network(widths).state_dict(), tmp_path / "weights.safetensors")
    (tmp_path / "config.json").write_text(f'{{"network": "{name}", "widths": {list(widths)}}}')
    return make(tmp_path)


def _scene(seed=3):
    scene = make_scene(np.random.default_rng([931_001, seed]), CONFIG)
    return scene.image, [Trace(cable.points_px, TraceEnd.ENDPOINT, 1.0) for cable in scene.cables]


def _beliefs(crossings, names):
    """Return the belief that each strand is on top, by places on cables with their names."""
    return {
        frozenset(
            [
                (names[found.trace_over], round(found.arc_over, 6)),
                (names[found.trace_under], round(found.arc_under, 6)),
            ]
        ): (names[found.trace_over], round(found.arc_over, 6), found.probability)
        for found in crossings
    }


def _assert_exchange_changes_nothing(classifier, seed):
    image, traces = _scene(seed)
    there = _beliefs(classifier.classify(image, traces), "ab")
    back = _beliefs(classifier.classify(image, traces[::-1]), "ba")
    assert there.keys() == back.keys()
    for place, (name, arc, belief) in there.items():
        assert back[place][2] == pytest.approx(belief, abs=1e-5)
        assert back[place][:2] == (name, arc) or belief < 0.501
    return len(there)


def test_exchanging_strands_leaves_every_belief(classifier):
    assert sum(_assert_exchange_changes_nothing(classifier, seed) for seed in range(4)) > 10


@pytest.mark.parametrize("make", [EdgeClassifier, ContinuityClassifier])
def test_exchanging_strands_leaves_the_evidence(make):
    assert _assert_exchange_changes_nothing(make(), 3) > 2


def test_lines_that_leave_the_image_and_end_are_judged(classifier):
    image = np.full((80, 90), 60, np.uint8)
    image[38:44, :] = 200
    image[:, 82:88] = 180
    across = Trace(np.array([[-30.0, 41.0], [130.0, 41.0]]), TraceEnd.EDGE, 1.0)
    short = Trace(np.array([[85.0, 38.0], [85.0, 44.5]]), TraceEnd.LOST, 1.0)
    (found,) = classifier.classify(image, [across, short])
    assert 0.5 <= found.probability <= 1.0
    assert found.position_px == pytest.approx([85.0, 41.0])


def test_no_cable_or_no_crossing_is_no_error(classifier):
    blank = np.full((60, 60), 90, np.uint8)
    lines = [
        Trace(np.array([[5.0, y], [55.0, 60.0 - y]]), TraceEnd.EDGE, 1.0) for y in (10.0, 50.0)
    ]
    assert len(classifier.classify(blank, lines)) == 1
    assert classifier.classify(blank, lines[:1]) == ()
    assert classifier.classify(blank, []) == ()


def test_the_thesis_flips_the_less_confident_of_equal_labels():
    for first, second in itertools.product(SCORES, SCORES):
        belief = corrected(first, second)
        assert belief == pytest.approx(1.0 - corrected(second, first)) or first == second
        if (first >= 0.275) != (second >= 0.275):
            assert (belief > 0.5) == (first >= 0.275)
        elif abs(confidence(first) - confidence(second)) > 1e-9:
            keeps = confidence(first) > confidence(second)
            assert (belief > 0.5) == (keeps == (first >= 0.275))


def test_confidence_grows_with_the_distance_from_the_threshold():
    assert confidence(0.275) == 0.5
    assert confidence(0.0) == confidence(1.0) == 1.0
    assert (np.diff([confidence(score) for score in np.linspace(0.275, 1.0, 9)]) > 0.0).all()


def test_a_path_goes_straight_on_beyond_its_line():
    strand = StrandPass(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]]), 2.0)
    path = path_through(strand, 8.0, 1.0)
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    assert path[8] == pytest.approx([2.0, 0.0])
    assert path[0] == pytest.approx([-6.0 * 0.6, -6.0 * 0.8]) or path[0, 0] < 0.0
    assert path[-1, 1] > 4.0
    assert steps == pytest.approx(np.ones(16), abs=0.3)


def _hairpin(swapped):
    """Return a cable that turns round and comes back beside itself [cable widths].

    Args:
        swapped: Whether its two sides change places half way, as where a trace goes over from
            one to the other.
    """
    x = np.arange(8.0, 34.0, 0.5)
    turn = np.linspace(-np.pi / 2.0, np.pi / 2.0, 9)[1:-1]
    aside = 0.6 * (-np.tanh((x - 20.0) / 1.5) if swapped else np.ones(len(x)))
    bend = np.column_stack([34.0 + 1.5 * np.cos(turn), 22.0 + 0.6 * np.sin(turn)])
    there = np.column_stack([x, 22.0 - aside])
    back = np.column_stack([x, 22.0 + aside])[::-1]
    return np.vstack([there, bend[::-1] if swapped else bend, back])


def test_traces_that_go_over_to_the_strand_beside_are_doubted():
    classifier = LearnedClassifier(FOLDER / CROSSING)
    config = SceneConfig(extent=44.0, narrowest_px=8.0, widest_px=9.0, bright=True, style="shaded")
    for seed in range(4):
        scene = lay_scene(np.random.default_rng(seed), [_hairpin(swapped=False)], config)
        right, wrong = (
            Trace(scene.width_px * _hairpin(swapped), TraceEnd.ENDPOINT, belief)
            for swapped, belief in ((False, 0.3), (True, 0.6))
        )
        first, second = classifier.doubted(scene.image, (wrong, right))
        assert np.array_equal(first.points_px, right.points_px)
        assert first.probability == pytest.approx(0.3)
        assert second.probability < 0.2
