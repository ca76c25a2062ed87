"""Ways through a place on the way: what is tried where trees do not meet.

Two arms go one after the other, so that each search is in the joints of one arm; any arm goes by
way of its rest.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.interfaces import Floats
from robots.motion.path import RrtConnect, Space

Joints = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Detours:
    """Looks for paths that lead through other places.

    Attributes:
        space: Where the paths lie.
        rng: Source of samples.
        rest: An ordinary configuration, shape (n,).
        arms: Indices of each arm's joints.
    """

    space: Space
    rng: np.random.Generator
    rest: Floats
    arms: Sequence[Joints]

    def path(self, start: Floats, end: Floats, max_checks: int) -> list[Floats] | None:
        """Return waypoints from start to end, or None.

        Args:
            start: Shape (n,).
            end: Shape (n,).
            max_checks: Collision checks that all searches together may spend.
        """
        ways = [way for way in self._ways(start, end) if not any(map(self.space.collides, way))]
        for way in ways:
            share = max_checks // (len(ways) * (len(way) + 1))
            path = self._through([start, *way, end], share)
            if path is not None:
                return path
        return None

    def _ways(self, start: Floats, end: Floats) -> Iterator[list[Floats]]:
        several = self.arms if len(self.arms) > 1 else ()
        for arm in several:
            yield [self._with(start, arm, end)]
        for arm in several:
            aside = self._with(start, arm, self.rest)
            yield [aside, self._with(end, arm, self.rest)]
        yield [self.rest]

    def _with(self, base: Floats, arm: Joints, other: Floats) -> Floats:
        mixed = base.copy()
        mixed[arm] = other[arm]
        return mixed

    def _through(self, places: Sequence[Floats], max_checks: int) -> list[Floats] | None:
        path = [places[0]]
        for place in places[1:]:
            leg = self._leg(path[-1], place, max_checks)
            if leg is None:
                return None
            path += leg[1:]
        return path

    def _leg(self, start: Floats, end: Floats, max_checks: int) -> list[Floats] | None:
        if np.array_equal(start, end) or self.space.edge_is_free(start, end):
            return [start, end]
        moving = np.concatenate([arm for arm in self.arms if (start[arm] != end[arm]).any()])
        part = self.space.part(start, moving)
        found = RrtConnect(part, self.rng, max_checks).path(start[moving], end[moving])
        if found is None:
            return None
        leg = [start.copy() for _ in found]
        for q, row in zip(leg, found, strict=True):
            q[moving] = row
        return leg
