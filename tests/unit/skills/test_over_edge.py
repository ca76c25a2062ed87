import numpy as np
import pytest
from cell_fakes import frame

from perception.cable.types import Trace, TraceEnd
from skills.cable.over_edge import at_edge, leaving


def line(first_x_px: float, last_x_px: float, end: TraceEnd = TraceEnd.ENDPOINT) -> Trace:
    return Trace(
        np.column_stack([np.linspace(first_x_px, last_x_px, 50), np.full(50, 375.0)]), end, 0.9
    )


def test_a_trace_to_the_edge_of_the_table_leaves_it():
    assert leaving(line(300.0, 990.0), frame()).end is TraceEnd.EDGE


def test_a_trace_from_the_edge_is_turned_round_so_that_it_ends_there():
    found = leaving(line(990.0, 300.0), frame())
    assert found.end is TraceEnd.EDGE
    assert found.points_px[-1, 0] == 990.0


@pytest.mark.parametrize("end", [TraceEnd.LOST, TraceEnd.EDGE, TraceEnd.RETRACE])
def test_what_was_not_taken_for_an_end_stays_what_it_is(end):
    assert leaving(line(300.0, 990.0, end), frame()).end is end


def test_an_end_on_the_table_is_one():
    trace = line(300.0, 800.0)
    assert leaving(trace, frame()) is trace


def test_all_four_edges_count():
    places = [(10.0, 375.0), (990.0, 375.0), (500.0, 10.0), (500.0, 740.0)]
    assert all(at_edge(np.array(place), frame()) for place in places)
    assert not at_edge(np.array([500.0, 375.0]), frame())
