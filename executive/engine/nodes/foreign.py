"""Leaves that were written for py_trees 2.6 with typed ports, as skills.

Such a class says its ports as `PortInformation` and keeps its values on py_trees' blackboard,
which is one for the whole process. Here every instance has keys of its own there, and values
cross to and from the blackboard of the tree: inputs when the node starts, outputs when it
succeeds. Types are checked by our rules where the leaf reads and writes: py_trees' own take a
bool for an int, and know neither None nor any generic type but lists.
"""

import inspect
import typing
from typing import Any

from py_trees.behaviour import Behaviour
from py_trees.blackboard import Blackboard
from py_trees.common import Status
from py_trees.ports import NoDataAvailable, PortInformation, PortsMixin

from executive.core.outcome import Outcome, failure, success
from executive.core.skill import REQUIRED, Port, Skill, SkillRun
from executive.engine.language.fitting import check
from executive.engine.language.porttypes import accepts

FAILED = "behaviour.failed"


def skill_from_behaviour(behaviour: type[Behaviour]) -> type[Skill]:
    """Return a skill that does what a py_trees leaf with ports does.

    Parameters of its constructor after `name` become devices. Inputs that it does not require
    are None while they are not wired; outputs that it has not written are None.

    Raises:
        TypeError: The class declares no ports, or has children.
    """
    if not issubclass(behaviour, PortsMixin) or not hasattr(behaviour, "INPUT_PORTS"):
        raise TypeError(f"{behaviour.__name__}: expected a py_trees leaf with ports")
    namespace = {
        "__doc__": inspect.getdoc(behaviour),
        "__init__": _constructor(behaviour),
        "OUT": {name: _port(info) for name, info in behaviour.output_ports().items()},
        "REASONS": frozenset({FAILED}),
        "run": _runner(behaviour),
    }
    return type(behaviour.__name__, (_ForeignSkill,), namespace)


class _ForeignSkill(Skill):
    """Drives one py_trees leaf."""

    _leaf: Any

    def drive(self, inputs: dict[str, object]) -> SkillRun:
        """Tick the leaf until it answers."""
        leaf = self._leaf
        for name, value in inputs.items():
            _put(leaf, name, value)
        for name, info in leaf.output_ports().items():
            _put(leaf, name, info.default_value)
        leaf.status = Status.INVALID
        while True:
            leaf.tick_once()
            if leaf.status is not Status.RUNNING:
                return self._outcome(leaf)
            yield

    def _outcome(self, leaf: Any) -> Outcome:
        if leaf.status is Status.FAILURE:
            return failure(FAILED, leaf.feedback_message)
        if leaf.status is not Status.SUCCESS:
            raise TypeError(f"{type(self).__name__}: update() must return a Status of py_trees")
        return success(**{name: _last_output(leaf, name) for name in self.OUT})

    def stop(self) -> None:
        """Terminate the leaf, which says itself what that leaves behind."""
        self._leaf.stop(Status.INVALID)


def _constructor(behaviour: type[Behaviour]) -> Any:
    def construct(self: Any, **devices: object) -> None:
        self._leaf = behaviour(name=behaviour.__name__, **devices)
        _let_ports_take_any_type(self._leaf)
        self._leaf.setup_ports()

    hints = typing.get_type_hints(behaviour.__init__)
    own = inspect.signature(behaviour).parameters.values()
    kinds = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    devices = [one for one in own if one.name != "name" and one.kind not in kinds]
    devices = [one for one in devices if one.name != "behaviour_class_name"]
    construct.__annotations__ = {one.name: hints.get(one.name, Any) for one in devices}
    keyword = [one.replace(kind=inspect.Parameter.KEYWORD_ONLY) for one in devices]
    _sign(construct, keyword)
    return construct


def _runner(behaviour: type[PortsMixin]) -> Any:
    def run(self: Any, **inputs: object) -> SkillRun:
        return self.drive(inputs)

    ports = {name: _port(info) for name, info in behaviour.input_ports().items()}
    run.__annotations__ = {name: port.type for name, port in ports.items()}
    empty = inspect.Parameter.empty
    keyword = [
        inspect.Parameter(
            name,
            inspect.Parameter.KEYWORD_ONLY,
            default=empty if port.required else port.default,
        )
        for name, port in ports.items()
    ]
    _sign(run, keyword)
    return run


def _sign(function: Any, parameters: list[inspect.Parameter]) -> None:
    this = inspect.Parameter("self", inspect.Parameter.POSITIONAL_OR_KEYWORD)
    function.__signature__ = inspect.Signature([this, *parameters])


def _port(info: PortInformation) -> Port:
    if info.has_default:
        return Port(info.data_type, info.description, default=info.default_value)
    if info.required:
        return Port(info.data_type, info.description, default=REQUIRED)
    return Port(info.data_type | None, info.description, default=None)


def _key(leaf: Any, port: str) -> str:
    """Return where the leaf itself finds a port on py_trees' blackboard."""
    client = leaf.blackboard_client
    return str(client.remappings[client.absolute_name(port)])


def _let_ports_take_any_type(leaf: Any) -> None:
    """Give one leaf our own reading and writing of its ports."""

    def get_input(port_name: str, default: Any = None) -> Any:
        if port_name not in leaf.input_ports() or not Blackboard.exists(_key(leaf, port_name)):
            return type(leaf).get_input(leaf, port_name, default)
        return _checked(leaf, port_name, Blackboard.get(_key(leaf, port_name)))

    def set_output(port_name: str, value: Any) -> None:
        if port_name not in leaf.output_ports():
            raise KeyError(f"{leaf.name}: Output port '{port_name}' not defined.")
        Blackboard.set(_key(leaf, port_name), _checked(leaf, port_name, value))

    def get_last_output(port_name: str) -> Any:
        if port_name not in leaf.output_ports() or not Blackboard.exists(_key(leaf, port_name)):
            return type(leaf).get_last_output(leaf, port_name)
        return Blackboard.get(_key(leaf, port_name))

    leaf.get_input, leaf.get_last_output = get_input, get_last_output
    leaf._set_output = set_output


def _checked(leaf: Any, port: str, value: object) -> object:
    try:
        check(value, leaf.get_port_type(port))
    except ValueError as error:
        raise TypeError(f"{type(leaf).__name__}: port {port!r}: {error}") from None
    return value


def _put(leaf: Any, port: str, value: object) -> None:
    """Set a port, or leave it without data where its type does not know None."""
    key = _key(leaf, port)
    if value is not None or accepts(leaf.get_port_type(port), type(None)):
        Blackboard.set(key, value)
    elif Blackboard.exists(key):
        Blackboard.unset(key)


def _last_output(leaf: Any, port: str) -> object:
    try:
        return leaf.get_last_output(port)
    except NoDataAvailable:
        return None
