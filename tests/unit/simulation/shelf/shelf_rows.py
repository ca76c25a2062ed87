"""Small scenes by hand."""

from perception.shelf.types import Box, Shelf
from simulation.shelf.scenes import Scene

CUBE = (0.06, 0.06, 0.08)
# What is named so is small enough to vanish behind one of the others.
HIDDEN = "hidden"
SMALL = (0.05, 0.05, 0.04)


def scene_of(target="", **places):
    """Return a scene of like cuboids, by the (x, y) of their centres."""
    boxes = tuple(
        Box(x_m, y_m, SMALL if name == HIDDEN else CUBE) for name, (x_m, y_m) in places.items()
    )
    return Scene(Shelf(), tuple(places), boxes, target)
