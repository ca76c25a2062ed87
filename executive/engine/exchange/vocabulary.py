"""The nodes that BehaviorTree.CPP v4 brings along: their ports, and what cannot be said here."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from executive.engine.exchange.foreign import ForeignPort, NodeKind

EXPLICIT: Final[tuple[NodeKind, ...]] = ("Action", "Condition", "Control", "Decorator")
"""Elements that name their node by an ID; any other element is named by its tag."""

CONDITIONS: Final = ("_failureIf", "_successIf", "_skipIf", "_while")
ENDINGS: Final = ("_onSuccess", "_onFailure", "_onHalted", "_post")
IGNORED: Final = frozenset({"_uid", "_fullpath", "_description", "_autoremap"})

COUNTERPARTS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "sequence": "Sequence",
        "reactive_sequence": "ReactiveSequence",
        "selector": "Fallback",
        "reactive_selector": "ReactiveFallback",
        "if_then_else": "IfThenElse",
        "while_do_else": "WhileDoElse",
        "inverter": "Inverter",
        "force_success": "ForceSuccess",
        "force_failure": "ForceFailure",
    }
)
"""What kinds of ours that have no ports there are called there."""

SEQUENCES: Final = frozenset(
    {"Sequence", "ReactiveSequence", "SequenceWithMemory", "AsyncSequence"}
)
FALLBACKS: Final = frozenset({"Fallback", "ReactiveFallback", "AsyncFallback"})
LOOPS: Final[Mapping[str, str]] = MappingProxyType(
    {"LoopInt": "int", "LoopBool": "bool", "LoopDouble": "double", "LoopString": "std::string"}
)
SWITCHES: Final[Mapping[str, int]] = MappingProxyType({f"Switch{n}": n for n in range(2, 7)})

_INT, _UINT, _BOOL, _TEXT = "int", "unsigned", "bool", "std::string"


def _inputs(**types: str) -> dict[str, ForeignPort]:
    return {name: ForeignPort("in", kind) for name, kind in types.items()}


PORTS: Final[Mapping[str, Mapping[str, ForeignPort]]] = MappingProxyType(
    {
        **{name: {} for name in (*SEQUENCES, *FALLBACKS)},
        **{name: {} for name in ("IfThenElse", "WhileDoElse")},
        **{name: {} for name in ("Inverter", "ForceSuccess", "ForceFailure")},
        **{name: {} for name in ("KeepRunningUntilFailure", "AlwaysSuccess", "AlwaysFailure")},
        "Parallel": _inputs(success_count=_INT, failure_count=_INT),
        "ParallelAll": _inputs(max_failures=_INT),
        "Repeat": _inputs(num_cycles=_INT),
        "RetryUntilSuccessful": _inputs(num_attempts=_INT),
        "Timeout": _inputs(msec=_UINT),
        "Delay": _inputs(delay_msec=_UINT),
        "RunOnce": _inputs(then_skip=_BOOL),
        "Sleep": _inputs(msec=_UINT),
        "SetBlackboard": {"value": ForeignPort("in"), "output_key": ForeignPort("out")},
        "UnsetBlackboard": _inputs(key=_TEXT),
        "Script": _inputs(code=_TEXT),
        "ScriptCondition": _inputs(code=_TEXT),
        "Precondition": {**_inputs(**{"if": _TEXT, "else": _TEXT})},
        **{
            name: {
                "queue": ForeignPort("in", f"std::vector<{kind}>"),
                "if_empty": ForeignPort("in", _TEXT),
                "value": ForeignPort("out", kind),
            }
            for name, kind in LOOPS.items()
        },
        **{
            name: {
                "variable": ForeignPort("in"),
                **_inputs(**{f"case_{i + 1}": _TEXT for i in range(count)}),
            }
            for name, count in SWITCHES.items()
        },
    }
)
"""Ports of every node that is translated, by its ID."""

REFUSED: Final[Mapping[str, str]] = MappingProxyType(
    {
        **dict.fromkeys(
            (
                *("WasEntryUpdated", "EntryUpdatedAction", "EntryUpdatedDecorator"),
                *("SkipUnlessUpdated", "WaitValueUpdate"),
            ),
            "asks whether a key was written since the last tick, which our keys do not remember; "
            "try a key that counts, and a condition on it",
        ),
        **dict.fromkeys(
            ("ConsumeQueue", "PopFromQueue", "QueueSize"),
            "takes items out of a list that others see; try for_each over the list",
        ),
        "ManualSelector": "waits for a person at the terminal; try a skill that asks",
        "TestNode": "is a substitute for tests; try a stub with scripted outcomes",
        "TryCatch": "runs a clean-up child; try a selector, or on_failure",
        "SubTreePlus": "is of version 3; try <SubTree ID=... _autoremap=...>",
        "SequenceStar": "is of version 3; it is called SequenceWithMemory now",
        "FallbackStar": "is of version 3; it is called Fallback now",
        "BlackboardCheckInt": "is of version 3; try _skipIf, or a ScriptCondition",
        "BlackboardCheckDouble": "is of version 3; try _skipIf, or a ScriptCondition",
        "BlackboardCheckString": "is of version 3; try _skipIf, or a ScriptCondition",
        "BlackboardCheckBool": "is of version 3; try _skipIf, or a ScriptCondition",
        "RecoveryNode": "is a control of Nav2, which only its C++ code defines; try "
        "<RetryUntilSuccessful> around a <Fallback> of the child and "
        "<ForceFailure> around the recovery",
        "PipelineSequence": "is a control of Nav2, which only its C++ code defines; try "
        "<ReactiveSequence>, or <Parallel>",
        "RoundRobin": "is a control of Nav2, which only its C++ code defines; try <Fallback>",
        "RateController": "is a decorator of Nav2, which only its C++ code defines; try "
        "<Delay> in a <Repeat>, or our cooldown",
        "DistanceController": "is a decorator of Nav2, which only its C++ code defines",
        "SpeedController": "is a decorator of Nav2, which only its C++ code defines",
        "SingleTrigger": "is a decorator of Nav2, which only its C++ code defines; try <RunOnce>",
        "GoalUpdater": "is a decorator of Nav2, which only its C++ code defines; try a "
        "<Sequence> with an action that updates the goal",
    }
)
"""Why a node that is known is not translated, and what to try."""
