"""What can be set about the table cell: light to import, checked before anything is built."""

from collections.abc import Mapping
from typing import Annotated, Literal, Self, TypeGuard, TypeVar, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from pydantic_core import ErrorDetails

from executive.core.errors import InputError
from executive.core.registry import closest
from simulation.cable.knot_names import KnotName, PairName, TierName

Stiffness = Literal["soft", "usual", "stiff"]


class _Document(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class CableScenario(_Document):
    """What lies on the table: from a file, else of a tier, else with one knot.

    Attributes:
        knot: Which knot is tied into a cable that is laid at random.
        tier: One of the thesis's tiers instead: which knots, how many crossings, and how the
            cable lies is drawn.
        leaves_view: Whether one end of a tier's cable is out of the camera's view; drawn where
            it is None.
        file: JSON file `{"nodes_m": [[x, y, z], ...]}` whose centre line is laid instead.
    """

    knot: KnotName = "overhand"
    tier: TierName | None = None
    leaves_view: bool | None = None
    file: str = ""

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        if self.file and self.tier is not None:
            raise ValueError("a cable comes from a file or is of a tier; try leaving one out")
        if self.leaves_view is not None and self.tier is None:
            raise ValueError("leaves_view is for cables of a tier; try adding tier: C1")
        return self


class OneCable(_Document):
    """One of several cables: from a file, else laid at random.

    Attributes:
        knot: Which knot is tied into it.
        length_m: How long it is.
        file: JSON file `{"nodes_m": [[x, y, z], ...]}` whose centre line is laid instead.
    """

    knot: KnotName = "none"
    length_m: Annotated[float, Field(ge=0.8, le=3.0)] = 1.5
    file: str = ""


class ArmsScenario(_Document):
    """What goes wrong with the arms; the seed decides when.

    Attributes:
        miss_rate: Share of closings at which the fingers take nothing, and stay open.
        slip_rate: Share of grasps out of which the cable slips some seconds later.
        stop_rate: Share of motions that end on the way, as at a protective stop.
    """

    miss_rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    slip_rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    stop_rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0


class CameraScenario(_Document):
    """What goes wrong with the camera.

    Attributes:
        freezes_after: Frames after which it hands out the last one for ever.
    """

    freezes_after: Annotated[int, Field(ge=1)] | None = None


class TableScenario(_Document):
    """What a mission finds in the cell.

    Attributes:
        cable: The only cable.
        cables: Several cables instead, all laid at random or all from files.
        tied: What ties the first two of them together; two plain cables if none are given.
        arms: What goes wrong with the arms.
        camera: What goes wrong with the camera.
    """

    cable: CableScenario = CableScenario()
    cables: Annotated[tuple[OneCable, ...], Field(max_length=4)] = ()
    tied: PairName | None = None
    arms: ArmsScenario = ArmsScenario()
    camera: CameraScenario = CameraScenario()

    @model_validator(mode="after")
    def _fit_together(self) -> Self:
        from_files = [bool(cable.file) for cable in self.cables]
        if any(from_files) and not all(from_files):
            raise ValueError("some cables come from files and some do not; try files for all")
        if self.tied is None:
            return self
        if any(from_files) or any(cable.knot != "none" for cable in self.cables[:2]):
            raise ValueError("tied is for two cables without knots or files; try leaving them out")
        if len(self.cables) == 1:
            raise ValueError("tied takes two cables, got 1; try leaving cables out")
        return self


class CameraConfig(_Document):
    """The overhead camera.

    Attributes:
        height_m: Above the table's surface.
        scale_m_px: What a pixel covers on the table's surface.
        blur_px: Standard deviation of the lens's blur.
        read_noise: Noise in the dark, in grey values.
        speckle: Factor on the flicker of surfaces under the projector.
        depth_noise_m: Standard deviation of measured depth.
        calibration_error_m: Standard deviation of each coordinate of where the camera is taken
            to be; drawn once a run.
        calibration_error_rad: Standard deviation of its orientation about each axis.
        focal_error: Standard deviation of its focal length, as a share of it.
        drop_rate: Share of frames that never arrive; the next one is taken instead.
    """

    height_m: Annotated[float, Field(gt=0.8, le=3.0)] = 1.15
    scale_m_px: Annotated[float, Field(gt=0.0, le=0.01)] = 0.00102
    blur_px: Annotated[float, Field(ge=0.0, le=1.5)] = 0.7
    read_noise: Annotated[float, Field(ge=0.0)] = 0.8
    speckle: Annotated[float, Field(ge=0.0)] = 1.0
    depth_noise_m: Annotated[float, Field(ge=0.0)] = 0.0005
    calibration_error_m: Annotated[float, Field(ge=0.0, le=0.05)] = 0.0
    calibration_error_rad: Annotated[float, Field(ge=0.0, le=0.1)] = 0.0
    focal_error: Annotated[float, Field(ge=0.0, le=0.1)] = 0.0
    drop_rate: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0


class PhysicsConfig(_Document):
    """How finely time is cut.

    Attributes:
        step_hz: Steps of arms and cable a second.
        joint_states_hz: Recorded joint states a second.
        scene_hz: Recorded scenes a second.
    """

    step_hz: Annotated[int, Field(ge=60, le=2000)] = 240
    joint_states_hz: Annotated[int, Field(ge=1, le=60)] = 20
    scene_hz: Annotated[int, Field(ge=1, le=60)] = 5


class CableConfig(_Document):
    """What cables in this cell are made of.

    Attributes:
        stiffness: A `soft` cable keeps to curves of 3 cm radius, the `usual` one of 5 cm, a
            `stiff` one of 8 cm.
        connector_mass_kg: Of the plug at each end.
        friction_table: Coulomb coefficient of cable on cloth.
    """

    stiffness: Stiffness = "usual"
    connector_mass_kg: Annotated[float, Field(ge=0.0, le=0.1)] = 0.004
    friction_table: Annotated[float, Field(ge=0.0, le=2.0)] = 0.4


class LayoutConfig(_Document):
    """Where the robot stands, behind the long side of the table; `cellwright doctor` judges it.

    Attributes:
        robot_y_m: Of the body's frame, from the table's centre.
        body_z_m: Of the body's frame, from the table's surface; the feet are 0.10 m lower.
    """

    robot_y_m: Annotated[float, Field(ge=-1.5, le=-0.36)] = -0.425
    body_z_m: Annotated[float, Field(ge=-0.4, le=0.4)] = -0.10


class TableCellConfig(_Document):
    """The cell itself."""

    camera: CameraConfig = CameraConfig()
    cable: CableConfig = CableConfig()
    layout: LayoutConfig = LayoutConfig()
    physics: PhysicsConfig = PhysicsConfig()


Model = TypeVar("Model", bound=BaseModel)


def read_settings(model: type[Model], values: Mapping[str, object], where: str) -> Model:
    """Check a mapping against a model.

    Args:
        model: What is expected.
        values: What was given.
        where: Begins each line of the message.

    Raises:
        InputError: Unknown keys or wrong values, all of them, one a line.
    """
    try:
        return model.model_validate(dict(values))
    except ValidationError as error:
        lines = [f"{where}: {_fault(model, detail)}" for detail in error.errors()]
        raise InputError("\n".join(lines)) from None


def _fault(model: type[BaseModel], detail: ErrorDetails) -> str:
    path = [str(part) for part in detail["loc"]]
    name = ".".join(path)
    if detail["type"] == "extra_forbidden":
        known = _fields(model, path[:-1])
        return f"{name}: unknown key; {closest(path[-1], known)}"
    if detail["type"] == "literal_error":
        expected = detail["ctx"]["expected"]
        return f"{name}: got {detail['input']!r}; expected {expected}"
    if detail["type"] == "value_error":
        return f"{name}: {detail['ctx']['error']}" if path else str(detail["ctx"]["error"])
    expected = detail["msg"].replace("Input should be", "expected", 1)
    return f"{name}: got {detail['input']!r}; {expected}"


def _is_model(kind: object) -> TypeGuard[type[BaseModel]]:
    return isinstance(kind, type) and issubclass(kind, BaseModel)


def _fields(model: type[BaseModel], path: list[str]) -> list[str]:
    for part in path:
        if part.isdigit():  # within a list, whose items have been looked up already
            continue
        annotation = model.model_fields[part].annotation
        model = next(kind for kind in (annotation, *get_args(annotation)) if _is_model(kind))
    return list(model.model_fields)
