"""The network that says which of two strands lies on top, antisymmetric by construction."""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from perception.models.blocks import Down, conv
from perception.models.crossing_ribbon import ACROSS, ALONG

RIBBON_CHANNELS = 2
SEEN = 64


class CrossingRibbonNet(nn.Module):
    """Map both ribbons of a crossing to two logits: first strand on top, and strands cross.

    The same features see both ribbons. A judge compares them in one order and in the other;
    the first logit is the difference of its two answers, so that exchanging the strands changes
    the sign and nothing else, the second logit is the sum of its other two.

    Args:
        widths: Number of channels at each of four resolutions, finest first.
    """

    def __init__(self, widths: Sequence[int]) -> None:
        super().__init__()
        first, second, third, last = widths
        self.features = nn.Sequential(
            conv(RIBBON_CHANNELS, first),
            Down(first, second),
            Down(second, third),
            Down(third, last),
        )
        coarse = (ALONG // 8 + 1) * (ACROSS // 8 + 1)
        self.see = nn.Sequential(nn.Linear(last * coarse, SEEN), nn.ReLU())
        self.judge = nn.Sequential(nn.Linear(2 * SEEN, SEEN), nn.ReLU(), nn.Linear(SEEN, 2))

    def forward(self, ribbons: Tensor) -> Tensor:
        """Return logits, shape (N, 2), of ribbons, shape (N, 2, 2, ALONG, ACROSS)."""
        features = self.features(ribbons.flatten(0, 1))
        seen = self.see(torch.flatten(features, 1)).view(-1, 2, SEEN)
        there = self.judge(seen.flatten(1))
        back = self.judge(seen.flip(1).flatten(1))
        return torch.stack([there[:, 0] - back[:, 0], there[:, 1] + back[:, 1]], dim=1)
