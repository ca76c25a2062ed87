"""Layers that the networks share."""

from torch import Tensor, nn


def conv(inputs: int, outputs: int, stride: int = 1) -> nn.Sequential:
    """Return a 3 x 3 convolution with batch normalisation and rectifier."""
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False),
        nn.BatchNorm2d(outputs),
        nn.ReLU(inplace=True),
    )


class Down(nn.Module):
    """Halve the resolution, then look once more."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        self.halve = conv(inputs, outputs, stride=2)
        self.refine = conv(outputs, outputs)

    def forward(self, features: Tensor) -> Tensor:
        """Return features of half the size."""
        halved: Tensor = self.halve(features)
        refined: Tensor = self.refine(halved)
        return halved + refined


class Up(nn.Module):
    """Double the resolution and add what the way down saw there."""

    def __init__(self, inputs: int, outputs: int) -> None:
        super().__init__()
        self.narrow = nn.Conv2d(inputs, outputs, 1)
        self.grow = nn.Upsample(scale_factor=2, mode="nearest")
        self.refine = conv(outputs, outputs)

    def forward(self, features: Tensor, skip: Tensor) -> Tensor:
        """Return features of the size of `skip`."""
        grown: Tensor = self.grow(self.narrow(features)) + skip
        refined: Tensor = self.refine(grown)
        return refined
