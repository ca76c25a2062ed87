"""The command line with a toy world behind it; run as a script it is `cellwright` itself."""

import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, ClassVar

from toy_runs import ToyCell

from executive.app import catalogue, compose
from executive.core.errors import DeviceError, InputError
from executive.core.outcome import failure, success
from executive.core.registry import Registry, closest
from executive.core.skill import In, Port, Skill, SkillRun

MISSION = """
format: 1
mission: toy
cell: toy_cell
scenario: {cable: {knot: overhand}, ending: success}
timeout_s: 30.0
in:
  steps: {type: int, default: 3}
out:
  claim: {type: Claim}
root:
  sequence:
    children:
      - {skill: toy_move, in: {steps: $steps}}
      - {skill: toy_end, out: {claim: $claim}}
"""
CELL = """
format: 1
cell: toy_cell
world: toy
"""


@dataclass(frozen=True)
class Claim:
    untangled: bool
    knotted_probability: float


@dataclass(frozen=True)
class Truth:
    untangled: bool
    crossings: int


class ToyMove(Skill):
    """Moves for some ticks."""

    ACTS = True

    def run(self, steps: Annotated[int, In("ticks")]) -> SkillRun:
        for _ in range(steps):
            time.sleep(0.001)
            yield
        return success()


class ToyEnd(Skill):
    """Ends as the scenario says."""

    OUT: ClassVar = {"claim": Port(Claim, "what it says")}
    REASONS = frozenset({"toy.missed"})

    def __init__(self, ending: str) -> None:
        self._ending = ending

    def run(self) -> SkillRun:
        yield from ()
        if self._ending == "hang":
            time.sleep(60.0)
        if self._ending == "raise":
            raise DeviceError("the toy broke")
        if self._ending == "failure":
            return failure("toy.missed", "nothing there")
        os.write(1, b"a library that prints to stdout\n")
        return success(claim=Claim(True, 0.02))


class ScoredCell(ToyCell):
    def truth(self):
        return Truth(True, 0)


def open_toy_cell(document, scenario, seed):
    """Open a cell that knows the truth."""
    allowed = ("success", "failure", "raise", "hang")
    if scenario["ending"] not in allowed:
        raise InputError(f"scenario: ending: {closest(str(scenario['ending']), list(allowed))}")
    return ScoredCell(devices={"ending": scenario["ending"]})


def toy_skills():
    registry = Registry("skill")
    registry.add("toy_move", ToyMove)
    registry.add("toy_end", ToyEnd)
    return registry


def toy_types():
    registry = Registry("port type")
    for kind in (int, float, str, bool, Claim):
        registry.add(kind.__name__, kind)
    return registry


def write_mission(folder):
    """Write the toy mission and its cell; return the mission's file."""
    (folder / "toy_cell.yaml").write_text(CELL)
    (folder / "toy.yaml").write_text(MISSION)
    return folder / "toy.yaml"


def replacements():
    """Return what stands in for the real catalogue and composition, by module and name."""
    return [
        (catalogue, "skills", toy_skills),
        (catalogue, "port_types", toy_types),
        (compose, "open_cell", open_toy_cell),
    ]


if __name__ == "__main__":
    for module, name, toy in replacements():
        setattr(module, name, toy)
    from executive.cli.main import main

    sys.argv[0] = str(Path(sys.argv[0]).with_name("cellwright"))
    main()
