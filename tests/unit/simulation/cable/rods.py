"""Small rods and hands that several tests of the cable share."""

import numpy as np

from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod

CONTROL_S = 0.005


def straight(length_m, z_m=0.0033, start=(0.0, 0.0), along=(1.0, 0.0), spacing_m=0.01):
    """Return nodes of a straight cable in the table plane."""
    arcs = np.arange(round(length_m / spacing_m) + 1) * spacing_m
    xy = np.asarray(start) + arcs[:, None] * np.asarray(along)
    return np.column_stack([xy, np.full(len(arcs), z_m)])


def floating(**changes):
    """Return parameters of a cable far from gravity, table and plugs."""
    return RodParameters(**{"gravity_m_s2": 0.0, "connector_length_m": 0.0, **changes})


def tool(x, y, z, opening="y"):
    """Return T_world_tcp of a hand that points down and opens along x or y."""
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    if opening == "y":
        pose[:3, :2] = [[0.0, 1.0], [1.0, 0.0], [0.0, 0.0]]
    pose[:3, 3] = x, y, z
    return pose


def grasp(rod: Rod, hand, mode, point_m, opening="y"):
    """Put a hand at a point and close it there."""
    rod.move_hand(hand, tool(*point_m, opening))
    return rod.close_hand(hand, mode, 0.04, 0.01, 0.008)


def carry(rod: Rod, paths_m, speed_m_s=0.3, opening="y"):
    """Move hands in straight lines, all in step."""
    starts = {hand: rod.hands[hand].pose[:3, 3].copy() for hand in paths_m}
    longest = max(np.linalg.norm(np.subtract(end, starts[hand])) for hand, end in paths_m.items())
    steps = max(1, round(longest / speed_m_s / CONTROL_S))
    for step in range(1, steps + 1):
        for hand, end in paths_m.items():
            at = starts[hand] + (np.asarray(end) - starts[hand]) * step / steps
            rod.move_hand(hand, tool(*at, opening))
        rod.advance(CONTROL_S)
