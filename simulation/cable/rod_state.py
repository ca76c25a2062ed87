"""Everything that decides how a cable goes on: what a snapshot of a free rod holds."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from executive.core.errors import InputError
from simulation.cable.kernels import Chain, Neighbours

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class RodState:
    """A free rod at one moment; N nodes, P listed pairs, M capsules.

    The listed pairs belong to it: a rod that listed them anew would meet its contacts in
    another order, and go on otherwise in the last digits.

    Attributes:
        positions: Nodes [m], (N, 3).
        velocities: Of the nodes [m/s], (N, 3).
        rest_lengths: Of the segments [m], (N - 1,).
        tensions: Of the segments over the last advance [N], (N - 1,).
        impulses: Of the segments in the last step, (N - 1,).
        peak: Greatest tension of late [N], (1,).
        reference: Nodes at the last listing [m], (N, 3).
        obstacle_reference: Capsules at the last listing [m], (M, 6).
        order: Segments along x, (N - 1,).
        pairs: Segments that may touch, (P, 2).
        normals: Between them, (P, 3).
        obstacle_pairs: Segments and capsules that may touch, (Q, 2).
        stale: Whether they have to be listed anew, (1,).
        capsules: Where the obstacles are [m], (M, 6).
        radii: Of the capsules [m], (M,).
        hand_poses: T_world_tcp of the hands, by their names in order, (H, 4, 4).
        times_s: Time, and since when the cable has been watched for rest, (2,).
        still: Nodes at that time [m], (N, 3).
        at_rest: Whether it lies still, (1,).
    """

    positions: Floats
    velocities: Floats
    rest_lengths: Floats
    tensions: Floats
    impulses: Floats
    peak: Floats
    reference: Floats
    obstacle_reference: Floats
    order: Ints
    pairs: Ints
    normals: Floats
    obstacle_pairs: Ints
    stale: Ints
    capsules: Floats
    radii: Floats
    hand_poses: Floats
    times_s: Floats
    still: Floats
    at_rest: NDArray[np.bool_]


def fill_chain(chain: Chain, state: RodState) -> None:
    """Put the nodes of a chain where they were.

    Raises:
        InputError: The state is that of another cable.
    """
    same = chain.rest_lengths.shape == state.rest_lengths.shape
    if not same or not np.array_equal(chain.rest_lengths, state.rest_lengths):
        raise InputError(
            f"Rod: state; got that of another cable with {len(state.positions)} nodes; "
            f"expected one with {len(chain.positions)} nodes and the same segments"
        )
    chain.positions[:] = state.positions
    chain.velocities[:] = state.velocities
    chain.tensions[:] = state.tensions
    chain.impulses[:] = state.impulses
    chain.peak[:] = state.peak


def fill_neighbours(near: Neighbours, state: RodState) -> None:
    """List the pairs that were listed."""
    pairs, obstacle_pairs = len(state.pairs), len(state.obstacle_pairs)
    near.reference[:] = state.reference
    near.obstacle_reference[:] = state.obstacle_reference
    near.order[:] = state.order
    near.pairs[:pairs] = state.pairs
    near.normals[:pairs] = state.normals
    near.obstacle_pairs[:obstacle_pairs] = state.obstacle_pairs
    near.places.fill(0)
    near.places[state.pairs[:, 0], state.pairs[:, 1]] = np.arange(1, pairs + 1)
    near.counts[:] = pairs, obstacle_pairs, state.stale[0]
