"""The network that says which of two strands lies on top, antisymmetric by construction."""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from perception.models.blocks import Down, conv
from perception.models.crossing_ribbon import ACROSS, ALONG, CHANNELS


class CrossingRibbonNet(nn.Module):
    """Map both ribbons of a crossing to two logits: first strand on top, and strands cross.

    The same features see both ribbons. A judge compares them in one order and in the other;
    the first logit is the difference of its two answers, so that exchanging the strands changes
    the sign and nothing else, the second logit is the sum of its other two.

    Args:
        widths: Number of channels at each of four resolutions, finest first, and of features that
            the judge is told of each ribbon.
    """

    def __init__(self, widths: Sequence[int]) -> None:
        super().__init__()
        first, second, third, last, self.told = widths
        self.features = nn.Sequential(
            conv(CHANNELS, first),
            Down(first, second),
            Down(second, third),
            Down(third, last),
        )
        coarse = (ALONG // 8 + 1) * (ACROSS // 8 + 1)
        self.see = nn.Sequential(nn.Linear(last * coarse, self.told), nn.ReLU())
        self.judge = nn.Sequential(
            nn.Linear(2 * self.told, self.told), nn.ReLU(), nn.Linear(self.told, 2)
        )

    def forward(self, ribbons: Tensor) -> Tensor:
        """Return logits, shape (N, 2), of ribbons, shape (N, 2, CHANNELS, ALONG, ACROSS)."""
        features = self.features(ribbons.flatten(0, 1))
        seen = self.see(torch.flatten(features, 1)).view(-1, 2, self.told)
        there = self.judge(seen.flatten(1))
        back = self.judge(seen.flip(1).flatten(1))
        return torch.stack([there[:, 0] - back[:, 0], there[:, 1] + back[:, 1]], dim=1)
