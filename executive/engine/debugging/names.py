"""What names in an expression mean while a mission runs: keys near a node first."""

from executive.engine.blackboard import Blackboard


class BoardNames:
    """The keys of a blackboard by their bare names, seen from a node.

    Of several keys with one name, that of the innermost tree around the node counts; a name
    that no tree around it has is looked for everywhere, and the one written first counts.
    """

    def __init__(self, blackboard: Blackboard, path: str) -> None:
        """Look from the node of that path."""
        self._blackboard, self._path = blackboard, path

    def __getitem__(self, name: str) -> object:
        key = self._key(name)
        if key is None:
            raise KeyError(name)
        return self._blackboard.read(key)

    def __contains__(self, name: object) -> bool:
        return self._key(str(name)) is not None

    def _key(self, name: str) -> str | None:
        place = self._path
        while place:
            if (key := f"{place}:{name}") in self._blackboard:
                return key
            place = place.rpartition("/")[0]
        everywhere = self._blackboard.keys()
        return next((key for key in everywhere if key.endswith(f":{name}")), None)
