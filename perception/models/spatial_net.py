"""The network in LAX-RAY's manner: where a hidden target may show, from depth and its size."""

from collections.abc import Sequence

from torch import Tensor, nn
from torch.nn.functional import softplus

from perception.models.blocks import Down, Up, conv
from perception.models.spatial_input import CHANNELS

# A usual share of poses that show in one pixel: the root is told in units of its root.
USUAL = 0.02


class SpatialNet(nn.Module):
    """Map looks into a shelf to the root of the occupancy distribution of a target.

    LAX-RAY's network has one output for each of a few proportions of targets; this one is told
    the size. Roots, since a distribution is small nearly everywhere.

    Args:
        widths: Number of channels at each of four resolutions, finest first.
    """

    def __init__(self, widths: Sequence[int]) -> None:
        super().__init__()
        first, second, third, last = widths
        self.stem = nn.Sequential(conv(CHANNELS, first), conv(first, first))
        self.down1, self.down2, self.down3 = (
            Down(first, second),
            Down(second, third),
            Down(third, last),
        )
        self.around = conv(last, last)
        self.up3, self.up2, self.up1 = Up(last, third), Up(third, second), Up(second, first)
        self.tell = nn.Conv2d(first, 1, 1)

    def forward(self, inputs: Tensor) -> Tensor:
        """Return roots of shares of poses that would show over `USUAL`, (N, ROWS, COLUMNS).

        Args:
            inputs: From `spatial_input.prepare`, shape (N, CHANNELS, ROWS, COLUMNS).
        """
        fine = self.stem(inputs)
        half = self.down1(fine)
        quarter = self.down2(half)
        coarse = self.down3(quarter)
        coarse = coarse + self.around(coarse)
        seen = self.up1(self.up2(self.up3(coarse, quarter), half), fine)
        return softplus(self.tell(seen)[:, 0] - 3.0)
