"""What a node may say about itself in YAML, and the nodes without children."""

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from executive.engine.language.fields import (
    Assignments,
    Code,
    Delay,
    ExpressionText,
    Formula,
    Model,
    Name,
    Reference,
    Seconds,
    Text,
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
