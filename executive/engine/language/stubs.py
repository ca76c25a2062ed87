"""Stubs: skills that a document declares and scripts, so that trees run without the real ones.

Every node that runs a stub has a script of its own: its first activation takes the first
outcome, the second one the second, and so on. Nothing in it is by chance, so a run with stubs
goes the same way every time.
"""

import inspect
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Protocol

from executive.core.errors import Fault, InputError
from executive.core.outcome import failure, success
from executive.core.registry import Registry, closest
from executive.core.skill import REQUIRED, In, Port, Skill, SkillRun
from executive.engine.language.document import (
    InPort,
    OutPort,
    StubOutcome,
    StubsDocument,
    StubSkill,
)
from executive.engine.language.fitting import fit
from executive.engine.language.outline import TreeSpec
from executive.engine.language.porttypes import parse_type
from executive.engine.language.sources import Source

FAILED = "stub.failed"
"""Reason of a scripted failure that names none."""


_AT_ONCE = StubOutcome.model_validate({"outcome": "success"})


@dataclass(frozen=True, slots=True)
class _Step:
    ticks: int
    outputs: Mapping[str, object] | None
    reason: str = FAILED


class ScriptedSkill(Skill):
    """A skill that answers what its document says, activation by activation."""

    SCRIPT: ClassVar[tuple[_Step, ...]] = ()
    AFTER: ClassVar[Literal["last", "first"]] = "last"
    STANDS_FOR: ClassVar[str] = ""
    INPUTS: ClassVar[Mapping[str, Port]] = {}

    _activations = 0

    def follow(self) -> SkillRun:
        """Run until the tick of the outcome whose turn it is, and answer it."""
        step = self.SCRIPT[self._turn()]
        self._activations += 1
        for _ in range(step.ticks - 1):
            yield
        if step.outputs is None:
            return failure(step.reason, "as its stub says")
        return success(**step.outputs)

    def _turn(self) -> int:
        count = len(self.SCRIPT)
        if self.AFTER == "first":
            return self._activations % count
        return min(self._activations, count - 1)


def stub_skills(
    document: StubsDocument, source: Source, types: Registry[type]
) -> tuple[dict[str, type[Skill]], list[Fault]]:
    """Return the skills of a document by name, and what is wrong with their ports and scripts.

    Args:
        document: The stubs.
        source: Where they stand.
        types: Types that ports may have, by name.
    """
    skills: dict[str, type[Skill]] = {}
    faults: list[Fault] = []
    for name, stub in document.skills.items():
        skills[name] = _Maker(name, stub, source, types, faults).skill()
    return skills, faults


class _Maker:
    """Makes one scripted skill."""

    def __init__(
        self,
        name: str,
        stub: StubSkill,
        source: Source,
        types: Registry[type],
        faults: list[Fault],
    ) -> None:
        self._name, self._stub, self._source = name, stub, source
        self._types, self._faults = types, faults

    def skill(self) -> type[Skill]:
        stub = self._stub
        inputs = self._ports("in", stub.in_)
        outputs = self._ports("out", stub.out)
        for name in inputs.keys() & outputs.keys():
            self._complain(f"{name!r} is an input and an output; try a second name", "out", name)
        outcomes: Sequence[StubOutcome] = stub.outcomes or (_AT_ONCE,)
        script = tuple(self._step(i, each, outputs) for i, each in enumerate(outcomes))
        namespace = {
            "__doc__": stub.about,
            "ACTS": stub.acts,
            "AFTER": stub.after,
            "INPUTS": inputs,
            "OUT": outputs,
            # The real one may fail, whatever the script says today.
            "REASONS": frozenset({FAILED, *(step.reason for step in script)}),
            "SCRIPT": script,
            "STANDS_FOR": stub.stands_for,
            "run": _runner(inputs),
        }
        return type(self._name, (ScriptedSkill,), namespace)

    def _ports(self, key: str, declared: Mapping[str, OutPort]) -> dict[str, Port]:
        return {name: self._port(port, key, name) for name, port in declared.items()}

    def _port(self, port: OutPort, key: str, name: str) -> Port:
        kind: Any = Any
        default: object = REQUIRED
        where: tuple[str, ...] = (key, name, "type")
        try:
            kind = parse_type(port.type, self._types)
            if isinstance(port, InPort) and port.has_default:
                where = (key, name, "default")
                default = fit(port.default, kind)
        except (InputError, ValueError) as error:
            self._complain(f"{key}/{name}: {error}", *where)
        return Port(kind, port.about, port.unit, default)

    def _step(self, index: int, outcome: StubOutcome, ports: Mapping[str, Port]) -> _Step:
        at = ("outcomes", index) if self._stub.outcomes else ()
        if outcome.outcome == "failure":
            if outcome.out:
                self._complain("a failure has no outputs; try outcome: success", *at, "out")
            return _Step(outcome.ticks, None, outcome.reason or FAILED)
        if outcome.reason is not None:
            self._complain("a success has no reason; try outcome: failure", *at, "reason")
        for name in outcome.out:
            if name not in ports:
                message = f"{self._name} has no output {name!r}; {closest(name, [*ports])}"
                self._complain(message, *at, "out", name)
        outputs = {name: self._value(name, port, outcome, at) for name, port in ports.items()}
        return _Step(outcome.ticks, outputs)

    def _value(
        self, name: str, port: Port, outcome: StubOutcome, at: tuple[str | int, ...]
    ) -> object:
        if name not in outcome.out:
            self._complain(f"a success gives every output; {name!r} is missing", *at)
            return None
        try:
            return fit(outcome.out[name], port.type)
        except ValueError as error:
            self._complain(f"output {name!r}: {error}", *at, "out", name)
            return None

    def _complain(self, message: str, *at: str | int) -> None:
        line, column = self._source.value_mark(("skills", self._name, *at))
        self._faults.append(Fault(self._source.file, line, column, self._name, message))


def _runner(ports: Mapping[str, Port]) -> Any:
    """Return a `run` with the signature that the ports call for."""

    def run(self: ScriptedSkill, **_: object) -> SkillRun:
        return self.follow()

    run.__annotations__ = {
        name: Annotated[port.type, In(port.about, port.unit)] for name, port in ports.items()
    }
    empty, keyword = inspect.Parameter.empty, inspect.Parameter.KEYWORD_ONLY
    parameters = [
        inspect.Parameter(name, keyword, default=empty if port.required else port.default)
        for name, port in ports.items()
    ]
    this = inspect.Parameter("self", inspect.Parameter.POSITIONAL_OR_KEYWORD)
    run.__signature__ = inspect.Signature([this, *parameters])  # type: ignore[attr-defined]  # as inspect reads it
    return run


class StubsLibrary(Protocol):
    """Where stubs are found by name."""

    def find(self, name: str, kind: str) -> Path:
        """Return the file of a document; InputError where there is none."""
        ...

    def stubs(self, file: Path) -> Mapping[str, type[Skill]]:
        """Return the scripted skills in a file; InputError where it holds something else."""
        ...


class Skillset:
    """The skills at hand, and with them the stubs that each tree says it uses.

    Attributes:
        used: The skills at hand and all stubs that were asked for so far.
    """

    def __init__(self, skills: Registry[type[Skill]]) -> None:
        """Know the skills that are written."""
        self._written = skills
        self._origins: dict[str, str] = {}
        self.used = skills

    def of(
        self, tree: TreeSpec, library: StubsLibrary, faults: list[Fault]
    ) -> Registry[type[Skill]]:
        """Return the skills that the nodes of a tree may run.

        Args:
            tree: The tree.
            library: Where its stubs are found.
            faults: What is wrong with the stubs that it names is added here.
        """
        own: dict[str, type[Skill]] = {}
        for i, name in enumerate(tree.document.uses):
            try:
                found = library.stubs(library.find(name, "stubs"))
                self._claim(name, found)
                own.update(found)
            except InputError as error:
                line, column = tree.source.value_mark(("uses", i))
                faults.append(Fault(tree.source.file, line, column, "", f"uses: {error}"))
        self.used = _joined(self.used, own)
        return _joined(self._written, own)

    def _claim(self, stubs: str, found: Mapping[str, type[Skill]]) -> None:
        for skill in found:
            origin = self._origins.setdefault(skill, stubs)
            if skill in self._written or origin != stubs:
                other = "a skill at hand" if skill in self._written else f"one of {origin!r}"
                raise InputError(f"stub {skill!r} of {stubs!r} has the name of {other}")


def _joined(
    registry: Registry[type[Skill]], more: Mapping[str, type[Skill]]
) -> Registry[type[Skill]]:
    if not more:
        return registry
    joined: Registry[type[Skill]] = Registry(registry.kind)
    for name in registry:
        joined.add(name, registry.get(name))
    for name, skill in more.items():
        if name not in joined:
            joined.add(name, skill)
    return joined
