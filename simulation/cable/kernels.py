"""The compiled solver of the rod: extended position-based dynamics with small steps.

Each step predicts positions, then corrects them: bending node by node, stretch of the whole
chain at once (its constraints form a tridiagonal system), contacts and grasps one by one.
One pass over many small steps converges better than many passes over few large ones
(Macklin et al., "Small Steps in Physics Simulation", 2019); the direct stretch solve follows
Deul et al., "Direct Position-Based Solver for Stiff Rods", 2018.

All kernels live in this one file: the compiler's cache looks only at the file of the function
that is called, and would keep stale code of helpers that live elsewhere.
"""

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# A step never moves a contact by more than this, so that a deep overlap does not explode [m].
LARGEST_PUSH_M = 0.004
# From these tensions on, steps are split into two and into four [N].
SHORTER_STEPS_N = 2.0
SHORTEST_STEPS_N = 8.0
# What is left of an earlier peak of tension after a step.
PEAK_MEMORY = 0.995
# Nodes are never faster than this [m/s]; arms move the cable at up to about 1 m/s.
LARGEST_SPEED_M_S = 8.0
# Segments this close along the chain are kept apart by bending, not by contact.
CHAIN_NEIGHBOURS = 3
# Rod segments this close to a grasp do not feel the fingers, which hold them.
GRASP_NEIGHBOURS = 2
# Every this many steps the candidate lists are checked against how far things have moved.
SKIN_M = 0.008


class Chain(NamedTuple):
    """State of the rod; N nodes, N - 1 segments."""

    positions: Floats  # (N, 3)
    previous: Floats  # (N, 3)
    velocities: Floats  # (N, 3)
    inverse_masses: Floats  # (N,)
    rest_lengths: Floats  # (N - 1,)
    bending_compliances: Floats  # (N,)
    tensions: Floats  # (N - 1,), mean over the last advance [N]
    peak: Floats  # (1,), greatest tension of late [N]
    directions: Floats  # (N - 1, 3), scratch
    solution: Floats  # (N - 1,), scratch
    sweep: Floats  # (N - 1,), scratch


class Neighbours(NamedTuple):
    """Segments that may touch each other or an obstacle before the lists are made anew."""

    reference: Floats  # (N, 3), positions at the last making
    obstacle_reference: Floats  # (M, 6)
    order: Ints  # (N - 1,), segments sorted by x
    pairs: Ints  # (P, 2)
    normals: Floats  # (P, 3), from the second to the first, kept to notice a strand passing through
    obstacle_pairs: Ints  # (Q, 2), segment and obstacle
    counts: Ints  # (2,), pairs and obstacle pairs in use; -1 asks for making anew


class Obstacles(NamedTuple):
    """Capsules that move in straight lines during an advance."""

    start: Floats  # (M, 6), both ends at the beginning
    end: Floats  # (M, 6), both ends at the end
    radii: Floats  # (M,)


class Rings(NamedTuple):
    """Grasps: each holds one point of the cable in one place, and lets it slide or not."""

    start: Floats  # (R, 3)
    end: Floats  # (R, 3)
    arc: Floats  # (R,), material coordinate in segments
    arc_limits: Floats  # (R, 2)
    clearance: Floats  # (R,)
    grip_force: Floats  # (R,), friction force that needs no normal force
    friction: Floats  # (R,)
    force: Floats  # (R, 3), mean force of the ring on the cable over the last advance


class Constants(NamedTuple):
    """Numbers of `RodParameters` that the solver needs."""

    radius: float
    stretch_compliance: float
    bending_damping: float
    air_damping: float
    friction_table: float
    friction_self: float
    friction_obstacles: float
    overload_force: float
    half_table_x: float
    half_table_y: float
    floor_height: float
    gravity: float


@numba.njit(cache=True)
def advance(
    chain: Chain,
    near: Neighbours,
    obstacles: Obstacles,
    rings: Rings,
    constants: Constants,
    steps: int,
    step_s: float,
) -> None:
    """Advance by `steps` steps of `step_s` each."""
    chain.tensions[:] = 0.0
    rings.force[:] = 0.0
    for step in range(steps):
        parts = _parts(chain.peak[0])
        part_s, share = step_s / parts, 1.0 / (steps * parts)
        for part in range(parts):
            done = (step * parts + part + 1.0) * share
            _predict(chain, constants, part_s)
            _bend(chain, constants, part_s, part == step % 2)
            _stretch(chain, rings, constants, part_s, share)
            _refresh(chain, near, obstacles, constants, rings, done)
            _touch_self(chain, near, constants)
            _touch_obstacles(chain, near, obstacles, constants, done, share)
            _hold(chain, rings, constants, done, part_s, share)
            _rest_on_table(chain, constants)
            _update_velocities(chain, part_s)


@numba.njit(cache=True)
def _parts(peak: float) -> int:
    """Return into how many parts a step is split at that tension.

    A contact bears what its nodes' mass times 1 / step^2 makes of an overlap; in a knot that
    is pulled tight, strands would pass through each other without shorter steps.
    """
    if peak < SHORTER_STEPS_N:
        return 1
    return 2 if peak < SHORTEST_STEPS_N else 4


@numba.njit(cache=True)
def _predict(chain: Chain, constants: Constants, step_s: float) -> None:
    keep = 1.0 - constants.air_damping * step_s
    for i in range(len(chain.positions)):
        chain.velocities[i, 2] -= constants.gravity * step_s
        for k in range(3):
            chain.previous[i, k] = chain.positions[i, k]
            chain.velocities[i, k] *= keep
            chain.positions[i, k] += chain.velocities[i, k] * step_s


@numba.njit(cache=True)
def _update_velocities(chain: Chain, step_s: float) -> None:
    for i in range(len(chain.positions)):
        square = 0.0
        for k in range(3):
            chain.velocities[i, k] = (chain.positions[i, k] - chain.previous[i, k]) / step_s
            square += chain.velocities[i, k] ** 2
        if square > LARGEST_SPEED_M_S**2:
            slow = LARGEST_SPEED_M_S / np.sqrt(square)
            for k in range(3):
                chain.velocities[i, k] *= slow


@numba.njit(cache=True)
def _bend(chain: Chain, constants: Constants, step_s: float, forward: bool) -> None:
    """Pull second differences to zero: energy |x- - 2x + x+|^2 B / (2 ds^3)."""
    x, before, w = chain.positions, chain.previous, chain.inverse_masses
    gamma = constants.bending_damping / step_s
    count = len(x)
    for n in range(1, count - 1):
        i = n if forward else count - 1 - n
        weight = w[i - 1] + 4.0 * w[i] + w[i + 1]
        scale = 1.0 / ((1.0 + gamma) * weight + chain.bending_compliances[i] / step_s**2)
        for k in range(3):
            now = x[i - 1, k] - 2.0 * x[i, k] + x[i + 1, k]
            then = before[i - 1, k] - 2.0 * before[i, k] + before[i + 1, k]
            push = -(now + gamma * (now - then)) * scale
            x[i - 1, k] += w[i - 1] * push
            x[i, k] -= 2.0 * w[i] * push
            x[i + 1, k] += w[i + 1] * push


@numba.njit(cache=True)
def _stretch(chain: Chain, rings: Rings, constants: Constants, step_s: float, share: float) -> None:
    """Restore all lengths at once.

    Nodes in a grasp move only along the cable here, so that the pull of a hand reaches the
    whole chain in one solve.
    """
    x, w, g = chain.positions, chain.inverse_masses, chain.directions
    diagonal, solution = chain.sweep, chain.solution
    count = len(g)
    compliance = constants.stretch_compliance / step_s**2
    guided = _guided_nodes(rings, solution, constants.overload_force * step_s**2)
    for i in range(count):
        dx = x[i + 1, 0] - x[i, 0]
        dy = x[i + 1, 1] - x[i, 1]
        dz = x[i + 1, 2] - x[i, 2]
        length = np.sqrt(dx * dx + dy * dy + dz * dz) + 1e-12
        g[i, 0] = dx / length
        g[i, 1] = dy / length
        g[i, 2] = dz / length
        diagonal[i] = w[i] + w[i + 1] + compliance * chain.rest_lengths[i]
        solution[i] = length - chain.rest_lengths[i]
    coupling = np.empty(count)
    for i in range(count - 1):
        coupling[i] = -w[i + 1] * (
            g[i, 0] * g[i + 1, 0] + g[i, 1] * g[i + 1, 1] + g[i, 2] * g[i + 1, 2]
        )
    fixed = np.empty((len(guided), 3))
    along = np.empty((len(guided), 3))
    for r in range(len(guided)):
        n = guided[r]
        fixed[r] = x[n]
        along[r] = _tangent(x, n)
        into = w[n] * _dot(along[r], g[n - 1])
        out = w[n] * _dot(along[r], g[n])
        diagonal[n - 1] += into * _dot(along[r], g[n - 1]) - w[n]
        diagonal[n] += out * _dot(along[r], g[n]) - w[n]
        coupling[n - 1] = -into * _dot(along[r], g[n])
    for i in range(1, count):
        factor = coupling[i - 1] / diagonal[i - 1]
        diagonal[i] -= factor * coupling[i - 1]
        solution[i] -= factor * solution[i - 1]
    solution[count - 1] /= diagonal[count - 1]
    for i in range(count - 2, -1, -1):
        solution[i] = (solution[i] - coupling[i] * solution[i + 1]) / diagonal[i]
    peak = PEAK_MEMORY * chain.peak[0]
    for i in range(count):
        tension = solution[i] / step_s**2
        chain.tensions[i] += tension * share
        peak = max(peak, tension)
        for k in range(3):
            x[i, k] += w[i] * g[i, k] * solution[i]
            x[i + 1, k] -= w[i + 1] * g[i, k] * solution[i]
    chain.peak[0] = peak
    for r in range(len(guided)):
        n = guided[r]
        moved = _dot(x[n] - fixed[r], along[r])
        for k in range(3):
            x[n, k] = fixed[r, k] + moved * along[r, k]


@numba.njit(cache=True)
def _guided_nodes(rings: Rings, pulls: Floats, overload: float) -> Ints:
    """Return the inner node nearest to each ring that is not overloaded, each node once."""
    guided = np.empty(len(rings.arc), np.int64)
    count = 0
    for r in range(len(rings.arc)):
        node = min(max(int(np.round(rings.arc[r])), 1), len(pulls) - 1)
        known = max(pulls[node - 1], pulls[node]) > overload
        for other in range(count):
            known = known or guided[other] == node
        if not known:
            guided[count] = node
            count += 1
    return guided[:count]


@numba.njit(cache=True)
def _tangent(x: Floats, node: int) -> Floats:
    along = x[node + 1] - x[node - 1]
    return along / (np.sqrt(_dot(along, along)) + 1e-12)


@numba.njit(cache=True)
def _dot(a: Floats, b: Floats) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@numba.njit(cache=True)
def _refresh(
    chain: Chain,
    near: Neighbours,
    obstacles: Obstacles,
    constants: Constants,
    rings: Rings,
    done: float,
) -> None:
    """Make the candidate lists anew where anything has moved by half the skin."""
    limit = (0.5 * SKIN_M) ** 2
    fresh = near.counts[0] >= 0
    for i in range(len(chain.positions)):
        square = 0.0
        for k in range(3):
            square += (chain.positions[i, k] - near.reference[i, k]) ** 2
        if square > limit:
            fresh = False
    for m in range(len(obstacles.radii)):
        for end in range(2):
            square = 0.0
            for k in range(3 * end, 3 * end + 3):
                now = obstacles.start[m, k] * (1.0 - done) + obstacles.end[m, k] * done
                square += (now - near.obstacle_reference[m, k]) ** 2
            if square > limit:
                fresh = False
    if fresh:
        return
    near.reference[:] = chain.positions
    near.obstacle_reference[:] = obstacles.start * (1.0 - done) + obstacles.end * done
    _list_pairs(chain, near, constants)
    _list_obstacle_pairs(chain, near, obstacles, constants, rings)


@numba.njit(cache=True)
def _list_pairs(chain: Chain, near: Neighbours, constants: Constants) -> None:
    """Sweep along x over segments sorted by their middle."""
    x = chain.positions
    order = near.order
    middles = 0.5 * (x[1:] + x[:-1])
    for n in range(1, len(order)):  # insertion sort: the order hardly changes between calls
        segment = order[n]
        place = n
        while place > 0 and middles[order[place - 1], 0] > middles[segment, 0]:
            order[place] = order[place - 1]
            place -= 1
        order[place] = segment
    longest = chain.rest_lengths.max() * 1.1
    reach = 2.0 * constants.radius + SKIN_M
    old_count = near.counts[0]
    old_pairs = near.pairs[: max(old_count, 0)].copy()
    old_normals = near.normals[: max(old_count, 0)].copy()
    count = 0
    for n in range(len(order)):
        for later in range(n + 1, len(order)):
            a = min(order[n], order[later])
            b = max(order[n], order[later])
            if middles[order[later], 0] - middles[order[n], 0] > reach + longest:
                break
            if b - a < CHAIN_NEIGHBOURS or count == len(near.pairs):
                continue
            if abs(middles[a, 1] - middles[b, 1]) > reach + longest:
                continue
            s, t = _closest(x[a], x[a + 1], x[b], x[b + 1])
            gap = x[a] + s * (x[a + 1] - x[a]) - x[b] - t * (x[b + 1] - x[b])
            distance = np.sqrt(_dot(gap, gap)) + 1e-12
            if distance < reach:
                near.pairs[count, 0] = a
                near.pairs[count, 1] = b
                near.normals[count] = gap / distance
                for other in range(len(old_pairs)):
                    if old_pairs[other, 0] == a and old_pairs[other, 1] == b:
                        near.normals[count] = old_normals[other]
                count += 1
    near.counts[0] = count


@numba.njit(cache=True)
def _list_obstacle_pairs(
    chain: Chain, near: Neighbours, obstacles: Obstacles, constants: Constants, rings: Rings
) -> None:
    x = chain.positions
    now = near.obstacle_reference
    count = 0
    for m in range(len(obstacles.radii)):
        reach = obstacles.radii[m] + constants.radius + SKIN_M
        for i in range(len(chain.rest_lengths)):
            outside = False
            for k in range(3):
                low = min(now[m, k], now[m, k + 3]) - reach
                high = max(now[m, k], now[m, k + 3]) + reach
                if max(x[i, k], x[i + 1, k]) < low or min(x[i, k], x[i + 1, k]) > high:
                    outside = True
            if outside or count == len(near.obstacle_pairs):
                continue
            held = False
            for r in range(len(rings.arc)):
                held = held or abs(i + 0.5 - rings.arc[r]) < GRASP_NEIGHBOURS
            if not held:
                near.obstacle_pairs[count, 0] = i
                near.obstacle_pairs[count, 1] = m
                count += 1
    near.counts[1] = count


@numba.njit(cache=True)
def _closest(p1: Floats, q1: Floats, p2: Floats, q2: Floats) -> tuple[float, float]:
    """Return where two segments are closest, as fractions of their lengths.

    Ericson, "Real-Time Collision Detection", section 5.1.9.
    """
    d1x, d1y, d1z = q1[0] - p1[0], q1[1] - p1[1], q1[2] - p1[2]
    d2x, d2y, d2z = q2[0] - p2[0], q2[1] - p2[1], q2[2] - p2[2]
    rx, ry, rz = p1[0] - p2[0], p1[1] - p2[1], p1[2] - p2[2]
    a = d1x * d1x + d1y * d1y + d1z * d1z + 1e-18
    e = d2x * d2x + d2y * d2y + d2z * d2z + 1e-18
    b = d1x * d2x + d1y * d2y + d1z * d2z
    c = d1x * rx + d1y * ry + d1z * rz
    f = d2x * rx + d2y * ry + d2z * rz
    denominator = a * e - b * b
    s = 0.5
    if denominator > 1e-6 * a * e:
        s = min(max((b * f - c * e) / denominator, 0.0), 1.0)
    t = (b * s + f) / e
    if t < 0.0:
        t = 0.0
        s = min(max(-c / a, 0.0), 1.0)
    elif t > 1.0:
        t = 1.0
        s = min(max((b - c) / a, 0.0), 1.0)
    return s, t


@numba.njit(cache=True)
def _touch_self(chain: Chain, near: Neighbours, constants: Constants) -> None:
    """Keep strands apart, with friction.

    A strand that has passed through another one's centre line within a step is noticed by the
    direction between them turning over, and is pushed back to the side that it came from.
    """
    x, before, w = chain.positions, chain.previous, chain.inverse_masses
    diameter = 2.0 * constants.radius
    for p in range(near.counts[0]):
        a, b = near.pairs[p, 0], near.pairs[p, 1]
        s, t = _closest(x[a], x[a + 1], x[b], x[b + 1])
        nx, ny, nz = 0.0, 0.0, 0.0
        nx = x[a, 0] + s * (x[a + 1, 0] - x[a, 0]) - x[b, 0] - t * (x[b + 1, 0] - x[b, 0])
        ny = x[a, 1] + s * (x[a + 1, 1] - x[a, 1]) - x[b, 1] - t * (x[b + 1, 1] - x[b, 1])
        nz = x[a, 2] + s * (x[a + 1, 2] - x[a, 2]) - x[b, 2] - t * (x[b + 1, 2] - x[b, 2])
        gap = np.sqrt(nx * nx + ny * ny + nz * nz)
        old = near.normals[p]
        if gap > 1e-9:
            nx, ny, nz = nx / gap, ny / gap, nz / gap
            if nx * old[0] + ny * old[1] + nz * old[2] < 0.0 and gap < diameter:
                nx, ny, nz, gap = -nx, -ny, -nz, -gap
        else:
            nx, ny, nz = old[0], old[1], old[2]
        old[0], old[1], old[2] = nx, ny, nz
        if gap >= diameter:
            continue
        weight = w[a] * (1.0 - s) ** 2 + w[a + 1] * s**2 + w[b] * (1.0 - t) ** 2 + w[b + 1] * t**2
        push = min(diameter - gap, LARGEST_PUSH_M)
        px, py, pz = push * nx, push * ny, push * nz
        slide = np.empty(3)
        for k in range(3):
            slide[k] = (
                (1.0 - s) * (x[a, k] - before[a, k])
                + s * (x[a + 1, k] - before[a + 1, k])
                - (1.0 - t) * (x[b, k] - before[b, k])
                - t * (x[b + 1, k] - before[b + 1, k])
            )
        normal_part = slide[0] * nx + slide[1] * ny + slide[2] * nz
        slide[0] -= normal_part * nx
        slide[1] -= normal_part * ny
        slide[2] -= normal_part * nz
        length = np.sqrt(_dot(slide, slide)) + 1e-15
        stick = min(1.0, constants.friction_self * push / length)
        slide[0] = (px - stick * slide[0]) / weight
        slide[1] = (py - stick * slide[1]) / weight
        slide[2] = (pz - stick * slide[2]) / weight
        for k in range(3):
            x[a, k] += w[a] * (1.0 - s) * slide[k]
            x[a + 1, k] += w[a + 1] * s * slide[k]
            x[b, k] -= w[b] * (1.0 - t) * slide[k]
            x[b + 1, k] -= w[b + 1] * t * slide[k]


@numba.njit(cache=True)
def _touch_obstacles(
    chain: Chain,
    near: Neighbours,
    obstacles: Obstacles,
    constants: Constants,
    done: float,
    share: float,
) -> None:
    """Push the cable out of capsules, with friction against their moving surface."""
    x, before, w = chain.positions, chain.previous, chain.inverse_masses
    for p in range(near.counts[1]):
        a, m = near.obstacle_pairs[p, 0], near.obstacle_pairs[p, 1]
        travel = (obstacles.end[m] - obstacles.start[m]) * share
        now = obstacles.start[m] * (1.0 - done) + obstacles.end[m] * done
        s, t = _closest(x[a], x[a + 1], now[:3], now[3:])
        normal = x[a] + s * (x[a + 1] - x[a]) - now[:3] - t * (now[3:] - now[:3])
        gap = np.sqrt(_dot(normal, normal)) + 1e-12
        depth = obstacles.radii[m] + constants.radius - gap
        if depth <= 0.0:
            continue
        normal /= gap
        surface = travel[:3] + t * (travel[3:] - travel[:3])
        slide = (1.0 - s) * (x[a] - before[a]) + s * (x[a + 1] - before[a + 1]) - surface
        push = min(depth, LARGEST_PUSH_M + max(0.0, _dot(surface, normal)))
        slide -= _dot(slide, normal) * normal
        length = np.sqrt(_dot(slide, slide)) + 1e-15
        stick = min(1.0, constants.friction_obstacles * push / length)
        weight = w[a] * (1.0 - s) ** 2 + w[a + 1] * s**2
        total = (push * normal - stick * slide) / weight
        for k in range(3):
            x[a, k] += w[a] * (1.0 - s) * total[k]
            x[a + 1, k] += w[a + 1] * s * total[k]


@numba.njit(cache=True)
def _hold(
    chain: Chain, rings: Rings, constants: Constants, done: float, step_s: float, share: float
) -> None:
    """Keep each held point in its ring; along the cable only as far as friction goes."""
    x, w = chain.positions, chain.inverse_masses
    for r in range(len(rings.arc)):
        centre = rings.start[r] * (1.0 - done) + rings.end[r] * done
        i = min(int(rings.arc[r]), len(x) - 2)
        f = rings.arc[r] - i
        along = x[i + 1] - x[i]
        length = np.sqrt(_dot(along, along)) + 1e-12
        along /= length
        offset = x[i] + f * length * along - centre
        weight = w[i] * (1.0 - f) ** 2 + w[i + 1] * f**2
        slip = _dot(offset, along)
        offset -= slip * along
        aside = np.sqrt(_dot(offset, offset)) + 1e-15
        push = min(
            max(aside - rings.clearance[r], 0.0),
            constants.overload_force * step_s**2 * weight,
        )
        bound = rings.grip_force[r] * step_s**2 * weight + rings.friction[r] * push
        stick = min(max(slip, -bound), bound)
        arc = rings.arc[r]
        if stick != slip:
            arc = min(
                max(arc - (slip - stick) / length, rings.arc_limits[r, 0]), rings.arc_limits[r, 1]
            )
            if arc in (rings.arc_limits[r, 0], rings.arc_limits[r, 1]):
                strongest = constants.overload_force * step_s**2 * weight
                stick = min(max(slip, -strongest), strongest)
            rings.arc[r] = arc
        total = -(push / aside * offset + stick * along) / weight
        rings.force[r] += total * (share / step_s**2)
        for k in range(3):
            x[i, k] += w[i] * (1.0 - f) * total[k]
            x[i + 1, k] += w[i + 1] * f * total[k]


@numba.njit(cache=True)
def _rest_on_table(chain: Chain, constants: Constants) -> None:
    """Keep nodes on the table, out of its sides, and above the floor."""
    x, before = chain.positions, chain.previous
    radius = constants.radius
    normal = np.zeros(3)
    for i in range(len(x)):
        beyond_x = abs(x[i, 0]) - constants.half_table_x
        beyond_y = abs(x[i, 1]) - constants.half_table_y
        normal[:] = 0.0
        if max(beyond_x, beyond_y) <= 0.0:
            if x[i, 2] >= radius:
                continue
            depth = radius - x[i, 2]
            side = radius - max(beyond_x, beyond_y)
            if depth <= side:
                normal[2] = 1.0
            else:
                depth = side
                axis = 0 if beyond_x > beyond_y else 1
                normal[axis] = np.sign(x[i, axis])
        else:
            if max(beyond_x, beyond_y) < radius and x[i, 2] < radius:
                normal[0] = max(beyond_x, 0.0) * np.sign(x[i, 0])
                normal[1] = max(beyond_y, 0.0) * np.sign(x[i, 1])
                normal[2] = max(x[i, 2], 0.0)
                distance = np.sqrt(_dot(normal, normal)) + 1e-12
                depth = radius - distance
                normal /= distance
            else:
                depth = constants.floor_height + radius - x[i, 2]
                normal[2] = 1.0
            if depth <= 0.0:
                continue
        slide = x[i] - before[i]
        slide -= _dot(slide, normal) * normal
        length = np.sqrt(_dot(slide, slide)) + 1e-15
        stick = min(1.0, constants.friction_table * depth / length)
        push = min(depth, LARGEST_PUSH_M * 4.0)
        for k in range(3):
            x[i, k] += push * normal[k] - stick * slide[k]
