"""The network that says which of two strands lies on top, antisymmetric by construction."""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

from perception.models.blocks import Down, conv
from perception.models.crossing_crop import SIZE

VIEW_CHANNELS = 3


class CrossingNet(nn.Module):
    """Map the two views of a crossing to the logit of "the first strand is on top".

    The same features judge both views, and the logit is the difference of their judgements,
    so exchanging the strands changes its sign and nothing else.

    Args:
        widths: Number of channels at each of four resolutions, finest first.
    """

    def __init__(self, widths: Sequence[int]) -> None:
        super().__init__()
        first, second, third, last = widths
        self.features = nn.Sequential(
            conv(VIEW_CHANNELS, first),
            Down(first, second),
            Down(second, third),
            Down(third, last),
        )
        coarse = SIZE // 8
        self.judge = nn.Sequential(
            nn.Linear(last * coarse * coarse, 64), nn.ReLU(), nn.Linear(64, 1)
        )

    def forward(self, views: Tensor) -> Tensor:
        """Return logits, shape (N,), of views, shape (N, 2, 3, S, S)."""
        judged = self.judge(torch.flatten(self.features(views.flatten(0, 1)), 1))
        first, second = judged.view(-1, 2).unbind(1)
        return first - second
