"""Train the detector: `python -m perception.training.sight --out FOLDER --hours 1`."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn.functional import binary_cross_entropy_with_logits, l1_loss, logsigmoid

from perception.models import sight_net
from perception.models.sight_input import prepare
from perception.models.sight_net import SightNet
from perception.models.sight_peaks import find_peaks
from perception.training import sight_targets as wanted
from perception.training.command import main
from perception.training.loop import Batch
from perception.training.sight_scenes import SightTruth, draw_truth, relit, turned

SIDE_PX = 384
# Scenes that are kept, and seen from other sides, while new ones come.
POOL = 48
FRESH = 3
# Shares of the loss.
MASK, HEATS, END, WIDTH, RADIUS, CONNECTOR = 4.0, (1.0, 0.4, 0.3), 0.5, 2.0, 0.2, 1.0
# For the figures only: how sure, and how many cells off, counts as found.
LIKELY, NEAR_CELLS = 0.3, 2.5


class SightTask:
    """See masks, ends, crossings and tangles in whole scenes."""

    name = "sight"
    widths: tuple[int, ...] = (32, 48, 96, 128)
    zoom: float = 1.0

    def network(self) -> nn.Module:
        """Return a fresh network that takes nothing for an end, crossing or tangle."""
        network = SightNet(self.widths)
        bias = network.grid.bias
        assert bias is not None
        with torch.no_grad():
            bias[: len(sight_net.HEATS)] = -4.0
            bias[sight_net.LOG_WIDTH], bias[sight_net.LOG_RADIUS] = 2.0, 3.5
        return network

    def batches(self, seed: int, first: int, stride: int, size: int) -> Iterator[Batch]:
        """Yield inputs, masks and targets; every scene is seen about three times."""
        pool: list[SightTruth] = []
        number = first
        while True:
            rng = np.random.default_rng([seed, number])
            fresh = max(size // FRESH, 1) if len(pool) >= size else size
            for _ in range(fresh):
                pool.append(
                    draw_truth(np.random.default_rng([seed, number, 1]), (SIDE_PX, SIDE_PX))
                )
                number += stride
            del pool[:-POOL]
            chosen = rng.choice(len(pool), size, replace=False)
            yield collate([_seen_otherwise(rng, pool[k]) for k in chosen])

    def loss(self, network: nn.Module, batch: Batch) -> Tensor:
        """Return the weighted sum of all losses."""
        inputs, masks, targets = batch
        shown, grid = network(inputs.contiguous(memory_format=torch.channels_last))
        shown, grid = shown[:, 0].float(), grid.float().contiguous()
        total = MASK * binary_cross_entropy_with_logits(shown, masks)
        total = total + CONNECTOR * binary_cross_entropy_with_logits(
            grid[:, sight_net.CONNECTOR], targets[:, wanted.CONNECTOR]
        )
        for k, share in enumerate(HEATS):
            weight = targets[:, wanted.WEIGHTS.start + k]
            total = total + share * heat_loss(grid[:, k], targets[:, k], weight)
        total = total + END * end_loss(grid, targets)
        log_width, at_cable = targets[:, wanted.LOG_WIDTH], targets[:, wanted.AT_CABLE]
        total = total + WIDTH * _mean((grid[:, sight_net.LOG_WIDTH] - log_width).abs(), at_cable)
        log_radius, at_tangle = targets[:, wanted.LOG_RADIUS], targets[:, wanted.AT_TANGLE]
        return total + RADIUS * _mean((grid[:, sight_net.LOG_RADIUS] - log_radius).abs(), at_tangle)

    @torch.inference_mode()
    def metrics(self, network: nn.Module, batches: list[Batch]) -> dict[str, float]:
        """Return the loss, overlap of the cable mask, ends found and false, error of widths."""
        network.eval()
        losses, widths = [], []
        both, either, hits, ends, peaks = 0, 0, 0, 0, 0
        for batch in batches:
            losses.append(float(self.loss(network, batch)))
            inputs, masks, targets = batch
            shown, grid = network(inputs)
            cable, truth = shown[:, 0] > 0.0, masks > 0.0
            both, either = both + int((cable & truth).sum()), either + int((cable | truth).sum())
            at_cable = targets[:, wanted.AT_CABLE] > 0.0
            errors = (grid[:, sight_net.LOG_WIDTH] - targets[:, wanted.LOG_WIDTH]).abs()
            widths.append(float(errors[at_cable].mean()))
            for heat, target in zip(grid[:, 0].numpy(), targets.numpy(), strict=True):
                counted = _found(heat, target)
                hits, ends, peaks = hits + counted[0], ends + counted[1], peaks + counted[2]
        return {
            "loss": float(np.mean(losses)),
            "mask_iou": both / max(either, 1),
            "ends_found": hits / max(ends, 1),
            "ends_right": hits / max(peaks, 1),
            "width_error": float(np.mean(widths)),
        }


def _seen_otherwise(rng: np.random.Generator, truth: SightTruth) -> SightTruth:
    other = turned(truth, bool(rng.random() < 0.5), int(rng.integers(4)))
    return replace(other, image=relit(rng, other.image))


def collate(truths: list[SightTruth]) -> Batch:
    """Return inputs, masks and targets of images of one size."""
    return (
        torch.from_numpy(np.stack([prepare(truth.image) for truth in truths])),
        torch.from_numpy(np.stack([truth.cable for truth in truths]).astype(np.float32)),
        torch.from_numpy(np.stack([wanted.grid_of(truth) for truth in truths])),
    )


def heat_loss(heat: Tensor, target: Tensor, weight: Tensor) -> Tensor:
    """Return the focal loss of bumps (Law and Deng 2018; Zhou et al. 2019)."""
    belief, top = torch.sigmoid(heat), (target == 1.0).float()
    there = top * (1.0 - belief) ** 2 * -logsigmoid(heat)
    elsewhere = (1.0 - top) * (1.0 - target) ** 4 * belief**2 * -logsigmoid(-heat)
    loss: Tensor = ((there + elsewhere) * weight).sum() / top.sum().clamp(min=1.0)
    return loss


def end_loss(grid: Tensor, targets: Tensor) -> Tensor:
    """Return the errors of offset, direction and kind where ends are."""
    at_end = targets[:, wanted.AT_END]
    offset = (grid[:, sight_net.OFFSET] - targets[:, wanted.OFFSET]).abs().sum(1)
    ways = l1_loss(
        grid[:, sight_net.DIRECTION], targets[:, wanted.DIRECTION], reduction="none"
    ).sum(1)
    kind = binary_cross_entropy_with_logits(
        grid[:, sight_net.PLUGGED], targets[:, wanted.PLUGGED], reduction="none"
    )
    return _mean(offset + ways + 0.5 * kind, at_end)


def _mean(values: Tensor, weights: Tensor) -> Tensor:
    return (values * weights).sum() / weights.sum().clamp(min=1.0)


def _found(heat: wanted.Maps, target: wanted.Maps) -> tuple[int, int, int]:
    """Return how many ends are found, how many there are, and how many are claimed."""
    rows, columns, _ = find_peaks(np.ascontiguousarray(heat), LIKELY)
    counted = target[wanted.WEIGHTS.start][rows, columns] > 0.0
    claimed = np.column_stack([rows, columns])[counted]
    true = np.argwhere(target[0] == 1.0)
    gaps = (
        np.linalg.norm(true[:, None] - claimed[None], axis=2)
        if len(claimed)
        else np.full((len(true), 1), np.inf)
    )
    return int((gaps.min(axis=1) < NEAR_CELLS).sum()) if len(true) else 0, len(true), len(claimed)


if __name__ == "__main__":
    main(SightTask())
