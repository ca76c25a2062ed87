"""Rules about the skills that a tree uses."""

from collections.abc import Iterator

from executive.core.skill import Skill
from executive.engine.language.stubs import ScriptedSkill
from executive.engine.lint.findings import Rule, Spot
from executive.engine.lint.subject import Subject


def _no_stop(subject: Subject) -> Iterator[Spot]:
    for node, _ in subject.nodes():
        skill = subject.outcomes.skill(node)
        if skill is None or issubclass(skill, ScriptedSkill):
            continue  # a script moves nothing
        if skill.ACTS and skill.stop is Skill.stop:
            message = f"{skill.__name__} moves something, but does not say how it stops"
            yield Spot(node, f"{message}; override stop()")


NO_STOP = Rule(
    "L301",
    "acting skill without stop",
    "A skill with `ACTS = True` that does not override `stop` leaves the cell moving when it is "
    "halted.",
    _no_stop,
)
