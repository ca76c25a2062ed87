"""The YAML documents as pydantic models: trees, missions, cells and stubs.

A model says what may stand where; what only shows with the skills and subtrees at hand
(ports, wiring, names) is for `executive.engine.loading.checks`. The JSON schema that editors use is
generated from these models.
"""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import Field

from executive.engine.language.block_models import Node
from executive.engine.language.fields import Count, Model, Name, ReasonCode, Seconds, Text


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
