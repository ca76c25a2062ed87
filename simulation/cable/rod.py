"""Cables as things to be pushed, held and pulled; the solver is in `kernels`."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from executive.core.errors import InputError
from simulation.cable import kernels
from simulation.cable.hands import GraspMode, Hand, Strand
from simulation.cable.parameters import RodParameters
from simulation.cable.rod_parts import (
    chain_of,
    constants_of,
    neighbours_of,
    no_capsules,
    plug_nodes,
    plug_pose,
    rings_of,
)
from simulation.cable.rod_state import RodState, fill_chain, fill_neighbours

Floats = NDArray[np.float64]

# How long a cable must have kept still to be at rest.
REST_WINDOW_S = 0.1


class Rod:
    """One cable or several on a table, each seen as a chain of nodes.

    Nodes of several cables are numbered through, in the order of the cables.

    Time passes only in `advance`; what is set before it (obstacles, hands) is where things are
    at the end of that advance, and is interpolated on the way. Equal calls give bit-equal
    results.
    """

    def __init__(
        self, nodes_m: Floats | Sequence[Floats], parameters: RodParameters | None = None
    ) -> None:
        """Lay the cable along `nodes_m`, or several cables along as many lines.

        Args:
            nodes_m: Centre line [m], shape (N, 3), N >= 4, world frame, or a sequence of such
                lines; the distance of neighbours becomes their rest length.
            parameters: What the cables are made of.

        Raises:
            InputError: The shape is wrong, a number is not finite, or there is no cable.
        """
        lines_m = (nodes_m,) if isinstance(nodes_m, np.ndarray) else tuple(nodes_m)
        lines_m = tuple(_checked(line_m) for line_m in lines_m)
        if not lines_m:
            raise InputError("Rod: nodes; got no cable; expected at least one")
        self.parameters = parameters or RodParameters()
        ends = np.cumsum([len(line_m) for line_m in lines_m]).tolist()
        self._spans = tuple(
            (end - len(line_m), end - 1) for line_m, end in zip(lines_m, ends, strict=True)
        )
        nodes_m = np.vstack(lines_m)
        self._chain = chain_of(lines_m, self.parameters)
        self._near = neighbours_of(len(nodes_m), 0)
        self._constants = constants_of(self.parameters)
        self._capsules = no_capsules()
        self._next_capsules = self._capsules
        self._hands: dict[str, Hand] = {}
        self.time_s = 0.0
        self._still_since_s, self._still_m = 0.0, nodes_m.copy()
        self._at_rest = False

    @property
    def positions_m(self) -> Floats:
        """Node positions in the world, of all cables, shape (N, 3); a read-only view."""
        return _read_only(self._chain.positions)

    @property
    def lines_m(self) -> tuple[Floats, ...]:
        """Node positions of each cable, shape (N_k, 3); read-only views."""
        x = self.positions_m
        return tuple(x[first : last + 1] for first, last in self._spans)

    @property
    def velocities_m_s(self) -> Floats:
        """Node velocities, shape (N, 3); a read-only view."""
        return _read_only(self._chain.velocities)

    @property
    def tensions_n(self) -> Floats:
        """Tension of each segment over the last advance, shape (N - 1,); negative is a push."""
        return _read_only(self._chain.tensions)

    @property
    def length_m(self) -> float:
        """Length of all centre lines together now."""
        steps = (np.diff(line_m, axis=0) for line_m in self.lines_m)
        return float(sum(np.linalg.norm(step, axis=1).sum() for step in steps))

    @property
    def hands(self) -> Mapping[str, Hand]:
        """Hands that have been moved so far, by name."""
        return MappingProxyType(self._hands)

    def energy_j(self) -> float:
        """Return kinetic plus gravitational plus bending energy."""
        chain, parameters = self._chain, self.parameters
        masses_kg = 1.0 / chain.inverse_masses
        moving = 0.5 * masses_kg @ np.einsum("ij,ij->i", chain.velocities, chain.velocities)
        lifted = parameters.gravity_m_s2 * masses_kg @ chain.positions[:, 2]
        bends = np.diff(chain.positions, n=2, axis=0)
        bent = 0.5 * np.einsum("ij,ij->i", bends, bends) @ chain.bending_stiffness[1:-1]
        return float(moving + lifted + bent)

    def connector_poses(self) -> Floats:
        """Return `T_world_plug` of both plugs of each cable in order, shape (2 K, 4, 4).

        The origin is the middle of the plug's body, x points out of the cable's end, z is as
        far up as x allows. The body covers the last `connector_length_m` of the chain.
        """
        count = plug_nodes(self.parameters)
        ends = ((x, x[::-1]) for x in self.lines_m)
        return np.stack([plug_pose(x[0], x[count]) for both in ends for x in both])

    def set_capsules(self, starts_m: Floats, ends_m: Floats, radii_m: Floats) -> None:
        """Say where the obstacles are at the end of the next advance.

        When their number changes, or at the first call, they appear there at once; else they
        move there in straight lines.

        Args:
            starts_m: First ends of the capsules' axes [m], shape (M, 3).
            ends_m: Second ends [m], shape (M, 3).
            radii_m: Radii [m], shape (M,).
        """
        axes = np.empty((len(starts_m), 6))
        axes[:, :3], axes[:, 3:] = starts_m, ends_m
        radii = np.array(radii_m, dtype=np.float64).reshape(-1)
        same = len(radii) == len(self._capsules.radii)
        start = self._capsules.end if same else axes
        if not same:
            self._near = neighbours_of(len(self._chain.positions), len(radii))
        self._next_capsules = kernels.Obstacles(start, axes, radii)

    def move_hand(self, hand: str, T_world_tcp: Floats) -> None:
        """Say where a hand is at the end of the next advance; a new one appears there."""
        pose = np.array(T_world_tcp, dtype=np.float64)
        if hand in self._hands:
            self._hands[hand].next_pose = pose
        else:
            self._hands[hand] = Hand(pose)

    def close_hand(
        self,
        hand: str,
        mode: GraspMode,
        finger_gap_m: float,
        finger_depth_m: float,
        finger_width_m: float,
    ) -> bool:
        """Take what lies between the fingers.

        The box between the fingers, in the tool frame: |x| <= gap / 2 along the opening,
        |y| <= width / 2, and z from `finger_depth_m` inside the hand to the finger tips
        (`hands.TIP_BEYOND_TCP_M` beyond the tool centre point).

        A `pinch` holds each strand until its tension exceeds `pinch_force_n`, then it slips. A
        `cage` is a ring: the cable slides through with little friction and cannot leave
        sideways; the plug is wider than the ring and stops there.

        Args:
            hand: Name given to `move_hand`.
            mode: What the fingers do.
            finger_gap_m: Distance between the fingers before they close.
            finger_depth_m: How deep between the fingers a cable still counts.
            finger_width_m: Width of the fingers.

        Returns:
            Whether anything was between them; a miss is a miss.

        Raises:
            InputError: The hand has never been moved.
        """
        self._known(hand).close(
            mode,
            self._chain.positions,
            self._spans,
            np.array([finger_gap_m, finger_width_m, finger_depth_m]),
            self.parameters,
        )
        self._near.counts[2] = 1
        return bool(self._hands[hand].strands)

    def release_hand(self, hand: str) -> None:
        """Open a hand; nothing happens when it holds nothing."""
        self._known(hand).strands = ()
        self._near.counts[2] = 1

    def held_nodes(self, hand: str) -> tuple[int, ...]:
        """Return the nodes nearest to where a hand holds the cable, one a strand."""
        return tuple(round(strand.arc) for strand in self._known(hand).strands)

    def tension_n(self, hand: str) -> float:
        """Return the greatest tension of the cable beside a hand's grasps."""
        tension = 0.0
        for strand in self._known(hand).strands:
            first, last = max(int(strand.arc) - 2, strand.span[0]), int(strand.arc) + 3
            last = min(last, strand.span[1])
            tension = max(tension, float(self._chain.tensions[first:last].max(initial=0.0)))
        return tension

    def force_n(self, hand: str) -> Floats:
        """Return the force of a hand on the cable over the last advance, world, shape (3,)."""
        return sum((s.force_n for s in self._known(hand).strands), np.zeros(3))

    def state(self) -> RodState:
        """Return a copy of all that decides how the cables go on; no hand may hold one."""
        chain, near = self._chain, self._near
        pairs, obstacle_pairs = int(near.counts[0]), int(near.counts[1])
        hands = [self._hands[name].pose for name in sorted(self._hands)]
        return RodState(
            positions=chain.positions.copy(),
            velocities=chain.velocities.copy(),
            rest_lengths=chain.rest_lengths.copy(),
            tensions=chain.tensions.copy(),
            impulses=chain.impulses.copy(),
            peak=chain.peak.copy(),
            reference=near.reference.copy(),
            obstacle_reference=near.obstacle_reference.copy(),
            order=near.order.copy(),
            pairs=near.pairs[:pairs].copy(),
            normals=near.normals[:pairs].copy(),
            obstacle_pairs=near.obstacle_pairs[:obstacle_pairs].copy(),
            stale=near.counts[2:].copy(),
            capsules=self._capsules.end.copy(),
            radii=self._capsules.radii.copy(),
            hand_poses=np.array(hands).reshape(-1, 4, 4),
            times_s=np.array([self.time_s, self._still_since_s]),
            still=self._still_m.copy(),
            at_rest=np.array([self._at_rest]),
        )

    def take_state(self, state: RodState) -> None:
        """Go on from the state of the same cables; hands of the same names stand open.

        Raises:
            InputError: It is the state of other cables, or of other hands.
        """
        if len(state.hand_poses) != len(self._hands):
            raise InputError(
                f"Rod: state; got {len(state.hand_poses)} hands; expected {len(self._hands)}"
            )
        fill_chain(self._chain, state)
        self._near = neighbours_of(len(state.positions), len(state.radii))
        fill_neighbours(self._near, state)
        self._capsules = kernels.Obstacles(state.capsules, state.capsules, state.radii)
        self._next_capsules = self._capsules
        self._hands = {
            name: Hand(pose)
            for name, pose in zip(sorted(self._hands), state.hand_poses, strict=True)
        }
        self.time_s, self._still_since_s = state.times_s.tolist()
        self._still_m, self._at_rest = state.still.copy(), bool(state.at_rest[0])

    @property
    def at_rest(self) -> bool:
        """Whether all cable lies still, so that time costs nothing until something comes near."""
        return self._at_rest

    def advance(self, duration_s: float) -> None:
        """Let time pass; hands and capsules arrive where they were sent."""
        strands = [(hand, strand) for hand in self._hands.values() for strand in hand.strands]
        if strands or kernels.is_approached(self._chain, self._next_capsules, self._constants):
            self._at_rest = False
        if not self._at_rest:
            self._solve(strands, duration_s)
        for hand in self._hands.values():
            hand.arrive(duration_s, self._chain.positions, self.parameters.tear_m)
        self._capsules = self._next_capsules
        self._next_capsules = kernels.Obstacles(
            self._capsules.end, self._capsules.end, self._capsules.radii
        )
        self.time_s += duration_s
        if not self._at_rest:
            self._watch_rest(bool(strands))

    def _solve(self, strands: list[tuple[Hand, Strand]], duration_s: float) -> None:
        steps = max(1, round(duration_s / self.parameters.substep_s))
        rings = rings_of(strands, duration_s, self.parameters, len(self._chain.positions))
        kernels.advance(
            self._chain,
            self._near,
            self._next_capsules,
            rings,
            self._constants,
            steps,
            duration_s / steps,
        )
        for (_, strand), arc, force in zip(strands, rings.arc, rings.force, strict=True):
            strand.arc, strand.force_n = float(arc), force

    def _watch_rest(self, held: bool) -> None:
        """Notice that a free cable has kept still for a while."""
        waited_s = self.time_s - self._still_since_s
        if not held and waited_s < REST_WINDOW_S:
            return
        moved_m = np.linalg.norm(self._chain.positions - self._still_m, axis=1).max()
        self._at_rest = not held and bool(moved_m < self.parameters.rest_speed_m_s * waited_s)
        if self._at_rest:
            self._chain.velocities.fill(0.0)
            self._chain.tensions.fill(0.0)
        self._still_since_s, self._still_m = self.time_s, self._chain.positions.copy()

    def _known(self, hand: str) -> Hand:
        if hand not in self._hands:
            known = ", ".join(sorted(self._hands)) or "none"
            raise InputError(f"Rod: unknown hand; got {hand!r}; expected one of: {known}")
        return self._hands[hand]


def _read_only(array: Floats) -> Floats:
    view = array.view()
    view.flags.writeable = False
    return view


def _checked(line_m: Floats) -> Floats:
    line_m = np.array(line_m, dtype=np.float64)
    if line_m.ndim != 2 or line_m.shape[1] != 3 or len(line_m) < 4:
        raise InputError(f"Rod: nodes; got shape {line_m.shape}; expected (N, 3) with N >= 4")
    if not np.isfinite(line_m).all():
        raise InputError("Rod: nodes; got a number that is not finite; expected metres")
    return line_m
