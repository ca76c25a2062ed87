"""The scene that a scenario asks for: the same for a seed, in whatever world."""

import numpy as np

from perception.camera import CameraModel
from perception.shelf.types import Shelf
from simulation.shelf.scenes import Scene, SceneRules, draw_scene
from simulation.shelf.taxonomy import shipped_domain
from simulation.shelf_cell.config import ShelfScenario


def drawn_scene(
    wanted: ShelfScenario, shelf: Shelf, camera: CameraModel, rng: np.random.Generator
) -> Scene:
    """Draw a scene.

    Args:
        wanted: What the scenario asks for.
        shelf: The shelf.
        camera: From where the target must be hidden.
        rng: Source of chance.

    Raises:
        InputError: No such scene can be made.
    """
    rules = SceneRules(wanted.count, wanted.organisation, wanted.scale, stacked=wanted.stacked)
    return draw_scene(shipped_domain(wanted.domain), rules, rng, shelf, camera)
