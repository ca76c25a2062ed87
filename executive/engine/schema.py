"""The JSON schema of the documents, for editors; made from the models.

`python -m executive.engine.schema` writes it anew after a change of the language.
"""

import json
import sys
from pathlib import Path
from typing import Any

from pydantic.json_schema import models_json_schema

from executive.engine.language.block_models import BLOCKS, LEAVES, NODE_SCHEMA, BlockBody
from executive.engine.language.document import DOCUMENTS
from executive.engine.language.fields import Model
from executive.engine.language.node_models import NodeModel
from executive.engine.loading.library import packaged_trees

SCHEMA_FILE = Path("schema") / "tree.schema.json"


def make_schema() -> dict[str, Any]:
    """Return the JSON schema of trees, missions and cells."""
    models = [*DOCUMENTS.values(), *LEAVES.values(), *BLOCKS.values()]
    _, schema = models_json_schema([(model, "validation") for model in models], by_alias=True)
    schema["$defs"]["Node"] = _any_node()
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Cellwright trees, missions and cells",
        "anyOf": [_reference(model) for model in DOCUMENTS.values()],
        "$defs": _filled_in(schema["$defs"]),
    }


def schema_text() -> str:
    """Return the schema as it stands in its file."""
    return json.dumps(make_schema(), indent=2, sort_keys=True) + "\n"


def _reference(model: type[Model]) -> dict[str, Any]:
    return {"$ref": f"#/$defs/{model.__name__}"}


def _any_node() -> dict[str, Any]:
    return {
        "oneOf": [
            *(_reference(model) for model in LEAVES.values()),
            *(_block(kind, model) for kind, model in BLOCKS.items()),
        ]
    }


def _block(kind: str, model: type[NodeModel]) -> dict[str, Any]:
    """Return a node whose keys stand under its kind; a list there is that of its children."""
    body = _reference(model)
    if issubclass(model, BlockBody):
        children = {"type": "array", "items": dict(NODE_SCHEMA), "minItems": 1}
        body = {"anyOf": [body, children]}
    return {
        "type": "object",
        "properties": {kind: body},
        "required": [kind],
        "additionalProperties": False,
    }


def _filled_in(part: Any) -> Any:
    """Put in what stands for a node, and drop titles that only repeat the names of the keys."""
    if isinstance(part, dict) and NODE_SCHEMA.items() <= part.items():
        return {"$ref": "#/$defs/Node"}
    if isinstance(part, dict):
        titled = isinstance(part.get("title"), str)
        return {
            key: _filled_in(value) for key, value in part.items() if not (titled and key == "title")
        }
    return [_filled_in(item) for item in part] if isinstance(part, list) else part


if __name__ == "__main__":
    file = packaged_trees() / SCHEMA_FILE
    file.parent.mkdir(exist_ok=True)
    file.write_text(schema_text(), encoding="utf-8")
    sys.stdout.write(f"{file}\n")
