"""The cable beside theory: capstan, catenary, cantilever, energy at rest; topology that is kept."""

from collections.abc import Iterator, Sequence
from math import asinh, cosh, exp, pi, radians

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from benchmarks.harness import Row, share
from perception.cable.topology.alexander import alexander_polynomial
from perception.cable.topology.curve import close_over, curve_crossings
from perception.cable.topology.simplify import simplify
from simulation.cable.configurations import starting_configuration
from simulation.cable.knot_names import KnotName
from simulation.cable.parameters import RodParameters
from simulation.cable.rod import Rod

Floats = NDArray[np.float64]
STEP_S = 1.0 / 240.0
WRAPS_DEG = (90, 180, 270, 360, 450, 540)
FRICTION = 0.2
DRUM_M = 0.03
SPACING_M = 0.005
# Ten times as stiff as the usual cable.
STIFF_N_M2 = 5e-4
FINE_STEP_S = 5e-5
# Full speed of the arms on lines is a quarter of this.
HAND_M_S = 1.0
KNOTS: tuple[KnotName, ...] = ("overhand", "figure_8", "none")


def laws(quick: bool, seed: int) -> Iterator[Row]:
    """Hold the cable to mechanics."""
    for wrap_deg in WRAPS_DEG[1::3] if quick else WRAPS_DEG:
        yield _one(f"capstan_ratio_error_{wrap_deg}_deg", capstan_error(wrap_deg), "<= 0.1")
    for span in (0.5, 0.7, 0.85):
        yield _one(f"catenary_sag_error_span_{100 * span:.0f}", catenary_error(span), "<= 0.02")
    for steps, substep_s in (("usual", RodParameters().substep_s), ("fine", FINE_STEP_S)):
        name = f"cantilever_droop_error_{steps}_steps"
        yield _one(name, cantilever_error(substep_s), "<= 0.05")
    growths = [energy_growth(seed + number) for number in range(2 if quick else 10)]
    yield Row(
        "energy_growth_at_rest", max(growths), "1", len(growths), min(growths), max(growths),
        "<= 0.0001",
    )  # fmt: skip
    kept = list(pushes_and_pulls(seed, 2 if quick else 20, 10 if quick else 50))
    yield share("crossings_kept_in_pushes_and_pulls", sum(kept), len(kept), "= 1")


def _one(name: str, error: float, goal: str) -> Row:
    return Row(name, error, "1", 1, error, error, goal)


def capstan_error(wrap_deg: float) -> float:
    """Pull a cable round a drum; compare the ratio of tensions with Euler and Eytelwein's.

    The cable is a helix round the drum, so that strands beside each other do not touch; its total
    curvature, the angle of the formula, is a little less than the wrap.
    """
    parameters = RodParameters(
        gravity_m_s2=0.0,
        connector_length_m=0.0,
        friction_obstacles=FRICTION,
        friction_self=0.0,
        pinch_force_n=2.0,
        bending_stiffness_n_m2=1e-6,
        air_damping_1_s=10.0,
        node_spacing_m=SPACING_M,
    )
    wrap, reach_m = radians(wrap_deg), DRUM_M + 1.05 * parameters.radius_m
    climb_m = 4.0 * parameters.radius_m / (2.0 * pi)
    nodes_m = _round_drum(wrap, reach_m, climb_m)
    rod = Rod(nodes_m, parameters)
    rod.set_capsules(np.array([[0.0, -0.3, 0.5]]), np.array([[0.0, 0.3, 0.5]]), np.array([DRUM_M]))
    _grasp(rod, "held", "pinch", nodes_m[20])
    _grasp(rod, "pulled", "cage", nodes_m[-2])
    out = nodes_m[-1] - nodes_m[-10]
    _carry(rod, "pulled", nodes_m[-2] + 0.02 * out / np.linalg.norm(out), 0.03)
    slack, tight = rod.tensions_n[24:34].mean(), rod.tensions_n[-30:-10].mean()
    turned = wrap * reach_m / np.hypot(reach_m, climb_m)
    return float(abs(tight / slack / exp(FRICTION * turned) - 1.0))


def _round_drum(wrap: float, reach_m: float, climb_m: float) -> Floats:
    """Return a cable that comes straight, winds round the axis y, and leaves straight down."""
    count = round(wrap * np.hypot(reach_m, climb_m) / SPACING_M) + 1
    angles = np.linspace(wrap, 0.0, count)
    climbs = climb_m * (0.5 * wrap - angles)
    wound = np.column_stack([reach_m * np.cos(angles), climbs, reach_m * np.sin(angles)])
    first, last = wound[0] - wound[1], wound[-1] - wound[-2]
    first, last = (SPACING_M * way / np.linalg.norm(way) for way in (first, last))
    tail = np.arange(1, 61)[:, None]
    nodes_m = np.vstack([(wound[0] + tail * first)[::-1], wound, wound[-1] + tail * last])
    return np.array(nodes_m + np.array([0.0, 0.0, 0.5]))


def catenary_error(span: float) -> float:
    """Hang a metre of cable from two hands; return the relative error of its sag.

    Args:
        span: Distance of the hands as a share of the length.
    """
    rod = Rod(
        _straight(1.0, 1.0),
        RodParameters(bending_stiffness_n_m2=1e-6, connector_mass_kg=0.0, air_damping_1_s=3.0),
    )
    for hand, x_m in (("left", -0.5), ("right", 0.5)):
        _grasp(rod, hand, "pinch", np.array([x_m, 0.0, 1.0]))
    for share_done in np.linspace(0.0, 1.0, 240):
        half_m = 0.5 + share_done * (0.5 * span - 0.5)
        for hand, side in (("left", -1.0), ("right", 1.0)):
            rod.move_hand(hand, _tool(np.array([side * half_m, 0.0, 1.0])))
        rod.advance(STEP_S)
    rod.advance(2.0)
    # length = 2 a sinh(span / 2 a), sag = a (cosh(span / 2 a) - 1)
    a_m = brentq(lambda a: 2.0 * a * asinh(0.5 / a) - span, 0.01, 5.0)
    sag_m = a_m * (cosh(0.5 * span / a_m) - 1.0)
    return float(abs((1.0 - rod.positions_m[:, 2].min()) / sag_m - 1.0))


def cantilever_error(substep_s: float) -> float:
    """Let a stiff cable stand out beyond two supports; return the relative error of its droop.

    For a beam of bending stiffness B and weight w a length, on supports `a` apart, that stands out
    by L, the tip droops by w L (3 L^3 + 4 L^2 a - a^3) / (24 B).

    Args:
        substep_s: Of the solver.
    """
    parameters = RodParameters(
        connector_mass_kg=0.0,
        connector_length_m=0.0,
        cage_clearance_m=0.0,
        friction_cage=0.0,
        air_damping_1_s=5.0,
        bending_stiffness_n_m2=STIFF_N_M2,
        substep_s=substep_s,
    )
    between_m, out_m = 0.06, 0.08
    nodes_m = _straight(between_m + out_m, 1.0)
    rod = Rod(nodes_m, parameters)
    inner = round(between_m / parameters.node_spacing_m)
    _grasp(rod, "root", "pinch", nodes_m[0])
    _grasp(rod, "edge", "cage", nodes_m[inner])
    rod.advance(3.0)
    weight_n_m = parameters.density_kg_m * parameters.gravity_m_s2
    cubes = 3.0 * out_m**3 + 4.0 * out_m**2 * between_m - between_m**3
    droop_m = weight_n_m * out_m * cubes / (24.0 * parameters.bending_stiffness_n_m2)
    measured_m = rod.positions_m[inner, 2] - rod.positions_m[-1, 2]
    return float(abs(measured_m / droop_m - 1.0))


def energy_growth(seed: int) -> float:
    """Return by what share the energy of a knotted cable at rest grows at most within 3 s."""
    nodes_m = starting_configuration(KNOTS[seed % 3], np.random.default_rng(seed))
    rod = Rod(nodes_m, RodParameters(rest_speed_m_s=0.0))
    first_j = rod.energy_j()
    growth = 0.0
    for _ in range(30):
        rod.advance(0.1)
        growth = max(growth, rod.energy_j() / first_j - 1.0)
    return growth


def pushes_and_pulls(seed: int, cables: int, actions: int) -> Iterator[bool]:
    """Push and pull cables at random, at a metre a second; say of each whether its knot stayed.

    Both ends are held up, so that no loop can slip over one: whatever the strands do on the table,
    the knot that they make, told by its Alexander polynomial, can only change by a strand that
    passes through another.
    """
    for number in range(cables):
        rng = np.random.default_rng([seed, number])
        nodes_m = starting_configuration(KNOTS[number % 3], rng)
        rod = Rod(nodes_m)
        _lift_ends(rod, nodes_m)
        knot = _polynomial(rod.positions_m)
        for _ in range(actions):
            (_push if rng.random() < 0.5 else _pull)(rod, rng)
            rod.advance(0.1)
            now = _polynomial(rod.positions_m)
            yield now == knot
            knot = now


def _lift_ends(rod: Rod, nodes_m: Floats) -> None:
    ends = {"first": nodes_m[3], "last": nodes_m[-4]}
    for hand, point_m in ends.items():
        _grasp(rod, hand, "pinch", point_m)
    for height_m in np.linspace(0.0, 0.12, 120):
        for hand, point_m in ends.items():
            rod.move_hand(hand, _tool(point_m + np.array([0.0, 0.0, height_m])))
        rod.advance(STEP_S)


def _polynomial(nodes_m: Floats) -> Sequence[int]:
    return alexander_polynomial(simplify(close_over(curve_crossings(nodes_m))))


def _pull(rod: Rod, rng: np.random.Generator) -> None:
    """Take hold of an inner point, carry it off, and let it go."""
    start_m = rod.positions_m[int(rng.integers(40, len(rod.positions_m) - 40))].copy()
    rod.move_hand("probe", _tool(start_m))
    rod.close_hand("probe", "pinch", 0.02, 0.01, 0.01)
    way_m = rng.uniform(0.05, 0.2) * _direction(rng)
    _carry(rod, "probe", start_m + way_m + np.array([0.0, 0.0, rng.uniform(0.0, 0.04)]), HAND_M_S)
    rod.release_hand("probe")


def _push(rod: Rod, rng: np.random.Generator) -> None:
    """Sweep a finger through the cable."""
    middle_m = rod.positions_m[int(rng.integers(40, len(rod.positions_m) - 40))].copy()
    way_m = rng.uniform(0.05, 0.2) * _direction(rng)
    low_m = np.array([middle_m[0], middle_m[1], 0.004]) - 0.4 * way_m
    radii_m, tall_m = np.array([0.005]), np.array([0.0, 0.0, 0.05])
    above_m = np.array([0.0, 0.0, 0.3])
    steps = round(float(np.linalg.norm(way_m)) / HAND_M_S / STEP_S)
    rod.set_capsules((low_m + above_m)[None], (low_m + tall_m + above_m)[None], radii_m)
    for height in np.linspace(1.0, 0.0, 60):
        at_m = (low_m + height * above_m)[None]
        rod.set_capsules(at_m, at_m + tall_m, radii_m)
        rod.advance(STEP_S)
    for step in range(1, steps + 1):
        at_m = (low_m + way_m * step / steps)[None]
        rod.set_capsules(at_m, at_m + tall_m, radii_m)
        rod.advance(STEP_S)
    rod.set_capsules(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0))
    rod.advance(STEP_S)


def _direction(rng: np.random.Generator) -> Floats:
    angle = rng.uniform(0.0, 2.0 * pi)
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def _straight(length_m: float, z_m: float, spacing_m: float = 0.01) -> Floats:
    arcs = np.arange(round(length_m / spacing_m) + 1) * spacing_m - 0.5 * length_m
    return np.column_stack([arcs, np.zeros(len(arcs)), np.full(len(arcs), z_m)])


def _tool(point_m: Floats) -> Floats:
    """Return a hand that points down and opens along y."""
    pose = np.diag([1.0, -1.0, -1.0, 1.0])
    pose[:3, :2] = [[0.0, 1.0], [1.0, 0.0], [0.0, 0.0]]
    pose[:3, 3] = point_m
    return pose


def _grasp(rod: Rod, hand: str, mode: str, point_m: Floats) -> None:
    rod.move_hand(hand, _tool(point_m))
    if not rod.close_hand(hand, "cage" if mode == "cage" else "pinch", 0.04, 0.01, 0.008):
        raise RuntimeError("the hand closed on nothing; the cable is not where it was laid")


def _carry(rod: Rod, hand: str, target_m: Floats, speed_m_s: float) -> None:
    start_m = rod.hands[hand].pose[:3, 3].copy()
    steps = max(1, round(float(np.linalg.norm(target_m - start_m)) / speed_m_s / STEP_S))
    for step in range(1, steps + 1):
        rod.move_hand(hand, _tool(start_m + (target_m - start_m) * step / steps))
        rod.advance(STEP_S)
