import os
import signal

import numpy as np
import pytest

pytest.importorskip("torch")

import torch

from executive.core.errors import InputError
from perception.training import loop
from perception.training.loop import Trainer, TrainingStoppedError
from perception.training.recipes import Recipe


class Line:
    """Learn y = 2 x from points, some of which are left out by chance."""

    name, widths, zoom = "line", (1,), 1.0

    def network(self):
        return torch.nn.Sequential(torch.nn.Conv2d(1, 4, 1), torch.nn.Conv2d(4, 1, 1))

    def batches(self, seed, first, stride, size):
        number = first
        while True:
            rng = np.random.default_rng([seed, number])
            number += stride
            yield (torch.from_numpy(rng.normal(size=(size, 1, 1, 1)).astype(np.float32)),)

    def loss(self, network, batch):
        kept = (torch.rand(len(batch[0]), 1, 1, 1) < 0.8).float()
        return (kept * (network(batch[0]).float() - 2.0 * batch[0])).square().mean()

    def metrics(self, network, batches):
        return {"loss": float(self.loss(network, batches[0]).detach())}


class Told:
    """Remembers what a training tells, and asks it to stop after some samples."""

    def __init__(self, stop_at=None):
        self.stop_at, self.steps = stop_at, []

    def step(self, progress):
        self.steps.append(progress)
        if progress.seen == self.stop_at:
            os.kill(os.getpid(), signal.SIGINT)

    def figures(self, progress, figures): ...

    def note(self, text): ...


def _recipe(samples, **changed):
    settings = {"batch": 16, "rate": 0.05, "workers": 0, "held_out_batches": 1, "average": 0.9}
    return Recipe(samples=samples, **settings | changed)


def _weights(trainer):
    both = [*trainer.network.parameters(), *trainer.average.parameters()]
    return torch.cat([weight.detach().flatten() for weight in both])


def test_training_learns_and_says_so(tmp_path, capsys):
    figures = Trainer(Line(), _recipe(16 * 120), tmp_path).run()
    assert figures["loss"] < 0.2
    assert "1920 of 1920 samples" in capsys.readouterr().out


@pytest.mark.parametrize("workers", [0, 1])
def test_a_stopped_training_goes_on_as_if_it_had_not_been(tmp_path, monkeypatch, workers):
    # A round's end lies between the stops, and another one behind them.
    monkeypatch.setattr(loop, "ROUND", 8)
    recipe = _recipe(16 * 20, workers=workers, report_s=1e-9)
    (tmp_path / "whole").mkdir()
    whole = Trainer(Line(), recipe, tmp_path / "whole")
    whole.run(Told())
    for stop_at in (16 * 3, 16 * 13):
        with pytest.raises(TrainingStoppedError, match="stopped after"):
            Trainer(Line(), recipe, tmp_path).run(Told(stop_at))
    stopped = Trainer(Line(), recipe, tmp_path)
    assert stopped.seen == 16 * 13
    stopped.run(Told())
    assert torch.equal(_weights(stopped), _weights(whole))


def test_a_finished_training_stays_as_it_is(tmp_path):
    recipe = _recipe(16 * 20)
    before = Trainer(Line(), recipe, tmp_path)
    before.run(Told())
    again = Trainer(Line(), recipe, tmp_path)
    again.run(Told())
    assert torch.equal(_weights(before), _weights(again))


def test_hours_are_process_time(tmp_path, monkeypatch):
    slept = iter(np.arange(0.0, 1e9, 3600.0))
    monkeypatch.setattr(loop.time, "perf_counter", lambda: float(next(slept)))
    told = Told()
    Trainer(Line(), _recipe(16 * 5, hours=0.5), tmp_path).run(told)
    # The clock on the wall has run for hours, the process has not.
    assert [progress.seen for progress in told.steps] == [16, 32, 48, 64, 80]
    assert told.steps[-1].hours < 0.01


def test_progress_says_what_is_left(tmp_path):
    told = Told()
    Trainer(Line(), _recipe(16 * 100, stop=16 * 50), tmp_path).run(told)
    assert told.steps[-1].seen == told.steps[-1].samples == 16 * 50
    assert told.steps[-1].left_s == 0.0
    assert told.steps[24].left_s > 0.0
    assert told.steps[24].share == pytest.approx(0.5)


def test_a_checkpoint_of_another_network_is_refused(tmp_path):
    Trainer(Line(), _recipe(16), tmp_path).run(Told())
    other = Line()
    other.name = "curve"
    with pytest.raises(InputError, match=r"got 'line'; expected 'curve'"):
        Trainer(other, _recipe(16), tmp_path)
