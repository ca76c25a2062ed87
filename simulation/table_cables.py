"""From the scenario of a table cell to the cables that lie on the table."""

from pathlib import Path

import numpy as np

from simulation.cable.configuration_file import configuration_from_file, configurations_from_files
from simulation.cable.configurations import Lines, starting_configuration
from simulation.cable.parameters import RodParameters
from simulation.cable.several import CableOrder, several_cables
from simulation.cable.tiers import tier_cable
from simulation.table_cell_config import CableScenario, OneCable, TableScenario


def lay_cables(found: TableScenario, rng: np.random.Generator, parameters: RodParameters) -> Lines:
    """Return where the cables of a scenario lie, shape (N_k, 3) each, world frame.

    Args:
        found: What the mission finds.
        rng: Source of all randomness.
        parameters: What the cables are made of.

    Raises:
        InputError: A file cannot be used, or no way to lay them was found.
    """
    if not found.cables and found.tied is None:
        return _one(found.cable, rng, parameters)
    if found.cables and found.cables[0].file:
        paths = [Path(cable.file) for cable in found.cables]
        return configurations_from_files(paths, parameters)
    cables = found.cables or (OneCable(), OneCable())
    orders = [CableOrder(cable.knot, cable.length_m) for cable in cables]
    return several_cables(orders, rng, found.tied, parameters)


def _one(cable: CableScenario, rng: np.random.Generator, parameters: RodParameters) -> Lines:
    if cable.file:
        return (configuration_from_file(Path(cable.file), parameters),)
    if cable.tier is None:
        return (starting_configuration(cable.knot, rng, parameters),)
    drawn = tier_cable(cable.tier, rng, leaves_view=cable.leaves_view, parameters=parameters)
    return (drawn.nodes_m,)
