"""The base class of every leaf that an engineer writes.

A skill is a generator: each bare `yield` ends its share of one tick (RUNNING), `return`
gives the outcome. Its inputs are the keyword arguments of `run`, so name, type and default
are written once::

    class DetectEndpoints(Skill):
        \"\"\"Find both ends of the cable in an image.\"\"\"

        OUT = {"endpoints": Port(CableEnds, "ends found")}
        REASONS = frozenset({"endpoints.none"})

        def __init__(self, vision: CableVision) -> None:      # devices, by name and type
            self._vision = vision

        def run(self, image: Annotated[CameraFrame, In("overhead image")]) -> SkillRun:
            ends = self._vision.endpoints(image)
            yield  # the rest in the next tick
            if not ends:
                return failure("endpoints.none")
            return success(endpoints=ends)

Constructor parameters are the devices of the cell, bound by name and checked by type when
the tree is built. Nothing may move before the first step of `run`. What takes longer than a
tick is done beside it (`executive.core.work`). docs/skill_api.md tells all of it.
"""

import inspect
import typing
from abc import ABC, abstractmethod
from collections.abc import Generator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from types import MappingProxyType
from typing import Any, ClassVar, Final

from executive.core.outcome import RUNNING, Outcome, Status

SkillRun = Generator[None, None, Outcome]


class _Required:
    """Marks an input without a default."""

    def __repr__(self) -> str:
        return "REQUIRED"


REQUIRED: Final = _Required()


@dataclass(frozen=True, slots=True)
class In:
    """What the type of an input does not say: goes into `Annotated`.

    Attributes:
        about: One line for the catalogue.
        unit: SI unit such as `m` or `rad`, empty where there is none.
    """

    about: str
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Port:
    """One typed port of a skill or a tree.

    Attributes:
        type: The type of its values.
        about: One line for the catalogue.
        unit: SI unit such as `m` or `rad`, empty where there is none.
        default: Value that is used when it is not wired; `REQUIRED` where it must be.
    """

    type: Any
    about: str = ""
    unit: str = ""
    default: object = REQUIRED

    @property
    def required(self) -> bool:
        """Whether a tree must wire it."""
        return self.default is REQUIRED


class PausePolicy(StrEnum):
    """What a pause of the mission does to a skill that runs.

    HOLD: `on_pause` is called, and no step until after `on_resume`.
    FINISH: it goes on being stepped, alone, until it has ended; the tree hears of it later.
    STOP: it is halted, and begins anew with its inputs after the pause.
    """

    HOLD = "hold"
    FINISH = "finish"
    STOP = "stop"


class Skill(ABC):
    """One thing that a cell can do, looked up by name from a tree.

    Attributes:
        OUT: Output ports by name; `success(name=value)` must give each of them.
        REASONS: Every code that `failure` may carry.
        ACTS: Whether it moves something in the cell; run reports list it under actions.
        REPEATABLE: Whether a tree may run it again after it has ended; `cellwright lint` holds
            loops to it.
        CLAIMS: What no other node may use while it runs, e.g. `left_arm`.
        PAUSE: What a pause of the mission does to it.
        BUDGET_S: How long one step may take on the machine's clock [s]; a longer one is
            recorded. None stands for the time from one tick to the next.
    """

    OUT: ClassVar[Mapping[str, Port]] = MappingProxyType({})
    REASONS: ClassVar[frozenset[str]] = frozenset()
    ACTS: ClassVar[bool] = False
    REPEATABLE: ClassVar[bool] = True
    CLAIMS: ClassVar[frozenset[str]] = frozenset()
    PAUSE: ClassVar[PausePolicy] = PausePolicy.HOLD
    BUDGET_S: ClassVar[float | None] = None

    _generator: SkillRun | None = None

    @abstractmethod
    def run(self, *args: Any, **kwargs: Any) -> SkillRun:
        """Do the work; `yield` ends this tick's share, `return` gives the outcome."""

    def stop(self) -> None:  # noqa: B027 - a skill that moves nothing has nothing to stop
        """Leave the cell safe; called once when a running skill is halted.

        Override it in every skill that moves something, and say in the class docstring what
        it leaves behind.
        """

    def on_pause(self) -> None:  # noqa: B027 - a skill that moves nothing rests already
        """Bring to rest what moves, so that it can be taken up again; for `PausePolicy.HOLD`."""

    def on_resume(self) -> None:  # noqa: B027 - see on_pause
        """Take up what `on_pause` has brought to rest."""

    def resting(self) -> bool:
        """Return whether all that this skill has set in motion rests; asked during a pause."""
        return True

    @typing.final
    @property
    def active(self) -> bool:
        """Whether it has been started and has not ended."""
        return self._generator is not None

    @typing.final
    def start(self, inputs: Mapping[str, object]) -> None:
        """Prepare a new activation with the values of the input ports."""
        self._generator = self.run(**inputs)

    @typing.final
    def step(self) -> Outcome:
        """Do one tick's share of the work.

        Raises:
            TypeError: The skill returned no outcome, or one that it does not declare.
        """
        generator = self._generator
        if generator is None:
            raise TypeError(f"{type(self).__name__}: stepped before it was started")
        try:
            next(generator)
        except StopIteration as end:
            self._generator = None
            return self._checked(end.value)
        return RUNNING

    @typing.final
    def halt(self) -> None:
        """Stop a running activation; does nothing when none runs."""
        if self._generator is None:
            return
        generator, self._generator = self._generator, None
        try:
            generator.close()
        finally:
            self.stop()

    def _checked(self, outcome: object) -> Outcome:
        name = type(self).__name__
        if not isinstance(outcome, Outcome) or outcome.status is Status.RUNNING:
            raise TypeError(
                f"{name}: run() must return success(...) or failure(...); got {outcome!r}"
            )
        if outcome.reason is not None and outcome.reason.code not in self.REASONS:
            raise TypeError(
                f"{name}: failure code {outcome.reason.code!r} is not listed in REASONS "
                f"(known: {', '.join(sorted(self.REASONS)) or 'none'})"
            )
        if outcome.status is Status.SUCCESS and outcome.outputs.keys() != self.OUT.keys():
            raise TypeError(
                f"{name}: success must give {sorted(self.OUT)}; got {sorted(outcome.outputs)}"
            )
        return outcome


def input_ports(skill: type[Skill]) -> dict[str, Port]:
    """Return the input ports of a skill, read from the signature of `run`."""
    hints = typing.get_type_hints(skill.run, include_extras=True)
    ports: dict[str, Port] = {}
    for name, parameter in inspect.signature(skill.run).parameters.items():
        if name == "self":
            continue
        hint = hints[name]
        note = In("")
        if typing.get_origin(hint) is typing.Annotated:
            hint, *extras = typing.get_args(hint)
            note = next((extra for extra in extras if isinstance(extra, In)), note)
        default = REQUIRED if parameter.default is inspect.Parameter.empty else parameter.default
        ports[name] = Port(hint, note.about, note.unit, default)
    return ports


def device_types(skill: type[Skill]) -> dict[str, Any]:
    """Return the devices that a skill's constructor asks for, by name."""
    if skill.__init__ is object.__init__:
        return {}
    hints = typing.get_type_hints(skill.__init__)
    return {name: hint for name, hint in hints.items() if name != "return"}
