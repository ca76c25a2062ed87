"""What the keeper of a simulated shelf knows beforehand: products, sizes, colours of boxes."""

import colorsys

import numpy as np

from perception.shelf.stock import Product, Stock
from simulation.shelf.scenes import Scene
from simulation.shelf.taxonomy import Domain, ShelfObject

# Colours of boxes: hues all round, strong and pale ones in turn.
SATURATIONS = (0.95, 0.5)
BRIGHTNESS = 0.85


def stock_of(domain: Domain, scene: Scene) -> Stock:
    """Return the stock of a domain, with the sizes of this scene's objects.

    Products that are not on the shelf have the middle of their sizes. What stands where is not in
    it, nor which products do.
    """
    sizes = {name: box.size_m for name, box in zip(scene.names, scene.boxes, strict=True)}
    colours = _colours(len(domain.objects))
    products = tuple(
        Product(thing.name, sizes.get(thing.name) or _middle(thing, domain.scale), colour)
        for thing, colour in zip(domain.objects, colours, strict=True)
    )
    return Stock(domain.name, scene.shelf, products, scene.target)


def _middle(thing: ShelfObject, scale: float) -> tuple[float, float, float]:
    width_m, depth_m, height_m = (
        0.5 * scale * sum(ends) for ends in (thing.width_m, thing.depth_m, thing.height_m)
    )
    return width_m, depth_m, height_m


def _colours(count: int) -> list[tuple[int, int, int]]:
    shares = np.arange(count) / count
    rows = [
        colorsys.hsv_to_rgb(share, SATURATIONS[number % 2], BRIGHTNESS)
        for number, share in enumerate(shares.tolist())
    ]
    return [(round(255 * red), round(255 * green), round(255 * blue)) for red, green, blue in rows]
