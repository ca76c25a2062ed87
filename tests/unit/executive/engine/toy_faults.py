"""A dry mission of stubs, run with and without faults."""

from dataclasses import replace
from pathlib import Path

from executive.app.compose import open_cell
from executive.core.registry import Registry
from executive.engine.faults.grammar import parse_injection
from executive.engine.loading.loader import load_mission
from executive.engine.nodes.builder import build
from executive.engine.recording.reader import Recording
from executive.engine.running.control import RunControl
from executive.engine.running.mission_run import RunPlan, run_mission

STUBS = """
format: 1
stubs: fetch_stubs
skills:
  look:
    out: {part: {type: str}, sure: {type: float}}
    outcomes:
      - {outcome: success, ticks: 2, out: {part: bolt, sure: 0.9}}
      - {outcome: success, ticks: 2, out: {part: nut, sure: 0.8}}
      - {outcome: success, ticks: 2, out: {part: gear, sure: 0.7}}
  grasp:
    in: {part: {type: str}}
    acts: true
    outcomes: [GRASPS]
  place:
    in: {part: {type: str}}
    acts: true
    outcomes: [{outcome: success, ticks: 3}]
  let_go:
    acts: true
    outcomes: [{outcome: success}]
"""
MISSION = """
format: 1
mission: fetch
cell: dry
uses: [fetch_stubs]
timeout_s: 30.0
on_error: ON_ERROR
root:
  repeat:
    name: fetch
    times: 3
    child:
      sequence:
        name: one
        children:
          - retry:
              name: until_held
              times: 3
              child:
                sequence:
                  name: pick
                  children:
                    - {skill: look, out: {part: $part, sure: $sure}}
                    - {when: sure > 0.5, name: sure_enough}
                    - timeout:
                        name: in_time
                        seconds: 2.0
                        child: {skill: grasp, in: {part: $part}}
          - selector:
              name: put_down
              children:
                - {skill: place, in: {part: $part}}
                - {skill: let_go}
"""
GRASP = "{outcome: success, ticks: 3}"
PATHS = {
    "look": "fetch/one/until_held/pick/look",
    "grasp": "fetch/one/until_held/pick/in_time/grasp",
    "place": "fetch/one/put_down/place",
}


def write_fetch(folder: Path, grasps=GRASP, on_error="end") -> Path:
    """Write the mission and its stubs; return the file of the mission."""
    (folder / "fetch_stubs.yaml").write_text(STUBS.replace("GRASPS", grasps))
    (folder / "fetch.yaml").write_text(MISSION.replace("ON_ERROR", on_error))
    return folder / "fetch.yaml"


class Run:
    """One run of the mission with faults."""

    def __init__(self, folder: Path, *faults: str, grasps=GRASP, on_error="end", seed=0):
        mission = load_mission(
            write_fetch(folder, grasps, on_error),
            skills=Registry("skill"),
            types=Registry("port type"),
        )
        cell = open_cell(mission.cell, {}, seed)
        tree = build(mission, devices=cell.devices, clock=cell.clock, seed=seed)
        plan = RunPlan(
            mission,
            seed,
            {},
            {},
            mission.document.timeout_s,
            folder / "run.mcap",
            faults=tuple(parse_injection(fault) for fault in faults),
        )
        self.result = run_mission(plan, tree, cell, RunControl())
        self.recording = Recording.open(plan.recording)
        self.ticks = list(self.recording.ticks())

    @property
    def outcome(self):
        return self.result.report.outcome

    @property
    def reason(self):
        return self.result.report.reason

    def happened(self, until=None):
        """Return all that happened in each tick before one, but for how long it took here."""
        return [replace(tick, duration_s=0.0) for tick in self.ticks[:until]]

    def answers(self):
        """Return visits, changes and halts of each tick, without reasons."""
        return [(tick.visited, tick.changes, tick.halts) for tick in self.ticks]

    def written(self, name):
        """Return the values that were written to a key, in order."""
        return [w.value for tick in self.ticks for w in tick.writes if w.key == f"fetch:{name}"]

    def halts(self, name):
        """Return how often a node was halted."""
        index = [node.name for node in self.recording.header.nodes].index(name)
        return sum(halt.node == index for tick in self.ticks for halt in tick.halts)
