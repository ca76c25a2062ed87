"""The detectors of products that ship with the package, one for each domain."""

from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import Final

from executive.core.errors import InputError
from executive.core.registry import closest
from perception.shelf.detection.appearance import load_appearance
from perception.shelf.detection.detector import ProductDetector
from perception.shelf.detection.reading import TextReader
from perception.shelf.detection.wording import Wording
from perception.shelf.types import Shelf

FOLDER: Final = Path(str(files("perception.shelf.detection"))) / "models"


def product_detector(
    domain: str,
    wordings: Sequence[Wording],
    reader: TextReader | None,
    shelf: Shelf | None = None,
) -> ProductDetector:
    """Return the detector of a domain.

    Args:
        domain: Which model of looks to take.
        wordings: What is printed on the domain's products, in any order.
        reader: What reads labels; None for looks alone.
        shelf: The shelf; None for the thesis's.

    Raises:
        InputError: No model ships for the domain, or a product that it knows has no wording.
    """
    known = [path.stem for path in FOLDER.glob("*.json")]
    if domain not in known:
        raise InputError(f"detector: no model of {domain!r}; {closest(domain, known)}")
    appearance = load_appearance(FOLDER / f"{domain}.json")
    by_name = {wording.name: wording for wording in wordings}
    missing = [name for name in appearance.names if name not in by_name]
    if missing:
        raise InputError(f"detector of {domain}: no wording of {', '.join(missing)}")
    ordered = [by_name[name] for name in appearance.names]
    return ProductDetector(shelf or Shelf(), ordered, appearance, reader)
