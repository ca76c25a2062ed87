"""Scenes as Blender's path tracer shows them: a second look at the same truth.

Blender runs in a process of its own (`perception.training.blender_script`), which alone loads
the package `bpy`. That package is under the GPL and asks for an older NumPy than the project
does, which what is used of it does without; so it is no extra, and comes only by hand.
"""

import subprocess
import sys
import tempfile
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import cv2
import numpy as np
from pydantic import BaseModel, ConfigDict

from executive.core.errors import InputError
from perception.training.drawn import DrawnScene, describe_scene
from perception.training.looks import draw_look
from perception.training.photograph import photograph
from perception.training.scenes import Scene

PACKAGE = "bpy==4.5.15"
SAMPLES = 12
SCRIPT = "perception.training.blender_script"


class BlenderJob(BaseModel):
    """What Blender is to show.

    Attributes:
        scene: Cables and connectors.
        table: Grey value of the table, from 0 to 255.
        grain: How uneven it is, as a share of its grey value.
        cables: Grey value of each cable.
        connector: Grey value of the connectors.
        roughness: Of the cables, 0 for a mirror.
        sun_rad: Direction that the sun shines in: round the vertical, and from it.
        sun_size_rad: How large the sun is, so how soft its shadows are.
        fill: Light from everywhere, over that of the sun.
        samples: Rays a pixel.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    scene: DrawnScene
    table: float
    grain: float
    cables: list[float]
    connector: float
    roughness: float
    sun_rad: tuple[float, float]
    sun_size_rad: float
    fill: float
    samples: int = SAMPLES


def need_blender() -> None:
    """Make sure that Blender is there.

    Raises:
        InputError: It is not.
    """
    if find_spec("bpy") is None:
        raise InputError(
            "--renderer blender: needs bpy, which is not installed; "
            f"try pip install --no-deps {PACKAGE}, or --renderer own"
        )


def shown_by_blender(rng: np.random.Generator, scene: Scene) -> Scene:
    """Return a scene with another image of it.

    Raises:
        InputError: Blender cannot show it.
    """
    look = draw_look(rng, len(scene.cables), style="shaded")
    job = BlenderJob(
        scene=describe_scene(scene, "image.png"),
        table=look.table.level,
        grain=look.table.texture,
        cables=[cable.brightness for cable in look.cables],
        connector=float(rng.uniform(10.0, 245.0)),
        roughness=float(rng.uniform(0.15, 0.9)),
        sun_rad=(float(rng.uniform(0.0, 2.0 * np.pi)), float(rng.uniform(0.0, 1.0))),
        sun_size_rad=float(rng.uniform(0.01, 0.8)),
        fill=float(rng.uniform(0.1, 0.8)),
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "job.json"
        path.write_text(job.model_dump_json())
        ended = subprocess.run(
            [sys.executable, "-m", SCRIPT, path], capture_output=True, text=True, check=False
        )
        picture = cv2.imread(str(path.with_name("image.png")), cv2.IMREAD_GRAYSCALE)
    if picture is None:
        raise InputError(f"--renderer blender: no image; Blender says: {ended.stderr[-500:]}")
    seen = photograph(rng, picture.astype(np.float32), scene.width_px, look.lens)
    return replace(scene, image=seen)
