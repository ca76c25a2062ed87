"""What can be set about the kinematic shelf cell: light to import, checked before it is built."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

# Of narrower images labels cannot be read.
LEGIBLE_PX = 320

Share = Annotated[float, Field(ge=0.0, le=1.0)]


class _Document(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class ToolConfig(_Document):
    """The tool and its luck.

    Attributes:
        suction: Whether it has a cup.
        blade_m: Thickness of the blade.
        missed: How often the cup does not take hold.
        lost: How often an object falls off on its way.
        toppled: How often a pushed object that is tall falls over.
    """

    suction: bool = True
    blade_m: Annotated[float, Field(ge=0.0, le=0.05)] = 0.01
    missed: Share = 0.05
    lost: Share = 0.02
    toppled: Share = 0.02


class CameraConfig(_Document):
    """The camera.

    Attributes:
        width_px: Width of the image; its height is three quarters of that.
        depth_noise_m: Standard deviation of depth.
        lost_share: Share of pixels without depth.
        colour_noise: Standard deviation of each colour, in grey values.
    """

    width_px: Annotated[int, Field(ge=80, le=640)] = 160
    depth_noise_m: Annotated[float, Field(ge=0.0, le=0.02)] = 0.0015
    lost_share: Share = 0.01
    colour_noise: Annotated[float, Field(ge=0.0, le=50.0)] = 5.0


class ShelfCellConfig(_Document):
    """The cell itself.

    Attributes:
        tool: The tool.
        camera: The camera.
        detector: `colour` reads products by the colours of their boxes; `oracle` is told by the
            world what each pixel shows, for experiments with nothing to detect; with `product` and
            `looks` boxes carry labels, and the detector of products goes by looks and text, or by
            looks alone, in images of at least 320 px.
        affinity: `stored` for the matrix that ships for the domain, `even` for none, `taxonomy`
            for the oracle that the scenes are made from.
    """

    tool: ToolConfig = ToolConfig()
    camera: CameraConfig = CameraConfig()
    detector: Literal["colour", "oracle", "product", "looks"] = "colour"
    affinity: Literal["stored", "even", "taxonomy"] = "stored"

    @property
    def labelled(self) -> bool:
        """Whether boxes carry labels."""
        return self.detector in ("product", "looks")

    @model_validator(mode="after")
    def _legible(self) -> "ShelfCellConfig":
        if self.labelled and self.camera.width_px < LEGIBLE_PX:
            raise ValueError(
                f"camera.width_px: got {self.camera.width_px}; expected at least {LEGIBLE_PX} "
                f"with the detector {self.detector!r}; try camera.width_px=480"
            )
        return self
