"""One motion as it is executed: shown, held on its path, taken up again."""

from functools import partial

from executive.core.work import CancelToken, Work, Worker
from robots.interfaces import Floats, Trajectory
from robots.limits import JointLimits
from robots.motion import feed


class Playback:
    """Shows a motion, cycle by cycle."""

    def __init__(self, motion: Trajectory, limits: JointLimits, worker: Worker) -> None:
        """Begin at the start of a motion.

        Args:
            motion: What to show.
            limits: Those of holding it.
            worker: Looks for the way back into a held motion, for which cycles cannot wait.
        """
        self._motion, self._limits, self._worker = motion, limits, worker
        self._way_back: Work[feed.FedTrajectory] | None = None
        self._way: Trajectory = motion
        self._elapsed_s = 0.0
        self._wants_rest = False

    @property
    def held(self) -> bool:
        """Whether it rests on its path."""
        return self._stands and self._way_back is None

    @property
    def over(self) -> bool:
        """Whether it has come to its own end."""
        return self._at_end and not self._stands

    def hold(self) -> None:
        """Bring it to rest on its path, after a ramp that is under way."""
        self._wants_rest = True
        if self._way_back is not None:
            self._way_back.cancel()
            self._way_back = None
        self._turn()

    def go_on(self) -> None:
        """Take it up again, after a ramp that is under way."""
        self._wants_rest = False
        self._turn()

    def advance(self, duration_s: float) -> tuple[Floats, Floats, Floats]:
        """Go on and return position, velocity and acceleration there."""
        self._elapsed_s += duration_s
        state = self.now()
        self._turn()
        return state

    def now(self) -> tuple[Floats, Floats, Floats]:
        """Return position, velocity and acceleration as they are shown now."""
        return self._way.at(self._elapsed_s)

    @property
    def _at_end(self) -> bool:
        return self._elapsed_s >= self._way.duration_s - 1e-9

    @property
    def _stands(self) -> bool:
        way = self._way
        return isinstance(way, feed.FedTrajectory) and way.rate == 0.0 and self._at_end

    def _turn(self) -> None:
        """Begin the ramp that is wanted, once the last one is over."""
        shown_s, rate = min(self._elapsed_s, self._motion.duration_s), 1.0
        if isinstance(self._way, feed.FedTrajectory):
            if self._way.ramping(self._elapsed_s):
                return
            shown_s, rate = self._way.progress_s(self._elapsed_s), self._way.rate
        if self._wants_rest and rate > 0.0:
            slowing = feed.held(self._motion, shown_s, rate, self._limits)
            # So near its end that it is over sooner than it could be held.
            self._wants_rest = slowing.rate == 0.0
            self._follow(slowing)
        elif not self._wants_rest and rate == 0.0:
            self._look_for_a_way_back(shown_s)

    def _look_for_a_way_back(self, shown_s: float) -> None:
        if self._way_back is None:
            look = partial(feed.resumed, self._motion, shown_s, self._limits)
            self._way_back = self._worker.begin(CancelToken(), look)
        if self._way_back.done:
            self._follow(self._way_back.result())
            self._way_back = None

    def _follow(self, way: Trajectory) -> None:
        self._way, self._elapsed_s = way, 0.0
