"""Suction cups that seal on flat faces, and let go of what is too much for them.

A cup holds with pressure times area, along its axis. Several on one edge share a pull evenly; a
moment about the tool's x axis, that of a box which hangs out before the cups, is taken by those
that are far from the edge about which it would turn. Shear is taken by friction on what presses
the lips on. A box that asks for more comes off (the usual sizing of vacuum grippers, e.g. Mantriota
and Messina, "Theoretical and experimental study of the performance of flat suction cups", 2011).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robots.descriptions.kinova import CUP_RADIUS_M, CUPS_M, SUCTION_FRAME
from simulation.poses import pose_matrices
from simulation.shelf_cell.physics import ShelfPhysics

Floats = NDArray[np.float64]

_RIM_POINTS = 8
# Lips give way that far along the cup's axis, and reach that far beyond where they are drawn.
_BEHIND_M, _AHEAD_M, _LIP_GIVES_M = 0.006, 0.0025, 0.0015
_LEAN_COSINE = np.cos(np.radians(10.0))
# A load that lasts for no longer than this is a jolt, which lips take [s].
_JOLT_S = 0.015
# A safety factor of two and a half: what is lifted by a face that stands rubs on the floor, comes
# off it askew, and is set in motion.
USED = 0.4
GRAVITY_M_S2 = 9.81


@dataclass(frozen=True, slots=True)
class Vacuum:
    """How well the cups hold.

    Attributes:
        pressure_pa: Below the air around.
        friction: Of a lip on a face.
        build_up_s: From valve to hold.
    """

    pressure_pa: float = 70_000.0
    friction: float = 0.6
    build_up_s: float = 0.25


class Cups:
    """The cups of a tool: off, sucking air, or holding a box."""

    def __init__(self, physics: ShelfPhysics, vacuum: Vacuum) -> None:
        """Begin switched off."""
        self._physics, self._vacuum = physics, vacuum
        self._on_s: float | None = None
        self._overload_s = 0.0
        self._constraint: int | None = None
        self._sealed: Floats = np.zeros(0)
        self.held = ""

    @property
    def on(self) -> bool:
        """Whether the valve is open."""
        return self._on_s is not None

    def switch(self, on: bool) -> None:
        """Open or shut the valve; shut, cups let go."""
        if on and self._on_s is None:
            self._on_s = 0.0
        elif not on:
            self._on_s = None
            self._let_go()

    def advance(self, duration_s: float) -> None:
        """Let pressure build up, take hold of what seals, and let go of what is too much."""
        if self._on_s is None:
            return
        self._on_s += duration_s
        if self._constraint is None:
            if self._on_s >= self._vacuum.build_up_s:
                self._take_hold()
        elif self._too_much():
            self._overload_s += duration_s
            if self._overload_s > _JOLT_S:
                self._let_go()
                self._on_s = 0.0
        else:
            self._overload_s = 0.0

    def sealing(self) -> dict[str, list[float]]:
        """Return which cups would seal now on which box: their places along y [m]."""
        tip = self._physics.link_pose(SUCTION_FRAME)
        T_world_tip = pose_matrices(tip[None, :3], tip[None, 3:])[0]
        found: dict[str, list[float]] = {}
        for y_m in CUPS_M:
            name = self._seals_on(T_world_tip, y_m)
            if name:
                found.setdefault(name, []).append(y_m)
        return found

    def _seals_on(self, T_world_tip: Floats, y_m: float) -> str:
        """Return the box on whose flat face the whole rim of a cup lies, or nothing."""
        angles = np.linspace(0.0, 2.0 * np.pi, _RIM_POINTS, endpoint=False)
        rim = np.zeros((_RIM_POINTS + 1, 3))
        rim[1:, 0] = CUP_RADIUS_M * np.cos(angles)
        rim[1:, 1] = CUP_RADIUS_M * np.sin(angles)
        rim[:, 1] += y_m
        axis = T_world_tip[:3, 2]
        points = rim @ T_world_tip[:3, :3].T + T_world_tip[:3, 3]
        hits = self._physics.faces_ahead(points - _BEHIND_M * axis, points + _AHEAD_M * axis)
        names = {name for name, _, _ in hits}
        if len(names) != 1 or "" in names:
            return ""
        ways_m = np.array([share for _, share, _ in hits]) * (_BEHIND_M + _AHEAD_M)
        flat = np.ptp(ways_m) <= 2.0 * _LIP_GIVES_M
        facing = all(-float(normal @ axis) >= _LEAN_COSINE for _, _, normal in hits)
        return names.pop() if flat and facing else ""

    def _take_hold(self) -> None:
        found = self.sealing() if self._vacuum.pressure_pa > 0.0 else {}
        if found:
            name = max(found, key=lambda box: len(found[box]))
            self._sealed = np.array(found[name])
            self._constraint = self._physics.attach(name)
            self.held, self._overload_s = name, 0.0

    def _let_go(self) -> None:
        if self._constraint is not None:
            self._physics.release(self.held, self._constraint)
        self._constraint, self.held, self._overload_s = None, "", 0.0

    def _too_much(self) -> bool:
        assert self._constraint is not None
        force_n, torque_nm = self._physics.load(self._constraint)
        return overloaded(force_n, torque_nm, self._sealed, self._vacuum)


def lift_of(vacuum: Vacuum) -> tuple[float, float]:
    """Return what all cups of the tool take by their data: a weight [kg] and a moment [N m]."""
    one_n = USED * vacuum.pressure_pa * np.pi * CUP_RADIUS_M**2
    levers_m = np.array(CUPS_M) - min(CUPS_M) + CUP_RADIUS_M
    weight_kg = vacuum.friction * one_n * len(CUPS_M) / GRAVITY_M_S2
    return float(weight_kg), float(one_n * levers_m.sum())


def overloaded(force_n: Floats, torque_nm: Floats, cups_m: Floats, vacuum: Vacuum) -> bool:
    """Return whether cups come off.

    Args:
        force_n: Force of the box on the tool, in the suction frame, shape (3,).
        torque_nm: Its torque about the origin of that frame, shape (3,).
        cups_m: Places along y of the cups that seal, shape (K,).
        vacuum: How well they hold.
    """
    one_n = vacuum.pressure_pa * np.pi * CUP_RADIUS_M**2
    most_n = one_n * len(cups_m)
    if most_n == 0.0:
        return True
    pull_n = max(0.0, float(force_n[2]))
    middle_m = float(cups_m.mean())
    bending_nm = float(torque_nm[0]) - middle_m * float(force_n[2])
    # Turning about +x takes the cups at low y off last: the edge is there.
    edge_m = cups_m.min() - CUP_RADIUS_M if bending_nm > 0.0 else cups_m.max() + CUP_RADIUS_M
    levers_m = np.abs(cups_m - edge_m)
    bent = abs(bending_nm) / (one_n * float(levers_m.sum()))
    tilted = abs(float(torque_nm[1])) / (most_n * CUP_RADIUS_M)
    pressed_n = max(most_n - pull_n, 0.0)
    shear_n = float(np.hypot(force_n[0], force_n[1]))
    twist_m = max(CUP_RADIUS_M, float(np.abs(cups_m - middle_m).mean()))
    twist_n = abs(float(torque_nm[2]) + middle_m * float(force_n[0])) / twist_m
    slips = shear_n + twist_n > vacuum.friction * pressed_n
    return pull_n / most_n + bent + tilted > 1.0 or slips
