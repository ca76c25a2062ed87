"""Pull cable towards the middle of the table."""

from collections.abc import Iterable, Iterator
from itertools import product

import numpy as np

from executive.core.skill import SkillRun
from robots.interfaces import Floats, TcpGoal
from skills.cable.carrying import CarrySkill

# Where the whole way is out of reach, these parts of it are tried in turn, each also askew.
SHARES_OF_WAY = (1.0, 0.6, 0.3)
# Of its way, a pull askew comes at least so much nearer to the middle.
LEAST_IN = 0.3
ASKEW_RAD = tuple(np.deg2rad((0.0, 35.0, -35.0, 70.0, -70.0)))


class PullSkill(CarrySkill):
    """Base of skills that grasp one place of the cable and pull it towards the middle."""

    def pull(self, goals: Iterable[TcpGoal], distance_m: float) -> SkillRun:
        """Grasp at the first goal from which an arm can pull, lift, pull, lay down, rise."""
        return (
            yield from self.carry(goals, lambda goal: ways_inwards(goal.position_m, distance_m))
        )


def ways_inwards(position_m: Floats, distance_m: float) -> Iterator[Floats]:
    """Yield level displacements towards the table's middle, the straightest and longest first."""
    for share, angle in product(SHARES_OF_WAY, ASKEW_RAD):
        way_m = towards_middle(position_m, share * distance_m)[:2]
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        end_m = position_m[:2] + turn @ way_m
        if np.linalg.norm(end_m) <= np.linalg.norm(position_m[:2]) - LEAST_IN * share * distance_m:
            yield np.append(end_m - position_m[:2], 0.0)


def towards_middle(position_m: Floats, distance_m: float) -> Floats:
    """Return the level displacement towards the table's middle, at most up to it."""
    level_m = np.array([-position_m[0], -position_m[1], 0.0])
    reach_m = float(np.linalg.norm(level_m))
    displacement: Floats = level_m * min(1.0, distance_m / max(reach_m, 1e-9))
    return displacement
