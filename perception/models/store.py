"""Read trained versions: a folder with weights, config, recipe, figures and a card."""

from collections.abc import Callable, Sequence
from pathlib import Path

import torch
from pydantic import BaseModel, ConfigDict
from safetensors import SafetensorError
from safetensors.torch import load_file
from torch import nn
from torch.nn.utils.fusion import fuse_conv_bn_eval

from executive.core.errors import InputError
from executive.core.json_files import read_json
from perception.models.checksums import check_checksum
from perception.models.crossing_ribbon_net import CrossingRibbonNet
from perception.models.sight_net import SightNet
from perception.models.spatial_net import SpatialNet
from perception.models.thesis_crossing_net import ThesisCrossingNet
from perception.models.tracer_net import TracerNet

FOLDER = Path(__file__).parent
NETWORKS: dict[str, Callable[[Sequence[int], float], nn.Module]] = {
    "tracer": TracerNet,
    "sight": lambda widths, _: SightNet(widths),
    "crossing_ribbons": lambda widths, _: CrossingRibbonNet(widths),
    "thesis_crossing": lambda widths, _: ThesisCrossingNet(widths),
    "thesis_spatial": lambda widths, _: SpatialNet(widths),
}


class ModelConfig(BaseModel):
    """The file `config.json` of a trained version.

    Attributes:
        network: Which network.
        widths: Its numbers of channels.
        temperature: What its logits are divided by, from held-out data.
        bias: What is then added to them.
        zoom: Pixels of a crop a unit of `perception.models.frames`.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    network: str
    widths: tuple[int, ...]
    temperature: float = 1.0
    bias: float = 0.0
    zoom: float = 1.0


def read_config(folder: Path) -> ModelConfig:
    """Read the config of a trained version.

    Raises:
        InputError: There is none, or it is damaged.
    """
    return read_json(folder / "config.json", ModelConfig, "the config of a network")


def load_network(folder: Path) -> nn.Module:
    """Return a trained network, ready to run, its normalisations folded into convolutions.

    Raises:
        InputError: The config names a network that does not exist, or its weights are damaged
            or not those that were trained.
    """
    config = read_config(folder)
    if config.network not in NETWORKS:
        known = ", ".join(sorted(NETWORKS))
        raise InputError(
            f"{folder / 'config.json'}: network: unknown; got {config.network!r}; "
            f"expected one of the networks (known: {known})"
        )
    network = NETWORKS[config.network](config.widths, config.zoom)
    weights = folder / "weights.safetensors"
    check_checksum(weights)
    try:
        network.load_state_dict(load_file(weights))
    except (OSError, RuntimeError, SafetensorError) as error:
        why = str(error).partition("\n")[0]
        raise InputError(
            f"{weights}: are no weights of the network {config.network!r}; got {why}; "
            "try git checkout of the file, or training it anew"
        ) from None
    network.eval()
    _fold(network)
    return network.to(memory_format=torch.channels_last)


def _fold(module: nn.Module) -> None:
    """Replace each convolution and its normalisation by one convolution, in place."""
    for child in module.children():
        if (
            isinstance(child, nn.Sequential)
            and isinstance(child[0], nn.Conv2d)
            and isinstance(child[1], nn.BatchNorm2d)
        ):
            child[0] = fuse_conv_bn_eval(child[0], child[1])
            child[1] = nn.Identity()
        else:
            _fold(child)
