"""Values of a recording on the blackboard of a tree: built again when a node reads them."""

from collections.abc import Iterable

from pydantic import JsonValue

from executive.core.errors import RecordingError
from executive.engine.blackboard import Blackboard
from executive.engine.recording.decoding import decode
from executive.engine.recording.reader import Recording
from executive.engine.recording.values import ValueEncoder
from executive.inspector.recorded_values import opened

_UNSET = "executive.engine.blackboard.Unset"


class RecordedValue:
    """A value as a recording holds it.

    Attributes:
        form: Its JSON form.
    """

    __slots__ = ("form",)

    def __init__(self, form: object) -> None:
        """Keep the JSON form."""
        self.form = form


class ReplayBoard(Blackboard):
    """A blackboard on which leaves put recorded values; a node that reads one gets the object.

    Of a value that the recording only describes there are the fields that it has.
    """

    def __init__(self, recording: Recording, classes: Iterable[type] = ()) -> None:
        """Begin empty; `classes` are those of values that are not of this project."""
        super().__init__()
        self._recording, self._classes = recording, tuple(classes)
        self._built: dict[int, tuple[object, RecordedValue]] = {}
        self._objects: dict[int, tuple[RecordedValue, object]] = {}
        self._encoder = ValueEncoder(lambda _: None)

    def read(self, key: str) -> object:
        """Return the value of a key.

        Raises:
            KeyError: Nothing has written it yet.
        """
        value = super().read(key)
        return self._object(value) if isinstance(value, RecordedValue) else value

    def form(self, value: object) -> object:
        """Return the JSON form of a value; of a recorded one that which the recording has."""
        if isinstance(value, RecordedValue):
            return value.form
        if id(value) in self._built:
            return self._built[id(value)][1].form
        return self._encoder.encode(value)

    def holds(self, key: str, form: object) -> bool:
        """Return whether a key has the value of that JSON form now."""
        return key in self and self.form(super().read(key)) == form

    def _object(self, value: RecordedValue) -> object:
        if isinstance(value.form, bool | int | float | str | type(None)):
            return value.form
        known = self._objects.get(id(value))
        if known is None:
            known = self._objects[id(value)] = value, self._decoded(value.form)
            # Kept beside the object, so that no other can take its place in memory.
            self._built[id(known[1])] = known[1], value
        return known[1]

    def _decoded(self, form: object) -> object:
        plain: JsonValue = form  # type: ignore[assignment]  # writes of a recording are JSON
        try:
            return decode(plain, self._recording, self._classes)
        except RecordingError:
            return opened(form)
