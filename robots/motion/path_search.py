"""Strategies for a path one after another: cheap ones first, other ones where those fail."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from robots.interfaces import Floats, PathStrategy, StrategyTried
from robots.motion.detours import Detours, Joints
from robots.motion.path import RrtConnect, Space, shorten
from robots.motion.roadmap import Roadmap

_SHORTEN_TRIES = 60
Path = list[Floats]


@dataclass(slots=True, eq=False)
class PathSearch:
    """Looks for paths to any of several ends.

    A straight edge to any end comes first. Then trees are grown (RRT-Connect) to the first few
    ends, ways through other places are tried, and at last a roadmap; see `detours` and
    `roadmap`. The checks that the last two spend are those of one tree each.

    Attributes:
        space: Where the paths lie.
        rng: Source of samples.
        max_checks: Collision checks that each tree search may spend.
        max_searches: Ends to which trees are grown.
        rest: An ordinary configuration of these joints, shape (n,).
        arms: Indices of each arm's joints among these.
        tried: What has been tried so far.
    """

    space: Space
    rng: np.random.Generator
    max_checks: int
    max_searches: int
    rest: Floats
    arms: Sequence[Joints]
    tried: list[StrategyTried] = field(default_factory=list)

    def paths(self, start: Floats, ends: Sequence[Floats]) -> Iterator[Path]:
        """Yield paths one by one, those that are cheap to find first."""
        for end in ends:
            if self.space.edge_is_free(start, end):
                yield [start, end]
        self.tried.append(StrategyTried("straight_edge", len(ends)))
        few = ends[: self.max_searches]
        strategies: dict[PathStrategy, tuple[Callable[[Floats, Floats], Path | None], int]] = {
            "rrt_connect": (self._trees, len(few)),
            "detour": (self._detour, 1),
            "roadmap": (self._roadmap, 1),
        }
        for name, (search, count) in strategies.items():
            for end in few[:count]:
                path = search(start, end)
                if path is not None:
                    yield shorten(path, self.space, self.rng, _SHORTEN_TRIES)
            self.tried.append(StrategyTried(name, count))

    def _trees(self, start: Floats, end: Floats) -> Path | None:
        return RrtConnect(self.space, self.rng, self.max_checks).path(start, end)

    def _detour(self, start: Floats, end: Floats) -> Path | None:
        detours = Detours(self.space, self.rng, self.rest, self.arms)
        return detours.path(start, end, self.max_checks)

    def _roadmap(self, start: Floats, end: Floats) -> Path | None:
        return Roadmap(self.space, self.rng, self.max_checks).path(start, end)
