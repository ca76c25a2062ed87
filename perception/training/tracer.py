"""Train the tracer: `python -m perception.training.tracer --out FOLDER --hours 2`."""

from collections import deque
from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn.functional import log_softmax

from perception.models.frames import Crop, Floats
from perception.models.tracer_crop import CELL, SIZE
from perception.models.tracer_math import cell_targets, step_logits
from perception.models.tracer_net import TracerNet
from perception.training.command import main
from perception.training.loop import Batch
from perception.training.scenes import SceneConfig
from perception.training.tracer_samples import NOWHERE, SampleConfig, sample_stream

LATER_STEPS = 0.3
REPLAY_AFTER = 40
MIXED = 1024
# Half a cable width.
HIT_CROP_PX = 2.25
# Cables in images are about as wide as this lets them be seen.
ZOOM = 1.5
# Places where a cable turns back tightly are rare, and a trace that steps over one is wrong.
HAIRPINS = 0.3


def mirrored(batch: Batch) -> Batch:
    """Return a batch seen in a mirror along the direction of travel."""
    crops, targets = batch
    turned = targets.clone()
    turned[:, :, 1] = SIZE - 1 - targets[:, :, 1]
    turned[targets[:, :, 0] <= NOWHERE] = NOWHERE
    return crops.flip(2), turned


class TracerTask:
    """Predict where the cable goes on."""

    name = "tracer"
    widths: tuple[int, ...] = (32, 48, 96, 160)
    zoom: float = ZOOM

    def network(self) -> nn.Module:
        """Return a fresh network."""
        return TracerNet(self.widths, self.zoom)

    def batches(self, seed: int, first: int, stride: int, size: int) -> Iterator[Batch]:
        """Yield crops and targets; every batch comes back once, mirrored, some time later."""
        waiting: deque[Batch] = deque()
        for batch in self._fresh(seed, first, stride, size):
            yield batch
            waiting.append(batch)
            if len(waiting) > REPLAY_AFTER:
                yield mirrored(waiting.popleft())

    def _fresh(self, seed: int, first: int, stride: int, size: int) -> Iterator[Batch]:
        crops: list[Crop] = []
        targets: list[Floats] = []
        for samples in sample_stream(
            seed, first, stride, SceneConfig(hairpins=HAIRPINS), SampleConfig(zoom=self.zoom)
        ):
            crops.extend(samples.crops)
            targets.extend(samples.targets)
            while len(crops) >= MIXED:
                # Samples of one scene are spread over batches.
                chosen = np.random.default_rng([seed, len(crops)]).permutation(len(crops))[:size]
                yield (
                    torch.from_numpy(np.stack([crops[k] for k in chosen])),
                    torch.from_numpy(np.stack([targets[k] for k in chosen])).float(),
                )
                left = sorted(set(range(len(crops))) - set(chosen.tolist()))
                crops, targets = [crops[k] for k in left], [targets[k] for k in left]

    def loss(self, network: nn.Module, batch: Batch) -> Tensor:
        """Return the cross-entropy of the first step, and a share of that of later ones."""
        crops, targets = batch
        heat, stop = network(crops.contiguous(memory_format=torch.channels_last))
        grid, total = heat.shape[-1], torch.zeros(())
        gone = targets[:, :, 0] <= NOWHERE
        for k in range(targets.shape[1]):
            wanted = cell_targets(targets[:, k], grid)
            if k == 0:
                wanted = torch.cat([wanted, torch.zeros(len(crops), 1)], dim=1)
                wanted[gone[:, 0]] = 0.0
                wanted[gone[:, 0], -1] = 1.0
                total = total - (wanted * log_softmax(step_logits(heat, stop), 1)).sum(1).mean()
            else:
                logs = log_softmax(heat[:, k].flatten(1).float(), 1)
                kept = (~gone[:, k]).float()
                total = total - LATER_STEPS * ((wanted * logs).sum(1) * kept).mean()
        return total

    @torch.inference_mode()
    def metrics(self, network: nn.Module, batches: list[Batch]) -> dict[str, float]:
        """Return the loss, and how often the best cell, or the end, is right."""
        network.eval()
        losses, hits, ends, false_ends = [], [], [], []
        for batch in batches:
            crops, targets = batch
            losses.append(float(self.loss(network, batch)))
            heat, stop = network(crops)
            grid = heat.shape[-1]
            best = step_logits(heat, stop).argmax(1)
            gone = targets[:, 0, 0] <= NOWHERE
            found = torch.stack([best % grid, best // grid], 1) * CELL + 0.5
            near = (found - targets[:, 0]).norm(dim=1) < HIT_CROP_PX
            stopped = best == grid * grid
            hits.append((near & ~stopped)[~gone])
            false_ends.append(stopped[~gone])
            ends.append(stopped[gone])
        return {
            "loss": float(np.mean(losses)),
            "hit": float(torch.cat(hits).float().mean()),
            "false_end": float(torch.cat(false_ends).float().mean()),
            "end": float(torch.cat(ends).float().mean()),
        }


if __name__ == "__main__":
    main(TracerTask())
