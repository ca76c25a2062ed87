"""Train the thesis's classifier: `python -m perception.training.thesis_crossing --out FOLDER`."""

from collections.abc import Iterator

import cv2
import numpy as np
import torch
from torch import Tensor, nn
from torch.nn.functional import binary_cross_entropy_with_logits

from perception.cable.classifiers.passes import StrandPass, path_through
from perception.models.frames import Crop, scale_image
from perception.models.thesis_crossing_crop import REACH, WIDTH, make_visit
from perception.models.thesis_crossing_net import ThesisCrossingNet
from perception.training.command import main
from perception.training.crossing_samples import MeetingConfig, meetings
from perception.training.loop import Batch
from perception.training.scenes import Scene, SceneConfig, make_scene

MIXED = 512
SCALE_ERROR = 0.12
ONLY_CROSSINGS = MeetingConfig(exchanged=0)
# What the thesis does to simulated images.
SHARPEN = np.array([[0.0, -0.25, 0.0], [-0.25, 2.0, -0.25], [0.0, -0.25, 0.0]], np.float32)
NOISE = (2.0, 6.0)
BRIGHTER = (5.0, 15.0)


class ThesisCrossingTask:
    """Say of each visit of a crossing whether its strand is on top; the first of a pair is."""

    name = "thesis_crossing"
    widths: tuple[int, ...] = (32, 64, 128, 256)
    zoom: float = 1.0

    def network(self) -> nn.Module:
        """Return a fresh network."""
        return ThesisCrossingNet(self.widths)

    def batches(self, seed: int, first: int, stride: int, size: int) -> Iterator[Batch]:
        """Yield visits, shape (N, 2, 3, S, S), crossings of several scenes mixed."""
        pairs: list[Crop] = []
        number = first
        while True:
            rng = np.random.default_rng([seed, number])
            pairs.extend(crossing_visits(rng, make_scene(rng, SceneConfig())))
            number += stride
            while len(pairs) >= MIXED:
                rng.shuffle(pairs)
                yield (torch.from_numpy(np.stack(pairs[:size])),)
                del pairs[:size]

    def loss(self, network: nn.Module, batch: Batch) -> Tensor:
        """Return the cross-entropy of visits by themselves."""
        logits = network(batch[0].flatten(0, 1)).float()
        wanted = torch.tensor([1.0, 0.0]).repeat(len(batch[0]))
        return binary_cross_entropy_with_logits(logits, wanted)

    @torch.inference_mode()
    def metrics(self, network: nn.Module, batches: list[Batch]) -> dict[str, float]:
        """Return the loss and the share of visits that are right."""
        network.eval()
        logits = torch.cat([network(batch[0].flatten(0, 1)).float() for batch in batches])
        wanted = torch.tensor([1.0, 0.0]).repeat(len(logits) // 2)
        return {
            "loss": float(binary_cross_entropy_with_logits(logits, wanted)),
            "right": float(((logits > 0.0) == (wanted > 0.5)).float().mean()),
        }


def crossing_visits(rng: np.random.Generator, scene: Scene) -> list[Crop]:
    """Return both visits of crossings of a scene, the upper strand's first, (2, 3, S, S) each."""
    width_px = scene.width_px * float(np.exp(rng.normal(0.0, SCALE_ERROR)))
    scaled = scale_image(scene.image, width_px, WIDTH)
    pairs = []
    for meeting in meetings(rng, scene, ONLY_CROSSINGS):
        strands = [
            StrandPass(scaled.into(strand.line), strand.at * scaled.scale)
            for strand in meeting.passes
        ]
        visits = [make_visit(scaled, path_through(strand, REACH, 1.0)) for strand in strands]
        pairs.append(np.stack([_augmented(rng, visit) for visit in visits]))
    return pairs


def _augmented(rng: np.random.Generator, visit: Crop) -> Crop:
    """Return a visit with sharpened, noisy and brighter grey values."""
    grey = cv2.filter2D(visit[2], -1, SHARPEN, borderType=cv2.BORDER_REFLECT) * 255.0
    grey += rng.normal(0.0, rng.uniform(*NOISE), grey.shape) + rng.uniform(*BRIGHTER)
    visit[2] = grey.clip(0.0, 255.0) / 255.0
    return visit


if __name__ == "__main__":
    main(ThesisCrossingTask())
