import json

import cv2
import numpy as np
import pytest

pytest.importorskip("torch")
pytest.importorskip("safetensors.torch")

import safetensors.torch
import torch

from perception.cable.classifiers.learned import LearnedClassifier
from perception.cable.interfaces import CrossingClassifier, Tracer
from perception.cable.tracers.learned import LearnedTracer
from perception.cable.types import Endpoint, Trace, TraceEnd
from perception.cable.vision import GreyImageVision, VisionConfig
from perception.models.store import FOLDER, load_network, read_config
from perception.training.scenes import SceneConfig, make_scene

VERSIONS = sorted(path.parent for path in FOLDER.glob("*/config.json"))


@pytest.mark.parametrize("folder", VERSIONS, ids=lambda folder: folder.name)
def test_a_version_answers_as_on_the_day_it_was_trained(folder):
    golden = safetensors.torch.load_file(folder / "golden.safetensors")
    with torch.inference_mode():
        answer = load_network(folder)(golden["inputs"])
    answer = answer if isinstance(answer, torch.Tensor) else answer[0]
    assert torch.allclose(answer, golden["answer"], atol=1e-2)


@pytest.mark.parametrize("folder", VERSIONS, ids=lambda folder: folder.name)
def test_a_version_is_complete_and_small(folder):
    assert {path.name for path in folder.iterdir()} >= {
        "weights.safetensors",
        "weights.sha256",
        "config.json",
        "recipe.yaml",
        "metrics.json",
        "card.md",
        "golden.safetensors",
    }
    assert (folder / "weights.safetensors").stat().st_size < 12e6
    metrics = json.loads((folder / "metrics.json").read_text())
    # The thesis's confidences are no probabilities, and it is here to show that.
    if not folder.name.startswith("thesis"):
        assert metrics["calibration"]["calibration_error"] <= 0.05


def _wave(bright):
    """Draw a wave that crosses a straight piece of itself; returns image and centre line."""
    turn = np.linspace(-0.75 * np.pi, 0.75 * np.pi, 200)
    loop = np.column_stack([260.0 + 90.0 * np.cos(turn), 200.0 + 90.0 * np.sin(turn)])
    run = np.linspace(0.0, 1.0, 120)[:, None]
    tail = loop[-1] + run * np.array([120.0, -120.0]) * 1.4
    head = loop[0] + (1.0 - run) * np.array([-90.0, 90.0]) * 1.2
    line = np.vstack([head, loop, tail[1:]])
    image = np.full((400, 520), 40.0 if bright else 200.0, np.float32)
    fixed = np.round(line * 8).astype(np.int32)[:, None]
    cv2.polylines(image, [fixed], False, 190.0 if bright else 40.0, 6, cv2.LINE_AA, 3)
    image += np.random.default_rng(0).normal(0.0, 3.0, image.shape)
    return image.clip(0, 255).astype(np.uint8), line


@pytest.mark.parametrize("version", ["tracer_v2", "tracer_v3", "tracer_v4"])
@pytest.mark.parametrize("bright", [True, False])
def test_the_tracer_follows_a_loop(version, bright):
    image, line = _wave(bright)
    tracer = LearnedTracer(FOLDER / version)
    assert isinstance(tracer, Tracer)
    ends = [
        Endpoint(line[k], (line[n] - line[k]) / np.linalg.norm(line[n] - line[k]), 1.0)
        for k, n in ((0, 10), (-1, -10))
    ]
    trace = tracer.trace(image, line[:25:4], ends)
    assert trace is not None
    assert trace.end is TraceEnd.ENDPOINT
    gaps = np.linalg.norm(line[::5, None] - _dense(trace.points_px)[None], axis=2).min(axis=1)
    # Steps of two widths cut the corners where the pieces of the drawn line are joined.
    assert gaps.max() < 7.0


def test_cable_vision_can_be_asked_for_the_learned_tracer():
    image, line = _wave(bright=True)
    vision = GreyImageVision(VisionConfig(tracer="learned"))
    trace = vision.trace(image, line[:25:4], [])
    assert trace is not None
    gaps = np.linalg.norm(line[::5, None] - _dense(trace.points_px)[None], axis=2).min(axis=1)
    # Steps of two widths cut the corners where the pieces of the drawn line are joined.
    assert gaps.max() < 7.0


def _dense(points):
    places = np.linspace(0.0, len(points) - 1.0, 8 * len(points))
    return np.column_stack([np.interp(places, np.arange(len(points)), axis) for axis in points.T])


def test_no_cable_no_trace():
    tracer = LearnedTracer(FOLDER / "tracer_v4")
    assert tracer.trace(np.full((200, 200), 50, np.uint8), np.array([[80.0, 90.0]]), []) is None


def test_the_classifier_knows_most_crossings_of_fresh_scenes():
    assert read_config(FOLDER / "crossing_v4").network == "crossing_ribbons"
    classifier = LearnedClassifier(FOLDER / "crossing_v4")
    assert isinstance(classifier, CrossingClassifier)
    right = total = 0
    for seed in range(8):
        config = SceneConfig(narrowest_px=6.0, widest_px=8.0, family="random", cables=1)
        scene = make_scene(np.random.default_rng([930_001, seed]), config)
        line, size = scene.cables[0].points_px, np.array(scene.image.shape[::-1])
        trace = Trace(line, TraceEnd.ENDPOINT, 1.0)
        for found in classifier.classify(scene.image, [trace]):
            if not (found.position_px > 0.0).all() or (found.position_px > size).any():
                continue
            for true in scene.crossings:
                places = np.array([true.over[1], true.under[1]]) / (len(line) - 1)
                if np.abs(places - (found.arc_over, found.arc_under)).max() < 0.02:
                    right, total = right + 1, total + 1
                elif np.abs(places[::-1] - (found.arc_over, found.arc_under)).max() < 0.02:
                    total += 1
    assert total > 15
    assert right / total > 0.8
