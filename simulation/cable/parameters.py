"""What the cable and its surroundings are made of."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RodParameters:
    """A braided USB cable on a cloth-covered table.

    Attributes:
        node_spacing_m: Arc length between neighbouring nodes.
        radius_m: Radius of the cable.
        density_kg_m: Mass per length.
        connector_mass_kg: Mass of the plug at each end.
        connector_length_m: Length of the plug; it covers the last stretch of the node chain.
        bending_stiffness_n_m2: E I; of a soft cable, which keeps to curves of 5 cm radius.
        bending_damping_s: Ratio of bending damping to bending stiffness (Kelvin-Voigt).
        axial_stiffness_n: E A; high enough that the cable does not visibly stretch.
        air_damping_1_s: Rate at which free motion dies out.
        friction_table: Coulomb coefficient of cable on cloth.
        friction_self: Coulomb coefficient of cable on cable.
        friction_obstacles: Coulomb coefficient of cable on fingers and links.
        friction_cage: Coulomb coefficient of cable sliding through a caging gripper.
        cage_clearance_m: How far the cable's centre line may lie off the centre of a cage.
        pinch_force_n: Tension at which the cable slips through a pinching gripper.
        overload_force_n: Force that no grasp can exert on a strand.
        tear_m: A strand this far from where the fingers should hold it has been torn out.
        table_size_m: Size of the table in x and y; its top is z = 0, its centre the origin.
        edge_radius_m: Of the table's rounded edges; about as large as the distance of nodes, or
            cable that is drawn in over an edge catches on it.
        floor_height_m: Height of the floor beside the table.
        gravity_m_s2: Acceleration of free fall, downwards.
        substep_s: Nominal length of one solver step.
        rest_speed_m_s: A free cable that no node of has moved faster for a while is at rest,
            and costs nothing until something comes near; 0 keeps it awake.
    """

    node_spacing_m: float = 0.01
    radius_m: float = 0.0033
    density_kg_m: float = 0.035
    connector_mass_kg: float = 0.004
    connector_length_m: float = 0.02
    bending_stiffness_n_m2: float = 5.0e-5
    bending_damping_s: float = 0.01
    axial_stiffness_n: float = 1.0e4
    air_damping_1_s: float = 0.2
    friction_table: float = 0.4
    friction_self: float = 0.25
    friction_obstacles: float = 0.3
    friction_cage: float = 0.15
    cage_clearance_m: float = 0.002
    pinch_force_n: float = 15.0
    overload_force_n: float = 30.0
    tear_m: float = 0.02
    table_size_m: tuple[float, float] = (1.0, 0.75)
    edge_radius_m: float = 0.01
    floor_height_m: float = -0.75
    gravity_m_s2: float = 9.81
    substep_s: float = 0.00025
    rest_speed_m_s: float = 0.002
