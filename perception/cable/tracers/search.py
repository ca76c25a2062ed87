"""A beam of paths from one start: every distinct way of a step is a path of its own.

Searches from several starts go on side by side, so that the network looks for all of them at
once.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from perception.cable.tracers.leaps import leap
from perception.cable.tracers.modes import find_modes
from perception.cable.tracers.paths import Ends, Path, checked
from perception.cable.tracers.rivals import RivalConfig, reduced
from perception.cable.tracers.steps import Outlook, StepModel
from perception.cable.tracers.stretches import Stretches
from perception.cable.types import TraceEnd
from perception.models.frames import ScaledImage


@dataclass(frozen=True, slots=True)
class SearchConfig:
    """Settings of a search.

    Attributes:
        beam: How many paths go on side by side.
        modes: How many ways a path may go on in one step.
        least: Ways less likely than this are not followed.
        lost: Without any way or end more likely than this, a path is lost.
        end_odds: How often a step meets an end of the cable, over how often it did in training.
        dead_end: Where what is seen of the cable ends, it ends at least this likely.
        window: Paths less likely than the best by this factor are dropped [nats].
        most_looks: After so many looks for each start what still goes on is lost.
        leaps: Whether a look may give more than one step.
        rivals: How paths that meet again are compared.
    """

    beam: int = 6
    modes: int = 3
    least: float = 0.05
    lost: float = 0.08
    end_odds: float = 0.15
    dead_end: float = 0.06
    window: float = 4.5
    most_looks: int = 250
    leaps: bool = True
    rivals: RivalConfig = field(default_factory=RivalConfig)


@dataclass(frozen=True, slots=True, eq=False)
class Sketch:
    """What is known of the cables in an image before they are followed.

    Attributes:
        stretches: Where they lie alone.
        dead_ends: Where what is seen of them ends; many of these are no ends of a cable.
    """

    stretches: Stretches
    dead_ends: Ends


class Search:
    """Follows one cable from its start.

    Attributes:
        alive: Paths that go on, likeliest first.

    Args:
        starts: First paths.
        ends: Where paths may finish.
        config: Settings.
        sketch: What is known of the cable, if anything is.
    """

    def __init__(
        self,
        starts: Sequence[Path],
        ends: Ends,
        config: SearchConfig,
        sketch: Sketch | None = None,
    ) -> None:
        self.alive = list(starts)
        self._done: list[Path] = []
        self._ends, self._config, self._sketch = ends, config, sketch

    def advance(self, image: ScaledImage, outlooks: Sequence[Outlook]) -> None:
        """Go on by one look for each path that is alive."""
        ahead = [
            way
            for path, outlook in zip(self.alive, outlooks, strict=True)
            for way in map(partial(self._run_on, image), self._ways(image, path, outlook))
        ]
        rivals = reduced(self._done + ahead, self._config.rivals)
        floor = rivals[0].log_probability - self._config.window
        rivals = [path for path in rivals if path.log_probability > floor]
        self._done = [path for path in rivals if path.end is not None]
        self.alive = [path for path in rivals if path.end is None][: self._config.beam]

    def found(self) -> list[Path]:
        """Return all paths, likeliest first; those that have not ended are lost."""
        lost = [path.ended(TraceEnd.LOST) for path in self.alive]
        return sorted(self._done + lost, key=lambda path: -path.log_probability)

    def _ways(self, image: ScaledImage, path: Path, outlook: Outlook) -> list[Path]:
        """Return every way in which a path may go on or end."""
        number = self._ends.doubtful(path)
        if number is None:
            return self._ways_on(image, path, outlook)
        belief = float(self._ends.beliefs[number])
        on = self._ways_on(image, path, outlook)
        loss = float(np.log1p(-belief))
        past = [way.lifted(min(len(path.points), len(way.points) - 1), loss) for way in on]
        arrived = path.extended(self._ends.points[number], belief).ended(TraceEnd.ENDPOINT)
        return [arrived, *past]

    def _ways_on(self, image: ScaledImage, path: Path, outlook: Outlook) -> list[Path]:
        """Return every way in which a path may go on or end where no end is known."""
        config = self._config
        modes = find_modes(outlook.cells, config.least, config.modes)
        is_dead = self._is_at_dead_end(path)
        end = config.end_odds * outlook.end
        if is_dead:
            end = max(outlook.end, config.dead_end)
        believed = [end, *(mode.probability for mode in modes)]
        # What lies beside the modes is the blur of the map, unless that is most of it.
        total = max(sum(believed), 0.5)
        ways = [
            self._checked(
                image, path.extended(outlook.frame.back(mode.point_crop), mode.probability / total)
            )
            for mode in modes
        ]
        if config.leaps and len(modes) == 1:
            for point in leap(outlook, modes[0]):
                if ways[0].end is None and not self._is_to_be_looked_at(ways[0]):
                    ways[0] = self._checked(image, ways[0].extended(outlook.frame.back(point), 1.0))
        if end > config.least:
            ways.append(path.ended(TraceEnd.ENDPOINT, end / total))
        if max(believed) < config.lost:
            why = TraceEnd.ENDPOINT if is_dead else TraceEnd.LOST
            ways.append(path.ended(why, config.lost))
        return ways

    def _is_at_dead_end(self, path: Path) -> bool:
        return self._sketch is not None and self._sketch.dead_ends.reached(path) is not None

    def _is_to_be_looked_at(self, path: Path) -> bool:
        return self._is_at_dead_end(path) or self._ends.doubtful(path) is not None

    def _run_on(self, image: ScaledImage, path: Path) -> Path:
        """Return the path up to the end of the stretch that it has come to."""
        points = self._sketch.stretches.ahead(path.points) if self._sketch is not None else ()
        for point in points:
            if path.end is None and self._ends.doubtful(path) is None:
                path = self._checked(image, path.extended(point, 1.0))
        return path

    def _checked(self, image: ScaledImage, path: Path) -> Path:
        return checked(path, image, self._ends)


def run_searches(
    model: StepModel, image: ScaledImage, searches: Sequence[Search], most_looks: int
) -> None:
    """Let searches go on, all of them with one look of the network, until they have ended."""
    left = most_looks * len(searches)
    while left > 0:
        paths = [path for search in searches for path in search.alive]
        if not paths:
            return
        left -= len(paths)
        outlooks = iter(model.outlooks(image, paths))
        for search in searches:
            if search.alive:
                search.advance(image, [next(outlooks) for _ in search.alive])
