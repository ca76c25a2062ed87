"""Train the crossing classifier: `python -m perception.training.crossing --out FOLDER`."""

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn.functional import softplus

from perception.models import crossing_crop
from perception.models.crossing_crop import make_views
from perception.models.crossing_net import CrossingNet
from perception.models.frames import Crop, Floats, scale_image
from perception.training.command import main
from perception.training.loop import Batch
from perception.training.scenes import Scene, SceneConfig, make_scene

MIXED = 512
MOST_OF_SCENE = 24
SCALE_ERROR = 0.12
# Errors of traces [cable widths].
PLACE_ERROR = 0.3
STRAND_ERROR = 0.15


class CrossingTask:
    """Say which strand lies on top; the first one of every sample does."""

    name = "crossing"
    widths: tuple[int, ...] = (16, 32, 64, 96)
    zoom: float = 1.0

    def network(self) -> nn.Module:
        """Return a fresh network."""
        return CrossingNet(self.widths)

    def batches(self, seed: int, first: int, stride: int, size: int) -> Iterator[Batch]:
        """Yield views of crossings, samples of several scenes mixed."""
        views: list[Crop] = []
        number = first
        while True:
            rng = np.random.default_rng([seed, number])
            views.extend(crossing_views(rng, make_scene(rng, SceneConfig())))
            number += stride
            while len(views) >= MIXED:
                rng.shuffle(views)
                yield (torch.from_numpy(np.stack(views[:size])),)
                del views[:size]

    def loss(self, network: nn.Module, batch: Batch) -> Tensor:
        """Return the cross-entropy."""
        loss: Tensor = softplus(-network(batch[0]).float()).mean()
        return loss

    @torch.inference_mode()
    def metrics(self, network: nn.Module, batches: list[Batch]) -> dict[str, float]:
        """Return the loss and the share of right answers."""
        network.eval()
        logits = torch.cat([network(batch[0]).float() for batch in batches])
        return {
            "loss": float(softplus(-logits).mean()),
            "right": float((logits > 0.0).float().mean()),
        }


def crossing_views(rng: np.random.Generator, scene: Scene) -> list[Crop]:
    """Return views of crossings of a scene, the upper strand first, with errors of traces."""
    width_px = scene.width_px * float(np.exp(rng.normal(0.0, SCALE_ERROR)))
    scaled = scale_image(scene.image, width_px, crossing_crop.WIDTH)
    lines = [scaled.into(cable.points_px) for cable in scene.cables]
    chosen = rng.permutation(len(scene.crossings))[:MOST_OF_SCENE]
    views = []
    for index in chosen:
        crossing = scene.crossings[index]
        over, under = (
            _piece(lines[cable], node) for cable, node in (crossing.over, crossing.under)
        )
        middle = 0.5 * (_at(lines, crossing.over) + _at(lines, crossing.under))
        if not scaled.holds(middle):
            continue
        middle = middle + rng.normal(0.0, PLACE_ERROR * rng.random() * crossing_crop.WIDTH, 2)
        views.append(make_views(scaled, middle, (_disturbed(rng, over), _disturbed(rng, under))))
    return views


def _at(lines: list[Floats], place: tuple[int, float]) -> Floats:
    line, node = lines[place[0]], place[1]
    return np.array([np.interp(node, np.arange(len(line)), axis) for axis in line.T])


def _piece(line: Floats, node: float) -> Floats:
    """Return the part of a line, half a width a node, that a view shows."""
    nodes = int(2.0 * crossing_crop.REACH / crossing_crop.WIDTH)
    first = max(int(node) - nodes, 0)
    return line[first : int(node) + nodes + 2]


def _disturbed(rng: np.random.Generator, piece: Floats) -> Floats:
    error = STRAND_ERROR * rng.random() * crossing_crop.WIDTH
    shift = rng.normal(0.0, error, 2)
    return piece + shift + rng.normal(0.0, 0.5 * error, piece.shape)


if __name__ == "__main__":
    main(CrossingTask())
