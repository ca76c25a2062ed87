import json

import pytest

pytest.importorskip("torch")
pytest.importorskip("safetensors.torch")

import safetensors.torch
import torch

from executive.core.errors import InputError
from perception.models.crossing_ribbon import ACROSS, ALONG, CHANNELS
from perception.models.crossing_ribbon_net import CrossingRibbonNet
from perception.models.store import load_network
from perception.models.tracer_math import cell_targets, step_logits
from perception.models.tracer_net import TracerNet

WIDTHS = (8, 8, 16, 16)


def _saved(folder, name, network):
    safetensors.torch.save_file(network.state_dict(), folder / "weights.safetensors")
    (folder / "config.json").write_text(json.dumps({"network": name, "widths": WIDTHS}))


def test_exchanging_ribbons_changes_one_sign_and_nothing_else():
    torch.manual_seed(1)
    network = CrossingRibbonNet((*WIDTHS, 16)).eval()
    ribbons = torch.randn(5, 2, CHANNELS, ALONG, ACROSS)
    exchanged = network(ribbons.flip(1)) * torch.tensor([-1.0, 1.0])
    assert torch.allclose(network(ribbons), exchanged, atol=1e-5)
    assert (network(ribbons)[:, 0].abs() > 1e-4).all()


def test_loading_folds_normalisation_without_changing_answers(tmp_path):
    torch.manual_seed(2)
    network = TracerNet(WIDTHS)
    network.train()(torch.randn(8, 3, 64, 64))
    _saved(tmp_path, "tracer", network)
    crops = torch.randn(2, 3, 64, 64)
    folded = load_network(tmp_path)
    assert not any(isinstance(part, torch.nn.BatchNorm2d) for part in folded.modules())
    for ours, theirs in zip(folded(crops), network.eval()(crops), strict=True):
        assert torch.allclose(ours, theirs, atol=1e-4)


def test_an_unknown_network_is_named(tmp_path):
    _saved(tmp_path, "oracle", CrossingRibbonNet((*WIDTHS, 16)))
    with pytest.raises(InputError, match=r"'oracle'.*known: crossing_ribbons, .*tracer"):
        load_network(tmp_path)


def test_step_logits_have_one_class_for_the_end():
    heat, stop = TracerNet(WIDTHS).eval()(torch.zeros(2, 3, 64, 64))
    assert step_logits(heat, stop).shape == (2, 32 * 32 + 1)


def test_cell_targets_are_distributions_around_the_point():
    point = torch.tensor([[33.2, 20.7]])
    cells = cell_targets(point, 32)[0].view(32, 32)
    centres = torch.arange(32) * 2 + 0.5
    assert float(cells.sum()) == pytest.approx(1.0, abs=1e-5)
    assert float(cells.sum(0) @ centres) == pytest.approx(33.2, abs=0.1)
    assert float(cells.sum(1) @ centres) == pytest.approx(20.7, abs=0.1)
