"""The compiled solver of the rod: extended position-based dynamics with small steps.

Each step predicts positions, then corrects them: bending and stretch each for the whole chain
at once (banded linear systems), grasps and contacts one by one.
One pass over many small steps converges better than many passes over few large ones
(Macklin et al., "Small Steps in Physics Simulation", 2019); the direct stretch solve follows
Deul et al., "Direct Position-Based Solver for Stiff Rods", 2018.

All kernels live in this one file: the compiler's cache looks only at the file of the function
that is called, and would keep stale code of helpers that live elsewhere. Vectors are tuples of
three numbers here, which compile to registers.
"""

from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Vector = tuple[float, float, float]

kernel = numba.njit(cache=True, error_model="numpy")

# A step never pushes strands apart, or the cable out of an obstacle, by more than this [m].
LARGEST_PUSH_M = 0.004
LARGEST_OBSTACLE_PUSH_M = 0.0005
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
# A push on a node bends the cable within a step as far as this on either side.
RESPONSE_NODES = 12
# Candidates are listed up to this distance, and anew when something has moved by half of it.
SKIN_M = 0.008
# Keeps divisions by lengths finite [m].
TINY_M = 1e-12


class Chain(NamedTuple):
    """State of all cables, one after another; N nodes, N - 1 segments."""

    positions: Floats  # (N, 3)
    previous: Floats  # (N, 3)
    velocities: Floats  # (N, 3)
    inverse_masses: Floats  # (N,)
    rest_lengths: Floats  # (N - 1,), zero between two cables
    cables: Ints  # (N - 1,), which cable a segment belongs to; -1 between two
    bending_stiffness: Floats  # (N,), B / ds^3, zero at both ends of each cable
    factor: Floats  # (N, 3), of the bending step: diagonal, first and second below it
    moves: Floats  # (N, 3), scratch
    tensions: Floats  # (N - 1,), mean over the last advance [N]
    peak: Floats  # (1,), greatest tension of late [N]
    directions: Floats  # (N - 1, 3), scratch
    diagonal: Floats  # (N - 1,), scratch
    coupling: Floats  # (N - 1,), scratch
    impulses: Floats  # (N - 1,), of stretch in the last step


class Neighbours(NamedTuple):
    """Segments that may touch each other or an obstacle before the lists are made anew."""

    reference: Floats  # (N, 3), positions at the last listing
    obstacle_reference: Floats  # (M, 6)
    order: Ints  # (N - 1,), segments sorted by x
    pairs: Ints  # (P, 2)
    normals: Floats  # (P, 3), from the second to the first as it was in the last step
    old_normals: Floats  # (P, 3), scratch
    places: Ints  # (N - 1, N - 1), place of a pair in the list plus one, or zero
    obstacle_pairs: Ints  # (Q, 2), segment and obstacle
    counts: Ints  # (3,), pairs, obstacle pairs, and whether to list them anew


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
    spans: Ints  # (R, 2), first and last node of the cable
    clearance: Floats  # (R,)
    grip_force: Floats  # (R,), friction force that needs no normal force
    friction: Floats  # (R,)
    force: Floats  # (R, 3), mean force of the ring on the cable over the last advance
    guided: Ints  # (R,), scratch
    guides: Floats  # (R, 6), scratch: where a guided node was, and along which direction
    pushes: Floats  # (R, 3), scratch: what a ring has done sideways so far in a step
    solved: Ints  # (R,), scratch: the segment whose responses are known, or -1
    responses: Floats  # (R, 2, N), scratch: moves of all nodes [1/kg] by a push on its two nodes


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
    edge_radius: float
    floor_height: float
    gravity: float


@kernel
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
    chain.tensions.fill(0.0)
    rings.force.fill(0.0)
    factored = 0
    for step in range(steps):
        parts = _parts(chain.peak[0])
        part_s, share = step_s / parts, 1.0 / (steps * parts)
        if parts != factored:
            _factor_bending(chain, constants, part_s)
            rings.solved.fill(-1)
            factored = parts
        for part in range(parts):
            done = (step * parts + part + 1.0) * share
            _predict(chain, constants, part_s)
            _bend(chain, constants, part_s)
            _hold_bent(chain, rings, constants, done, part_s, share)
            _stretch(chain, rings, constants, part_s, share)
            if _is_stale(chain, near, obstacles, done):
                _list_pairs(chain, near, constants)
                _list_obstacle_pairs(chain, near, obstacles, rings, constants, done)
            _touch_obstacles(chain, near, obstacles, constants, done, share)
            _hold(chain, rings, constants, done, part_s, share)
            _touch_self(chain, near, constants)
            _rest_on_table(chain, constants)
            _update_velocities(chain, part_s)


@kernel
def is_approached(chain: Chain, obstacles: Obstacles, constants: Constants) -> bool:
    """Return whether a box around the way of any obstacle holds any of the cable."""
    x = chain.positions
    for m in range(len(obstacles.radii)):
        reach = obstacles.radii[m] + constants.radius + SKIN_M
        box = np.empty((2, 3))
        for k in range(3):
            first = min(obstacles.start[m, k], obstacles.start[m, k + 3])
            second = min(obstacles.end[m, k], obstacles.end[m, k + 3])
            box[0, k] = min(first, second) - reach
            first = max(obstacles.start[m, k], obstacles.start[m, k + 3])
            second = max(obstacles.end[m, k], obstacles.end[m, k + 3])
            box[1, k] = max(first, second) + reach
        for i in range(len(x)):
            inside = True
            for k in range(3):
                inside = inside and box[0, k] < x[i, k] < box[1, k]
            if inside:
                return True
    return False


@kernel
def _parts(peak: float) -> int:
    """Return into how many parts a step is split at that tension.

    A contact bears what its nodes' mass times 1 / step^2 makes of an overlap; in a knot that
    is pulled tight, strands would pass through each other without shorter steps.
    """
    if peak < SHORTER_STEPS_N:
        return 1
    return 2 if peak < SHORTEST_STEPS_N else 4


@kernel
def _at(x: Floats, i: int) -> Vector:
    return x[i, 0], x[i, 1], x[i, 2]


@kernel
def _add(x: Floats, i: int, scale: float, v: Vector) -> None:
    x[i, 0] += scale * v[0]
    x[i, 1] += scale * v[1]
    x[i, 2] += scale * v[2]


@kernel
def _copy(to: Floats, source: Floats, rows: int) -> None:
    for i in range(rows):
        for k in range(3):
            to[i, k] = source[i, k]


@kernel
def _plus(a: Vector, scale: float, b: Vector) -> Vector:
    return a[0] + scale * b[0], a[1] + scale * b[1], a[2] + scale * b[2]


@kernel
def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@kernel
def _between(a: Vector, b: Vector, f: float) -> Vector:
    return _plus(a, f, _minus(b, a))


@kernel
def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def _length(a: Vector) -> float:
    return np.sqrt(_dot(a, a))


@kernel
def _predict(chain: Chain, constants: Constants, step_s: float) -> None:
    keep = 1.0 - constants.air_damping * step_s
    fall = constants.gravity * step_s
    x, v = chain.positions, chain.velocities
    for i in range(len(x)):
        v[i, 2] -= fall
        for k in range(3):
            chain.previous[i, k] = x[i, k]
            v[i, k] *= keep
            x[i, k] += v[i, k] * step_s


@kernel
def _update_velocities(chain: Chain, step_s: float) -> None:
    rate = 1.0 / step_s
    v = chain.velocities
    for i in range(len(v)):
        for k in range(3):
            v[i, k] = (chain.positions[i, k] - chain.previous[i, k]) * rate
    for i in range(len(v)):
        square = v[i, 0] ** 2 + v[i, 1] ** 2 + v[i, 2] ** 2
        if square > LARGEST_SPEED_M_S**2:
            slow = LARGEST_SPEED_M_S / np.sqrt(square)
            for k in range(3):
                v[i, k] *= slow


@kernel
def _factor_bending(chain: Chain, constants: Constants, step_s: float) -> None:
    """Factor M + (h^2 + h tau) K into L D L^T; K is the stiffness of bending.

    Bending energy is a quadratic form in second differences, sum of k |x- - 2x + x+|^2 / 2 with
    k = B / ds^3, so that its implicit step is one banded linear system that stays the same.
    """
    k, factor = chain.bending_stiffness, chain.factor
    scale = step_s * (step_s + constants.bending_damping)
    count = len(k)
    for i in range(count):
        before = k[i - 1] if i > 0 else 0.0
        after = k[i + 1] if i < count - 1 else 0.0
        middle = 1.0 / chain.inverse_masses[i] + scale * (before + 4.0 * k[i] + after)
        first, second = 0.0, 0.0
        if i > 1:
            second = scale * before / factor[i - 2, 0]
            middle -= second * second * factor[i - 2, 0]
        if i > 0:
            first = -2.0 * scale * (before + k[i])
            if i > 1:
                first -= second * factor[i - 2, 0] * factor[i - 1, 1]
            first /= factor[i - 1, 0]
            middle -= first * first * factor[i - 1, 0]
        factor[i, 0], factor[i, 1], factor[i, 2] = middle, first, second


@kernel
def _bend(chain: Chain, constants: Constants, step_s: float) -> None:
    """Make the implicit step of bending and its damping, exactly, for the whole chain."""
    x, before, k, factor = (
        chain.positions,
        chain.previous,
        chain.bending_stiffness,
        chain.factor,
    )
    square, damped = step_s**2, step_s * constants.bending_damping
    count = len(x)
    move = chain.moves
    move.fill(0.0)
    for i in range(1, count - 1):
        for axis in range(3):
            now = x[i - 1, axis] - 2.0 * x[i, axis] + x[i + 1, axis]
            then = before[i - 1, axis] - 2.0 * before[i, axis] + before[i + 1, axis]
            pull = k[i] * (square * now + damped * (now - then))
            move[i - 1, axis] -= pull
            move[i, axis] += 2.0 * pull
            move[i + 1, axis] -= pull
    for i in range(1, count):
        for axis in range(3):
            move[i, axis] -= factor[i, 1] * move[i - 1, axis]
            if i > 1:
                move[i, axis] -= factor[i, 2] * move[i - 2, axis]
    for i in range(count - 1, -1, -1):
        for axis in range(3):
            move[i, axis] /= factor[i, 0]
            if i < count - 1:
                move[i, axis] -= factor[i + 1, 1] * move[i + 1, axis]
            if i < count - 2:
                move[i, axis] -= factor[i + 2, 2] * move[i + 2, axis]
            x[i, axis] += move[i, axis]


@kernel
def _respond(chain: Chain, response: Floats, node: int) -> None:
    """Write how far nodes move when one is pushed and bending acts within the same step.

    This is a column of (M + (h^2 + h tau) K)^-1; far from the node it is as good as zero.
    """
    factor = chain.factor
    low, high = max(0, node - RESPONSE_NODES), min(len(factor), node + RESPONSE_NODES + 1)
    response.fill(0.0)
    response[node] = 1.0
    for i in range(node + 1, high):
        response[i] = -factor[i, 1] * response[i - 1]
        if i > node + 1:
            response[i] -= factor[i, 2] * response[i - 2]
    for i in range(high - 1, low - 1, -1):
        response[i] /= factor[i, 0]
        if i < high - 1:
            response[i] -= factor[i + 1, 1] * response[i + 1]
        if i < high - 2:
            response[i] -= factor[i + 2, 2] * response[i + 2]


@kernel
def _stretch(chain: Chain, rings: Rings, constants: Constants, step_s: float, share: float) -> None:
    """Restore all lengths at once.

    Nodes in a grasp move only along the cable here, so that the pull of a hand reaches the
    whole chain in one solve.
    """
    x, w, g = chain.positions, chain.inverse_masses, chain.directions
    diagonal, coupling, impulses = chain.diagonal, chain.coupling, chain.impulses
    guides = _choose_guides(chain, rings, constants.overload_force * step_s**2)
    count = len(g)
    compliance = constants.stretch_compliance / step_s**2
    for i in range(count):
        along = _minus(_at(x, i + 1), _at(x, i))
        length = _length(along) + TINY_M
        inverse = 1.0 / length
        g[i, 0], g[i, 1], g[i, 2] = along[0] * inverse, along[1] * inverse, along[2] * inverse
        diagonal[i] = w[i] + w[i + 1] + compliance * chain.rest_lengths[i]
        impulses[i] = length - chain.rest_lengths[i]
        if chain.cables[i] < 0:
            diagonal[i], impulses[i] = 1.0, 0.0
    for i in range(count - 1):
        coupling[i] = -w[i + 1] * _dot(_at(g, i), _at(g, i + 1))
        if chain.cables[i] != chain.cables[i + 1]:
            coupling[i] = 0.0
    for r in range(guides):
        n, along = rings.guided[r], _guide_direction(rings, r)
        into, out = _dot(along, _at(g, n - 1)), _dot(along, _at(g, n))
        diagonal[n - 1] += w[n] * (into * into - 1.0)
        diagonal[n] += w[n] * (out * out - 1.0)
        coupling[n - 1] = -w[n] * into * out
    for i in range(1, count):
        factor = coupling[i - 1] / diagonal[i - 1]
        diagonal[i] -= factor * coupling[i - 1]
        impulses[i] -= factor * impulses[i - 1]
    impulses[count - 1] /= diagonal[count - 1]
    for i in range(count - 2, -1, -1):
        impulses[i] = (impulses[i] - coupling[i] * impulses[i + 1]) / diagonal[i]
    peak = PEAK_MEMORY * chain.peak[0]
    rate = 1.0 / step_s**2
    for i in range(count):
        tension = impulses[i] * rate
        chain.tensions[i] += tension * share
        peak = max(peak, tension)
        _add(x, i, w[i] * impulses[i], _at(g, i))
        _add(x, i + 1, -w[i + 1] * impulses[i], _at(g, i))
    chain.peak[0] = peak
    for r in range(guides):
        n, along = rings.guided[r], _guide_direction(rings, r)
        fixed = rings.guides[r, 0], rings.guides[r, 1], rings.guides[r, 2]
        moved = _plus(fixed, _dot(_minus(_at(x, n), fixed), along), along)
        x[n, 0], x[n, 1], x[n, 2] = moved


@kernel
def _choose_guides(chain: Chain, rings: Rings, overload: float) -> int:
    """Note the inner node nearest to each ring that is not overloaded, each once; count them."""
    x, pulls = chain.positions, chain.impulses
    count = 0
    for r in range(len(rings.arc)):
        node = min(max(int(rings.arc[r] + 0.5), rings.spans[r, 0] + 1), rings.spans[r, 1] - 1)
        known = max(pulls[node - 1], pulls[node]) > overload
        for other in range(count):
            known = known or rings.guided[other] == node
        if not known:
            along = _minus(_at(x, node + 1), _at(x, node - 1))
            inverse = 1.0 / (_length(along) + TINY_M)
            rings.guided[count] = node
            for k in range(3):
                rings.guides[count, k] = x[node, k]
                rings.guides[count, k + 3] = along[k] * inverse
            count += 1
    return count


@kernel
def _guide_direction(rings: Rings, r: int) -> Vector:
    return rings.guides[r, 3], rings.guides[r, 4], rings.guides[r, 5]


@kernel
def _obstacle_end(obstacles: Obstacles, m: int, end: int, done: float) -> Vector:
    start = obstacles.start[m, end], obstacles.start[m, end + 1], obstacles.start[m, end + 2]
    stop = obstacles.end[m, end], obstacles.end[m, end + 1], obstacles.end[m, end + 2]
    return _between(start, stop, done)


@kernel
def _is_stale(chain: Chain, near: Neighbours, obstacles: Obstacles, done: float) -> bool:
    """Return whether anything has moved by half the skin since the last listing."""
    limit = (0.5 * SKIN_M) ** 2
    if near.counts[2]:
        return True
    for i in range(len(chain.positions)):
        moved = _minus(_at(chain.positions, i), _at(near.reference, i))
        if _dot(moved, moved) > limit:
            return True
    for m in range(len(obstacles.radii)):
        for end in range(0, 6, 3):
            now = _obstacle_end(obstacles, m, end, done)
            for k in range(3):
                if abs(now[k] - near.obstacle_reference[m, end + k]) > 0.25 * SKIN_M:
                    return True
    return False


@kernel
def _may_touch(cables: Ints, a: int, b: int) -> bool:
    """Return whether two segments are of cable, and not neighbours along the same one."""
    if cables[a] < 0 or cables[b] < 0:
        return False
    return cables[a] != cables[b] or b - a >= CHAIN_NEIGHBOURS


@kernel
def _list_pairs(chain: Chain, near: Neighbours, constants: Constants) -> None:
    """Sweep along x over segments sorted by their start."""
    x, order = chain.positions, near.order
    near.counts[2] = 0
    _copy(near.reference, x, len(x))
    _copy(near.old_normals, near.normals, near.counts[0])
    for n in range(1, len(order)):  # insertion sort: the order hardly changes between calls
        segment, place = order[n], n
        while place > 0 and x[order[place - 1], 0] > x[segment, 0]:
            order[place] = order[place - 1]
            place -= 1
        order[place] = segment
    reach = 2.0 * constants.radius + SKIN_M
    apart = reach
    for length in chain.rest_lengths:
        apart = max(apart, reach + 2.1 * length)
    count = 0
    for n in range(len(order)):
        for later in range(n + 1, len(order)):
            a, b = min(order[n], order[later]), max(order[n], order[later])
            if x[order[later], 0] - x[order[n], 0] > apart:
                break
            if abs(x[a, 1] - x[b, 1]) > apart or not _may_touch(chain.cables, a, b):
                continue
            s, t = _closest(_at(x, a), _at(x, a + 1), _at(x, b), _at(x, b + 1))
            gap = _gap(x, a, s, b, t)
            distance = _length(gap) + TINY_M
            if distance < reach and count < len(near.pairs):
                old = near.places[a, b]
                for k in range(3):
                    known = near.old_normals[old - 1, k] if old else gap[k] / distance
                    near.normals[count, k] = known
                near.pairs[count, 0], near.pairs[count, 1] = a, b
                count += 1
    near.counts[0] = count
    near.places.fill(0)
    for p in range(count):
        near.places[near.pairs[p, 0], near.pairs[p, 1]] = p + 1


@kernel
def _list_obstacle_pairs(
    chain: Chain,
    near: Neighbours,
    obstacles: Obstacles,
    rings: Rings,
    constants: Constants,
    done: float,
) -> None:
    x = chain.positions
    count = 0
    for m in range(len(obstacles.radii)):
        first = _obstacle_end(obstacles, m, 0, done)
        second = _obstacle_end(obstacles, m, 3, done)
        reach = obstacles.radii[m] + constants.radius + SKIN_M
        for k in range(3):
            near.obstacle_reference[m, k] = first[k]
            near.obstacle_reference[m, k + 3] = second[k]
        for i in range(len(chain.rest_lengths)):
            outside = chain.cables[i] < 0
            for k in range(3):
                low, high = min(first[k], second[k]) - reach, max(first[k], second[k]) + reach
                if max(x[i, k], x[i + 1, k]) < low or min(x[i, k], x[i + 1, k]) > high:
                    outside = True
            if not outside and not _is_held(rings, i) and count < len(near.obstacle_pairs):
                near.obstacle_pairs[count, 0], near.obstacle_pairs[count, 1] = i, m
                count += 1
    near.counts[1] = count


@kernel
def _is_held(rings: Rings, segment: int) -> bool:
    held = False
    for r in range(len(rings.arc)):
        held = held or abs(segment + 0.5 - rings.arc[r]) < GRASP_NEIGHBOURS
    return held


@kernel
def _closest(p1: Vector, q1: Vector, p2: Vector, q2: Vector) -> tuple[float, float]:
    """Return where two segments are closest, as fractions of their lengths.

    Ericson, "Real-Time Collision Detection", section 5.1.9.
    """
    d1, d2, r = _minus(q1, p1), _minus(q2, p2), _minus(p1, p2)
    a, e, b = _dot(d1, d1) + TINY_M**2, _dot(d2, d2) + TINY_M**2, _dot(d1, d2)
    c, f = _dot(d1, r), _dot(d2, r)
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


@kernel
def _gap(x: Floats, a: int, s: float, b: int, t: float) -> Vector:
    """Return the vector to a point of segment a from a point of segment b."""
    return _minus(_between(_at(x, a), _at(x, a + 1), s), _between(_at(x, b), _at(x, b + 1), t))


@kernel
def _sideways(v: Vector, normal: Vector) -> Vector:
    """Return the part of a vector at right angles to a normal."""
    return _plus(v, -_dot(v, normal), normal)


@kernel
def _with_friction(push: float, normal: Vector, slide: Vector, friction: float) -> Vector:
    """Return the correction of a contact: the push, and what friction takes of the slide."""
    stick = min(1.0, friction * push / (_length(slide) + TINY_M))
    return (
        push * normal[0] - stick * slide[0],
        push * normal[1] - stick * slide[1],
        push * normal[2] - stick * slide[2],
    )


@kernel
def _touch_self(chain: Chain, near: Neighbours, constants: Constants) -> None:
    """Keep strands apart, with friction.

    A strand that has passed through another one's centre line within a step is noticed by the
    direction between them turning over, and is pushed back to the side that it came from.
    """
    x, before, w, normals = chain.positions, chain.previous, chain.inverse_masses, near.normals
    diameter = 2.0 * constants.radius
    for p in range(near.counts[0]):
        a, b = near.pairs[p, 0], near.pairs[p, 1]
        s, t = _closest(_at(x, a), _at(x, a + 1), _at(x, b), _at(x, b + 1))
        gap = _gap(x, a, s, b, t)
        distance = _length(gap)
        normal = _at(normals, p)
        if distance > 1e-9:
            side = -1.0 if _dot(gap, normal) < 0.0 and distance < diameter else 1.0
            distance *= side
            normal = gap[0] / distance, gap[1] / distance, gap[2] / distance
            normals[p, 0], normals[p, 1], normals[p, 2] = normal
        if distance >= diameter:
            continue
        slide = _sideways(_minus(gap, _gap(before, a, s, b, t)), normal)
        push = min(diameter - distance, LARGEST_PUSH_M)
        total = _with_friction(push, normal, slide, constants.friction_self)
        weight = w[a] * (1.0 - s) ** 2 + w[a + 1] * s**2 + w[b] * (1.0 - t) ** 2 + w[b + 1] * t**2
        _add(x, a, w[a] * (1.0 - s) / weight, total)
        _add(x, a + 1, w[a + 1] * s / weight, total)
        _add(x, b, -w[b] * (1.0 - t) / weight, total)
        _add(x, b + 1, -w[b + 1] * t / weight, total)


@kernel
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
        first = _obstacle_end(obstacles, m, 0, done)
        second = _obstacle_end(obstacles, m, 3, done)
        s, t = _closest(_at(x, a), _at(x, a + 1), first, second)
        point = _between(_at(x, a), _at(x, a + 1), s)
        surface = _between(first, second, t)
        gap = _minus(point, surface)
        distance = _length(gap) + TINY_M
        depth = obstacles.radii[m] + constants.radius - distance
        if depth <= 0.0:
            continue
        normal = gap[0] / distance, gap[1] / distance, gap[2] / distance
        travel = _minus(
            surface,
            _between(
                _obstacle_end(obstacles, m, 0, done - share),
                _obstacle_end(obstacles, m, 3, done - share),
                t,
            ),
        )
        moved = _minus(_minus(point, _between(_at(before, a), _at(before, a + 1), s)), travel)
        push = min(depth, LARGEST_OBSTACLE_PUSH_M + max(0.0, _dot(travel, normal)))
        slide = _sideways(moved, normal)
        total = _with_friction(push, normal, slide, constants.friction_obstacles)
        weight = w[a] * (1.0 - s) ** 2 + w[a + 1] * s**2
        _add(x, a, w[a] * (1.0 - s) / weight, total)
        _add(x, a + 1, w[a + 1] * s / weight, total)


@kernel
def _responses(chain: Chain, rings: Rings, r: int, segment: int) -> tuple[Floats, Floats]:
    """Return how nodes move when a ring pushes on the first and on the second node it is at."""
    first, second = rings.responses[r, 0], rings.responses[r, 1]
    if rings.solved[r] != segment:
        _respond(chain, first, segment)
        _respond(chain, second, segment + 1)
        rings.solved[r] = segment
    return first, second


@kernel
def _hold_bent(
    chain: Chain, rings: Rings, constants: Constants, done: float, step_s: float, share: float
) -> None:
    """Push each held point into its ring as one with the bending of this step.

    Without this, bending would meet the ring's force a step late, and wait for it in a kink.
    """
    strongest = constants.overload_force * step_s**2
    x = chain.positions
    for r in range(len(rings.arc)):
        i, f = _held_at(rings, r)
        first, second = _responses(chain, rings, r, i)
        along, offset = _offset_in_ring(chain, rings, r, done)
        offset = _sideways(offset, along)
        aside = _length(offset) + TINY_M
        yielding = (first[i] * (1.0 - f) + second[i] * f) * (1.0 - f)
        yielding += (first[i + 1] * (1.0 - f) + second[i + 1] * f) * f
        push = min(max(aside - rings.clearance[r], 0.0) / yielding, strongest)
        back = _plus((0.0, 0.0, 0.0), -push / aside, offset)
        rings.pushes[r, 0], rings.pushes[r, 1], rings.pushes[r, 2] = back
        _add(rings.force, r, share / step_s**2, back)
        for n in range(max(0, i - RESPONSE_NODES), min(len(x), i + RESPONSE_NODES + 2)):
            _add(x, n, first[n] * (1.0 - f) + second[n] * f, back)


@kernel
def _held_at(rings: Rings, r: int) -> tuple[int, float]:
    """Return the segment that a ring is at, and where on it."""
    i = min(int(rings.arc[r]), rings.spans[r, 1] - 1)
    return i, rings.arc[r] - i


@kernel
def _offset_in_ring(chain: Chain, rings: Rings, r: int, done: float) -> tuple[Vector, Vector]:
    """Return the direction of the cable in a ring, and where it is from the ring's centre."""
    x = chain.positions
    i, f = _held_at(rings, r)
    centre = _between(_at(rings.start, r), _at(rings.end, r), done)
    along = _minus(_at(x, i + 1), _at(x, i))
    inverse = 1.0 / (_length(along) + TINY_M)
    along = along[0] * inverse, along[1] * inverse, along[2] * inverse
    return along, _minus(_between(_at(x, i), _at(x, i + 1), f), centre)


@kernel
def _hold(
    chain: Chain, rings: Rings, constants: Constants, done: float, step_s: float, share: float
) -> None:
    """Keep each held point in its ring; along the cable only as far as friction goes."""
    x, w = chain.positions, chain.inverse_masses
    for r in range(len(rings.arc)):
        i, f = _held_at(rings, r)
        along, offset = _offset_in_ring(chain, rings, r, done)
        slip = _dot(offset, along)
        offset = _sideways(offset, along)
        aside = _length(offset) + TINY_M
        weight = w[i] * (1.0 - f) ** 2 + w[i + 1] * f**2
        strongest = constants.overload_force * step_s**2
        push = min(max(aside - rings.clearance[r], 0.0) / weight, strongest)
        back = _plus((0.0, 0.0, 0.0), -push / aside, offset)
        pushed = _length(_plus(_at(rings.pushes, r), 1.0, back))
        bound = (rings.grip_force[r] * step_s**2 + rings.friction[r] * pushed) * weight
        stick = min(max(slip, -bound), bound)
        if stick != slip:
            low, high = rings.arc_limits[r, 0], rings.arc_limits[r, 1]
            gone = (slip - stick) / chain.rest_lengths[i]
            rings.arc[r] = min(max(rings.arc[r] - gone, low), high)
            if rings.arc[r] in (low, high):
                stick = min(max(slip, -strongest * weight), strongest * weight)
        back = _plus(back, -stick / weight, along)
        _add(rings.force, r, share / step_s**2, back)
        _add(x, i, w[i] * (1.0 - f), back)
        _add(x, i + 1, w[i + 1] * f, back)


@kernel
def _rest_on_table(chain: Chain, constants: Constants) -> None:
    """Keep nodes on the table, out of its sides, and above the floor."""
    x, before = chain.positions, chain.previous
    for i in range(len(x)):
        if x[i, 2] >= constants.radius:
            continue
        depth, normal = _depth_in_table(_at(x, i), constants)
        if depth > 0.0:
            slide = _sideways(_minus(_at(x, i), _at(before, i)), normal)
            push = _with_friction(depth, normal, slide, constants.friction_table)
            _add(x, i, 1.0, push)


@kernel
def _depth_in_table(p: Vector, constants: Constants) -> tuple[float, Vector]:
    """Return how deep a node is in the table or the floor, and which way is out."""
    radius, rounding = constants.radius, constants.edge_radius
    beyond_x, beyond_y = abs(p[0]) - constants.half_table_x, abs(p[1]) - constants.half_table_y
    beyond = max(beyond_x, beyond_y)
    if beyond >= radius:
        return constants.floor_height + radius - p[2], (0.0, 0.0, 1.0)
    out_x, out_y = np.sign(p[0]), np.sign(p[1])
    if beyond > -rounding:
        edge = (
            max(beyond_x + rounding, 0.0) * out_x,
            max(beyond_y + rounding, 0.0) * out_y,
            max(p[2] + rounding, 0.0),
        )
        distance = _length(edge) + TINY_M
        normal = edge[0] / distance, edge[1] / distance, edge[2] / distance
        return rounding + radius - distance, normal
    if radius - p[2] <= radius - beyond:
        return radius - p[2], (0.0, 0.0, 1.0)
    if beyond_x > beyond_y:
        return radius - beyond, (out_x, 0.0, 0.0)
    return radius - beyond, (0.0, out_y, 0.0)
