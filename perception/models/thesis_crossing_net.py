"""The thesis's classifier: a residual network of 34 layers that judges one visit by itself.

K. He et al., Deep Residual Learning for Image Recognition, CVPR 2016, table 1: 3, 4, 6 and 3
blocks of two convolutions each. Channels are half as many, so that weights stay small.
"""

from collections.abc import Sequence

import torch
from torch import Tensor, nn

VISIT_CHANNELS = 3
BLOCKS = (3, 4, 6, 3)


def _normed(inputs: int, outputs: int, size: int, stride: int) -> nn.Sequential:
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, size, stride, size // 2, bias=False), nn.BatchNorm2d(outputs)
    )


class ResidualBlock(nn.Module):
    """Two convolutions beside a way round them."""

    def __init__(self, inputs: int, outputs: int, stride: int) -> None:
        super().__init__()
        self.first = _normed(inputs, outputs, 3, stride)
        self.second = _normed(outputs, outputs, 3, 1)
        same = inputs == outputs and stride == 1
        self.round = nn.Identity() if same else _normed(inputs, outputs, 1, stride)

    def forward(self, features: Tensor) -> Tensor:
        """Return features, of half the size where the stride is 2."""
        inner: Tensor = self.second(torch.relu(self.first(features)))
        return torch.relu(inner + self.round(features))


class ThesisCrossingNet(nn.Module):
    """Map visits of crossings to the logit of "this strand is on top".

    Args:
        widths: Numbers of channels of the four stages, finest first.
    """

    def __init__(self, widths: Sequence[int]) -> None:
        super().__init__()
        self.stem = _normed(VISIT_CHANNELS, widths[0], 7, 2)
        blocks: list[nn.Module] = []
        inputs = widths[0]
        for stage, (outputs, count) in enumerate(zip(widths, BLOCKS, strict=True)):
            for number in range(count):
                stride = 2 if stage > 0 and number == 0 else 1
                blocks.append(ResidualBlock(inputs, outputs, stride))
                inputs = outputs
        self.blocks = nn.Sequential(*blocks)
        self.judge = nn.Linear(inputs, 1)

    def forward(self, visits: Tensor) -> Tensor:
        """Return logits, shape (N,), of visits, shape (N, 3, S, S)."""
        features = torch.max_pool2d(torch.relu(self.stem(visits)), 3, 2, 1)
        logits: Tensor = self.judge(self.blocks(features).mean((2, 3)))
        return logits[:, 0]
