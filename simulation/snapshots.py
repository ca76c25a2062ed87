"""The table cell at one moment as bytes: what a simulated mission goes on from.

Only the world reads them. They hold the truth about the cable, so they are in recordings as
they are, and no skill gets to see them.
"""

import io
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from executive.core.errors import InputError
from robots.interfaces import ARMS
from simulation.arms_driver import DriverState
from simulation.cable.rod_state import RodState
from simulation.table_world import WorldState

FORMAT = 1
_ROD = "rod."


@dataclass(frozen=True, slots=True, eq=False)
class TableSnapshot:
    """The table cell at one moment.

    Attributes:
        world: Arms and cable.
        camera: State of the generator behind the camera's noise.
    """

    world: WorldState
    camera: Mapping[str, Any]

    def to_bytes(self) -> bytes:
        """Return it as the bytes of a compressed NumPy archive."""
        rod = self.world.rod
        arrays = {f"{_ROD}{field.name}": getattr(rod, field.name) for field in fields(RodState)}
        driver = self.world.driver
        words = {
            "format": FORMAT,
            "steps": self.world.steps,
            "still_steps": self.world.still_steps,
            "grips": driver.grips,
            "openings_m": driver.openings_m,
            "camera": self.camera,
        }
        arrays |= {"joints": self.world.joints, "target_rad": driver.target_rad}
        buffer = io.BytesIO()
        np.savez_compressed(buffer, words=np.array(json.dumps(words)), **arrays)
        return buffer.getvalue()

    @classmethod
    def from_bytes(cls, data: bytes) -> "TableSnapshot":
        """Read it back.

        Raises:
            InputError: These are no such bytes.
        """
        try:
            arrays = _arrays(data)
            words = json.loads(str(arrays["words"]))
            if words["format"] != FORMAT:
                raise ValueError(f"format {words['format']}; expected {FORMAT}")
            rod = RodState(**{field.name: arrays[_ROD + field.name] for field in fields(RodState)})
            driver = DriverState(
                target_rad=arrays["target_rad"],
                grips={arm: words["grips"][arm] for arm in ARMS},
                openings_m={arm: float(words["openings_m"][arm]) for arm in ARMS},
            )
            world = WorldState(words["steps"], words["still_steps"], arrays["joints"], driver, rod)
        except (ValueError, KeyError, OSError, EOFError, zipfile.BadZipFile) as cause:
            raise InputError(
                f"snapshot: cannot be read; got {cause}; expected one of this cell"
            ) from cause
        return cls(world, words["camera"])


def _arrays(data: bytes) -> dict[str, NDArray[Any]]:
    with np.load(io.BytesIO(data), allow_pickle=False) as archive:
        return {name: archive[name] for name in archive.files}
