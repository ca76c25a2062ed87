"""The YAML documents as pydantic models: trees, missions, cells and the nodes of a tree.

A model says what may stand where; what only shows with the skills and subtrees at hand
(ports, wiring, names) is for `executive.engine.checks`. The JSON schema that editors use is
generated from these models.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    StringConstraints,
    WithJsonSchema,
)
from pydantic_core import PydanticCustomError, core_schema

Name = Annotated[str, StringConstraints(strict=True, pattern=r"^[a-z][a-z0-9_]*$")]
Text = Annotated[str, Field(strict=True)]
Reference = Annotated[str, StringConstraints(strict=True, pattern=r"^\$[a-z][a-z0-9_]*$")]
ReasonCode = Annotated[
    str, StringConstraints(strict=True, pattern=r"^[a-z][a-z0-9_]*(\.[a-z][a-z0-9_]*)*$")
]
Count = Annotated[int, Field(strict=True, ge=1)]
Seconds = Annotated[float, Field(strict=True, gt=0.0, allow_inf_nan=False)]
Delay = Annotated[float, Field(strict=True, ge=0.0, allow_inf_nan=False)]
Formula = Annotated[str, StringConstraints(strict=True, pattern=r"^\$[^$]")]
"""An expression behind a `$`, worked out when the node starts."""
Code = Annotated[str, StringConstraints(strict=True, pattern=r"^[a-z][a-z0-9_]*([.][a-z0-9_]+)*$")]


def _as_text(value: object) -> object:
    """Write YAML's true, false and numbers as the expressions that they also are."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, (int, float)) else value


ExpressionText = Annotated[
    str,
    BeforeValidator(_as_text),
    Field(strict=True, min_length=1),
    WithJsonSchema({"type": ["string", "boolean", "number"]}),
]
Assignments = Annotated[dict[Name, ExpressionText], Field(min_length=1)]


class Model(BaseModel):
    """Base of everything that is read from a file."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", hide_input_in_errors=True, defer_build=True
    )


class NodeModel(Model):
    """What every node may say about itself."""

    kind: ClassVar[str]

    name: Name | None = Field(None, description="Name in paths; the kind or skill otherwise.")
    about: Text = Field("", description="One line for people.")
    checkpoint: Annotated[bool, Field(strict=True)] = Field(
        False,
        description="Before it starts nothing is held and nothing moves: a mission that was "
        "killed may go on from here.",
    )
    if_: ExpressionText | None = Field(
        None, alias="if", description="Asked once before it starts; when false, the node fails."
    )
    unless: ExpressionText | None = Field(
        None, description="Asked once before it starts; when true, the node succeeds."
    )
    while_: ExpressionText | None = Field(
        None, alias="while", description="Asked every tick; when false, it is halted and fails."
    )
    on_start: Assignments | None = Field(None, description="Keys to set when it starts.")
    on_success: Assignments | None = Field(None, description="Keys to set when it succeeds.")
    on_failure: Assignments | None = Field(None, description="Keys to set when it fails.")
    on_halt: Assignments | None = Field(None, description="Keys to set when it is halted.")
    finally_: Assignments | None = Field(
        None, alias="finally", description="Keys to set however it ends, after the others."
    )

    @property
    def guards(self) -> dict[str, str]:
        """Conditions around the node, by keyword."""
        texts = {"if": self.if_, "unless": self.unless, "while": self.while_}
        return {keyword: text for keyword, text in texts.items() if text is not None}

    @property
    def endings(self) -> dict[str, dict[str, str]]:
        """Assignments when the node starts and ends, by keyword."""
        given = {
            "on_start": self.on_start,
            "on_success": self.on_success,
            "on_failure": self.on_failure,
            "on_halt": self.on_halt,
            "finally": self.finally_,
        }
        return {keyword: texts for keyword, texts in given.items() if texts}


class SkillNode(NodeModel):
    """Run a skill."""

    kind = "skill"

    skill: Name = Field(description="Name of the skill; `cellwright skills` lists them.")
    in_: dict[Name, Any] = Field(
        default_factory=dict, alias="in", description="Inputs: literals, `$key` or `$expression`."
    )
    out: dict[Name, Reference] = Field(
        default_factory=dict, description="Keys that its outputs are written to, as `$key`."
    )
    budget_s: Seconds | None = Field(
        None, description="How long a step may take [s]; a longer one is recorded."
    )


class SubtreeNode(NodeModel):
    """Run another tree, which sees only the ports that it declares."""

    kind = "subtree"

    subtree: Name = Field(description="Name of the tree; its file has the same name.")
    in_: dict[Name, Any] = Field(
        default_factory=dict, alias="in", description="Inputs: literals, `$key` or `$expression`."
    )
    out: dict[Name, Reference] = Field(
        default_factory=dict, description="Keys that its outputs are written to, as `$key`."
    )


class WhenNode(NodeModel):
    """Succeed when an expression is true, fail when it is false."""

    kind = "when"

    when: ExpressionText


class SetNode(NodeModel):
    """Set keys of the blackboard to the values of expressions."""

    kind = "set"

    set: Assignments


class UnsetNode(NodeModel):
    """Take the values of keys away, so that they have none."""

    kind = "unset"

    unset: Name | Annotated[tuple[Name, ...], Field(min_length=1)]

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys."""
        return (self.unset,) if isinstance(self.unset, str) else self.unset


class WaitNode(NodeModel):
    """Run for a while on the cell's clock, then succeed."""

    kind = "wait"

    wait: Delay | Literal["forever"] | Formula = Field(
        description="Seconds on the cell's clock, an expression, or forever."
    )


class WaitForNode(NodeModel):
    """Run until an expression is true, then succeed."""

    kind = "wait_for"

    wait_for: ExpressionText


class FailNode(NodeModel):
    """Fail with a reason."""

    kind = "fail"

    fail: Code = Field(description="Code of the reason, such as part.missing.")
    text: Text = Field("", description="The reason for people.")


class ChanceNode(NodeModel):
    """Succeed with a probability, else fail; the seed of the run decides."""

    kind = "chance"

    chance: Annotated[float, Field(strict=True, ge=0.0, le=1.0)] | Formula = Field(
        description="Probability of success, 0 to 1."
    )


class BlockBody(NodeModel):
    """What stands inside a node with children."""

    children: Annotated[tuple["Node", ...], Field(min_length=1)]


class DecoratorBody(NodeModel):
    """What stands inside a node with one child."""

    child: "Node"


class SequenceBody(BlockBody):
    """Children in order until one fails; goes on where it was."""

    kind = "sequence"
    memory: Literal[True] = Field(True, description="A sequence goes on where it was.")


class ReactiveSequenceBody(BlockBody):
    """Children in order until one fails; begins with the first in every tick."""

    kind = "reactive_sequence"
    memory: Literal[False] = Field(False, description="It begins with the first in every tick.")


class SelectorBody(BlockBody):
    """Children in order until one succeeds; goes on where it was."""

    kind = "selector"
    memory: Literal[True] = Field(True, description="A selector goes on where it was.")


class ReactiveSelectorBody(BlockBody):
    """Children in order until one succeeds; begins with the first in every tick."""

    kind = "reactive_selector"
    memory: Literal[False] = Field(False, description="It begins with the first in every tick.")


class IfThenElseBody(BlockBody):
    """The second child if the first succeeds, else the third; decided once."""

    kind = "if_then_else"
    children: Annotated[tuple["Node", ...], Field(min_length=2, max_length=3)]


class WhileDoElseBody(BlockBody):
    """The second child while the first succeeds, else the third; asked in every tick."""

    kind = "while_do_else"
    children: Annotated[tuple["Node", ...], Field(min_length=2, max_length=3)]


class CasesBody(NodeModel):
    """What stands inside a node that picks one of its cases."""

    on: ExpressionText = Field(description="What is compared with the cases.")
    cases: Annotated[dict[Text, "Node"], Field(min_length=1)] = Field(
        description="A node for each value, as text."
    )
    default: Annotated["Node | None", Field(description="When no case fits; else it fails.")] = None


class SwitchBody(CasesBody):
    """The case that fits a value; picked once."""

    kind = "switch"


class ReactiveSwitchBody(CasesBody):
    """The case that fits a value; picked anew in every tick."""

    kind = "reactive_switch"


class ParallelBody(BlockBody):
    """All children in every tick, until enough have succeeded or failed."""

    kind = "parallel"
    succeed: Literal["all", "any"] | Count | tuple[Name, ...] = Field(
        "all", description="How many children must succeed: all, any, a count, or these by name."
    )
    fail: Literal["any", "all"] | Count | None = Field(
        None,
        description="How many failures make it fail: any, a count, or all; "
        "as soon as it cannot succeed without it.",
    )
    on_done: Literal["stop", "wait"] = Field(
        "stop", description="When it is decided: stop the children that run, or wait for them."
    )


class RetryBody(DecoratorBody):
    """Run the child again when it fails, one attempt a tick at most."""

    kind = "retry"
    times: Count | Literal["forever"] | Formula = Field(description="Attempts in all.")
    delay_s: Delay | Formula = Field(0.0, description="Pause after a failure [s].")
    backoff: Annotated[float, Field(strict=True, ge=1.0, allow_inf_nan=False)] = Field(
        1.0, description="Factor by which the pause grows with every failure."
    )


class RepeatBody(DecoratorBody):
    """Run the child again when it succeeds, one round a tick at most."""

    kind = "repeat"
    times: Count | Literal["forever"] | Formula = Field(description="Successes that are needed.")
    delay_s: Delay | Formula = Field(0.0, description="Pause after a success [s].")


class TimeoutBody(DecoratorBody):
    """Halt the child and fail when it takes too long."""

    kind = "timeout"
    seconds: Seconds | Formula = Field(description="On the cell's clock [s].")


class CooldownBody(DecoratorBody):
    """Fail without starting the child for a while after it has finished."""

    kind = "cooldown"
    seconds: Seconds | Formula = Field(description="On the cell's clock [s].")


class ForEachBody(DecoratorBody):
    """Run the child once for each item of a list, until it fails."""

    kind = "for_each"
    item: Reference = Field(description="Key that holds the item, as `$key`.")
    in_: Any = Field(alias="in", description="The list: `$key`, `$expression` or a literal list.")


class RunOnceBody(DecoratorBody):
    """Run the child until it has finished once, then answer the same."""

    kind = "run_once"
    until: Literal["finished", "success"] = Field(
        "finished", description="Which answer is kept: any, or only a success."
    )


class InverterBody(DecoratorBody):
    """Succeed when the child fails, fail when it succeeds."""

    kind = "inverter"


class ForceSuccessBody(DecoratorBody):
    """Succeed whatever the child answers when it has finished."""

    kind = "force_success"


class ForceFailureBody(DecoratorBody):
    """Fail whatever the child answers when it has finished."""

    kind = "force_failure"


class RunningIsSuccessBody(DecoratorBody):
    """Succeed while the child runs; it goes on in the next tick."""

    kind = "running_is_success"


class RunningIsFailureBody(DecoratorBody):
    """Fail while the child runs; it goes on in the next tick."""

    kind = "running_is_failure"


class ObserveBody(DecoratorBody):
    """Answer what the child answers, and note that in keys."""

    kind = "observe"
    status: Reference | None = Field(None, description="Key for the child's status.")
    counts: Reference | None = Field(None, description="Key for how often it did what.")


LEAVES: dict[str, type[NodeModel]] = {
    model.kind: model
    for model in (
        *(SkillNode, SubtreeNode, WhenNode, SetNode, UnsetNode),
        *(WaitNode, WaitForNode, FailNode, ChanceNode),
    )
}
BLOCKS: dict[str, type[NodeModel]] = {
    model.kind: model
    for model in (
        *(SequenceBody, ReactiveSequenceBody, SelectorBody, ReactiveSelectorBody, ParallelBody),
        *(IfThenElseBody, WhileDoElseBody, SwitchBody, ReactiveSwitchBody),
        *(RetryBody, RepeatBody, TimeoutBody, CooldownBody, ForEachBody, RunOnceBody),
        *(InverterBody, ForceSuccessBody, ForceFailureBody),
        *(RunningIsSuccessBody, RunningIsFailureBody, ObserveBody),
    )
}
KINDS = (*LEAVES, *BLOCKS)


def kind_of(value: object) -> str | None:
    """Return the kind of a node as it stands in a file, None unless it has exactly one."""
    kinds = [key for key in value if key in KINDS] if isinstance(value, Mapping) else []
    return kinds[0] if len(kinds) == 1 else None


if TYPE_CHECKING:
    Node = NodeModel
else:

    class Node:
        """Any node; read by the model of its kind alone.

        So a fault speaks of that kind only, and pydantic builds no kind that no file uses:
        building all of them takes longer than checking a tree.
        """

        @classmethod
        def __get_pydantic_core_schema__(
            cls, source: Any, handler: GetCoreSchemaHandler
        ) -> core_schema.CoreSchema:
            return core_schema.no_info_plain_validator_function(_read_node)

        @classmethod
        def __get_pydantic_json_schema__(
            cls, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
        ) -> dict[str, Any]:
            return dict(NODE_SCHEMA)


NODE_SCHEMA: Mapping[str, str] = MappingProxyType({"$comment": "any node"})
"""Stands for a node in JSON schemas of single models; `executive.engine.schema` fills it in."""


def _read_node(value: object) -> NodeModel:
    """Return a node; what pydantic says of it has its own place in front."""
    kind = kind_of(value)
    if kind is None or not isinstance(value, Mapping):
        raise PydanticCustomError("no_node", "expected a node")
    if kind in LEAVES:
        return LEAVES[kind].model_validate(value)
    return BLOCKS[kind].model_validate(_under(kind, value))


def _under(kind: str, value: Mapping[str, Any]) -> Any:
    """Return what stands under the kind of a node; a plain list there is that of its children."""
    beside = [key for key in value if key != kind]
    if beside:
        raise PydanticCustomError(
            "beside",
            "{key} stands beside {kind}; try it under {kind}",
            {"key": repr(beside[0]), "kind": repr(kind)},
        )
    body = value[kind]
    return {"children": body} if isinstance(body, list) else body


class OutPort(Model):
    """An output that a tree declares."""

    type: Text = Field(description="Type name, `list[NAME]` or `NAME | None`.")
    unit: Text = Field("", description="SI unit such as m, rad or m/s.")
    about: Text = Field("", description="One line for people.")


class InPort(OutPort):
    """An input that a tree declares."""

    default: Any = Field(None, description="Value when it is not given; required without one.")

    @property
    def has_default(self) -> bool:
        """Whether a default is written, be it null."""
        return "default" in self.model_fields_set


Kept = Annotated[
    dict[Name, Any],
    Field(description="Keys that keep their values when the tree starts anew, with first values."),
]


class TreeDocument(Model):
    """A tree that missions and other trees use as a subtree."""

    format: Literal[1]
    tree: Name = Field(description="Its name, which is also the name of its file.")
    about: Text = ""
    uses: tuple[Name, ...] = Field((), description="Stubs that it may run as skills, by name.")
    in_: dict[Name, InPort] = Field(default_factory=dict, alias="in")
    out: dict[Name, OutPort] = Field(default_factory=dict)
    keep: Kept = Field(default_factory=dict)
    root: Node

    @property
    def name(self) -> str:
        """Name of the tree."""
        return self.tree


class MissionDocument(Model):
    """A tree with the cell that it runs on, what is set up there, and limits."""

    format: Literal[1]
    mission: Name = Field(description="Its name, which is also the name of its file.")
    about: Text = ""
    cell: Name = Field(description="Name of the cell that it runs on.")
    uses: tuple[Name, ...] = Field((), description="Stubs that it may run as skills, by name.")
    scenario: dict[str, Any] = Field(
        default_factory=dict, description="What is set up in the cell; its world checks it."
    )
    timeout_s: Seconds | None = Field(None, description="Limit on the cell's clock [s].")
    tick_hz: Annotated[float, Field(strict=True, gt=0.0, le=1000.0)] = 10.0
    on_error: Literal["end", "fail"] = Field(
        "end", description="What a node that raises does: end the mission, or fail."
    )
    in_: dict[Name, InPort] = Field(default_factory=dict, alias="in")
    out: dict[Name, OutPort] = Field(default_factory=dict)
    keep: Kept = Field(default_factory=dict)
    root: Node

    @property
    def name(self) -> str:
        """Name of the mission."""
        return self.mission


class CellDocument(Model):
    """A cell: the world behind it and how that is configured."""

    format: Literal[1]
    cell: Name = Field(description="Its name, which is also the name of its file.")
    about: Text = ""
    world: Name = Field(description="Name of the world, simulated or real.")
    config: dict[str, Any] = Field(
        default_factory=dict, description="Configuration of the world, which checks it."
    )
    work: Literal["inline", "beside"] = Field(
        "inline",
        description="Where skills have long work done: inline, in the tick that asks, so that the "
        "same seed gives the same run; or beside the ticks, in threads and processes.",
    )

    @property
    def name(self) -> str:
        """Name of the cell."""
        return self.cell


class StubOutcome(Model):
    """What a stub answers in one activation."""

    ticks: Count = Field(1, description="Tick in which it answers; it runs until then.")
    outcome: Literal["success", "failure"]
    out: dict[Name, Any] = Field(default_factory=dict, description="Its outputs on a success.")
    reason: ReasonCode | None = Field(None, description="Code of a failure.")


class StubSkill(Model):
    """A skill that is declared and scripted, not written."""

    about: Text = ""
    acts: bool = Field(False, strict=True, description="Whether the real one moves something.")
    in_: dict[Name, InPort] = Field(default_factory=dict, alias="in")
    out: dict[Name, OutPort] = Field(default_factory=dict)
    stands_for: Text = Field("", description="Name of the node in the language it came from.")
    outcomes: tuple[StubOutcome, ...] = Field(
        (), description="One an activation of a node; succeeds at once without any."
    )
    after: Literal["last", "first"] = Field(
        "last", description="After the last outcome: the last again, or from the first on."
    )


class StubsDocument(Model):
    """Skills that are declared and scripted, for trees whose skills are not at hand."""

    format: Literal[1]
    stubs: Name = Field(description="Its name, which is also the name of its file.")
    about: Text = ""
    skills: Annotated[dict[Name, StubSkill], Field(min_length=1)]

    @property
    def name(self) -> str:
        """Name of the stubs."""
        return self.stubs


Document = TreeDocument | MissionDocument | CellDocument | StubsDocument
DOCUMENTS: Mapping[str, type[Document]] = {
    "tree": TreeDocument,
    "mission": MissionDocument,
    "cell": CellDocument,
    "stubs": StubsDocument,
}
