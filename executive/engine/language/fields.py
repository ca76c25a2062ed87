"""What the values of documents may be, and the base of all their models."""

from typing import Annotated

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    StringConstraints,
    WithJsonSchema,
)

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
