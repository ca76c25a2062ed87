"""What a node was given, as the attributes that Groot2 shows beside it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

from executive.engine.exchange.xmltext import printable
from executive.engine.language.block_models import ParallelBody, RepeatBody, RetryBody, TimeoutBody
from executive.engine.language.node_models import NodeModel, SetNode, SkillNode, WhenNode
from executive.engine.language.values import key_of, parse_value
from executive.inspector.rebuilt import WrittenNode

_NOT_SHOWN: Final = frozenset({*NodeModel.model_fields, "children", "child", "cases", "default"})
_TAKEN: Final = frozenset({"ID", "name"})


@dataclass(frozen=True, slots=True)
class Ports:
    """Attributes of a node by name.

    Attributes:
        inputs: What it reads, `{key}` for a plain key.
        outputs: Keys that it writes.
    """

    inputs: Mapping[str, str] = field(default_factory=dict)
    outputs: Mapping[str, str] = field(default_factory=dict)


def ports_of(written: WrittenNode) -> Ports:
    """Return the ports of a node as it was written.

    The nodes that BehaviorTree.CPP has too get the names and units of theirs.
    """
    model = written.spec.model
    if written.is_guard:
        return Ports(_shown({**model.guards, **_endings(model)}))
    if isinstance(model, SkillNode):
        return Ports(_shown(model.in_), _shown(model.out))
    return Ports(_shown(_inputs(model)))


def _inputs(model: NodeModel) -> dict[str, object]:
    match model:
        case WhenNode(when=text):
            return {"code": text}
        case SetNode():
            return {"code": _assigned(model.set)}
        case RetryBody(times=times):
            return {"num_attempts": -1 if times == "forever" else times}
        case RepeatBody(times=times):
            return {"num_cycles": -1 if times == "forever" else times}
        case TimeoutBody(seconds=float() as seconds):
            return {"msec": round(seconds * 1000)}
        case TimeoutBody(seconds=text):
            return {"msec": f"{text} s"}
        case ParallelBody(succeed=succeed, fail=fail):
            amounts = {"all": -1, "any": 1}
            counts = {"success_count": succeed, "failure_count": fail}
            return {
                name: amounts.get(str(count), count)
                for name, count in counts.items()
                if isinstance(count, int | str)
            }
    given = model.model_fields_set - _NOT_SHOWN
    fields = type(model).model_fields
    return {fields[name].alias or name: getattr(model, name) for name in sorted(given)}


def _endings(model: NodeModel) -> dict[str, object]:
    return {keyword: _assigned(texts) for keyword, texts in model.endings.items()}


def _assigned(texts: Mapping[str, str]) -> str:
    return "; ".join(f"{key} := {text}" for key, text in texts.items())


def _shown(values: Mapping[str, object]) -> dict[str, str]:
    return {name: _text(value) for name, value in values.items() if name not in _TAKEN}


def _text(value: object) -> str:
    key = key_of(parse_value(value)) if isinstance(value, str) else None
    return printable(str(value)) if key is None else f"{{{key}}}"
