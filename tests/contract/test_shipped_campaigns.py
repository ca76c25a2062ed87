"""The campaigns that ship: each runs a mission that there is, with settings that its cell takes."""

from pathlib import Path

import pytest

from executive.app.campaigns.campaign import Campaign
from executive.app.campaigns.document import read_campaign
from executive.app.campaigns.variants import variants
from executive.app.missions import load, settings_of
from simulation.shelf_cell.config import ShelfScenario
from simulation.table_cell_config import TableScenario, read_settings

FILES = sorted((Path(__file__).parents[2] / "campaigns").glob("*.yaml"))
SCENARIOS = {
    "table_cell": TableScenario,
    "shelf_cell": ShelfScenario,
    "shelf_kinematic": ShelfScenario,
}


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_every_variant_of_a_campaign_can_be_run(file, tmp_path):
    document, _ = read_campaign(file)
    assert document.campaign == file.stem
    assert Campaign(document, file.parent, tmp_path).count > 0
    mission = load(document.mission)
    for variant in variants(document):
        scenario = settings_of(mission, variant.settings).scenario
        read_settings(SCENARIOS[mission.cell.world], scenario, file.name)
