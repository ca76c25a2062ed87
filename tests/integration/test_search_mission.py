"""The mission that searches a shelf, end to end in the world without physics."""

from pathlib import Path

import pytest

from executive.app.catalogue import port_types, skills
from executive.app.compose import open_cell
from executive.engine.loading.loader import load_mission
from executive.engine.nodes.builder import build
from executive.engine.recording.reader import Recording
from executive.engine.running.control import RunControl
from executive.engine.running.mission_run import RunPlan, run_mission


def searched(folder, seed, scenario=None, inputs=None):
    mission = load_mission("search", skills=skills(), types=port_types())
    settings = {**mission.document.scenario, "count": 10, **(scenario or {})}
    cell = open_cell(mission.cell, settings, seed)
    given = inputs or {}
    tree = build(mission, devices=cell.devices, clock=cell.clock, inputs=given, seed=seed)
    plan = RunPlan(
        mission=mission,
        seed=seed,
        inputs=given,
        scenario=settings,
        timeout_s=mission.document.timeout_s,
        recording=folder / f"{seed}.mcap",
        faults=(),
    )
    return run_mission(plan, tree, cell, RunControl(), (), None)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return searched(tmp_path_factory.mktemp("search"), 2)


def test_it_ends_with_the_target_in_hand_and_says_so(run):
    assert run.report.outcome == "success"
    assert run.raised == ()
    assert run.report.claim["retrieved"]
    assert run.report.truth["retrieved"]
    assert run.report.truth["wrong"] == []
    assert run.report.claim["target"] == run.report.truth["target"]


def test_looks_and_beliefs_are_in_the_recording(run):
    recording = Recording.open(Path(run.report.recording))
    images = [image.png for image in recording.images()]
    looks = sum(action.name == "look_at_shelf" for action in run.report.actions)
    assert len(images) >= 2 * looks


def test_a_product_that_the_stock_does_not_have_ends_it_at_once(tmp_path):
    report = searched(tmp_path, 2, inputs={"product": "vitamin"}).report
    assert report.outcome == "failure"
    assert "order.unknown" in report.reason
    assert report.actions == ()


def test_a_target_of_which_a_sliver_shows_is_uncovered_and_taken_out(tmp_path):
    report = searched(tmp_path, 13, {"count": 15}).report
    assert report.outcome == "success"
    assert report.truth["retrieved"]
    assert report.truth["wrong"] == []


def test_a_search_that_runs_out_of_moves_says_so_and_claims_nothing(tmp_path):
    report = searched(tmp_path, 5, {"count": 15}, {"moves": 0}).report
    assert report.outcome == "failure"
    assert "search.ended" in report.reason
    assert not report.claim["found"]
