"""The network that looks at a whole image: what is cable, where it ends, crosses and tangles."""

from collections.abc import Sequence

from torch import Tensor, nn

from perception.models.blocks import Down, Up, conv
from perception.models.sight_input import CHANNELS, STRIDE

# Maps on the grid, in order. Heats are logits of a middle of something in a cell.
HEATS = ("end", "crossing", "tangle")
END, CROSSING, TANGLE = range(3)
# From the middle of the cell [cells]; unit vector into the cable; logit of an end that carries
# a connector; logs of pixels; logit of a cell that shows a connector.
OFFSET, DIRECTION = slice(3, 5), slice(5, 7)
PLUGGED, LOG_WIDTH, LOG_RADIUS, CONNECTOR = 7, 8, 9, 10
GRID_MAPS = 11


class SightNet(nn.Module):
    """Map images of any size to maps of what is seen.

    Most work is done on a grid of a quarter of the resolution, where cables are still a cell
    wide.

    Args:
        widths: Number of channels at each of four resolutions, finest first.
    """

    def __init__(self, widths: Sequence[int]) -> None:
        super().__init__()
        first, second, third, last = widths
        self.unshuffle = nn.PixelUnshuffle(STRIDE)
        self.stem = nn.Sequential(conv(CHANNELS * STRIDE * STRIDE, first), conv(first, first))
        self.down1, self.down2, self.down3 = (
            Down(first, second),
            Down(second, third),
            Down(third, last),
        )
        self.around = conv(last, last)
        self.up3, self.up2, self.up1 = Up(last, third), Up(third, second), Up(second, first)
        self.mask = nn.Conv2d(first, STRIDE * STRIDE, 1)
        self.shuffle = nn.PixelShuffle(STRIDE)
        self.look = conv(first, first)
        self.grid = nn.Conv2d(first, GRID_MAPS, 1)

    def forward(self, inputs: Tensor) -> tuple[Tensor, Tensor]:
        """Return logits of cable, shape (N, 1, H, W), and maps, (N, GRID_MAPS, H / 4, W / 4).

        Args:
            inputs: From `sight_input.prepare`, shape (N, CHANNELS, H, W), both sides multiples
                of `sight_input.MULTIPLE`.
        """
        fine = self.stem(self.unshuffle(inputs))
        half = self.down1(fine)
        quarter = self.down2(half)
        coarse = self.down3(quarter)
        coarse = coarse + self.around(coarse)
        seen = self.up1(self.up2(self.up3(coarse, quarter), half), fine)
        return self.shuffle(self.mask(seen)), self.grid(self.look(seen))
