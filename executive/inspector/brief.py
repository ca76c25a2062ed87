"""Values of the blackboard in one line."""

import json

MAX_LENGTH = 100
_ITEMS = 4


def brief(value: object) -> str:
    """Return a recorded value, which is JSON, as one line for people."""
    text = _brief(value)
    return text if len(text) <= MAX_LENGTH else text[: MAX_LENGTH - 1] + "…"


def _brief(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, list):
        return f"[{_some(value)}]"
    if isinstance(value, dict):
        return _object(value)
    return json.dumps(value, ensure_ascii=False)


def _object(value: dict[str, object]) -> str:
    kind = value.get("$type")
    if kind is None:
        return "{" + ", ".join(f"{key}: {_brief(item)}" for key, item in value.items()) + "}"
    name = str(kind).rpartition(".")[2]
    if kind in ("image", "ndarray"):
        return _array(name, value)
    if "items" in value and isinstance(value["items"], list):
        brackets = "()" if kind == "tuple" else "{}"
        return f"{brackets[0]}{_some(value['items'])}{brackets[1]}"
    if "name" in value and "value" in value:
        return f"{name}.{value['name']}"
    if "repr" in value:
        return str(value["repr"])
    fields = (f"{key}={_brief(item)}" for key, item in value.items() if key != "$type")
    return f"{name}({', '.join(fields)})"


def _array(name: str, value: dict[str, object]) -> str:
    shape = value.get("shape")
    size = "x".join(str(length) for length in shape) if isinstance(shape, list) else ""
    if name == "image":
        return f"<image {value['image']} {size}>"
    values = value.get("values")
    if values is not None and isinstance(values, list) and len(values) <= _ITEMS:
        return _brief(values)
    return f"<{value['dtype']} {size}>"


def _some(items: list[object]) -> str:
    shown = [_brief(item) for item in items[:_ITEMS]]
    return ", ".join([*shown, f"… {len(items)} in all"] if len(items) > _ITEMS else shown)
