"""What is known beforehand of the products that a shelf may hold."""

from collections.abc import Mapping
from dataclasses import dataclass

from executive.core.errors import InputError
from executive.core.registry import closest
from perception.shelf.types import Shelf, Size


@dataclass(frozen=True, slots=True)
class Product:
    """One product.

    Attributes:
        name: What it is called.
        size_m: Width, depth and height of its box.
        colour: Red, green and blue of its box in plain light, 0 to 255.
    """

    name: str
    size_m: Size
    colour: tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Stock:
    """A shelf, the products that it may hold, and the one that is asked for.

    Attributes:
        domain: Which shelf it is; affinities are stored by it.
        shelf: Its inside.
        products: All products that may stand there.
        wanted: Name of the product that is asked for; empty when none is.
    """

    domain: str
    shelf: Shelf
    products: tuple[Product, ...]
    wanted: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all products."""
        return tuple(product.name for product in self.products)

    @property
    def sizes_m(self) -> Mapping[str, Size]:
        """Sizes by name."""
        return {product.name: product.size_m for product in self.products}

    def product(self, name: str) -> Product:
        """Return a product by name.

        Raises:
            InputError: There is none of that name.
        """
        for product in self.products:
            if product.name == name:
                return product
        raise InputError(f"stock: no product {name!r}; {closest(name, list(self.names))}")
