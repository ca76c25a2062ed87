"""Examples of packages for `perception.shelf.detection.appearance`, and its training.

`python -m simulation.shelf.teaching DOMAIN FILE` makes the model of a domain anew. Its seeds are
those that no benchmark uses.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from perception.shelf.detection.appearance import AppearanceModel, features_of, trained
from perception.shelf.detection.matching import matched
from perception.shelf.detection.segmenting import segmented, shelf_points
from perception.shelf.types import Floats
from simulation.shelf.labelled import LabelledShelf, Looks, overview_camera
from simulation.shelf.packages import draw_package
from simulation.shelf.scenes import Scene, SceneRules, draw_scene
from simulation.shelf.taxonomy import Domain, shipped_domain

FIRST_SEED = 7_000_000
SCENES = 400
WIDTHS_PX = (480, 640, 800)
# What is seen of an example.
LEAST_SHOWN = 0.15


def labelled_scene(
    domain: Domain, rules: SceneRules, looks: Looks, seed: int
) -> tuple[Scene, LabelledShelf]:
    """Draw a scene with an edition of each of its packages."""
    rng = np.random.default_rng(seed)
    scene = draw_scene(domain, rules, rng)
    things = {thing.name: thing for thing in domain.objects}
    packages = [
        draw_package(things[name], box.size_m, rng)
        for name, box in zip(scene.names, scene.boxes, strict=True)
    ]
    return scene, LabelledShelf(scene.shelf, scene.boxes, packages, looks, rng)


def examples(domain: Domain, seed: int) -> Iterator[tuple[str, Floats]]:
    """Yield names and features of what is told apart in a scene of its own."""
    count = 10 + seed % 9
    scene, shelf = labelled_scene(domain, SceneRules(count), Looks(), seed)
    camera = overview_camera(scene.shelf, WIDTHS_PX[seed % len(WIDTHS_PX)])
    picture = shelf.photograph(camera)
    points = shelf_points(picture.frame, scene.shelf)
    segments = segmented(points)
    shares = shelf.visible_shares(camera)
    for number, found in matched(picture.segments, segments).items():
        if shares[number] >= LEAST_SHOWN:
            mask = segments == found
            yield scene.names[number], features_of(picture.frame.colour, points, mask)


def taught(domain: Domain, scenes: int = SCENES) -> AppearanceModel:
    """Return a model of a domain's packages."""
    pairs = [pair for at in range(scenes) for pair in examples(domain, FIRST_SEED + at)]
    labels = np.array([domain.names.index(name) for name, _ in pairs])
    return trained(domain.names, np.array([features for _, features in pairs]), labels)


def main() -> None:
    """Train the model of a domain and write it."""
    name, path = sys.argv[1], Path(sys.argv[2])
    model = taught(shipped_domain(name))
    last = FIRST_SEED + SCENES - 1
    about = f"{SCENES} rendered scenes, seeds {FIRST_SEED} to {last}; simulation.shelf.teaching"
    model.save(path, name, about)


if __name__ == "__main__":
    main()
