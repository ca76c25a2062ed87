"""What the blackboard held in the middle of a tick, when a node asked it."""

from bisect import bisect_right

from executive.engine.blackboard import Blackboard
from executive.inspector.index import RunIndex, WritePlace
from executive.inspector.recorded_values import opened


class PastBlackboard(Blackboard):
    """The blackboard of a recorded run at a moment that can be moved.

    Writes of a tick count from the moment on that their writer answered, so a condition sees
    what it saw in the run. Assignments of guards (`on_success`, ...) count when the guard
    answered.
    """

    def __init__(self, index: RunIndex) -> None:
        """Begin before the first tick."""
        super().__init__()
        self._index = index
        self._tick, self._rank = 0, 0
        self._ranks: dict[str, int] = {}

    def at(self, tick: int, node: int) -> None:
        """Move to the moment at which a node was first asked in a tick.

        Answers come in the order in which nodes are done, so everything that was done before
        the first of its descendants was done before it.
        """
        visited = self._index.recording.tick(tick).visited
        ranks = {visited_node: rank for rank, visited_node in enumerate(visited)}
        inside = [ranks[below] for below in self._below(node) if below in ranks]
        self._tick, self._rank = tick, min(inside, default=len(ranks))
        self._ranks = {self._index.nodes[n].path: rank for n, rank in ranks.items()}

    def after(self, tick: int) -> None:
        """Move to the end of a tick."""
        self._tick, self._rank, self._ranks = tick + 1, 0, {}

    def place(self, key: str) -> WritePlace | None:
        """Return the write whose value a key has at this moment, None where it has none."""
        places = self._index.writes.get(key, [])
        count = bisect_right(places, self._tick, key=lambda place: place.tick)
        while count and not self._is_past(places[count - 1]):
            count -= 1
        return places[count - 1] if count else None

    def read(self, key: str) -> object:
        """Return the value of a key at this moment.

        Raises:
            KeyError: Nothing had written it yet.
        """
        place = self.place(key)
        if place is None:
            raise KeyError(key)
        return opened(self._index.value_at(place))

    def __contains__(self, key: object) -> bool:
        return self.place(str(key)) is not None

    def _is_past(self, place: WritePlace) -> bool:
        if place.tick < self._tick or not place.writer:
            return True
        rank = self._ranks.get(place.writer)
        return place.tick == self._tick and rank is not None and rank < self._rank

    def _below(self, node: int) -> list[int]:
        """Return a node and everything below it."""
        found = [node]
        for above in found:
            found.extend(self._index.children[above])
        return found
