"""What goes into a recording comes out as it was, and a recording chooses no imports."""

import json
from dataclasses import dataclass, field
from enum import Enum, StrEnum

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from py_trees.common import Status
from toy_runs import Leaf, built, header_of, record

from executive.core.errors import RecordingError
from executive.core.outcome import Reason
from executive.engine.blackboard import Blackboard, Write
from executive.engine.recording.decoding import decode
from executive.engine.recording.reader import Recording
from executive.engine.recording.values import ValueEncoder
from executive.engine.recording.writer import RecordingWriter
from executive.engine.ticks import NodeStatus, Tick


class Colour(StrEnum):
    RED = "red"
    GREEN = "green"


class Shape(Enum):
    ROUND = (1, 2)


@dataclass(frozen=True, slots=True)
class Part:
    """A part that the tests put on the blackboard."""

    colour: Colour
    holes: tuple[int, ...] = ()
    notes: object = None
    count: int = field(init=False, default=3)


class Shelf:
    """Keeps what the encoder stores."""

    def __init__(self):
        self.kept = []

    def store(self, array):
        self.kept.append(array)
        return len(self.kept) - 1

    def image(self, number):
        return self.kept[number]

    array = image


def there_and_back(value):
    shelf = Shelf()
    encoded = ValueEncoder(shelf.store, shelf.store).encode(value)
    text = json.dumps(encoded, allow_nan=False)
    return decode(json.loads(text), shelf, [Part, Colour, Shape])


def same(one, other):
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=True)
    if isinstance(one, Part):
        return type(one) is type(other) and same(
            [one.colour, one.holes, one.notes], [other.colour, other.holes, other.notes]
        )
    if isinstance(one, list | tuple):
        return type(one) is type(other) and len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    return type(one) is type(other) and (one == other or (one != one and other != other))


plain = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(2**53), 2**53),
    st.floats(),
    st.text(),
    st.binary(),
    st.sampled_from([*Colour, *Shape]),
    st.frozensets(st.integers()),
    arrays.arrays(
        st.sampled_from([np.float32, np.float64, np.uint16, np.int64, np.bool_, np.uint8]),
        arrays.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4),
    ),
)
values = st.recursive(
    plain,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.lists(inner, max_size=3).map(tuple),
        st.dictionaries(st.text(max_size=3), inner, max_size=3),
        st.dictionaries(st.integers(), inner, max_size=3),
        st.builds(Part, st.sampled_from(Colour), st.just((1, 2)), inner),
    ),
    max_leaves=8,
)


@given(values)
def test_every_kept_value_comes_back_as_it_was(value):
    assert same(value, there_and_back(value))


@pytest.mark.parametrize("dtype", [np.float32, np.uint16, ">f4", np.float64, np.bool_])
def test_large_arrays_are_stored_once_and_come_back(tmp_path, dtype):
    blackboard = Blackboard()
    depth = np.random.default_rng(0).integers(0, 2, (100, 120)).astype(dtype)

    def look():
        blackboard.write("toy:depth", depth, "look")
        return Status.RUNNING if len(leaf.answers) > 1 else Status.SUCCESS

    leaf = Leaf("look", look, look, look)
    recording, _ = record(tmp_path / "a.mcap", leaf, blackboard)
    forms = [recording.blackboard(k)["toy:depth"].value for k in range(len(recording))]
    assert len(forms) == 2
    assert forms[0] == forms[1]
    assert forms[0]["array"] == 0
    back = decode(forms[1], recording)
    assert np.array_equal(back, depth)
    assert back.dtype == np.dtype(dtype).newbyteorder("=")


def test_images_come_back_from_the_file(tmp_path):
    blackboard = Blackboard()
    rng = np.random.default_rng(0)
    grey, colour = (rng.integers(0, 255, s, dtype=np.uint8) for s in ((40, 60), (8, 9, 3)))
    leaf = Leaf(
        "look", lambda: blackboard.write("toy:images", (grey, colour), "") or Status.SUCCESS
    )
    recording, _ = record(tmp_path / "a.mcap", leaf, blackboard)
    back = decode(recording.blackboard(0)["toy:images"].value, recording)
    assert np.array_equal(back[0], grey)
    assert np.array_equal(back[1], colour)


def test_classes_of_this_project_need_no_registration():
    outcome = Reason("grasp.missed", "closed on nothing", {"width_m": 0.1})
    assert there_and_back([NodeStatus.RUNNING, outcome]) == [NodeStatus.RUNNING, outcome]


@pytest.mark.parametrize(
    "name",
    [
        "subprocess.Popen",
        "os.PathLike",
        "executive.nowhere.Thing",
        "executive.core.outcome.Nothing",
        "executive.engine.recording.decoding.importlib.machinery.ModuleSpec",
        "executive.engine.recording.decoding.Enum",
        "executive.engine.blackboard.Blackboard",
        f"{__name__}.Part",
        "executive",
        "",
        "..",
    ],
)
def test_a_recording_cannot_name_any_class(name):
    with pytest.raises(RecordingError, match="expected a dataclass, an enumeration"):
        decode({"$type": name, "args": ["true"]}, Shelf())


@pytest.mark.parametrize(
    "form",
    [
        {"$type": "executive.core.outcome.Reason"},
        {"$type": "tuple"},
        {"$type": "float", "value": "much"},
        {"$type": "bytes", "base64": "?"},
        {"$type": "ndarray", "dtype": "float32", "shape": [3], "values": [1]},
        {"$type": 5},
    ],
)
def test_a_damaged_form_is_an_error_of_the_recording(form):
    with pytest.raises(RecordingError, match="cannot be read back"):
        decode(form, Shelf())


def test_what_was_only_described_cannot_come_back():
    for value in (object(), np.zeros((100, 100))):
        encoded = ValueEncoder(lambda _: None).encode(value)
        with pytest.raises(RecordingError, match="was not kept"):
            decode(encoded, Shelf())


def test_images_above_the_rate_are_named_by_hash_key_by_key(tmp_path):
    header = header_of(built(Leaf("look", Status.SUCCESS)))
    rng = np.random.default_rng(0)
    with RecordingWriter(tmp_path / "a.mcap", header, images_per_s=2.0) as writer:
        for number in range(20):
            images = [rng.integers(0, 255, (4, 5), dtype=np.uint8) for _ in range(3)]
            writes = (Write("toy:a", tuple(images[:2]), ""), Write("toy:b", images[2], ""))
            writer.on_tick(Tick(number, 0.1 * number, 0.0, writes=writes))
    recording = Recording.open(tmp_path / "a.mcap")
    forms = [[write.value for write in recording.tick(number).writes] for number in range(20)]
    kept = [number for number, (_, b) in enumerate(forms) if "image" in b]
    assert kept == [0, 5, 10, 15]
    assert all({"image" in f for f in a["items"]} == {"image" in b} for a, b in forms)
    assert all(len(b["hash"]) == 16 for _, b in forms if "image" not in b)
    assert len(list(recording.images())) == 12
