"""The JSON schema of the documents, for editors; made from the models.

`python -m executive.engine.schema` writes it anew after a change of the language.
"""

import json
import sys
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter

from executive.engine.document import BLOCKS, BlockBody, Document
from executive.engine.library import packaged_trees

SCHEMA_FILE = Path("schema") / "tree.schema.json"


def make_schema() -> dict[str, Any]:
    """Return the JSON schema of trees, missions and cells."""
    schema = TypeAdapter(Document).json_schema(by_alias=True)
    schema["$defs"]["Node"] = _with_plain_lists(schema["$defs"]["Node"])
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Cellwright trees, missions and cells",
        **_without_titles(schema),
    }


def schema_text() -> str:
    """Return the schema as it stands in its file."""
    return json.dumps(make_schema(), indent=2, sort_keys=True) + "\n"


def _with_plain_lists(node: dict[str, Any]) -> dict[str, Any]:
    """Let a list stand for a block with children and nothing else to say."""
    plain = {"type": "array", "items": {"$ref": "#/$defs/Node"}, "minItems": 1}
    kinds = [dict(kind) for kind in node["oneOf"]]
    for kind in kinds:
        for name, body in kind.get("properties", {}).items():
            if issubclass(BLOCKS[name], BlockBody):
                kind["properties"] = {name: {"anyOf": [body, plain]}}
    return {"oneOf": kinds}


def _without_titles(part: Any) -> Any:
    """Drop the titles that only repeat the names of the keys."""
    if isinstance(part, dict):
        titled = isinstance(part.get("title"), str)
        return {
            key: _without_titles(value)
            for key, value in part.items()
            if not (titled and key == "title")
        }
    return [_without_titles(item) for item in part] if isinstance(part, list) else part


if __name__ == "__main__":
    file = packaged_trees() / SCHEMA_FILE
    file.parent.mkdir(exist_ok=True)
    file.write_text(schema_text(), encoding="utf-8")
    sys.stdout.write(f"{file}\n")
