"""Holds what was read against the models, and says what is wrong in the words of the file."""

from collections import defaultdict
from collections.abc import Container, Mapping
from functools import lru_cache
from typing import Any, Final

from pydantic import ValidationError

from executive.core.errors import Fault
from executive.core.registry import closest
from executive.engine.language.block_models import BLOCKS, KINDS, LEAVES, kind_of
from executive.engine.language.document import DOCUMENTS, Document, InPort, OutPort
from executive.engine.language.fields import Model
from executive.engine.language.node_models import NodeModel
from executive.engine.language.outline import node_paths, value_at
from executive.engine.language.sources import Source, YamlPath

_EXPECTED: Final[Mapping[str, str]] = {
    "bool_type": "true or false",
    "dict_type": "a mapping",
    "finite_number": "a finite number",
    "float_type": "a number",
    "greater_than": "a number above {gt}",
    "greater_than_equal": "at least {ge}",
    "int_type": "an integer",
    "less_than_equal": "at most {le}",
    "list_type": "a list",
    "literal_error": "{expected}",
    "model_type": "a mapping",
    "string_too_short": "some text",
    "string_type": "text",
    "too_long": "at most {max_length} of them",
    "too_short": "at least {min_length} of them",
    "tuple_type": "a list",
}
_NUMBERS: Final = ("a number", "a finite number", "an integer")
_NAME: Final = "a name of lower-case letters, digits and _"
_REFERENCE: Final = "a key of the blackboard such as $image"
_FORMULA: Final = "an expression such as $2 * pause_s"
_CODE: Final = "a code such as part.missing"
_OF_ANY_NODE: Final = frozenset(
    field.alias or name for name, field in NodeModel.model_fields.items()
)


def validate(source: Source) -> tuple[Document | None, list[Fault]]:
    """Return the document that a source holds, or every fault that keeps it from being one."""
    faults = list(source.faults)
    if faults:
        return None, faults
    if not isinstance(source.data, dict):
        kinds = ", ".join(DOCUMENTS)
        wanted = f"expected a mapping with one of the keys {kinds}"
        return None, [_fault(source, (), f"{wanted}; got {_shown(source.data)}")]
    found = [kind for kind in DOCUMENTS if kind in source.data]
    if found == ["mission", "cell"]:  # a mission names its cell
        found = ["mission"]
    if len(found) != 1:
        return None, [_fault(source, (), _no_single_kind(source.data, found))]
    model = DOCUMENTS[found[0]]
    try:
        return model.model_validate(source.data), []
    except ValidationError as error:
        return None, _translate(source, model, error)
    except RecursionError:
        return None, [_fault(source, (), "nodes are nested too deeply")]


def _no_single_kind(data: dict[str, object], found: list[str]) -> str:
    if found:
        return f"more than one kind of document: {', '.join(found)}; expected one a file"
    odd = next((key for key in data if key not in ("format", "about", "in", "out", "root")), "")
    hint = f"{odd!r} is none, {closest(odd, [*DOCUMENTS])}" if odd else f"one of {[*DOCUMENTS]}"
    return f"a document says what it is by a key: {hint}"


def _translate(source: Source, model: type[Document], error: ValidationError) -> list[Fault]:
    """Say what pydantic found; what several members of a union say of one value is joined."""
    said: dict[tuple[YamlPath, bool], list[str]] = defaultdict(list)
    whole: list[Fault] = []
    nodes = _paths(source)
    for detail in error.errors(include_url=False, include_input=False):
        path, inner = _yaml_path(source.data, detail["loc"], nodes)
        context = {name: _number(value) for name, value in detail.get("ctx", {}).items()}
        match detail["type"]:
            case "extra_forbidden":
                known = _known_keys(model, source.data, path, nodes)
                message = f"unknown key {path[-1]!r}; {_meant(str(path[-1]), known)}"
                whole.append(_fault(source, path, message, at_key=True))
            case "missing":
                whole.append(_fault(source, path, f"missing key {detail['loc'][-1]!r}"))
            case "no_node":
                whole.append(_fault(source, path, _no_node(value_at(source.data, path))))
            case "beside":
                whole.append(_fault(source, path, detail["msg"]))
            case "string_pattern_mismatch":
                is_key = inner == ("[key]",)
                said[path, is_key].append(_pattern(str(context["pattern"])))
            case "too_short" if _has_items(source.data, path, context["min_length"]):
                continue  # items that are wrong themselves are not counted
            case kind:
                expected = _EXPECTED.get(kind, detail["msg"]).format(**context)
                said[path, False].append(expected)
    whole += [_misfit(source, *place, wanted) for place, wanted in said.items()]
    return whole


def _meant(key: str, known: list[str]) -> str:
    if key.startswith("-"):
        return "an entry of a list begins with a dash and a blank"
    return closest(key, known)


def _number(value: Any) -> Any:
    """Write a limit as a file has it: 1000 where pydantic says 1000.0."""
    return f"{value:g}" if isinstance(value, float) else value


def _pattern(pattern: str) -> str:
    """Say what a pattern asks for."""
    if pattern.endswith("[^$]"):
        return _FORMULA
    return _REFERENCE if "$" in pattern[:3] else _CODE if "[.]" in pattern else _NAME


def _has_items(data: object, path: YamlPath, count: int) -> bool:
    value = value_at(data, path)
    items = value.get("children") if isinstance(value, dict) else value
    return isinstance(items, (list, dict)) and len(items) >= count


def _misfit(source: Source, path: YamlPath, is_key: bool, expected: list[str]) -> Fault:
    value = path[-1] if is_key else value_at(source.data, path)
    if isinstance(value, (int, float)):  # what a text might be instead is no help then
        expected = [one for one in expected if one in _NUMBERS or one[-1].isdigit()] or expected
    wanted = ", or ".join(dict.fromkeys(expected)).replace("True", "true").replace("False", "false")
    name = f"{path[-1]}: " if path and not is_key else ""
    return _fault(source, path, f"{name}expected {wanted}; got {_shown(value)}", at_key=is_key)


def _shown(value: object) -> str:
    """Return a value as a message shows it: in the words of YAML, and not at length."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (str, int, float)):
        return repr(value)
    if isinstance(value, list):
        return f"a list of {len(value)}"
    return "a mapping" if isinstance(value, dict) else "nothing"


def _no_node(value: object) -> str:
    if not isinstance(value, dict):
        return f"expected a node such as {{skill: NAME}}; got {_shown(value)}"
    kinds = [key for key in value if key in KINDS]
    if kinds:
        return f"a node has one kind; got {' and '.join(kinds)}, try one list entry for each"
    odd = next((key for key in value if key not in _OF_ANY_NODE), "")
    if not odd:
        return (
            f"a node needs a kind, such as skill or sequence; got only {', '.join(value) or '{}'}"
        )
    if odd == "<<":
        return "merge keys (<<) are not read; try a subtree for what is said twice"
    return f"unknown kind of node {odd!r}; {closest(odd, [*KINDS])}"


def _fault(source: Source, path: YamlPath, message: str, *, at_key: bool = False) -> Fault:
    line, column = source.key_mark(path) if at_key else source.value_mark(path)
    paths = _paths(source)
    above = (path[:length] for length in range(len(path), -1, -1))
    node = next((paths[place] for place in above if place in paths), "")
    return Fault(source.file, line, column, node, message)


@lru_cache(maxsize=2)  # all faults of a file are told one after the other
def _paths(source: Source) -> Mapping[YamlPath, str]:
    return node_paths(source.data)


def _yaml_path(
    data: object, location: tuple[int | str, ...], nodes: Container[YamlPath]
) -> tuple[YamlPath, tuple[Any, ...]]:
    """Return the path in the file that pydantic's location means, and what is left of it.

    Pydantic does not name the kind of a block, under which its keys stand in the file, and
    `children` is not written where a list stands for it.
    """
    path: YamlPath = ()
    for i, step in enumerate(location):
        path = _into_block(data, path, nodes)
        here = value_at(data, path)
        if isinstance(here, list) and step == "children":
            continue
        exists = step in here if isinstance(here, dict) else isinstance(step, int)
        if not exists:
            return path, location[i:]
        path = (*path, step)
    return _into_block(data, path, nodes), ()


def _into_block(data: object, path: YamlPath, nodes: Container[YamlPath]) -> YamlPath:
    """Return where the keys of a node stand: under its kind if it is a block."""
    kind = kind_of(value_at(data, path)) if path in nodes else None
    return (*path, kind) if kind in BLOCKS else path


def _known_keys(
    document: type[Document], data: object, path: YamlPath, nodes: Container[YamlPath]
) -> list[str]:
    """Return the keys that the mapping around an unknown key may have."""
    model: type[Model] = document
    if len(path) == 3 and path[0] in ("in", "out"):
        model = InPort if path[0] == "in" else OutPort
    for length in range(1, len(path)):
        if path[:length] in nodes and (kind := kind_of(value_at(data, path[:length]))):
            model = {**LEAVES, **BLOCKS}[kind]
    return [field.alias or name for name, field in model.model_fields.items()]
