"""What can be set about the shelf cell: light to import, checked before anything is built."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

Share = Annotated[float, Field(ge=0.0, le=1.0)]
NotNegative = Annotated[float, Field(ge=0.0)]
Positive = Annotated[float, Field(gt=0.0)]
Span = tuple[Positive, Positive]


class _Document(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class CameraConfig(_Document):
    """The camera on the tool.

    Attributes:
        width_px: Image width; the height is three quarters of it.
        depth_noise_m: Standard deviation of measured depth.
        lost_share: Share of pixels without depth.
        colour_noise: Standard deviation of each colour, in grey values.
        drop_share: Share of frames that are dropped.
        calibration_m: Standard deviation of where the camera is on the tool, each axis.
        calibration_rad: Standard deviation of how it is turned, about each axis.
    """

    width_px: Annotated[int, Field(ge=64, le=1280)] = 160
    depth_noise_m: NotNegative = 0.001
    lost_share: Share = 0.01
    colour_noise: NotNegative = 2.0
    drop_share: Share = 0.0
    calibration_m: NotNegative = 0.0
    calibration_rad: NotNegative = 0.0


class ToolConfig(_Document):
    """The bluction tool.

    Attributes:
        pressure_pa: What the cups pull, below the air around.
        friction: Of a cup's lip on a face.
        force_noise_n: Standard deviation of the force sensor, each axis.
        lane_m: Room that the blade is given beside an object.
    """

    pressure_pa: Annotated[float, Field(ge=0.0, le=101_325.0)] = 70_000.0
    friction: Positive = 0.6
    force_noise_n: NotNegative = 0.03
    lane_m: Annotated[float, Field(ge=0.012, le=0.05)] = 0.014


class MatterConfig(_Document):
    """What boxes are made of: each draws evenly between two ends.

    Attributes:
        density_kg_m3: Least and greatest density.
        friction: Least and greatest friction.
    """

    density_kg_m3: Span = (150.0, 500.0)
    friction: Span = (0.25, 0.45)

    @model_validator(mode="after")
    def _ordered(self) -> "MatterConfig":
        for name, (low, high) in (
            ("density_kg_m3", self.density_kg_m3),
            ("friction", self.friction),
        ):
            if low > high:
                raise ValueError(f"{name}: got [{low:g}, {high:g}]; expected low <= high")
        return self


class PhysicsConfig(_Document):
    """How finely time is cut.

    Attributes:
        step_hz: Steps of the physics a second.
        joint_states_hz: Recorded joint states a second.
        scene_hz: Recorded scenes a second.
    """

    step_hz: Annotated[int, Field(ge=120, le=2000)] = 240
    joint_states_hz: Annotated[int, Field(ge=1, le=60)] = 20
    scene_hz: Annotated[int, Field(ge=1, le=60)] = 5


class ShelfCellConfig(_Document):
    """The cell itself.

    Attributes:
        camera: The camera on the tool.
        tool: The bluction tool.
        matter: What the boxes are made of.
        physics: How finely time is cut.
        detector: `colour` reads products by the colours of their boxes; `oracle` is told by the
            world what each pixel shows, for experiments with nothing to detect.
        affinity: `stored` for the matrix that ships for the domain, `even` for none, `taxonomy`
            for the oracle that the scenes are made from.
    """

    camera: CameraConfig = CameraConfig()
    tool: ToolConfig = ToolConfig()
    matter: MatterConfig = MatterConfig()
    physics: PhysicsConfig = PhysicsConfig()
    detector: Literal["colour", "oracle"] = "colour"
    affinity: Literal["stored", "even", "taxonomy"] = "stored"


class ShelfScenario(_Document):
    """What a mission finds in the shelf: a scene as `simulation.shelf.scenes` draws it.

    Attributes:
        domain: What kind of shelf it is.
        count: Objects on it.
        organisation: Share of objects that stand where they belong.
        scale: Factor on sizes; the domain's when not given.
        stacked: Share of objects that stand on another one, where they fit.
    """

    domain: str = "pharmacy"
    count: Annotated[int, Field(ge=2, le=60)] = 15
    organisation: Share = 1.0
    scale: Annotated[float, Field(gt=0.0, le=1.0)] | None = None
    stacked: Share = 0.0
