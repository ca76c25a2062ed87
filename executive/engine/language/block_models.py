"""The nodes with children as they stand in YAML, and how any node is read."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import PydanticCustomError, core_schema

from executive.engine.language.fields import (
    Code,
    Count,
    Delay,
    ExpressionText,
    Formula,
    Name,
    Reference,
    Seconds,
    Text,
)
from executive.engine.language.node_models import (
    ChanceNode,
    FailNode,
    NodeModel,
    SetNode,
    SkillNode,
    SubtreeNode,
    UnsetNode,
    WaitForNode,
    WaitNode,
    WhenNode,
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
    gives_up_on: tuple[Code, ...] = Field(
        (), description="Reasons of a failure after which there is no other attempt."
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
