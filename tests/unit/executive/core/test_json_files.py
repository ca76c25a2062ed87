"""Files of JSON say what is wrong with them, where, and in words."""

from pathlib import Path

import pytest
from pydantic import BaseModel, ConfigDict

from executive.core.errors import InputError
from executive.core.json_files import read_json


class Line(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    nodes_m: tuple[tuple[float, float], ...]


def test_what_was_written_is_read(tmp_path: Path) -> None:
    path, line = tmp_path / "line.json", Line(nodes_m=((0.0, 1.0), (2.0, 3.0)))
    path.write_text(line.model_dump_json(), encoding="utf-8")
    assert read_json(path, Line, "a line") == line


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "no JSON: EOF while parsing a value at line 1 column 0"),
        (b"\xff\xfe", "no JSON: "),
        (b'{"nodes_m": [[0, 1], [2, "far"]]}', "nodes_m[1][1]: expected a valid number, "),
        (b'{"nodes_m": [[0, 1]], "knot": 1}', "knot: unknown key"),
        (b"{}", "nodes_m is missing"),
        (b'{"nodes_m": [1, 2, 3, 4, 5]}', "; and 2 more"),
    ],
)
def test_what_is_wrong_is_said_without_the_parsers_own_text(
    tmp_path: Path, content: bytes, said: str
) -> None:
    path = tmp_path / "line.json"
    path.write_bytes(content)
    with pytest.raises(InputError) as refused:
        read_json(path, Line, "a line")
    message = str(refused.value)
    assert message.startswith(f"{path}: not a line: ")
    assert said in message
    assert "\n" not in message
    assert "pydantic" not in message


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.json: cannot be read; got No such file"):
        read_json(tmp_path / "none.json", Line, "a line")
