"""Kinematics of one arm in compiled loops: tool, Jacobian, and steps towards a pose.

The same numbers as Pinocchio's, which a test holds them to, without the way from Python and back
for each: looking for configurations and for ways along a line asks for them many thousand times.

All kernels live in this one file, see `simulation.cable.kernels`.
"""

import math
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

kernel = numba.njit(cache=True, error_model="numpy")

# Below this angle [rad] series take the place of formulas that divide by it.
SMALL_RAD = 1e-6
# Keeps roots of what rounding has made negative real.
TINY = 1e-300
# Rotations towards a diagonal are done when what is beside it, squared, is smaller than this.
SWEEPS, TINY_SQUARE = 12, 1e-22
# A Jacobian whose rest has no larger element has lost rank.
NO_PIVOT = 1e-12


class Chain(NamedTuple):
    """One arm, n joints that turn or slide one after the other.

    Attributes:
        rotations: Of each joint's frame in that of the joint before, then of the tool in that of
            the last one, shape (n + 1, 3, 3).
        offsets: The same of their origins [m], shape (n + 1, 3).
        turns: Axis of each joint that turns, else 0, shape (n, 3).
        slides: Direction of each joint that slides, else 0, shape (n, 3).
        lower: What inverse kinematics may use, shape (n,).
        upper: As `lower`.
    """

    rotations: Floats
    offsets: Floats
    turns: Floats
    slides: Floats
    lower: Floats
    upper: Floats


class Descent(NamedTuple):
    """Settings of inverse kinematics, see `robots.motion.ik`."""

    most_steps: int
    tolerance: float
    step_cap: float
    damping: float


@kernel
def tool(chain: Chain, q: Floats, rotation: Floats, position: Floats, jacobian: Floats) -> None:
    """Write where the tool is, and the Jacobian of its twist in its own frame.

    Args:
        chain: The arm.
        q: Joint positions, shape (n,).
        rotation: Written, of the tool in the world, shape (3, 3).
        position: Written [m], shape (3,).
        jacobian: Written, first linear, then angular velocity, shape (6, n).
    """
    joints = len(q)
    r, p = np.eye(3), np.zeros(3)
    axes, ways, places = np.empty((joints, 3)), np.empty((joints, 3)), np.empty((joints, 3))
    for j in range(joints):
        for a in range(3):
            p[a] += (
                r[a, 0] * chain.offsets[j, 0]
                + r[a, 1] * chain.offsets[j, 1]
                + r[a, 2] * chain.offsets[j, 2]
            )
        r = _times(r, chain.rotations[j])
        for a in range(3):
            axes[j, a] = _row(r, a, chain.turns, j)
            ways[j, a] = _row(r, a, chain.slides, j)
        for a in range(3):
            p[a] += q[j] * ways[j, a]
            places[j, a] = p[a]
        r = _times(r, _turned(chain.turns[j], q[j]))
    for a in range(3):
        position[a] = p[a] + _row(r, a, chain.offsets, joints)
    rotation[:] = _times(r, chain.rotations[joints])
    for j in range(joints):
        x, y, z = (
            position[0] - places[j, 0],
            position[1] - places[j, 1],
            position[2] - places[j, 2],
        )
        w = axes[j]
        linear = (
            ways[j, 0] + w[1] * z - w[2] * y,
            ways[j, 1] + w[2] * x - w[0] * z,
            ways[j, 2] + w[0] * y - w[1] * x,
        )
        for a in range(3):
            jacobian[a, j] = (
                rotation[0, a] * linear[0] + rotation[1, a] * linear[1] + rotation[2, a] * linear[2]
            )
            jacobian[a + 3, j] = (
                rotation[0, a] * w[0] + rotation[1, a] * w[1] + rotation[2, a] * w[2]
            )


@kernel
def _row(r: Floats, a: int, vectors: Floats, j: int) -> float:
    return r[a, 0] * vectors[j, 0] + r[a, 1] * vectors[j, 1] + r[a, 2] * vectors[j, 2]


@kernel
def _times(a: Floats, b: Floats) -> Floats:
    c = np.empty((3, 3))
    for i in range(3):
        for k in range(3):
            c[i, k] = a[i, 0] * b[0, k] + a[i, 1] * b[1, k] + a[i, 2] * b[2, k]
    return c


@kernel
def _turned(axis: Floats, angle: float) -> Floats:
    """Return the rotation about a unit axis; none about 0."""
    c, s = math.cos(angle), math.sin(angle)
    x, y, z = axis[0], axis[1], axis[2]
    r = np.eye(3)
    if x * x + y * y + z * z == 0.0:
        return r
    d = 1.0 - c
    r[0, 0], r[0, 1], r[0, 2] = c + d * x * x, d * x * y - s * z, d * x * z + s * y
    r[1, 0], r[1, 1], r[1, 2] = d * x * y + s * z, c + d * y * y, d * y * z - s * x
    r[2, 0], r[2, 1], r[2, 2] = d * x * z - s * y, d * y * z + s * x, c + d * z * z
    return r


@kernel
def twist_to(
    rotation: Floats, position: Floats, goal_rotation: Floats, goal_position: Floats, twist: Floats
) -> None:
    """Write the twist, shape (6,), that takes a pose to another in unit time, in its own frame."""
    between = _times(rotation.T, goal_rotation)
    ahead = goal_position - position
    x = rotation[0, 0] * ahead[0] + rotation[1, 0] * ahead[1] + rotation[2, 0] * ahead[2]
    y = rotation[0, 1] * ahead[0] + rotation[1, 1] * ahead[1] + rotation[2, 1] * ahead[2]
    z = rotation[0, 2] * ahead[0] + rotation[1, 2] * ahead[1] + rotation[2, 2] * ahead[2]
    wx, wy, wz = _turn_of(between)
    angle2 = wx * wx + wy * wy + wz * wz
    angle = math.sqrt(angle2)
    if angle < 1e-4:
        share = 1.0 / 12.0 + angle2 / 720.0
    else:
        half = 0.5 * angle
        share = (1.0 - half * math.cos(half) / math.sin(half)) / angle2
    cx, cy, cz = wy * z - wz * y, wz * x - wx * z, wx * y - wy * x
    twist[0] = x - 0.5 * cx + share * (wy * cz - wz * cy)
    twist[1] = y - 0.5 * cy + share * (wz * cx - wx * cz)
    twist[2] = z - 0.5 * cz + share * (wx * cy - wy * cx)
    twist[3], twist[4], twist[5] = wx, wy, wz


@kernel
def _turn_of(r: Floats) -> tuple[float, float, float]:
    """Return axis times angle of a rotation, by its quaternion (S. Shepperd, 1978)."""
    trace = r[0, 0] + r[1, 1] + r[2, 2]
    if trace >= r[0, 0] and trace >= r[1, 1] and trace >= r[2, 2]:
        w = 1.0 + trace
        x, y, z = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
    elif r[0, 0] >= r[1, 1] and r[0, 0] >= r[2, 2]:
        w, x = r[2, 1] - r[1, 2], 1.0 + 2.0 * r[0, 0] - trace
        y, z = r[0, 1] + r[1, 0], r[0, 2] + r[2, 0]
    elif r[1, 1] >= r[2, 2]:
        w, y = r[0, 2] - r[2, 0], 1.0 + 2.0 * r[1, 1] - trace
        x, z = r[0, 1] + r[1, 0], r[1, 2] + r[2, 1]
    else:
        w, z = r[1, 0] - r[0, 1], 1.0 + 2.0 * r[2, 2] - trace
        x, y = r[0, 2] + r[2, 0], r[1, 2] + r[2, 1]
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    length = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 / w if length < SMALL_RAD * w else 2.0 * math.atan2(length, w) / length
    return x * scale, y * scale, z * scale


@kernel
def descend(
    chain: Chain,
    rotation: Floats,
    position: Floats,
    start: Floats,
    settings: Descent,
    limited: bool,
) -> tuple[Floats, bool]:
    """Return joint positions that a descent towards a pose came to, and whether it is reached.

    Args:
        chain: The arm.
        rotation: Of the pose, shape (3, 3).
        position: Of the pose [m], shape (3,).
        start: Joint positions to descend from, shape (n,).
        settings: Of the descent.
        limited: Whether to stay within limits.
    """
    joints = len(start)
    q, stuck = start.copy(), np.zeros(joints, np.bool_)
    now_r, now_p = np.empty((3, 3)), np.empty(3)
    jacobian, error = np.empty((6, joints)), np.empty(6)
    for _ in range(settings.most_steps):
        tool(chain, q, now_r, now_p, jacobian)
        twist_to(now_r, now_p, rotation, position, error)
        size = math.sqrt((error * error).sum())
        if size < settings.tolerance:
            return q, True
        step = _damped_step(jacobian, error, size, settings)
        any_stuck = False
        for j in range(joints):
            stuck[j] = limited and (
                (q[j] <= chain.lower[j] and step[j] < 0.0)
                or (q[j] >= chain.upper[j] and step[j] > 0.0)
            )
            any_stuck |= stuck[j]
        if any_stuck:
            for j in range(joints):
                if stuck[j]:
                    jacobian[:, j] = 0.0
            step = _damped_step(jacobian, error, size, settings)
        q += step
        if limited:
            for j in range(joints):
                q[j] = min(max(q[j], chain.lower[j]), chain.upper[j])
    return q, False


@kernel
def _damped_step(jacobian: Floats, error: Floats, size: float, settings: Descent) -> Floats:
    """Return J^T (J J^T + mu I)^-1 e, no joint farther than the cap; by Cholesky's way."""
    joints = jacobian.shape[1]
    low = np.zeros((6, 6))
    solved = error.copy()
    damping = settings.damping * max(size, 1e-3)
    for i in range(6):
        for k in range(i + 1):
            total = damping if i == k else 0.0
            for j in range(joints):
                total += jacobian[i, j] * jacobian[k, j]
            for m in range(k):
                total -= low[i, m] * low[k, m]
            low[i, k] = math.sqrt(max(total, TINY)) if i == k else total / low[k, k]
        for m in range(i):
            solved[i] -= low[i, m] * solved[m]
        solved[i] /= low[i, i]
    for i in range(5, -1, -1):
        for m in range(i + 1, 6):
            solved[i] -= low[m, i] * solved[m]
        solved[i] /= low[i, i]
    step = np.zeros(joints)
    largest = 0.0
    for j in range(joints):
        for i in range(6):
            step[j] += jacobian[i, j] * solved[i]
        largest = max(largest, abs(step[j]))
    if largest > settings.step_cap:
        step *= settings.step_cap / largest
    return step


class Swing(NamedTuple):
    """Settings of following a line, see `robots.motion.line`."""

    largest_step: float
    limit_zone: float
    largest_push: float
    probe: float
    singular_zone: float


@kernel
def swing_along(
    chain: Chain,
    start: Floats,
    rotation: Floats,
    places: Floats,
    swing_rad: float,
    redundant: bool,
    descent: Descent,
    swing: Swing,
) -> Floats:
    """Return configurations along a line, up to the first place that the last one does not reach.

    Args:
        chain: The arm.
        start: Joint positions at the beginning, shape (n,).
        rotation: Of the tool, kept all along, shape (3, 3).
        places: Of the tool [m], the first one where it is, shape (k, 3).
        swing_rad: Motion of the elbow that is added at each step.
        redundant: Whether joints can move while the tool rests.
        descent: Settings of inverse kinematics.
        swing: Settings.

    Returns:
        Shape (m, n), 1 <= m <= k.
    """
    joints = len(start)
    samples = np.empty((len(places), joints))
    samples[0] = start
    q, free = start.copy(), np.zeros(joints)
    r, p, jacobian = np.empty((3, 3)), np.empty(3), np.empty((6, joints))
    for k in range(1, len(places)):
        swung = q.copy()
        if redundant:
            tool(chain, q, r, p, jacobian)
            _turn_alike(free_direction(jacobian), free, k == 1)
            push = swing_rad + _push(chain, q, free, smallest_singular(jacobian), swing)
            for j in range(joints):
                swung[j] = min(max(q[j] + push * free[j], chain.lower[j]), chain.upper[j])
        following, reached = descend(chain, rotation, places[k], swung, descent, True)
        if not reached or np.abs(following - q).max() > swing.largest_step:
            return samples[:k]
        samples[k] = following
        q = following
    return samples


@kernel
def _turn_alike(found: Floats, free: Floats, first: bool) -> None:
    """Write the unit joint motion that leaves the tool where it is, signed as before."""
    lead = found[np.argmax(np.abs(found))] if first else (found * free).sum()
    free[:] = found if lead >= 0.0 else -found


@kernel
def _push(chain: Chain, q: Floats, free: Floats, dexterity: float, swing: Swing) -> float:
    """Return how far to swing along the free direction, away from limits and singularities."""
    from_limits = 0.0
    for j in range(len(q)):
        near_lower = min(max(1.0 - (q[j] - chain.lower[j]) / swing.limit_zone, 0.0), 1.0)
        near_upper = min(max(1.0 - (chain.upper[j] - q[j]) / swing.limit_zone, 0.0), 1.0)
        from_limits += free[j] * (near_lower - near_upper)
    if dexterity >= swing.singular_zone:
        return swing.largest_push * from_limits
    probe = swing.probe * free
    slope = dexterity_at(chain, q + probe) - dexterity_at(chain, q - probe)
    away = np.sign(slope) * (1.0 - dexterity / swing.singular_zone)
    return swing.largest_push * (from_limits + away)


@kernel
def dexterity_at(chain: Chain, q: Floats) -> float:
    """Return the smallest singular value of the tool's Jacobian."""
    r, p, jacobian = np.empty((3, 3)), np.empty(3), np.empty((6, len(q)))
    tool(chain, q, r, p, jacobian)
    return smallest_singular(jacobian)


@kernel
def smallest_singular(jacobian: Floats) -> float:
    """Return the smallest singular value of a Jacobian, by Jacobi's rotations of J J^T.

    To eight digits of the largest one. Faster than LAPACK for so small a matrix, and in one
    thread.
    """
    a = np.zeros((6, 6))
    for i in range(6):
        for k in range(6):
            for j in range(jacobian.shape[1]):
                a[i, k] += jacobian[i, j] * jacobian[k, j]
    for _ in range(SWEEPS):
        rest = 0.0
        for i in range(5):
            for k in range(i + 1, 6):
                rest += a[i, k] * a[i, k]
                _rotate(a, i, k)
        if rest < TINY_SQUARE:
            break
    least = a[0, 0]
    for i in range(1, 6):
        least = min(least, a[i, i])
    return math.sqrt(max(least, 0.0))


@kernel
def _rotate(a: Floats, i: int, k: int) -> None:
    """Make a[i, k] of a symmetric matrix zero."""
    if a[i, k] == 0.0:
        return
    slope = (a[k, k] - a[i, i]) / (2.0 * a[i, k])
    t = math.copysign(1.0, slope) / (abs(slope) + math.sqrt(slope * slope + 1.0))
    c = 1.0 / math.sqrt(t * t + 1.0)
    s = t * c
    for m in range(6):
        a[m, i], a[m, k] = c * a[m, i] - s * a[m, k], s * a[m, i] + c * a[m, k]
    for m in range(6):
        a[i, m], a[k, m] = c * a[i, m] - s * a[k, m], s * a[i, m] + c * a[k, m]


@kernel
def free_direction(jacobian: Floats) -> Floats:
    """Return a unit joint motion that leaves the tool where it is, by elimination, shape (n,)."""
    a, joints = jacobian.copy(), jacobian.shape[1]
    order, way = np.arange(joints), np.zeros(joints)
    rank = 0
    while rank < 6:
        row, column = rank, rank
        for i in range(rank, 6):
            for j in range(rank, joints):
                if abs(a[i, j]) > abs(a[row, column]):
                    row, column = i, j
        if abs(a[row, column]) < NO_PIVOT:
            break
        for j in range(joints):
            a[rank, j], a[row, j] = a[row, j], a[rank, j]
        for i in range(6):
            a[i, rank], a[i, column] = a[i, column], a[i, rank]
        order[rank], order[column] = order[column], order[rank]
        for i in range(rank + 1, 6):
            share = a[i, rank] / a[rank, rank]
            for j in range(rank, joints):
                a[i, j] -= share * a[rank, j]
        rank += 1
    way[order[rank]] = 1.0
    for i in range(rank - 1, -1, -1):
        total = 0.0
        for j in range(i + 1, rank + 1):
            total += a[i, j] * way[order[j]]
        way[order[i]] = -total / a[i, i]
    return way / math.sqrt((way * way).sum())


@kernel
def restored(
    chain: Chain, rotation: Floats, places: Floats, blurred: Floats, descent: Descent
) -> tuple[Floats, bool]:
    """Return configurations near others with the tool at its places, and whether all have one.

    Args:
        chain: The arm.
        rotation: Of the tool, shape (3, 3).
        places: Of the tool [m], shape (k, 3).
        blurred: Where to look from, shape (k, n); the first is taken as it is.
        descent: Settings of inverse kinematics.
    """
    samples = blurred.copy()
    for k in range(1, len(places)):
        samples[k], reached = descend(chain, rotation, places[k], blurred[k], descent, True)
        if not reached:
            return samples, False
    return samples, True
