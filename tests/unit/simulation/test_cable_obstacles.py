"""Capsules that push the cable stand where the robot's links do."""

import numpy as np

from robots.descriptions import DESCRIPTIONS
from simulation.cable_obstacles import CableObstacles
from simulation.poses import pose_matrices


class Links:
    """A body whose links stand anywhere, any way round."""

    def __init__(self, rng, count):
        self.positions_m = rng.uniform(-1.0, 1.0, (count, 3))
        quats = rng.standard_normal((count, 4))
        self.quats_xyzw = quats / np.linalg.norm(quats, axis=1)[:, None]

    def link_poses(self, names):
        return self.positions_m, self.quats_xyzw


class Pushed:
    """A rod that notes what it is told."""

    def __init__(self):
        self.hands = {}

    def set_capsules(self, starts_m, ends_m, radii_m):
        self.ends_m = np.stack([starts_m, ends_m], axis=1)

    def move_hand(self, hand, T_world_tcp):
        self.hands[hand] = T_world_tcp


def test_capsules_and_hands_go_where_their_links_are():
    obstacles, rod = CableObstacles.of(DESCRIPTIONS["yumi"]()), Pushed()
    body = Links(np.random.default_rng(3), len(obstacles.links))
    obstacles.follow(body, rod)
    matrices = pose_matrices(body.positions_m, body.quats_xyzw)
    owners = matrices[obstacles.owners]
    expected = np.einsum("mij,mej->mei", owners[:, :3, :3], obstacles.ends_m)
    np.testing.assert_allclose(rod.ends_m, expected + owners[:, None, :3, 3], atol=1e-12)
    for number, arm in enumerate(("left", "right")):
        np.testing.assert_allclose(rod.hands[arm], matrices[number])
