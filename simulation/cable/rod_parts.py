"""What the solver of `kernels` works on, made from lines, hands and parameters."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from simulation.cable import kernels
from simulation.cable.hands import Hand, Strand
from simulation.cable.parameters import RodParameters

Floats = NDArray[np.float64]

# A plug is this much stiffer than the cable.
PLUG_STIFFNESS = 100.0
# Room in the candidate lists: a bundle of twenty strands touching all along stays below it.
PAIRS_PER_NODE = 40


def chain_of(lines_m: Sequence[Floats], parameters: RodParameters) -> kernels.Chain:
    """Return cables at rest along lines, shape (N_k, 3) each, one after another."""
    nodes_m = np.vstack(lines_m)
    cables = np.concatenate(
        [np.append(np.full(len(line_m) - 1, k), -1) for k, line_m in enumerate(lines_m)]
    )[:-1]
    rest_lengths_m = np.linalg.norm(np.diff(nodes_m, axis=0), axis=1)
    rest_lengths_m[cables < 0] = 0.0
    segments = len(nodes_m) - 1
    return kernels.Chain(
        positions=nodes_m,
        previous=nodes_m.copy(),
        velocities=np.zeros_like(nodes_m),
        inverse_masses=np.concatenate([1.0 / _masses_kg(line_m, parameters) for line_m in lines_m]),
        rest_lengths=rest_lengths_m,
        cables=cables,
        bending_stiffness=np.concatenate(
            [_stiffness_n_m(len(line_m), parameters) for line_m in lines_m]
        ),
        factor=np.zeros_like(nodes_m),
        moves=np.zeros_like(nodes_m),
        tensions=np.zeros(segments),
        peak=np.zeros(1),
        directions=np.zeros((segments, 3)),
        diagonal=np.zeros(segments),
        coupling=np.zeros(segments),
        impulses=np.zeros(segments),
    )


def plug_nodes(parameters: RodParameters) -> int:
    """Return how many segments of a chain a plug covers."""
    return max(1, round(parameters.connector_length_m / parameters.node_spacing_m))


def _masses_kg(line_m: Floats, parameters: RodParameters) -> Floats:
    lengths_m = np.linalg.norm(np.diff(line_m, axis=0), axis=1)
    masses_kg = np.zeros(len(line_m))
    masses_kg[:-1] += 0.5 * parameters.density_kg_m * lengths_m
    masses_kg[1:] += 0.5 * parameters.density_kg_m * lengths_m
    plug = min(plug_nodes(parameters), len(line_m) // 2 - 1)
    masses_kg[: plug + 1] += parameters.connector_mass_kg / (plug + 1)
    masses_kg[-plug - 1 :] += parameters.connector_mass_kg / (plug + 1)
    return masses_kg


def _stiffness_n_m(nodes: int, parameters: RodParameters) -> Floats:
    plug = min(plug_nodes(parameters), nodes // 2 - 1)
    stiffness = np.full(nodes, parameters.bending_stiffness_n_m2)
    stiffness /= parameters.node_spacing_m**3
    stiffness[:plug] *= PLUG_STIFFNESS
    stiffness[-plug:] *= PLUG_STIFFNESS
    stiffness[[0, -1]] = 0.0
    return stiffness


def neighbours_of(nodes: int, capsules: int) -> kernels.Neighbours:
    """Return empty lists of what may touch."""
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


def constants_of(parameters: RodParameters) -> kernels.Constants:
    """Return the numbers that the solver needs."""
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
        edge_radius=parameters.edge_radius_m,
        floor_height=parameters.floor_height_m,
        gravity=parameters.gravity_m_s2,
    )


def no_capsules() -> kernels.Obstacles:
    """Return no obstacles."""
    return kernels.Obstacles(np.zeros((0, 6)), np.zeros((0, 6)), np.zeros(0))


def rings_of(
    strands: Sequence[tuple[Hand, Strand]], duration_s: float, parameters: RodParameters, nodes: int
) -> kernels.Rings:
    """Return what hands hold while they go where they are sent.

    Args:
        strands: Each with its hand.
        duration_s: Of the advance.
        parameters: What the cables are made of.
        nodes: Of all cables.
    """
    count = len(strands)
    plug = plug_nodes(parameters)
    rings = kernels.Rings(
        start=np.zeros((count, 3)),
        end=np.zeros((count, 3)),
        arc=np.array([strand.arc for _, strand in strands], dtype=np.float64),
        arc_limits=np.zeros((count, 2)),
        spans=np.array([strand.span for _, strand in strands], dtype=np.int64).reshape(-1, 2),
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


def plug_pose(end: Floats, inner: Floats) -> Floats:
    """Return `T_world_plug` of a plug from an end to an inner node; x points out of the end."""
    out = (end - inner) / np.linalg.norm(end - inner)
    up = np.array([0.0, 0.0, 1.0]) if abs(out[2]) < 0.99 else np.array([1.0, 0.0, 0.0])
    side = np.cross(up, out)
    side /= np.linalg.norm(side)
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2] = out, side, np.cross(out, side)
    pose[:3, 3] = 0.5 * (end + inner)
    return pose
