"""One model of the YuMi at its table for all tests of motion; building it is not free."""

import numpy as np
import pytest

from robots.motion.collision import CollisionModel
from robots.motion.model import yumi_model
from robots.motion.solver import GoalSolver
from robots.placement import HOME_RAD, table_scene


@pytest.fixture(scope="session")
def robot():
    return yumi_model(table_scene().placement)


@pytest.fixture
def collision(robot):
    return CollisionModel(robot, table_scene())


@pytest.fixture
def solver(robot):
    solver = GoalSolver(robot, table_scene(), HOME_RAD, seed=0)
    solver.set_openings({"left": 0.05, "right": 0.05})
    return solver


@pytest.fixture
def rng():
    return np.random.default_rng(7)
