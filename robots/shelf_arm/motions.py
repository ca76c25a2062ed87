"""Motions that actions at a shelf are made of, as generators: each `yield` waits for a poll."""

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from robots.interfaces import Floats, MotionFailure, PoseGoal, Trajectory
from robots.shelf_arm.driver import Guard, ShelfArmDriver
from robots.shelf_arm.scene import LEVEL_TOOL, ShelfSize, closed_scene, open_scene
from robots.shelf_arm.settings import ShelfArmSettings
from robots.shelf_tool import Cuboid, ToolFailure
from robots.single_arm import PlannedArm

Step = Generator[None, None, None]
# Lines are planned at that speed of the tool, and slowed from there [m/s].
LINE_SPEED_M_S = 0.25
LEAST_LINE_M = 1e-4
_LEVEL_QUAT: Floats = Rotation.from_matrix(LEVEL_TOOL).as_quat()


class ActionError(Exception):
    """An action that cannot go on; ends in a `ToolResult`."""

    def __init__(self, failure: ToolFailure, text: str) -> None:
        """Take the reason and a sentence for people."""
        super().__init__(text)
        self.failure, self.text = failure, text


@dataclass(frozen=True, slots=True, eq=False)
class Slowed:
    """A trajectory driven more slowly; what was checked of its path stays true.

    Attributes:
        whole: The trajectory.
        share: Of its speed, in (0, 1].
    """

    whole: Trajectory
    share: float

    @property
    def duration_s(self) -> float:
        """Length in time [s]."""
        return self.whole.duration_s / self.share

    def at(self, time_s: float) -> tuple[Floats, Floats, Floats]:
        """Return position, velocity and acceleration; outside, the first or last state."""
        position, velocity, acceleration = self.whole.at(self.share * time_s)
        return position, self.share * velocity, self.share**2 * acceleration


class ShelfMotions:
    """The tool's motions before and in a shelf; the tool stays level.

    Attributes:
        driver: Controllers of the arm, with their guard and the valve.
        settings: Speeds and forces.
        shelf: What the arm stands before.
        carried: What the cups hold and where it stood; None when they hold nothing.
    """

    def __init__(
        self,
        arm: PlannedArm,
        driver: ShelfArmDriver,
        shelf: ShelfSize,
        settings: ShelfArmSettings,
    ) -> None:
        """Bind an arm.

        Args:
            arm: Plans, and hands trajectories to the driver.
            driver: The same driver, for its guard and its cups.
            shelf: What it stands before.
            settings: Speeds and forces.
        """
        self._arm, self.driver, self.settings = arm, driver, settings
        self.shelf = shelf
        self.carried: Cuboid | None = None
        self._open, self._closed = open_scene(shelf).boxes, closed_scene(shelf).boxes

    def tip_m(self) -> Floats:
        """Return where the cups' lips are now, shape (3,)."""
        return self._arm.tcp_pose()[0]

    def now_s(self) -> float:
        """Return the time [s]."""
        return self.driver.state().stamp_s

    def free_to(
        self, position_m: Floats, *onward_m: Floats, quat_xyzw: Floats = _LEVEL_QUAT
    ) -> Step:
        """Go to a place before the shelf by any way that keeps out of it.

        Args:
            position_m: Of the cups' lips, shape (3,).
            onward_m: Lines that must be possible from there, into the open shelf.
            quat_xyzw: Orientation of the tool.
        """
        self.driver.guard(None)
        lines_m = tuple(line for line in onward_m if np.linalg.norm(line) > LEAST_LINE_M)
        goal = PoseGoal(position_m, quat_xyzw, onward_m=lines_m)
        # Lines lead into the open shelf; the way to where they begin keeps out of it.
        self._arm.set_obstacles(self._open if lines_m else self._closed)
        plan = self._arm.plan(goal)
        if lines_m and not isinstance(plan, MotionFailure):
            self._arm.set_obstacles(self._closed)
            plan = self._arm.plan_configuration(plan.at(plan.duration_s)[0])
        yield from self._run(plan, 1.0)

    def line_by(self, vector_m: Floats, speed_m_s: float, most_n: float | None = None) -> Step:
        """Go along a straight line in the open shelf; too great a force ends it early.

        Args:
            vector_m: Shape (3,).
            speed_m_s: Greatest speed of the tool.
            most_n: Greatest force against the motion; None goes on whatever it meets.
        """
        length_m = float(np.linalg.norm(vector_m))
        if length_m < LEAST_LINE_M:
            return
        self._arm.set_obstacles(self._open)
        guard = None if most_n is None else Guard(vector_m / length_m, most_n)
        self.driver.guard(guard)
        share = min(1.0, speed_m_s / LINE_SPEED_M_S)
        yield from self._run(self._arm.plan_line(vector_m), share)
        self.driver.guard(None)

    def retreat(self) -> Step:
        """Come straight out of the shelf."""
        out_m = self.tip_m()[1] + self.settings.before_m
        if out_m > 0.0:
            yield from self.line_by(np.array([0.0, -out_m, 0.0]), self.settings.entry_speed_m_s)

    def wait(self, duration_s: float) -> Step:
        """Let time pass."""
        end_s = self.now_s() + duration_s
        while self.now_s() < end_s - 1e-9:
            yield

    def _run(self, plan: Trajectory | MotionFailure, share: float) -> Step:
        if isinstance(plan, MotionFailure):
            raise ActionError(_failure(plan), plan.text)
        self._arm.start(plan if share == 1.0 else Slowed(plan, share))
        while self._arm.moving():
            yield


def _failure(plan: MotionFailure) -> ToolFailure:
    known = {
        "motion.unreachable": ToolFailure.UNREACHABLE,
        "motion.collision": ToolFailure.COLLISION,
    }
    return known.get(plan.code, ToolFailure.NO_PATH)
