"""A cell in memory for skills: arms that arrive at once, and a camera model over the table."""

from dataclasses import dataclass, field

import numpy as np

from perception.cable.types import Crossing, Knot, Trace, TraceEnd
from perception.camera import CameraFrame, CameraModel
from robots.interfaces import MotionFailure


def overhead() -> CameraModel:
    """A camera 1 m above the table's centre, 1 mm a pixel."""
    pose = np.eye(4)
    pose[:3, :3] = np.diag([1.0, -1.0, -1.0])
    pose[2, 3] = 1.0
    return CameraModel(1001, 751, 1000.0, (500.0, 375.0), pose)


def frame() -> CameraFrame:
    """A dark frame of that camera."""
    image = np.full((751, 1001), 40, dtype=np.uint8)
    image[0, 0] = 200
    return CameraFrame(image, image.astype(np.float32), 0.0, overhead())


@dataclass
class Move:
    """A planned motion: where each tool ends."""

    ends: dict
    duration_s: float = 0.0


@dataclass
class ArrivingArms:
    """A `DualArm` whose tools are where they were sent, one tick later."""

    tools: dict = field(
        default_factory=lambda: {
            "left": np.array([-0.3, -0.3, 0.2]),
            "right": np.array([0.3, -0.3, 0.2]),
        }
    )
    held: bool = True
    lines_blocked: int = 0
    log: list = field(default_factory=list)
    busy: int = 0

    def plan(self, goals):
        return Move({arm: goal.position_m for arm, goal in goals.items()})

    def plan_line(self, displacements_m):
        if self.lines_blocked > 0:
            self.lines_blocked -= 1
            return MotionFailure("motion.collision", "line", "blocked on purpose")
        return Move({arm: self.tools[arm] + way for arm, way in displacements_m.items()})

    def plan_home(self):
        return Move({})

    def assign(self, goals):
        first_is_left = goals[0].position_m[0] <= goals[1].position_m[0]
        return ("left", "right") if first_is_left else ("right", "left")

    def reachable(self, arm, goal):
        return abs(goal.position_m[0]) <= 0.4

    def tcp_position(self, arm):
        return self.tools[arm].copy()

    def start(self, move):
        self.tools |= {arm: np.array(end) for arm, end in move.ends.items()}
        self.log.append(("move", {arm: tuple(end.round(3)) for arm, end in self.tools.items()}))
        self.busy = 1

    def moving(self):
        self.busy -= 1
        return self.busy >= 0

    def grip(self, arm, grip):
        self.log.append(("grip", arm, grip))

    def holds(self, arm):
        return self.held

    def stop(self):
        self.log.append(("stop",))

    def hold(self):
        self.log.append(("hold",))

    def go_on(self):
        self.log.append(("go on",))

    def resting(self):
        return self.busy <= 0


def overhand(size_px: float = 60.0) -> tuple[Trace, tuple[Crossing, ...], Knot]:
    """A trefoil-like overhand knot in the middle of the view with two straight tails."""
    angle = np.linspace(0.35, 2.0 * np.pi - 0.35 + 2.0 * np.pi, 400)
    radius = size_px * (1.6 + np.cos(1.5 * angle))
    loop = np.column_stack([500 + radius * np.cos(angle), 375 + radius * np.sin(angle)])
    path = np.vstack([np.linspace((760, 300), loop[0], 60)[:-1], loop])
    path = np.vstack([path, np.linspace(loop[-1], (760, 450), 60)[1:]])
    trace = Trace(path, TraceEnd.ENDPOINT, 1.0)
    begin, end = 0.3, 0.7
    crossing = Crossing(path[int(begin * len(path))], 0, end, 0, begin, 1.0)
    middle, east = np.array([500.0, 375.0]), np.array([1.0, 0.0])
    return trace, (crossing,), Knot(0, (begin, end), middle, middle, middle, east, east)


def finished(skill, inputs, ticks: int = 400):
    """Step a skill to its end and return the outcome and the ticks that it took."""
    skill.start(inputs)
    for count in range(ticks):
        outcome = skill.step()
        if outcome.status != "RUNNING":
            return outcome, count + 1
    raise AssertionError(f"still running after {ticks} ticks")
