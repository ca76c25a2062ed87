"""The network that says where a cable goes on: a small U-Net over one crop."""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from perception.models.blocks import Down, Up, conv
from perception.models.tracer_crop import CELL, SIZE

CROP_CHANNELS = 3
HORIZONS = 3


class TracerNet(nn.Module):
    """Map crops to logits of where the cable is one, two and three steps ahead.

    The first step is a distribution over the cells of a grid and one more class, "the cable
    ends before"; the others only train the features to look ahead.

    Args:
        widths: Number of channels at each of four resolutions, finest first.
        zoom: Pixels of a crop a unit.
    """

    def __init__(self, widths: Sequence[int], zoom: float = 1.0) -> None:
        super().__init__()
        first, second, third, last = widths
        stride = round(CELL * zoom)
        self.unshuffle = nn.PixelUnshuffle(stride)
        self.stem = nn.Sequential(conv(CROP_CHANNELS * stride * stride, first), conv(first, first))
        self.down1, self.down2, self.down3 = (
            Down(first, second),
            Down(second, third),
            Down(third, last),
        )
        self.up3, self.up2, self.up1 = Up(last, third), Up(third, second), Up(second, first)
        self.heat = nn.Conv2d(first, HORIZONS, 1)
        coarse = SIZE // (8 * CELL)
        self.stop = nn.Linear(last * coarse * coarse, 1)

    def forward(self, crops: Tensor) -> tuple[Tensor, Tensor]:
        """Return logits of cells, shape (N, HORIZONS, G, G), and of the end, shape (N, 1)."""
        fine = self.stem(self.unshuffle(crops))
        half = self.down1(fine)
        quarter = self.down2(half)
        coarse = self.down3(quarter)
        seen = self.up1(self.up2(self.up3(coarse, quarter), half), fine)
        return self.heat(seen), self.stop(torch.flatten(coarse, 1))
