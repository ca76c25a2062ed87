"""Train the crossing classifier: `python -m perception.training.crossing --out FOLDER`."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import cv2
import numpy as np
import torch
from torch import Tensor, nn
from torch.nn.functional import binary_cross_entropy_with_logits, softplus

from perception.cable.classifiers.passes import StrandPass, path_through
from perception.camera import GreyImage
from perception.models.crossing_ribbon import (
    CHANNELS,
    DISTANCE,
    REACH,
    make_ribbons,
    scale_for_ribbons,
)
from perception.models.crossing_ribbon_net import CrossingRibbonNet
from perception.models.frames import Crop
from perception.training.command import main
from perception.training.crossing_samples import Meeting, meetings
from perception.training.loop import Batch
from perception.training.scenes import Scene, SceneConfig, make_scene

MIXED = 512
# Small scenes have more crossings for their pixels.
EXTENTS = (28.0, 46.0)
# Thin cables are hard to tell, so this share of scenes has none wider than that [px].
THIN = (0.6, 7.0)
SCALE_ERROR = 0.18
# Cameras differ in these ways; shares of scenes, and how much.
GAMMA = (0.5, 0.6, 1.7)
SOFTER = (0.3, 0.18)
COARSER = (0.2, 3.0)


class CrossingTask:
    """Say which strand lies on top; the first one of every sample that crosses does.

    Args:
        times: How often a sample is shown; drawing one costs more than learning from it.
    """

    name = "crossing_ribbons"
    widths: tuple[int, ...] = (24, 48, 96, 128, 128)
    zoom: float = 1.0

    def __init__(self, times: int = 2) -> None:
        self._times = times

    def network(self) -> nn.Module:
        """Return a fresh network."""
        return CrossingRibbonNet(self.widths)

    def batches(self, seed: int, first: int, stride: int, size: int) -> Iterator[Batch]:
        """Yield ribbons and whether strands cross there, places of several scenes mixed."""
        ribbons: list[Crop] = []
        real: list[bool] = []
        number = first
        while True:
            rng = np.random.default_rng([seed, number])
            scene = make_scene(rng, _scene_config(rng))
            found = meetings(rng, scene)
            drawn = scene_ribbons(rng, scene, found)
            for _ in range(self._times):
                ribbons.extend(drawn)
                real.extend(meeting.real for meeting in found)
            number += stride
            while len(ribbons) >= MIXED * self._times:
                order = rng.permutation(len(ribbons))
                ribbons, real = [ribbons[k] for k in order], [real[k] for k in order]
                yield (
                    torch.from_numpy(np.stack(ribbons[:size])),
                    torch.tensor(real[:size], dtype=torch.float32),
                )
                del ribbons[:size], real[:size]

    def loss(self, network: nn.Module, batch: Batch) -> Tensor:
        """Return the cross-entropy of both answers."""
        ribbons, real = batch
        logits = network(_turned(ribbons)).float()
        on_top = (softplus(-logits[:, 0]) * real).sum() / real.sum().clamp(min=1.0)
        return on_top + 0.5 * binary_cross_entropy_with_logits(logits[:, 1], real)

    @torch.inference_mode()
    def metrics(self, network: nn.Module, batches: list[Batch]) -> dict[str, float]:
        """Return the loss and the share of right answers, of both kinds."""
        network.eval()
        logits = torch.cat([network(batch[0]).float() for batch in batches])
        real = torch.cat([batch[1] for batch in batches])
        on_top = logits[real > 0.5, 0]
        return {
            "loss": float(softplus(-on_top).mean()),
            "right": float((on_top > 0.0).float().mean()),
            "real_right": float(((logits[:, 1] > 0.0) == (real > 0.5)).float().mean()),
        }


def _scene_config(rng: np.random.Generator) -> SceneConfig:
    config = SceneConfig(extent=float(rng.choice(EXTENTS)))
    share, widest_px = THIN
    return replace(config, widest_px=widest_px) if rng.random() < share else config


def scene_ribbons(
    rng: np.random.Generator, scene: Scene, found: Sequence[Meeting]
) -> Sequence[Crop]:
    """Return the ribbons of meetings of a scene, shape (2, CHANNELS, ALONG, ACROSS) each."""
    if not found:
        return ()
    width_px = scene.width_px * float(np.exp(rng.normal(0.0, SCALE_ERROR)))
    image, shrink = _photographed(rng, scene.image, scene.width_px)
    scaled = scale_for_ribbons(image, shrink * width_px)
    paths = [
        [
            path_through(
                StrandPass(
                    scaled.into((strand.line + 0.5) * shrink - 0.5),
                    strand.at * shrink * scaled.scale,
                ),
                REACH,
                1.0,
            )
            for strand in meeting.passes
        ]
        for meeting in found
    ]
    return list(make_ribbons(scaled, np.array(paths)))


def _photographed(
    rng: np.random.Generator, image: GreyImage, width_px: float
) -> tuple[GreyImage, float]:
    """Return an image as another camera might take it, and its size over the given one's."""
    share, darkest, brightest = GAMMA
    if rng.random() < share:
        levels = 255.0 * (np.arange(256) / 255.0) ** rng.uniform(darkest, brightest)
        image = cv2.LUT(image, levels.astype(np.uint8)).astype(np.uint8)
    share, most = SOFTER
    if rng.random() < share:
        image = cv2.GaussianBlur(image, (0, 0), rng.uniform(0.05, most) * width_px).astype(np.uint8)
    share, narrowest_px = COARSER
    shrink = 1.0
    if rng.random() < share:
        shrink = rng.uniform(min(narrowest_px / width_px, 1.0), 1.0)
        image = cv2.resize(image, None, fx=shrink, fy=shrink, interpolation=cv2.INTER_AREA).astype(
            np.uint8
        )
    return image, shrink


def _turned(ribbons: Tensor) -> Tensor:
    """Return ribbons of which some run the other way, or are seen in a mirror."""
    count = len(ribbons)
    along, across, sign = (torch.rand(3, count, 2, 1, 1) < 0.5).unbind(0)
    ribbons = torch.where(along[..., None], ribbons.flip(3), ribbons)
    ribbons = torch.where(across[..., None], ribbons.flip(4), ribbons)
    sides = torch.ones(CHANNELS)
    sides[DISTANCE] = -1.0
    return torch.where(sign[..., None], ribbons * sides[:, None, None], ribbons)


if __name__ == "__main__":
    main(CrossingTask())
