"""Train the spatial network: `python -m perception.training.thesis_spatial --out FOLDER`."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

from perception.models.spatial_input import Maps, prepare
from perception.models.spatial_net import USUAL, SpatialNet
from perception.training.command import main
from perception.training.loop import Batch
from perception.training.shelf_samples import HiddenSample, hidden_samples

# Samples that are kept, and seen again with other noise or in a mirror, while new ones come.
POOL = 1024
FRESH = 4
# Most noise of depth [m], and most of it that is lost.
NOISE_M, LOST = 0.003, 0.03


class ThesisSpatialTask:
    """Say where a hidden target of known size may show, from one look of a depth camera."""

    name = "thesis_spatial"
    widths: tuple[int, ...] = (16, 32, 48, 64)
    zoom: float = 1.0

    def network(self) -> nn.Module:
        """Return a fresh network."""
        return SpatialNet(self.widths)

    def batches(self, seed: int, first: int, stride: int, size: int) -> Iterator[Batch]:
        """Yield inputs and roots of shares; every sample is seen about four times."""
        pool: list[HiddenSample] = []
        number = first
        while True:
            fresh = max(size // FRESH, 1) if len(pool) >= 2 * size else 2 * size
            wanted = len(pool) + fresh
            while len(pool) < wanted:
                pool.extend(hidden_samples(np.random.default_rng([seed, number])))
                number += stride
            del pool[:-POOL]
            rng = np.random.default_rng([seed, number, 1])
            chosen = rng.choice(len(pool), size, replace=False)
            yield collate([noisy(rng, pool[k]) for k in chosen])

    def loss(self, network: nn.Module, batch: Batch) -> Tensor:
        """Return the mean square error of roots."""
        inputs, roots = batch
        told = network(inputs.contiguous(memory_format=torch.channels_last)).float()
        loss: Tensor = (told - roots).square().mean()
        return loss

    @torch.inference_mode()
    def metrics(self, network: nn.Module, batches: list[Batch]) -> dict[str, float]:
        """Return the loss, and how far distributions along the shelf are alike."""
        network.eval()
        told = torch.cat([network(batch[0]).float() for batch in batches])
        roots = torch.cat([batch[1] for batch in batches])
        alike = likeness(told, roots)
        return {
            "loss": float((told - roots).square().mean()),
            "overlap": float(alike.overlap.mean()),
            "best_column_right": float(alike.best_right.mean()),
        }


@dataclass(frozen=True, slots=True, eq=False)
class Likeness:
    """How well distributions along the shelf are told, of each look with any.

    Attributes:
        overlap: What told and exact distribution have in common, in [0, 1], shape (N,).
        best_right: 1 where the column that is said to be likeliest has at least half of what the
            likeliest has, shape (N,).
    """

    overlap: Tensor
    best_right: Tensor


def likeness(told: Tensor, roots: Tensor) -> Likeness:
    """Compare what a network tells with what it is to tell, roots both, (N, ROWS, COLUMNS)."""
    columns, exact = (maps.square().sum(1) for maps in (told, roots))
    some = exact.sum(1) > 0.0
    columns, exact = columns[some] + 1e-12, exact[some]
    shares = [each / each.sum(1, keepdim=True) for each in (columns, exact)]
    there = exact.gather(1, columns.argmax(1, keepdim=True))[:, 0]
    return Likeness(torch.minimum(*shares).sum(1), (there >= 0.5 * exact.amax(1)).to(torch.float32))


def noisy(rng: np.random.Generator, sample: HiddenSample) -> tuple[Maps, Maps]:
    """Return the input of a sample as some camera sees it, perhaps in a mirror, and its answer."""
    depth_m = sample.depth_m + rng.normal(0.0, rng.uniform(0.0, NOISE_M), sample.depth_m.shape)
    depth_m[rng.random(depth_m.shape) < rng.uniform(0.0, LOST)] = np.nan
    share = sample.share
    if rng.random() < 0.5:
        depth_m, share = depth_m[:, ::-1], share[:, ::-1]
    inputs = prepare(depth_m, sample.window, sample.shelf, sample.target_m)
    return inputs, np.sqrt(share / np.float32(USUAL))


def collate(samples: list[tuple[Maps, Maps]]) -> Batch:
    """Return inputs and answers of samples."""
    inputs, roots = zip(*samples, strict=True)
    return torch.from_numpy(np.stack(inputs)), torch.from_numpy(np.stack(roots))


if __name__ == "__main__":
    main(ThesisSpatialTask())
