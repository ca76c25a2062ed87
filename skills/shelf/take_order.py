"""Know what is to be searched for."""

from typing import Annotated

from executive.core.outcome import failure, success
from executive.core.registry import closest
from executive.core.skill import In, Port, Skill, SkillRun
from perception.shelf.stock import Stock


class TakeOrder(Skill):
    """Take what is asked for: the product that is named, else the one the cell has an order for.

    SUCCESS: `target` is a product of the stock.
    FAILURE: `order.none` when nothing is asked for; `order.unknown` when the stock has no such
        product.
    """

    OUT = {"target": Port(str, "name of the product to search for")}
    REASONS = frozenset({"order.none", "order.unknown"})

    def __init__(self, stock: Stock) -> None:
        """Bind what is known of the products."""
        self._stock = stock

    def run(
        self, name: Annotated[str, In("name of a product; empty takes the cell's order")] = ""
    ) -> SkillRun:
        """Look the product up."""
        yield from ()
        target = name or self._stock.wanted
        if not target:
            return failure("order.none", "no product is named, and the cell has no order")
        if target not in self._stock.names:
            known = closest(target, list(self._stock.names))
            return failure("order.unknown", f"no product {target!r}; {known}", name=target)
        return success(target=target)
