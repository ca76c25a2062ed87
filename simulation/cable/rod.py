"""The cable as a thing to be pushed, held and pulled; the solver is in `kernels`."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from executive.core.errors import InputError
from simulation.cable import kernels
from simulation.cable.hands import GraspMode, Hand, Strand
from simulation.cable.parameters import RodParameters
from simulation.cable.rod_state import RodState, fill_chain, fill_neighbours

Floats = NDArray[np.float64]

# Room in the candidate lists: a bundle of twenty strands touching all along stays below it.
PAIRS_PER_NODE = 40
# How long a cable must have kept still to be at rest.
REST_WINDOW_S = 0.1


class Rod:
    """A cable on a table, seen as a chain of nodes.

    Time passes only in `advance`; what is set before it (obstacles, hands) is where things are
    at the end of that advance, and is interpolated on the way. Equal calls give bit-equal
    results.
    """

    def __init__(self, nodes_m: Floats, parameters: RodParameters | None = None) -> None:
        """Lay the cable along `nodes_m`.

        Args:
            nodes_m: Centre line [m], shape (N, 3), N >= 4, world frame; the distance of
                neighbours becomes their rest length.
            parameters: What the cable is made of.

        Raises:
            InputError: The shape is wrong or a number is not finite.
        """
        nodes_m = np.array(nodes_m, dtype=np.float64)
        if nodes_m.ndim != 2 or nodes_m.shape[1] != 3 or len(nodes_m) < 4:
            raise InputError(f"Rod: nodes; got shape {nodes_m.shape}; expected (N, 3) with N >= 4")
        if not np.isfinite(nodes_m).all():
            raise InputError("Rod: nodes; got a number that is not finite; expected metres")
        self.parameters = parameters or RodParameters()
        self._chain = _chain(nodes_m, self.parameters)
        self._near = _neighbours(len(nodes_m), 0)
        self._constants = _constants(self.parameters)
        self._capsules = _no_capsules()
        self._next_capsules = self._capsules
        self._hands: dict[str, Hand] = {}
        self.time_s = 0.0
        self._still_since_s, self._still_m = 0.0, nodes_m.copy()
        self._at_rest = False

    @property
    def positions_m(self) -> Floats:
        """Node positions in the world, shape (N, 3); a read-only view."""
        return _read_only(self._chain.positions)

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
        """Length of the centre line now."""
        return float(np.linalg.norm(np.diff(self._chain.positions, axis=0), axis=1).sum())

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
        """Return `T_world_plug` of both plugs, shape (2, 4, 4).

        The origin is the middle of the plug's body, x points out of the cable's end, z is as
        far up as x allows. The body covers the last `connector_length_m` of the chain.
        """
        x, count = self._chain.positions, _plug_nodes(self.parameters)
        return np.stack([_plug_pose(x[0], x[count]), _plug_pose(x[-1], x[-1 - count])])

    def set_capsules(self, starts_m: Floats, ends_m: Floats, radii_m: Floats) -> None:
        """Say where the obstacles are at the end of the next advance.

        When their number changes, or at the first call, they appear there at once; else they
        move there in straight lines.

        Args:
            starts_m: First ends of the capsules' axes [m], shape (M, 3).
            ends_m: Second ends [m], shape (M, 3).
            radii_m: Radii [m], shape (M,).
        """
        axes = np.hstack([np.reshape(starts_m, (-1, 3)), np.reshape(ends_m, (-1, 3))])
        axes = np.ascontiguousarray(axes, dtype=np.float64)
        radii = np.array(radii_m, dtype=np.float64).reshape(-1)
        same = len(radii) == len(self._capsules.radii)
        start = self._capsules.end if same else axes
        if not same:
            self._near = _neighbours(len(self._chain.positions), len(radii))
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
            first, last = max(int(strand.arc) - 2, 0), int(strand.arc) + 3
            tension = max(tension, float(self._chain.tensions[first:last].max(initial=0.0)))
        return tension

    def force_n(self, hand: str) -> Floats:
        """Return the force of a hand on the cable over the last advance, world, shape (3,)."""
        return sum((s.force_n for s in self._known(hand).strands), np.zeros(3))

    def state(self) -> RodState:
        """Return a copy of all that decides how the cable goes on; no hand may hold it."""
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
        """Go on from the state of the same cable; hands of the same names stand open.

        Raises:
            InputError: It is the state of another cable, or of other hands.
        """
        if len(state.hand_poses) != len(self._hands):
            raise InputError(
                f"Rod: state; got {len(state.hand_poses)} hands; expected {len(self._hands)}"
            )
        fill_chain(self._chain, state)
        self._near = _neighbours(len(state.positions), len(state.radii))
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
        """Whether the cable lies still, so that time costs nothing until something comes near."""
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
        rings = _rings(strands, duration_s, self.parameters, len(self._chain.positions))
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


def _plug_nodes(parameters: RodParameters) -> int:
    return max(1, round(parameters.connector_length_m / parameters.node_spacing_m))


def _chain(nodes_m: Floats, parameters: RodParameters) -> kernels.Chain:
    lengths_m = np.linalg.norm(np.diff(nodes_m, axis=0), axis=1)
    masses_kg = np.zeros(len(nodes_m))
    masses_kg[:-1] += 0.5 * parameters.density_kg_m * lengths_m
    masses_kg[1:] += 0.5 * parameters.density_kg_m * lengths_m
    plug = min(_plug_nodes(parameters), len(nodes_m) // 2 - 1)
    masses_kg[: plug + 1] += parameters.connector_mass_kg / (plug + 1)
    masses_kg[-plug - 1 :] += parameters.connector_mass_kg / (plug + 1)
    stiffness = np.full(len(nodes_m), parameters.bending_stiffness_n_m2)
    stiffness /= parameters.node_spacing_m**3
    stiffness[:plug] *= PLUG_STIFFNESS
    stiffness[-plug:] *= PLUG_STIFFNESS
    stiffness[[0, -1]] = 0.0
    segments = len(nodes_m) - 1
    return kernels.Chain(
        positions=nodes_m,
        previous=nodes_m.copy(),
        velocities=np.zeros_like(nodes_m),
        inverse_masses=1.0 / masses_kg,
        rest_lengths=lengths_m,
        bending_stiffness=stiffness,
        factor=np.zeros_like(nodes_m),
        moves=np.zeros_like(nodes_m),
        tensions=np.zeros(segments),
        peak=np.zeros(1),
        directions=np.zeros((segments, 3)),
        diagonal=np.zeros(segments),
        coupling=np.zeros(segments),
        impulses=np.zeros(segments),
    )


# A plug is this much stiffer than the cable.
PLUG_STIFFNESS = 100.0


def _neighbours(nodes: int, capsules: int) -> kernels.Neighbours:
    room = PAIRS_PER_NODE * nodes
    return kernels.Neighbours(
        reference=np.zeros((nodes, 3)),
        obstacle_reference=np.zeros((capsules, 6)),
        order=np.arange(nodes - 1),
        pairs=np.zeros((room, 2), dtype=np.int64),
        normals=np.zeros((room, 3)),
        old_normals=np.zeros((room, 3)),
        places=np.zeros((nodes - 1, nodes - 1), dtype=np.int64),
        obstacle_pairs=np.zeros((room, 2), dtype=np.int64),
        counts=np.array([0, 0, 1]),
    )


def _constants(parameters: RodParameters) -> kernels.Constants:
    return kernels.Constants(
        radius=parameters.radius_m,
        stretch_compliance=1.0 / parameters.axial_stiffness_n,
        bending_damping=parameters.bending_damping_s,
        air_damping=parameters.air_damping_1_s,
        friction_table=parameters.friction_table,
        friction_self=parameters.friction_self,
        friction_obstacles=parameters.friction_obstacles,
        overload_force=parameters.overload_force_n,
        half_table_x=0.5 * parameters.table_size_m[0],
        half_table_y=0.5 * parameters.table_size_m[1],
        floor_height=parameters.floor_height_m,
        gravity=parameters.gravity_m_s2,
    )


def _no_capsules() -> kernels.Obstacles:
    return kernels.Obstacles(np.zeros((0, 6)), np.zeros((0, 6)), np.zeros(0))


def _rings(
    strands: list[tuple[Hand, Strand]], duration_s: float, parameters: RodParameters, nodes: int
) -> kernels.Rings:
    count = len(strands)
    plug = _plug_nodes(parameters)
    rings = kernels.Rings(
        start=np.zeros((count, 3)),
        end=np.zeros((count, 3)),
        arc=np.array([strand.arc for _, strand in strands], dtype=np.float64),
        arc_limits=np.zeros((count, 2)),
        clearance=np.zeros(count),
        grip_force=np.zeros(count),
        friction=np.zeros(count),
        force=np.zeros((count, 3)),
        guided=np.zeros(count, dtype=np.int64),
        guides=np.zeros((count, 6)),
        pushes=np.zeros((count, 3)),
        solved=np.full(count, -1),
        responses=np.zeros((count, 2, nodes)),
    )
    for r, (hand, strand) in enumerate(strands):
        rings.start[r], rings.end[r] = hand.strand_path(strand, duration_s)
        rings.arc_limits[r] = strand.arc_limits(plug)
        caging = strand.mode == "cage"
        rings.clearance[r] = parameters.cage_clearance_m if caging else 0.0
        rings.grip_force[r] = 0.0 if caging else parameters.pinch_force_n
        rings.friction[r] = parameters.friction_cage
    return rings


def _plug_pose(end: Floats, inner: Floats) -> Floats:
    out = (end - inner) / np.linalg.norm(end - inner)
    up = np.array([0.0, 0.0, 1.0]) if abs(out[2]) < 0.99 else np.array([1.0, 0.0, 0.0])
    side = np.cross(up, out)
    side /= np.linalg.norm(side)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2] = out, side, np.cross(out, side)
    pose[:3, 3] = 0.5 * (end + inner)
    return pose
