"""Where skills of a cell have long work done."""

import pytest
from pydantic import ValidationError

from executive.app.compose import workers
from executive.core.process_work import ProcessWorker
from executive.core.work import InlineWorker, ThreadWorker
from executive.engine.language.document import CellDocument

CELL = {"format": 1, "cell": "c", "world": "w"}


def test_a_cell_says_where_long_work_is_done():
    assert CellDocument.model_validate(CELL).work == "inline"
    beside = CellDocument.model_validate({**CELL, "work": "beside"})
    kinds = {name: type(worker) for name, worker in workers(beside.work).items()}
    assert kinds == {"worker": ThreadWorker, "processes": ProcessWorker}
    inline = workers("inline").values()
    assert {type(worker) for worker in inline} == {InlineWorker}
    with pytest.raises(ValidationError):
        CellDocument.model_validate({**CELL, "work": "thread"})
