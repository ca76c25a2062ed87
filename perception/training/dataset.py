"""Sets of drawn images on disk: PNG files, the truth about each as JSON, contact sheets."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal, Self

import cv2
import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, NonNegativeInt, PositiveInt, model_validator

from executive.core.errors import InputError
from executive.core.registry import closest
from perception.training.blender import shown_by_blender
from perception.training.curves import FAMILIES
from perception.training.drawn import DrawnScene, describe_scene
from perception.training.looks import STYLES
from perception.training.scenes import Scene, SceneConfig, make_scene
from perception.training.sheets import contact_sheet, draw_truth_over

INDEX, SHEET, TRUTH_SHEET = "data.json", "sheet.png", "truth.png"
ON_SHEET = 20
# Scenes with fewer widths each way have no room for a cable.
LEAST_EXTENT, LEAST_PX = 12.0, 32
Renderer = Literal["own", "blender"]
Count = Annotated[int, Field(ge=1, le=3)]


class DataSettings(BaseModel):
    """What images a set has; together with the number of an image this gives every pixel.

    Attributes:
        format: Of the file `data.json`.
        images: How many images.
        seed: Of all of them.
        family: One family of curves, none for all.
        style: One style of looks, none for all.
        cables: Fewest and most cables in an image.
        size_px: Width and height of images, none for square ones that suit the cable.
        width_px: Narrowest and widest cable.
        renderer: What shows them: our own, or Blender.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal[1] = 1
    images: PositiveInt
    seed: NonNegativeInt = 0
    family: str | None = None
    style: str | None = None
    cables: tuple[Count, Count] = (1, 3)
    size_px: tuple[PositiveInt, PositiveInt] | None = None
    width_px: tuple[Annotated[float, Field(ge=2.0)], Annotated[float, Field(le=100.0)]] = (
        4.0,
        14.0,
    )
    renderer: Renderer = "own"

    @model_validator(mode="after")
    def _fits(self) -> Self:
        for name, value, known in (
            ("family", self.family, FAMILIES),
            ("style", self.style, STYLES),
        ):
            if value is not None and value not in known:
                raise ValueError(f"{name}: unknown; got {value!r}; {closest(value, [*known])}")
        for name, (low, high) in (("cables", self.cables), ("width", self.width_px)):
            if low > high:
                raise ValueError(f"{name}: got {low:g}-{high:g}; expected the smaller one first")
        least = max(LEAST_EXTENT * self.width_px[1], LEAST_PX)
        if self.size_px is not None and min(self.size_px) < least:
            raise ValueError(
                f"size: got {self.size_px[0]}x{self.size_px[1]}; expected at least {least:g} px "
                f"each way for cables up to {self.width_px[1]:g} px wide; try a smaller width"
            )
        return self


def draw_image(settings: DataSettings, number: int) -> Scene:
    """Return a scene of a set; each number has a seed of its own."""
    rng = np.random.default_rng([settings.seed, number])
    low, high = settings.width_px
    width_px = float(np.exp(rng.uniform(np.log(low), np.log(high))))
    chosen = SceneConfig(
        narrowest_px=width_px,
        widest_px=width_px,
        family=settings.family,
        style=settings.style,
        cables=int(rng.integers(settings.cables[0], settings.cables[1] + 1)),
    )
    if settings.size_px is not None:
        columns, rows = settings.size_px
        extent = max(columns, rows) / width_px
        chosen = replace(chosen, size_px=(rows, columns), extent=extent)
    scene = make_scene(rng, chosen)
    return shown_by_blender(rng, scene) if settings.renderer == "blender" else scene


def write_images(settings: DataSettings, folder: Path) -> Iterator[int]:
    """Write the images of a set that are not there yet, and yield the number of each.

    Raises:
        InputError: The folder holds a set with other settings.
        OSError: A file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    index = folder / INDEX
    document = settings.model_dump_json(indent=2) + "\n"
    if index.exists() and index.read_text() != document:
        raise InputError(
            f"{index}: a set with other settings; try those that it was begun with, or another "
            "folder"
        )
    _write(index, document.encode())
    for number in range(settings.images):
        path = folder / f"{number:06d}.json"
        if not path.exists():
            scene = draw_image(settings, number)
            _write(path.with_suffix(".png"), encoded(scene.image))
            # The truth comes last: an image with it is complete.
            truth = describe_scene(scene, path.with_suffix(".png").name)
            _write(path, truth.model_dump_json().encode() + b"\n")
        yield number


def write_sheets(folder: Path) -> None:
    """Write contact sheets of the first images of a set: as they are, and with the truth."""
    truths = [read_truth(path) for path in sorted(folder.glob("[0-9]*.json"))[:ON_SHEET]]
    images = [cv2.imread(str(folder / truth.image), cv2.IMREAD_GRAYSCALE) for truth in truths]
    grey = [np.asarray(image, np.uint8) for image in images]
    over = [draw_truth_over(image, truth) for image, truth in zip(grey, truths, strict=True)]
    _write(folder / SHEET, encoded(contact_sheet(grey)))
    _write(folder / TRUTH_SHEET, encoded(contact_sheet(over)[:, :, ::-1]))


def read_truth(path: Path) -> DrawnScene:
    """Return the truth about an image, from the JSON file beside it."""
    return DrawnScene.model_validate_json(path.read_text())


def encoded(image: NDArray[np.uint8]) -> bytes:
    """Return an image as the bytes of a PNG file."""
    _, packed = cv2.imencode(".png", image)
    return packed.tobytes()


def _write(path: Path, content: bytes) -> None:
    """Write a file so that nobody ever finds half of it."""
    unfinished = path.with_name(f".{path.name}")
    unfinished.write_bytes(content)
    unfinished.replace(path)
