"""The checksum that lies beside a file of weights, in the form of `sha256sum`."""

import hashlib
from pathlib import Path

from executive.core.errors import InputError

_TRY = "try git checkout of both files, or training it anew"


def write_checksum(weights: Path) -> None:
    """Write the checksum of a file of weights beside it."""
    _beside(weights).write_text(f"{_sha256(weights)}  {weights.name}\n", encoding="ascii")


def check_checksum(weights: Path) -> None:
    """Hold a file of weights against the checksum beside it; without one, it is taken as it is.

    Raises:
        InputError: It is not the file that was trained, or cannot be read.
    """
    beside = _beside(weights)
    try:
        expected = beside.read_text(encoding="ascii").partition(" ")[0].strip()
        got = _sha256(weights)
    except FileNotFoundError as error:
        if error.filename == str(beside):
            return
        raise InputError(f"{weights}: is not there; expected weights; {_TRY}") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{weights}: cannot be read with {beside.name}; got {error}") from None
    if got != expected:
        raise InputError(
            f"{weights}: is not the file that was trained; got the SHA-256 {got[:12]}...; expected "
            f"{expected[:12]}..., as {beside.name} says; {_TRY}"
        )


def _beside(weights: Path) -> Path:
    return weights.with_suffix(".sha256")


def _sha256(file: Path) -> str:
    with file.open("rb") as data:
        return hashlib.file_digest(data, "sha256").hexdigest()
