"""docs/recording.md names every field that a recording can hold."""

import re
from pathlib import Path

import pytest

from executive.engine.recording import messages
from executive.engine.ticks import Halt, NodeFault, NodeOutcome

PAGE = (Path(__file__).parents[3] / "docs" / "recording.md").read_text()
MODELS = [
    messages.MissionHeader,
    messages.SourceFile,
    messages.RecordedNode,
    messages.TickMessage,
    messages.Keyframe,
    messages.RunReport,
    messages.ActionReport,
    messages.ResultMessage,
    messages.InjectedReport,
]


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.__name__)
def test_every_field_is_explained(model):
    words = set(re.findall(r"\w+", " ".join(re.findall(r"`([^`]+)`", PAGE))))
    assert set(model.model_fields) <= words


@pytest.mark.parametrize("record", [Halt, NodeOutcome, NodeFault], ids=lambda kind: kind.__name__)
def test_every_field_of_a_record_in_a_tick_is_explained(record):
    words = set(re.findall(r"\w+", " ".join(re.findall(r"`([^`]+)`", PAGE))))
    assert set(record.__dataclass_fields__) <= words
