import numpy as np
import pytest

from robots.placement import TABLE_SIZE_M
from skills.cable.pull_in import INSIDE_M, STEP_M, ways_from_edge

HALF_M = 0.5 * np.array(TABLE_SIZE_M)


def straight(begin_m, end_m) -> np.ndarray:
    return np.linspace(begin_m, end_m, 60)


@pytest.mark.parametrize("out_m", [0.05, 0.15, 0.25])
def test_a_hand_goes_so_far_from_the_edge_that_the_end_comes_up(out_m):
    line_m = straight((-0.2, 0.1), (-0.2, -HALF_M[1]))
    hold_m = line_m[-10]
    way_m = ways_from_edge(hold_m, line_m, out_m)[0]
    beyond_m = np.linalg.norm(line_m[-1] - hold_m) + out_m
    assert hold_m[1] + way_m[1] + HALF_M[1] >= beyond_m + INSIDE_M - STEP_M


def test_where_no_hand_can_go_so_far_it_goes_as_far_as_it_can():
    line_m = straight((-0.2, 0.1), (-0.2, -HALF_M[1]))
    ways_m = ways_from_edge(line_m[-10], line_m, 2.0)
    ends_m = [line_m[-10] + way_m[:2] for way_m in ways_m]
    assert ends_m[0][1] == max(end_m[1] for end_m in ends_m)


@pytest.mark.parametrize("edge_m", [(-HALF_M[0], 0.0), (HALF_M[0], 0.0), (0.0, HALF_M[1])])
def test_cable_is_drawn_away_from_the_edge_that_it_leaves_over(edge_m):
    edge_m = np.array(edge_m)
    line_m = straight(0.5 * edge_m, edge_m)
    way_m = ways_from_edge(line_m[-15], line_m, 0.2)[0]
    assert way_m[:2] @ edge_m < -0.1 * np.linalg.norm(edge_m)


def test_of_ways_that_bring_the_end_up_those_past_other_cable_come_last():
    beside_m = straight((-0.05, 0.2), (-0.05, -0.1))
    under_m = straight((-0.05, -0.1), (-0.3, -0.15))
    away_m = straight((-0.3, -0.15), (-0.3, -HALF_M[1]))
    line_m = np.vstack([beside_m, under_m[1:], away_m[1:]])
    end_m = line_m[-20] + ways_from_edge(line_m[-20], line_m, 0.05)[0][:2]
    assert np.linalg.norm(beside_m - end_m, axis=1).min() > 0.05


def test_parts_of_the_best_way_come_last():
    line_m = straight((-0.2, 0.1), (-0.2, -HALF_M[1]))
    *_, first, second = (way_m[:2] for way_m in ways_from_edge(line_m[-10], line_m, 0.1))
    best = ways_from_edge(line_m[-10], line_m, 0.1)[0][:2]
    assert np.linalg.norm(second) < np.linalg.norm(first) < np.linalg.norm(best)
    assert abs(np.cross(first, best)) < 1e-12
