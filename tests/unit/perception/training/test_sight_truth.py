import numpy as np
import pytest

pytest.importorskip("torch")

import torch

from perception.models import sight_net
from perception.models.sight_input import STRIDE
from perception.training import sight_targets as wanted
from perception.training.sight import SightTask, end_loss, heat_loss
from perception.training.sight_scenes import draw_truth, relit, turned

SIDE = 192


def _truth(seed, size=(SIDE, SIDE)):
    return draw_truth(np.random.default_rng([940_001, seed]), size)


@pytest.mark.parametrize("seed", range(4))
def test_four_quarters_and_two_mirrors_change_nothing(seed):
    truth = _truth(seed)
    again = truth
    for _ in range(4):
        again = turned(again, mirrored=False, quarters=1)
    again = turned(turned(again, mirrored=True, quarters=0), mirrored=True, quarters=0)
    assert (again.image == truth.image).all()
    assert (again.cable == truth.cable).all()
    assert np.allclose(again.ends, truth.ends)
    assert np.allclose(again.inwards, truth.inwards)


@pytest.mark.parametrize("quarters", range(4))
def test_ends_turn_with_the_image(quarters):
    for seed in range(6):
        other = turned(_truth(seed), mirrored=True, quarters=quarters)
        # A little way into the cable from a visible end there is cable.
        inner = other.ends + 0.6 * other.width_px * other.inwards
        inside = ((inner > 0) & (inner < SIDE - 1)).all(axis=1) & other.visible
        columns, rows = np.round(inner[inside]).astype(int).T
        assert other.shown[rows, columns].all()


def test_the_cell_that_holds_an_end_answers_with_its_place_and_way():
    for seed in range(8):
        truth = _truth(seed)
        grid = wanted.grid_of(truth)
        rows, columns = np.nonzero(grid[0] == 1.0)
        found = np.column_stack([columns, rows]) + grid[wanted.OFFSET][:, rows, columns].T
        places = (found + 0.5) * STRIDE - 0.5
        clear = truth.ends[truth.clear_ends(wanted.INSIDE)]
        for place in clear:
            assert np.linalg.norm(places - place, axis=1).min() < 0.51 * STRIDE or len(clear) > 1
        for place in places:
            assert np.linalg.norm(truth.ends - place, axis=1).min() < 1.5 * STRIDE


def test_masks_are_apart_and_widths_are_those_of_the_scene():
    for seed in range(6):
        truth = _truth(seed)
        assert not (truth.cable & truth.connector).any()
        if truth.cable.any():
            assert 0.5 < truth.usual_width_px / truth.width_px < 1.6


def test_relighting_keeps_size_and_kind():
    image = _truth(1).image
    lit = relit(np.random.default_rng(3), image)
    assert lit.shape == image.shape
    assert lit.dtype == np.uint8


def test_perfect_answers_cost_nothing_and_wrong_ones_something():
    truth = next(t for t in map(_truth, range(20)) if t.clear_ends(wanted.INSIDE).any())
    targets = torch.from_numpy(wanted.grid_of(truth))[None]
    heat = torch.where(targets[:, 0] == 1.0, 12.0, -12.0)
    assert float(heat_loss(heat, targets[:, 0], targets[:, 3])) < 1e-3
    assert float(heat_loss(-heat, targets[:, 0], targets[:, 3])) > 10.0
    grid = torch.zeros(1, sight_net.GRID_MAPS, *targets.shape[2:])
    grid[:, sight_net.OFFSET] = targets[:, wanted.OFFSET]
    grid[:, sight_net.DIRECTION] = targets[:, wanted.DIRECTION]
    grid[:, sight_net.PLUGGED] = 40.0 * targets[:, wanted.PLUGGED] - 20.0
    assert float(end_loss(grid, targets)) < 1e-4
    assert float(end_loss(-grid, targets)) > 0.5


def test_a_few_steps_of_training_lower_the_loss():
    torch.manual_seed(4)
    task = SightTask()
    batch = next(task.batches(5, 0, 1, 2))
    small = tuple(part[..., : part.shape[-2] // 4, : part.shape[-1] // 4] for part in batch)
    network = task.network()
    optimiser = torch.optim.AdamW(network.parameters(), 2e-3)
    losses = []
    for _ in range(12):
        loss = task.loss(network, small)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        losses.append(float(loss.detach()))
    assert losses[-1] < 0.8 * losses[0]
    assert set(task.metrics(network, [small])) >= {"mask_iou", "ends_found", "ends_right"}


def test_batches_of_one_seed_are_one_and_the_same():
    first, again = (next(SightTask().batches(7, 3, 1, 2)) for _ in range(2))
    assert all(torch.equal(a, b) for a, b in zip(first, again, strict=True))
