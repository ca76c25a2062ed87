"""From the tracer network's logits to distributions, for training and for tracing."""

import torch
from torch import Tensor

from perception.models.tracer_crop import CELL

# Spread of the training target [cells]; below one cell the place within a cell would be lost.
SPREAD = 0.8


def step_logits(heat: Tensor, stop: Tensor) -> Tensor:
    """Return logits of every cell (row by row) and, last, of the end; shape (N, G * G + 1)."""
    return torch.cat([heat[:, 0].flatten(1), stop], dim=1).float()


def cell_targets(points_crop: Tensor, grid: int) -> Tensor:
    """Return a distribution over cells around each point, shape (N, G * G)."""
    # A cell's middle lies half a cell, less half a pixel, after its first pixel.
    centres = torch.arange(grid) * CELL + 0.5 * (CELL - 1)
    over_x, over_y = (
        torch.exp(-(((points_crop[:, k : k + 1] - centres) / (SPREAD * CELL)) ** 2) / 2.0)
        for k in (0, 1)
    )
    weights = (over_y[:, :, None] * over_x[:, None, :]).flatten(1)
    return weights / weights.sum(1, keepdim=True).clamp_min(1e-12)
