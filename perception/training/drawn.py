"""The truth about a drawn image as a file: one JSON document beside each PNG."""

from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict

from perception.training.connectors import Kind
from perception.training.scenes import Scene
from perception.training.sight_scenes import truth_of

Point = tuple[float, float]

DECIMALS = 4


class _Document(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class DrawnCable(_Document):
    """One cable.

    Attributes:
        width_px: Its width.
        points_px: Centre line (x, y), nodes half a width of the scene's cables apart.
        heights: Height of each node above the table [widths of the scene's cables].
    """

    width_px: float
    points_px: list[Point]
    heights: list[float]


class DrawnPlace(_Document):
    """A place along a cable.

    Attributes:
        cable: Number of the cable, from 0.
        node: Number of the node, with fraction.
    """

    cable: int
    node: float


class DrawnCrossing(_Document):
    """Where two strands cross.

    Attributes:
        position_px: Where, in the image.
        over: The upper strand.
        under: The lower strand.
    """

    position_px: Point
    over: DrawnPlace
    under: DrawnPlace


class DrawnEnd(_Document):
    """One end of a cable.

    Attributes:
        cable: Number of the cable.
        position_px: Last point of its centre line; it may lie outside the image.
        inwards: Unit vector into the cable.
        connector: What it carries there, null for a bare end.
        outline_px: Corners of all parts of the connector.
        covered: Whether strands lie over the connector, not under it.
        visible: Whether no strand lies over it.
    """

    cable: int
    position_px: Point
    inwards: Point
    connector: Kind | None
    outline_px: list[list[Point]]
    covered: bool
    visible: bool


class DrawnScene(_Document):
    """Everything that is true about an image.

    Attributes:
        format: Of this document.
        image: Name of the PNG beside it.
        size_px: Width and height of the image.
        width_px: Width of the scene's cables; single ones may differ from it.
        cables: All cables.
        crossings: Where strands cross, but for those that a connector hides and those of
            strands at nearly one height.
        ends: Both ends of each cable, the first one of each first.
    """

    format: Literal[1] = 1
    image: str
    size_px: tuple[int, int]
    width_px: float
    cables: list[DrawnCable]
    crossings: list[DrawnCrossing]
    ends: list[DrawnEnd]


def describe_scene(scene: Scene, image: str) -> DrawnScene:
    """Return the truth about a scene whose image is stored as `image`."""
    rows, columns = scene.image.shape
    truth = truth_of(scene)
    kinds = {(each.cable, each.end): each for each in scene.connectors}
    carried = [kinds.get((k, end)) for k in range(len(scene.cables)) for end in (0, 1)]
    return DrawnScene(
        image=image,
        size_px=(columns, rows),
        width_px=round(scene.width_px, DECIMALS),
        cables=[
            DrawnCable(
                width_px=round(cable.width_px, DECIMALS),
                points_px=_points(cable.points_px),
                heights=np.round(cable.heights, DECIMALS).tolist(),
            )
            for cable in scene.cables
        ],
        crossings=[
            DrawnCrossing(
                position_px=_points(place[None])[0],
                over=DrawnPlace(cable=crossing.over[0], node=round(crossing.over[1], DECIMALS)),
                under=DrawnPlace(cable=crossing.under[0], node=round(crossing.under[1], DECIMALS)),
            )
            for crossing, place in zip(scene.crossings, truth.crossings, strict=True)
        ],
        ends=[
            DrawnEnd(
                cable=number // 2,
                position_px=_points(truth.ends[None, number])[0],
                inwards=_points(truth.inwards[None, number])[0],
                connector=None if plug is None else plug.kind,
                outline_px=[] if plug is None else [_points(part) for part in plug.outlines_px],
                covered=plug is not None and plug.covered,
                visible=bool(truth.visible[number]),
            )
            for number, plug in enumerate(carried)
        ],
    )


def _points(points: NDArray[np.float64]) -> list[Point]:
    return [(round(float(x), DECIMALS), round(float(y), DECIMALS)) for x, y in points]
