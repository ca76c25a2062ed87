"""Missions for the benchmarks of campaigns and of the service, and a bare loop over one."""

import time
from collections.abc import Callable, Iterable
from contextlib import closing
from pathlib import Path

from executive.app.campaigns.campaign import Campaign
from executive.app.campaigns.document import CampaignDocument
from executive.app.compose import open_cell
from executive.app.missions import load, settings_of
from executive.engine.loading.loader import Mission
from executive.engine.nodes.builder import build
from executive.engine.running.control import RunControl
from executive.engine.running.mission_run import RunPlan, run_mission

TRIVIAL = """
format: 1
mission: trivial
cell: dry
root: {chance: 0.9}
"""


def write_trivial(folder: Path) -> str:
    """Write a mission of one node, and return its name."""
    (folder / "trivial.yaml").write_text(TRIVIAL, encoding="utf-8")
    return "trivial"


def campaign(
    mission: str, seeds: Iterable[int], folder: Path, *, timeout_s: float | None = None
) -> Campaign:
    """Begin a campaign over seeds."""
    document = CampaignDocument.model_validate(
        {
            "campaign": "bench",
            "format": 1,
            "mission": mission,
            "seeds": tuple(seeds),
            "limits": {"timeout_s": timeout_s} if timeout_s else {},
            "keep": "none",
        }
    )
    begun = Campaign(document, folder.parent, folder)
    begun.begin()
    return begun


def bare(mission: Mission, seed: int, file: Path, timeout_s: float | None = None) -> None:
    """Run a mission in this process, with its recording and nothing else."""
    settings = settings_of(mission, {})
    limit_s = mission.document.timeout_s if timeout_s is None else timeout_s
    plan = RunPlan(mission, seed, settings.inputs, settings.scenario, limit_s, file)
    with closing(open_cell(mission.cell, settings.scenario, seed)) as cell:
        tree = build(
            mission, devices=cell.devices, clock=cell.clock, inputs=settings.inputs, seed=seed
        )
        run_mission(plan, tree, cell, RunControl())
    file.unlink()


def bare_loop(named: str, file: Path, timeout_s: float | None = None) -> Callable[[int], None]:
    """Return what runs a mission with a seed, warmed up by one run."""
    mission = load(named)

    def run(seed: int) -> None:
        bare(mission, seed, file, timeout_s)

    run(0)
    return run


def seconds(act: Callable[[], object]) -> float:
    """Return how long something takes on the machine's clock [s]."""
    began_s = time.perf_counter()
    act()
    return time.perf_counter() - began_s
