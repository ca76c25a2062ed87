"""What skills need beside the devices of a shelf cell, in whatever world: detector and reasoner."""

from collections.abc import Mapping
from typing import Literal

from perception.camera import CameraModel
from perception.shelf.affinity import AffinityMatrix, Origin, affinity_from_scores, even_rows
from perception.shelf.detections import ShelfDetector
from perception.shelf.planning.room import Reach
from perception.shelf.stock import Stock
from robots.shelf_tool import ToolShape

AffinityKind = Literal["stored", "even", "taxonomy"]


def shelf_services(
    stock: Stock,
    shape: ToolShape,
    camera: CameraModel,
    detector: ShelfDetector | None = None,
    affinity: AffinityKind = "stored",
) -> Mapping[str, object]:
    """Return the services `stock`, `detector` and `search`.

    Args:
        stock: The shelf and its products.
        shape: What the tool needs of room.
        camera: The camera at the middle viewpoint.
        detector: What finds and names objects; None for the one that goes by colours of boxes.
        affinity: Which affinities; see `shelf_affinity`.
    """
    from perception.shelf.colour_codes import ColourCodeDetector
    from perception.shelf.reasoner import SearchReasoner

    return {
        "stock": stock,
        "detector": detector or ColourCodeDetector(stock),
        "search": SearchReasoner(stock, shelf_affinity(stock, affinity), reach_of(shape), camera),
    }


def reach_of(shape: ToolShape) -> Reach:
    """Return what planning needs to know of a tool."""
    return Reach(
        shape.blade_m,
        shape.overlap_m,
        shape.gap_m,
        shape.suction,
        lift_kg=shape.lift_kg,
        lift_nm=shape.lift_nm,
    )


def product_reader(domain: str, *, text: bool) -> ShelfDetector:
    """Return the detector of labelled products of a domain.

    Args:
        domain: The domain.
        text: Whether it reads; else it goes by looks alone.

    Raises:
        InputError: Nothing has been learned of the domain's looks, or nothing here reads text.
    """
    from perception.shelf.detection.products import product_detector
    from perception.shelf.detection.reading import RapidReader
    from perception.shelf.detection.wording import Wording
    from simulation.shelf.taxonomy import shipped_domain

    wordings = [Wording(thing.name, thing.brand) for thing in shipped_domain(domain).objects]
    return product_detector(domain, wordings, RapidReader() if text else None)


def shelf_affinity(stock: Stock, kind: AffinityKind) -> AffinityMatrix:
    """Return affinities of a stock.

    Args:
        stock: The stock.
        kind: `stored` for those that ship for its domain, `even` for none, `taxonomy` for the
            oracle that simulated scenes are made from.

    Raises:
        InputError: None are stored for the domain.
    """
    if kind == "even":
        return affinity_from_scores(stock.names, even_rows(len(stock.names)), Origin("even"))
    if kind == "taxonomy":
        from simulation.shelf.taxonomy import shipped_domain, taxonomy_affinity

        rows = taxonomy_affinity(shipped_domain(stock.domain))
        return affinity_from_scores(stock.names, rows, Origin("taxonomy, an oracle"))
    from perception.shelf.language.stored import stored_affinity

    return stored_affinity(stock.domain)
