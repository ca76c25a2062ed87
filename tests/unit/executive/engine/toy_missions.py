"""Missions on a toy cell, run by the runner: for what only shows when something runs them."""

from textwrap import dedent, indent
from typing import ClassVar

from toy_language import Journal, toy_skills, toy_types
from toy_runs import Ticks, ToyCell

from executive.core.outcome import failure, success
from executive.core.skill import PausePolicy, Port, Skill, SkillRun
from executive.engine.loading.loader import load_mission
from executive.engine.nodes.builder import build
from executive.engine.recording.messages import PAUSES_TOPIC, PauseMessage
from executive.engine.running.runner import Runner

CELL = """
format: 1
cell: toy_cell
world: toy
"""


class Swing(Skill):
    """Swing for some steps; it needs some looks to come to rest."""

    OUT: ClassVar = {"steps": Port(int)}
    REASONS: ClassVar = frozenset({"swing.failed"})

    def __init__(self, journal: Journal) -> None:
        self._journal = journal
        self._looks = 0

    def run(self, steps: int = 5, coast: int = 0, ending: str = "success") -> SkillRun:
        self._looks = coast
        for step in range(steps):
            self._journal.note(f"{self.PAUSE} {step}")
            yield
        if ending == "raise":
            raise RuntimeError("rope broke")
        return success(steps=steps) if ending == "success" else failure("swing.failed")

    def on_pause(self) -> None:
        self._journal.note(f"{self.PAUSE} pauses")

    def on_resume(self) -> None:
        self._journal.note(f"{self.PAUSE} resumes")

    def resting(self) -> bool:
        self._looks -= 1
        return self._looks < 0

    def stop(self) -> None:
        self._journal.note(f"{self.PAUSE} stops")


class Finish(Swing):
    """Swing to the end, whatever happens."""

    PAUSE = PausePolicy.FINISH


class Restart(Swing):
    """Swing from the start after a pause."""

    PAUSE = PausePolicy.STOP


class Breaks(Skill):
    """Raise, and raise again when it is stopped."""

    def __init__(self, journal: Journal) -> None:
        self._journal = journal

    def run(self, after: int = 0, badly: bool = False) -> SkillRun:
        for _ in range(after):
            yield
        raise SystemExit(3) if badly else ValueError("broken wire")

    def stop(self) -> None:
        self._journal.note("breaks stops")
        raise OSError("valve")


def skills_of_missions():
    """Return the toy skills, and those above."""
    registry = toy_skills()
    for skill in (Swing, Finish, Restart, Breaks):
        registry.add(skill.__name__.lower(), skill)
    return registry


class Rehearsal:
    """One mission on one toy cell, built and ready to run."""

    def __init__(self, folder, root, keys="", **runner):
        self.cell, self.seen, self.journal = ToyCell(), Ticks(), Journal()
        (folder / "toy_cell.yaml").write_text(CELL)
        body = indent(dedent(root).strip(), "  ")
        head = f"format: 1\nmission: m\ncell: toy_cell\n{dedent(keys).strip()}"
        (folder / "m.yaml").write_text(f"{head}\nroot:\n{body}\n")
        mission = load_mission(
            str(folder / "m.yaml"), skills=skills_of_missions(), types=toy_types()
        )
        devices = {"journal": self.journal}
        self.tree = build(mission, devices=devices, clock=self.cell.clock)
        runner.setdefault("observers", (self.seen,))
        self.runner = Runner(self.tree, self.cell, tick_hz=10.0, **runner)

    def run(self):
        """Run it to its end."""
        return self.runner.run()

    @property
    def pauses(self):
        """Pauses as they were told to observers."""
        return [
            PauseMessage.model_validate_json(message.data)
            for message in self.seen.messages
            if message.topic == PAUSES_TOPIC
        ]


class AtTick:
    """An observer that does something after some ticks."""

    def __init__(self, acts):
        self._acts = acts

    def on_tick(self, tick):
        self._acts.get(tick.number, lambda: None)()

    def on_streams(self, messages):
        pass
