"""From the settings of a table cell to what the world and the planner are made with."""

from math import pi

from robots.placement import Placement, PlanningScene, table_scene
from simulation.cable.parameters import RodParameters
from simulation.table_cell_config import CableConfig, LayoutConfig, Stiffness

# E I: curves that a cable keeps to grow with its square root.
STIFFNESS_N_M2: dict[Stiffness, float] = {"soft": 2.0e-5, "usual": 5.0e-5, "stiff": 1.3e-4}


def rod_parameters(cable: CableConfig) -> RodParameters:
    """Return what the cable is made of."""
    return RodParameters(
        bending_stiffness_n_m2=STIFFNESS_N_M2[cable.stiffness],
        connector_mass_kg=cable.connector_mass_kg,
        friction_table=cable.friction_table,
    )


def planning_scene(layout: LayoutConfig) -> PlanningScene:
    """Return the YuMi behind the middle of the table, looking along +y, and the table."""
    placement = Placement((0.0, layout.robot_y_m, layout.body_z_m), 0.5 * pi)
    return table_scene(placement)
