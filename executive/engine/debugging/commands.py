"""What a terminal or a page may ask of a running mission, by the name of the command."""

from collections.abc import Callable, Mapping
from typing import Any

from pydantic import BaseModel, ConfigDict, TypeAdapter, ValidationError

from executive.core.errors import InputError
from executive.core.json_files import first_fault
from executive.engine.debugging.debugger import Debugger
from executive.engine.debugging.stepping import Step
from executive.engine.running.control import RunControl
from executive.engine.running.remote import Arguments, Command


class _Asked(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    by: str = "another process"


class _Stride(_Asked):
    step: Step = Step.TICK


class _Text(_Asked):
    text: str


class _Number(_Asked):
    number: int


class _Nodes(_Asked):
    nodes: str


class _Forced(_Nodes):
    answer: str
    once: bool = False


class RunCommands:
    """The commands of one run."""

    def __init__(self, control: RunControl, debugger: Debugger) -> None:
        """Command a run through its control and its debugger."""
        self._control, self._debugger = control, debugger

    def by_name(self) -> Mapping[str, Command]:
        """Return the commands as `CommandServer` takes them; each answers with the state."""
        return {
            "state": self._command(_Asked, lambda _: None),
            "pause": self._command(_Asked, lambda asked: self._control.pause(asked.by)),
            "resume": self._command(_Asked, lambda asked: self._debugger.go_on(asked.by)),
            "step": self._command(_Stride, self._step),
            "stop": self._command(_Asked, lambda asked: self._control.stop(asked.by)),
            "emergency_stop": self._command(
                _Asked, lambda asked: self._control.emergency_stop(asked.by)
            ),
            "break": self._command(_Text, lambda asked: self._debugger.add(asked.text)),
            "unbreak": self._command(_Number, lambda asked: self._debugger.remove(asked.number)),
            "force": self._command(_Forced, self._force),
            "unforce": self._command(
                _Nodes, lambda asked: self._debugger.unforce(asked.nodes, by=asked.by)
            ),
        }

    def state(self) -> dict[str, object]:
        """Return whether the run is paused and where, its breakpoints and forced answers."""
        standing = self._debugger.standing
        return {
            "paused": standing is not None,
            "stopping": self._control.stop_reason,
            "standing": None
            if standing is None
            else TypeAdapter(type(standing)).dump_python(standing),
            "breakpoints": self._debugger.breakpoints(),
            "forced": self._debugger.forced(),
        }

    def _step(self, asked: _Stride) -> None:
        if self._debugger.standing is None:
            raise InputError("the mission is not paused; pause it first")
        self._debugger.step(asked.step, asked.by)

    def _force(self, asked: _Forced) -> None:
        self._debugger.force(asked.nodes, asked.answer, once=asked.once, by=asked.by)

    def _command(self, form: type[_Asked], act: Callable[[Any], object]) -> Command:
        def command(arguments: Arguments) -> object:
            try:
                asked = form.model_validate(arguments)
            except ValidationError as error:
                raise InputError(first_fault(error)) from None
            act(asked)
            return self.state()

        return command
