"""The shelf as it was: where each object stood when it was first seen (thesis, section 6.3)."""

from collections.abc import Iterable, Mapping

from perception.shelf.types import Box, Sighting


class OriginalScene:
    """Remembers first places, since a search disorders the shelf that it learns from."""

    def __init__(self) -> None:
        """Begin with nothing seen."""
        self._boxes: dict[str, Box] = {}

    @property
    def boxes(self) -> Mapping[str, Box]:
        """First known box of every object seen so far."""
        return self._boxes

    def update(self, seen: Iterable[Sighting]) -> None:
        """Add what was not seen before; the rest stays where it was first."""
        for sighting in seen:
            self._boxes.setdefault(sighting.label, sighting.box)
