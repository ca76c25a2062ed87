from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("torch")

import torch

from perception.models import tracer_crop
from perception.training.scenes import SceneConfig, make_scene
from perception.training.tracer import ZOOM, TracerTask, mirrored
from perception.training.tracer_samples import (
    NOWHERE,
    SampleConfig,
    scene_samples,
)

SMALL = SceneConfig(extent=24.0, narrowest_px=5.0, widest_px=7.0)
STRAIGHT = SampleConfig(from_scene=40, scale_error=0.0, jitter=0.0, drift=0.0, zoom=ZOOM)


def _samples(seed=2):
    rng = np.random.default_rng(seed)
    return scene_samples(rng, make_scene(rng, SMALL), STRAIGHT)


def test_targets_lie_one_step_ahead():
    samples = _samples()
    first = samples.targets[:, 0]
    known = first[:, 0] > NOWHERE
    gaps = np.linalg.norm(first[known] - np.array(tracer_crop.HERE), axis=1)
    # A bend makes the chord shorter than the arc, and nothing makes it longer.
    assert gaps.max() < tracer_crop.STEP * 1.01
    assert np.median(gaps) > tracer_crop.STEP * 0.9


def test_cable_turns_back_in_samples_of_hairpins():
    rng = np.random.default_rng(3)
    folded = make_scene(rng, SceneConfig(extent=24.0, family="hairpin", cables=1))
    targets = scene_samples(rng, folded, replace(STRAIGHT, hairpins=1.0)).targets
    after_two = targets[targets[:, 1, 0] > NOWHERE, 1]
    assert (after_two[:, 0] < tracer_crop.HERE[0] + 0.5 * tracer_crop.STEP).any()


def test_path_ends_at_its_place_in_the_crop():
    column, row = (int((value + 0.5) * ZOOM) for value in tracer_crop.HERE)
    samples = _samples()
    assert (
        samples.crops[:, 1, row : row + 2, column - 1 : column + 1].max(axis=(1, 2)) > 0.5
    ).all()


def test_a_mirror_twice_is_no_mirror():
    samples = _samples()
    batch = torch.from_numpy(samples.crops), torch.from_numpy(samples.targets)
    crops, targets = mirrored(mirrored(batch))
    assert torch.equal(crops, batch[0])
    assert torch.allclose(targets, batch[1])


def test_loss_falls_on_one_batch():
    torch.manual_seed(0)
    task, samples = TracerTask(), _samples()
    batch = torch.from_numpy(samples.crops[:16]), torch.from_numpy(samples.targets[:16]).float()
    network = task.network()
    optimiser = torch.optim.Adam(network.parameters(), 3e-3)
    losses = []
    for _ in range(12):
        loss = task.loss(network, batch)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        losses.append(float(loss.detach()))
    assert losses[-1] < 0.8 * losses[0]
