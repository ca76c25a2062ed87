"""Toy skills and a way to write trees inside tests."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from textwrap import dedent, indent
from typing import Annotated, ClassVar

from executive.core.clock import ManualClock
from executive.core.errors import DocumentError
from executive.core.outcome import failure, success
from executive.core.registry import Registry
from executive.core.skill import In, Port, Skill, SkillRun
from executive.engine.loading.loader import load_program
from executive.engine.nodes.builder import build


class Colour(StrEnum):
    RED = "red"
    GREEN = "green"


@dataclass(frozen=True, slots=True)
class Part:
    """A part on a toy table."""

    kind: ClassVar[str] = "part"
    mass_kg: float
    colour: Colour
    holes: tuple[int, ...] = ()


class Journal:
    """A device that notes what skills did."""

    def __init__(self):
        self.lines = []

    def note(self, line):
        self.lines.append(line)


class Find(Skill):
    """Find a part."""

    OUT: ClassVar = {"part": Port(Part, "what was found"), "distance": Port(float, unit="m")}

    def run(self) -> SkillRun:
        return success(part=Part(0.5, Colour.RED, (1, 2)), distance=2.0)
        yield


class Weigh(Skill):
    """Weigh a part."""

    OUT: ClassVar = {"mass": Port(float, unit="kg")}

    def run(self, part: Part, factor: Annotated[float, In("scale", unit="m")] = 1.0) -> SkillRun:
        return success(mass=part.mass_kg * factor)
        yield


class Work(Skill):
    """Answer after some ticks, and note start, end and stop."""

    OUT: ClassVar = {"label": Port(str)}
    REASONS: ClassVar = frozenset({"work.failed"})
    ACTS = True

    def __init__(self, journal: Journal) -> None:
        self._journal = journal
        self._label = ""

    def run(self, label: str, ticks: int = 1, fails: int = 0, raises: bool = False) -> SkillRun:
        self._label = label
        self._journal.note(f"{label} starts")
        for _ in range(ticks - 1):
            yield
        if raises:
            raise RuntimeError("broken")
        self._journal.note(f"{label} ends")
        earlier = sum(line == f"{label} starts" for line in self._journal.lines) - 1
        return failure("work.failed", label) if earlier < fails else success(label=label)

    def stop(self) -> None:
        self._journal.note(f"{self._label} stops")


class Grab(Work):
    """Work with the one arm that there is."""

    CLAIMS = frozenset({"arm"})


class Liar(Skill):
    """Give something else than it declares."""

    OUT: ClassVar = {"mass": Port(float)}

    def run(self) -> SkillRun:
        return success(mass="heavy")
        yield


class Sort(Skill):
    """Take one of everything."""

    def run(
        self,
        colour: Colour = Colour.RED,
        parts: tuple[Part, ...] = (),
        limit: float | None = None,
    ) -> SkillRun:
        assert isinstance(colour, Colour)
        assert limit is None or isinstance(limit, float)
        return success()
        yield


def toy_skills():
    """Return the toy skills."""
    registry = Registry("skill")
    for skill in (Find, Weigh, Work, Grab, Liar, Sort):
        registry.add(skill.__name__.lower(), skill)
    return registry


def toy_types():
    """Return the toy types."""
    registry = Registry("port type")
    registry.add("Part", Part)
    registry.add("Colour", Colour)
    return registry


class Bench:
    """A folder of trees that are written, checked, built and ticked by a test."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.clock = ManualClock()
        self.journal = Journal()
        self.tree = None

    def write(self, name, text):
        """Write a file of trees."""
        (self.folder / f"{name}.yaml").write_text(dedent(text))
        return self.folder / f"{name}.yaml"

    def write_root(self, root, ports="", name="t"):
        """Write a tree from its root node alone."""
        body = indent(dedent(root).strip(), "  ")
        return self.write(
            name, f"format: 1\ntree: {name}\n{dedent(ports).strip()}\nroot:\n{body}\n"
        )

    def load(self, root, ports="", name="t"):
        """Load a tree from its root node."""
        file = self.write_root(root, ports, name)
        return load_program(file, skills=toy_skills(), types=toy_types())

    def faults(self, root, ports=""):
        """Return the faults of a tree, without the name of the file."""
        try:
            self.load(root, ports)
        except DocumentError as error:
            return [f"{fault.node}: {fault.message}" for fault in error.faults]
        return []

    def build(self, root, ports="", **inputs):
        """Build a tree from its root node."""
        program = self.load(root, ports)
        devices = {"journal": self.journal}
        self.tree = build(program, devices=devices, clock=self.clock, inputs=inputs)
        return self.tree

    def tick(self, count=1, period_s=0.1):
        """Tick the tree some times and return its status after each."""
        statuses = []
        for _ in range(count):
            self.tree.root.tick_once()
            statuses.append(self.tree.root.status.value)
            self.clock.sleep_until(self.clock.now_s() + period_s)
        return statuses

    def run(self, root, ports="", limit=100, **inputs):
        """Tick a tree until it answers; return the answer and what its skills noted."""
        self.build(root, ports, **inputs)
        for _ in range(limit):
            status = self.tick()[0]
            if status != "RUNNING":
                return status, self.journal.lines
        return "RUNNING", self.journal.lines
