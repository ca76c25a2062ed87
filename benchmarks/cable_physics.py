"""The cable's physics: its laws, its speed beside a PyBullet chain, worlds that repeat.

For the speed, both worlds do the same: 3 m of cable with an overhand knot's centre line lie on a
table, one end is held and pulled sideways at 0.25 m/s. Each pair of timings is taken in turn, so
that a noisy machine slows both. Seconds are those of the process on its core: on a quiet machine
wall seconds, and on a shared one what is left of them.
"""

import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.cable_laws import laws
from benchmarks.cable_worlds import world_digest
from benchmarks.harness import Row, median, share
from perception.cable.topology import Knottedness, classify_curve
from simulation.cable.configurations import starting_configuration
from simulation.cable.rod import Rod

Floats = NDArray[np.float64]
PULL_M_S = 0.25
STEP_S = 1.0 / 240.0
CAPSULES = 250
LENGTHS = (100, 300, 1000)


def run(quick: bool, seed: int) -> Sequence[Row]:
    """Time both cables in turn, then pull knotted cables about and look at their knots."""
    pairs, seconds, pulls = (3, 0.5, 4) if quick else (15, 1.0, 60)
    nodes_m = starting_configuration("overhand", np.random.default_rng(seed))
    _rod_cpu_s(nodes_m, 0.05)  # compiles
    ours, theirs = [], []
    for _ in range(pairs):
        ours.append(_rod_cpu_s(nodes_m, seconds) / seconds)
        theirs.append(_pybullet_cpu_s(nodes_m, seconds / 10.0) / (seconds / 10.0))
    ratios = [chain / rod for rod, chain in zip(ours, theirs, strict=True)]
    kept = [_keeps_its_knot(seed + number) for number in range(pulls)]
    return [
        *laws(quick, seed),
        *_speeds(1 if quick else 5),
        *_worlds(5.0 if quick else 60.0, seed),
        median("realtime_factor_301", [1.0 / cpu for cpu in ours], "1", ">= 5"),
        median("ratio_to_pybullet_chain", ratios, "1", ">= 15"),
        median("pybullet_realtime_factor_250", [1.0 / cpu for cpu in theirs], "1"),
        share("knots_kept_in_pulls", sum(kept), len(kept), "= 1"),
    ]


def _speeds(pairs: int) -> Iterator[Row]:
    """Time cables of several lengths that are pulled, beside chains of as many capsules."""
    for nodes in LENGTHS:
        nodes_m = _serpentine(nodes)
        _rod_cpu_s(nodes_m, 0.02)
        seconds, chain_s = 200.0 / nodes, 6.0 / nodes
        ours, theirs = [], []
        for _ in range(pairs):
            ours.append(_rod_cpu_s(nodes_m, seconds) / seconds)
            theirs.append(_pybullet_cpu_s(nodes_m, chain_s, nodes - 1) / chain_s)
        ratios = [chain / rod for rod, chain in zip(ours, theirs, strict=True)]
        yield median(f"realtime_factor_{nodes}_nodes", [1.0 / cpu for cpu in ours], "1")
        yield median(f"ratio_to_pybullet_chain_{nodes}", ratios, "1")


def _serpentine(nodes: int) -> Floats:
    """Return a cable that lies in rows beside each other, 4 cm apart."""
    spacing_m, row_m, turn_m = 0.01, 0.6, 0.02
    rows = ceil(nodes * spacing_m / row_m) + 1
    corners = []
    for row in range(rows):
        ends = (-0.5 * row_m, 0.5 * row_m) if row % 2 == 0 else (0.5 * row_m, -0.5 * row_m)
        corners += [(x, 2.0 * turn_m * row - 0.3) for x in ends]
        way = 1.0 if row % 2 == 0 else -1.0
        arc = np.linspace(0.0, np.pi, 12)[1:-1]
        bend = np.column_stack([way * turn_m * np.sin(arc), turn_m * (1.0 - np.cos(arc))])
        corners += [tuple(corners[-1] + step) for step in bend]
    points = np.array(corners)
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    arcs = spacing_m * np.arange(nodes)
    flat = [np.interp(arcs, along, points[:, axis]) for axis in range(2)]
    return np.column_stack([*flat, np.full(nodes, 0.0033)])


def _worlds(seconds: float, seed: int) -> Iterator[Row]:
    """Let the same world go on here and in a second process; compare them bit by bit."""
    here = world_digest(seed, seconds)
    command = [sys.executable, "-m", "benchmarks.cable_worlds", str(seed), str(seconds)]
    there = subprocess.run(command, capture_output=True, text=True, check=True)
    same = here == there.stdout.strip()
    yield share("bit_equal_in_second_process", int(same), 1, "= 1")


def _rod_cpu_s(nodes_m: Floats, seconds: float) -> float:
    rod = Rod(nodes_m)
    _hold(rod, nodes_m[5])
    began_s = time.process_time()
    _pull(rod, nodes_m[5], np.array([PULL_M_S, 0.0, 0.0]), seconds)
    return time.process_time() - began_s


def _hold(rod: Rod, point_m: Floats) -> None:
    rod.move_hand("hand", _tool_at(point_m))
    if not rod.close_hand("hand", "pinch", 0.05, 0.03, 0.02):
        raise RuntimeError("the hand closed on nothing; the cable is not where it was laid")


def _pull(rod: Rod, point_m: Floats, velocity_m_s: Floats, seconds: float) -> None:
    for step in range(round(seconds / STEP_S)):
        rod.move_hand("hand", _tool_at(point_m + velocity_m_s * (step + 1) * STEP_S))
        rod.advance(STEP_S)


def _tool_at(point_m: Floats) -> Floats:
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[:3, 3] = point_m
    return pose


def _keeps_its_knot(seed: int) -> bool:
    """Pull a random inner point of a knotted cable at full speed for 0.4 m; compare knots.

    Pulling the inside of a knot may draw an end out of it, so a knot that ends with an end
    inside it does not count as broken; the ends here are 0.7 m away or more.
    """
    rng = np.random.default_rng(seed)
    nodes_m = starting_configuration(("overhand", "figure_8")[seed % 2], rng)
    at = int(rng.integers(110, 190))
    angle = rng.uniform(0.0, 2.0 * np.pi)
    rod = Rod(nodes_m)
    _hold(rod, nodes_m[at])
    velocity_m_s = PULL_M_S * np.array([np.cos(angle), np.sin(angle), 0.1])
    _pull(rod, nodes_m[at], velocity_m_s, 0.4 / PULL_M_S)
    return classify_curve(rod.positions_m).state is Knottedness.KNOTTED


def _pybullet_cpu_s(nodes_m: Floats, seconds: float, capsules: int = CAPSULES) -> float:
    """Time a chain of capsules on point-to-point constraints, pulled the same way."""
    import pybullet
    from pybullet_utils.bullet_client import BulletClient

    client = BulletClient(pybullet.DIRECT)
    client.setGravity(0.0, 0.0, -9.81)
    client.setPhysicsEngineParameter(fixedTimeStep=STEP_S, numSolverIterations=50)
    bodies = _chain(client, pybullet, nodes_m, capsules)
    began_s = time.process_time()
    for step in range(max(1, round(seconds / STEP_S))):
        client.resetBasePositionAndOrientation(
            bodies[0], nodes_m[0] + np.array([PULL_M_S * (step + 1) * STEP_S, 0.0, 0.0]), _UPRIGHT
        )
        client.stepSimulation()
    cpu_s = time.process_time() - began_s
    client.disconnect()
    return cpu_s


_UPRIGHT = (0.0, 0.0, 0.0, 1.0)


def _chain(client: Any, pybullet: Any, nodes_m: Floats, capsules: int) -> list[int]:
    plane = client.createCollisionShape(pybullet.GEOM_PLANE)
    client.createMultiBody(0.0, plane)
    arcs = np.linspace(0.0, len(nodes_m) - 1.0, capsules + 1)
    points = np.column_stack(
        [np.interp(arcs, np.arange(len(nodes_m)), nodes_m[:, axis]) for axis in range(3)]
    )
    half_m = float(np.linalg.norm(np.diff(nodes_m, axis=0), axis=1).sum()) / capsules / 2.0
    shape = client.createCollisionShape(
        pybullet.GEOM_CAPSULE, radius=0.0033, height=2.0 * half_m - 0.0066
    )
    bodies = [
        client.createMultiBody(
            0.035 * 2.0 * half_m,
            shape,
            basePosition=(a + b) / 2.0,
            baseOrientation=_turn_z_onto(b - a),
        )
        for a, b in pairwise(points)
    ]
    for one, other in pairwise(bodies):
        client.setCollisionFilterPair(one, other, -1, -1, 0)
        client.createConstraint(
            one,
            -1,
            other,
            -1,
            pybullet.JOINT_POINT2POINT,
            (0, 0, 0),
            (0, 0, half_m),
            (0, 0, -half_m),
        )
    return bodies


def _turn_z_onto(direction: Floats) -> tuple[float, ...]:
    """Return the quaternion (xyzw) that turns z onto a direction."""
    x, y, z = direction / np.linalg.norm(direction)
    quat_xyzw = np.array([-y, x, 0.0, 1.0 + z])
    return tuple(quat_xyzw / np.linalg.norm(quat_xyzw))
