"""JSON files that are read into models, and what pydantic finds wrong, in words."""

from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from executive.core.errors import InputError

# Of a file with one mistake a row, the first few tell as much as all.
_SHOWN = 3
_LONGEST = 60

Model = TypeVar("Model", bound=BaseModel)


def read_json(path: Path, model: type[Model], what: str) -> Model:
    """Read a file.

    Args:
        path: The file.
        model: What it holds.
        what: The same in words, such as "a campaign".

    Raises:
        InputError: It cannot be read or holds something else; says what, where in the file.
    """
    try:
        return model.model_validate_json(path.read_bytes())
    except OSError as error:
        raise InputError(
            f"{path}: cannot be read; got {error.strerror}; expected a JSON file with {what}"
        ) from None
    except ValidationError as error:
        raise InputError(f"{path}: not {what}: {faults_of(error)}") from None


def faults_of(error: ValidationError) -> str:
    """Return what is wrong, the first few faults of it."""
    return faults_in_words(error.errors(include_url=False))


def faults_in_words(details: Sequence[ErrorDetails]) -> str:
    """Return the first few of pydantic's faults in words."""
    more = len(details) - _SHOWN
    shown = [_in_words(detail) for detail in details[:_SHOWN]]
    return "; ".join(shown + ([f"and {more} more"] if more > 0 else []))


def first_fault(error: ValidationError) -> str:
    """Return the first of what is wrong."""
    return _in_words(error.errors(include_url=False)[0])


def _in_words(detail: ErrorDetails) -> str:
    where = "".join(_step(part) for part in detail["loc"]).removeprefix(".")
    place = f"{where}: " if where else ""
    message = detail["msg"].removeprefix("Value error, ")
    match detail["type"]:
        case "json_invalid":
            return f"{place}no JSON: {message.removeprefix('Invalid JSON: ')}"
        case "missing":
            return f"{where} is missing"
        case "extra_forbidden":
            return f"{place}unknown key"
        case "value_error":
            return f"{place}{message}"
    expected = message.replace("Input should be", "expected", 1)
    got = repr(detail["input"])
    short = got if len(got) <= _LONGEST else f"{got[:_LONGEST]}..."
    return f"{place}{expected}, got {short}"


def _step(part: int | str) -> str:
    return f"[{part}]" if isinstance(part, int) else f".{part}"
