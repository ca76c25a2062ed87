"""The loop of every search without a tree: look, choose, act, until the target shows."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol, TypeVar

from perception.shelf.planning.moves import Move
from perception.shelf.types import ShelfView
from simulation.shelf.contents import MoveResult

# The thesis's rule: found when 1 % of the target shows (section 7.4).
SHOWN = 0.01
# A push that stops short by less has met what was seen.
SHORT_M = 0.01

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Trial:
    """What came of a search.

    Attributes:
        success: Whether the target was found.
        actions: Moves that were made.
        stuck: Whether the search gave up before its time.
        refusals: Moves that did not succeed.
        belief_s: Time of each update of the belief.
        choice_s: Time of each decision.
    """

    success: bool
    actions: int
    stuck: bool = False
    refusals: int = 0
    belief_s: tuple[float, ...] = field(default=(), compare=False)
    choice_s: tuple[float, ...] = field(default=(), compare=False)


class SearchedShelf(Protocol):
    """What a search looks into and acts on."""

    def look(self) -> ShelfView:
        """Take a view from the middle viewpoint; detection is perfect."""
        ...

    def act(self, move: Move) -> MoveResult:
        """Do one action."""
        ...

    def visible_share(self, name: str) -> float:
        """Return how much of an object's silhouette is seen, in [0, 1]; truth, for scoring."""
        ...


class Searcher(Protocol):
    """Somebody who searches a shelf."""

    def shows(self) -> bool:
        """Ask the world whether the target counts as found."""
        ...

    def look(self) -> None:
        """Look, and take in what is seen."""
        ...

    def choose(self) -> Move | None:
        """Choose the next move; None where there is none that helps."""
        ...

    def act(self, move: Move) -> MoveResult:
        """Act, and take in what was felt."""
        ...


def search(searcher: Searcher, limit: int) -> Trial:
    """Search with at most so many actions; the thesis allows two an object (section 5.2)."""
    beliefs, choices = list[float](), list[float]()
    refusals = 0
    for actions in range(limit + 1):
        if searcher.shows():
            return Trial(True, actions, False, refusals, tuple(beliefs), tuple(choices))
        if actions == limit:
            break
        _timed(beliefs, searcher.look)
        move = _timed(choices, searcher.choose)
        if move is None:
            return Trial(False, actions, True, refusals, tuple(beliefs), tuple(choices))
        refusals += searcher.act(move).failure is not None
    return Trial(False, limit, False, refusals, tuple(beliefs), tuple(choices))


def _timed(times: list[float], call: Callable[[], T]) -> T:
    """Call something, and note how long it took [s]."""
    begun = time.perf_counter()
    answer = call()
    times.append(time.perf_counter() - begun)
    return answer
