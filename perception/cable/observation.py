"""One image looked at once: mask and skeleton graph, which most steps start from."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Protocol

import numpy as np

from perception.cable.gaps import close_gaps
from perception.cable.graph import SkeletonGraph, build_graph
from perception.cable.mask import CableMask, MaskConfig, find_mask
from perception.cable.plug_ends import with_plugs
from perception.cable.plugs import Plug, find_plugs
from perception.camera import GreyImage


@dataclass(frozen=True, slots=True, eq=False)
class Observation:
    """What is seen of cables in one image.

    Attributes:
        mask: Cable pixels.
        graph: Their centre lines.
    """

    mask: CableMask
    graph: SkeletonGraph


class Observe(Protocol):
    """Looks at an image; `observe` is one."""

    def __call__(self, image: GreyImage, /) -> Observation | None:
        """Return mask and graph of an image; None where no cable is seen."""
        ...


def observe(image: GreyImage, config: MaskConfig | None = None) -> Observation | None:
    """Return mask and graph of an image; None where no cable is seen.

    The steps of perception ask one after the other about the same image, so the last answers
    are kept; they depend on nothing but the pixels and the settings.
    """
    return _observe(image.tobytes(), image.shape, config or MaskConfig())


@lru_cache(maxsize=2)
def _observe(pixels: bytes, shape: tuple[int, int], config: MaskConfig) -> Observation | None:
    image = np.frombuffer(pixels, dtype=np.uint8).reshape(shape)
    mask = find_mask(image, config)
    return observation_of(mask, lambda closed: find_plugs(image, closed)) if mask else None


def observation_of(
    mask: CableMask, plugs_in: Callable[[CableMask], Sequence[Plug]]
) -> Observation | None:
    """Return a mask with its gaps closed, and the graph of its centre lines; None without any.

    Args:
        mask: Cable pixels.
        plugs_in: Returns the connectors in the mask.
    """
    graph = build_graph(mask)
    if graph.edges and (closed := close_gaps(mask, graph)) is not None:
        mask, graph = closed, build_graph(closed)
    if not graph.edges:
        return None
    return Observation(mask, with_plugs(graph, plugs_in(mask), mask.width_px))
