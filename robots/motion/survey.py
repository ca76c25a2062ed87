"""What a robot is once it is loaded: arms, limits, reach, and pairs that can never part."""

from dataclasses import dataclass

import numpy as np

from robots.descriptions.specs import RobotSpec
from robots.motion.collision import CollisionModel
from robots.motion.model import RobotModel
from robots.placement import Placement, PlanningScene

_CONFIGURATIONS = 300


@dataclass(frozen=True, slots=True)
class ArmSurvey:
    """One arm.

    Attributes:
        name: What it is called.
        joints: In chain order.
        tcp: Frame of the tool centre point.
        fingers: Joints of its hand.
        reach_m: The tool is never farther than this from the first joint.
    """

    name: str
    joints: tuple[str, ...]
    tcp: str
    fingers: tuple[str, ...]
    reach_m: float


@dataclass(frozen=True, slots=True)
class RobotSurvey:
    """A robot.

    Attributes:
        name: What it is called.
        arms: In the order of configurations.
        shapes: How many there are to check collisions with.
        pairs: How many pairs of bodies are checked.
        always: Pairs that collide in every configuration that was tried.
        colliding: Share of configurations that collide.
    """

    name: str
    arms: tuple[ArmSurvey, ...]
    shapes: int
    pairs: int
    always: tuple[tuple[str, str], ...]
    colliding: float


def survey(spec: RobotSpec, seed: int = 0) -> RobotSurvey:
    """Load a robot and look at random configurations of it.

    Raises:
        InputError: It cannot be loaded.
    """
    robot = RobotModel(spec, Placement((0.0, 0.0, 0.0), 0.0))
    collision = CollisionModel(robot, PlanningScene(Placement((0.0, 0.0, 0.0), 0.0)))
    rng = np.random.default_rng(seed)
    samples = rng.uniform(robot.limits.lower, robot.limits.upper, (_CONFIGURATIONS, robot.size))
    hits = [collision.colliding_pairs(q) for q in samples]
    arms = tuple(
        ArmSurvey(name, arm.joints, arm.tcp, arm.fingers, robot.kinematics[name].reach_m)
        for name, arm in spec.arms.items()
    )
    return RobotSurvey(
        spec.name,
        arms,
        robot.geometry.ngeoms,
        len(collision.checked_bodies()),
        tuple(sorted(set.intersection(*hits))),
        float(np.mean([bool(pairs) for pairs in hits])),
    )
