import numpy as np
import pytest

torch = pytest.importorskip("torch")

from perception.training.loop import Recipe, Trainer  # noqa: E402  # after the skip


class Line:
    """Learn y = 2 x from noise-free points."""

    name, widths = "line", (1,)

    def network(self):
        return torch.nn.Conv2d(1, 1, 1)

    def batches(self, seed, first, stride, size):
        number = first
        while True:
            rng = np.random.default_rng([seed, number])
            number += stride
            yield (torch.from_numpy(rng.normal(size=(size, 1, 1, 1)).astype(np.float32)),)

    def loss(self, network, batch):
        return (network(batch[0]).float() - 2.0 * batch[0]).square().mean()

    def metrics(self, network, batches):
        return {"loss": float(self.loss(network, batches[0]).detach())}


def _recipe(samples):
    return Recipe(samples=samples, batch=16, rate=0.05, workers=0, held_out_batches=1, average=0.9)


def test_training_learns_and_says_so(tmp_path, capsys):
    figures = Trainer(Line(), _recipe(16 * 400), tmp_path).run()
    assert figures["loss"] < 0.05
    assert "6400 samples" in capsys.readouterr().out


def test_training_goes_on_from_its_checkpoint(tmp_path):
    Trainer(Line(), _recipe(16 * 40), tmp_path).run()
    again = Trainer(Line(), _recipe(16 * 60), tmp_path)
    assert again.seen == 16 * 40
    again.run()
    assert again.seen == 16 * 60
