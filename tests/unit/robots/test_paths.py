"""Path search in toy spaces where the right answer is plain to see."""

from itertools import pairwise

import numpy as np
import pytest

from robots.motion import path_search
from robots.motion.detours import Detours
from robots.motion.path import RESOLUTION_M, RrtConnect, Space, shorten
from robots.motion.path_search import PathSearch
from robots.motion.roadmap import Roadmap

START, GOAL = np.array([-0.8, 0.0]), np.array([0.8, 0.0])


def space(collides):
    return Space(-np.ones(2), np.ones(2), np.ones(2), collides)


def wall_with_a_gap(q):
    return abs(q[0]) < 0.1 and q[1] < 0.7


def walled_in(q):
    return 0.2 < np.linalg.norm(q - GOAL) < 0.4


def search(collides, checks=20_000, seed=0):
    rest, arm = np.array([0.0, 0.9]), np.arange(2)
    return PathSearch(space(collides), np.random.default_rng(seed), checks, 3, rest, [arm])


def densely_free(path, collides):
    for a, b in pairwise(path):
        count = int(np.abs(b - a).sum() / 0.005) + 2
        if any(collides(q) for q in np.linspace(a, b, count)):
            return False
    return True


def test_a_free_straight_edge_is_taken():
    path = next(search(lambda q: False).paths(START, [GOAL]))
    assert np.array_equal(path, [START, GOAL])


def test_of_several_ends_a_straight_one_is_taken_before_any_search():
    other = np.array([-0.8, 0.5])
    path = next(search(wall_with_a_gap).paths(START, [GOAL, other]))
    assert np.array_equal(path, [START, other])


@pytest.mark.parametrize("seed", range(5))
def test_a_way_round_is_found_from_start_to_goal(seed):
    path = next(search(wall_with_a_gap, seed=seed).paths(START, [GOAL]))
    assert np.array_equal(path[0], START)
    assert np.array_equal(path[-1], GOAL)
    assert densely_free(path, lambda q: abs(q[0]) < 0.1 - RESOLUTION_M and q[1] < 0.68)


def test_the_same_seed_finds_the_same_path():
    first, second = (next(search(wall_with_a_gap, seed=3).paths(START, [GOAL])) for _ in range(2))
    assert np.array_equal(first, second)


def test_where_there_is_no_path_the_search_ends_with_its_checks():
    count = 0

    def counting(q):
        nonlocal count
        count += 1
        return walled_in(q)

    tree = RrtConnect(space(counting), np.random.default_rng(0), 2000)
    assert tree.path(START, GOAL) is None
    assert count <= 2000 + 200


def test_edges_are_checked_as_densely_as_promised():
    seen = []
    space(lambda q: bool(seen.append(q))).edge_is_free(START, GOAL)
    ordered = sorted(float(q[0]) for q in [START, *seen])
    assert max(np.diff(ordered)) <= RESOLUTION_M + 1e-12
    assert ordered[-1] == GOAL[0]
    assert len(set(ordered)) == len(ordered)


def test_shortening_keeps_the_ends_and_only_removes_waypoints():
    path = [START, np.array([-0.4, 0.9]), np.array([0.0, 0.9]), np.array([0.4, 0.9]), GOAL]
    short = shorten(path, space(wall_with_a_gap), np.random.default_rng(0), 50)
    assert 3 <= len(short) < len(path)
    assert short[0] is START
    assert short[-1] is GOAL
    assert all(any(q is old for old in path) for q in short)


def blind(monkeypatch, *strategies):
    """Let some strategies find nothing."""
    for name in strategies:
        monkeypatch.setattr(getattr(path_search, name), "path", lambda *_: None)


@pytest.mark.parametrize("blinded", [("RrtConnect",), ("RrtConnect", "Detours")])
@pytest.mark.parametrize("seed", range(3))
def test_where_trees_do_not_meet_other_strategies_find_a_way(monkeypatch, blinded, seed):
    blind(monkeypatch, *blinded)
    looked = search(wall_with_a_gap, seed=seed)
    path = next(looked.paths(START, [GOAL]))
    assert np.array_equal(path[0], START)
    assert np.array_equal(path[-1], GOAL)
    assert densely_free(path, lambda q: abs(q[0]) < 0.1 - RESOLUTION_M and q[1] < 0.68)
    assert [tried.name for tried in looked.tried] == ["straight_edge", "rrt_connect", "detour"][
        : len(blinded) + 1
    ]


def test_what_was_tried_is_told_in_order():
    looked = search(walled_in, checks=500)
    assert list(looked.paths(START, [GOAL, GOAL, GOAL, GOAL])) == []
    assert [(tried.name, tried.ends) for tried in looked.tried] == [
        ("straight_edge", 4), ("rrt_connect", 3), ("detour", 1), ("roadmap", 1),
    ]  # fmt: skip


def test_two_arms_go_one_after_the_other_where_both_at_once_would_meet():
    def meet(q):
        return abs(q[0] - q[1]) < 0.4 and max(abs(q)) < 0.5

    start, goal, arms = np.array([-0.8, 0.8]), np.array([0.8, -0.8]), [np.array([0]), np.array([1])]
    rng = np.random.default_rng(0)
    path = Detours(space(meet), rng, np.array([0.0, 0.9]), arms).path(start, goal, 100)
    assert densely_free(path, meet)
    assert all(np.count_nonzero(np.diff([a, b], axis=0)) <= 1 for a, b in pairwise(path))


@pytest.mark.parametrize("seed", range(5))
def test_a_roadmap_leads_through_a_narrow_gap(seed):
    def narrow(q):
        return abs(q[0]) < 0.3 and abs(q[1] - 0.5) > 0.06

    road = Roadmap(space(narrow), np.random.default_rng(seed), 20_000)
    path = road.path(START, GOAL)
    assert densely_free(path, lambda q: abs(q[0]) < 0.28 and abs(q[1] - 0.5) > 0.08)


def test_a_roadmap_ends_with_its_checks():
    count = 0

    def counting(q):
        nonlocal count
        count += 1
        return walled_in(q)

    assert Roadmap(space(counting), np.random.default_rng(0), 3000).path(START, GOAL) is None
    assert count <= 3000 + 200


def test_part_of_a_space_keeps_the_other_joints_where_they_are():
    part = space(lambda q: q[0] > 0.5 and q[1] > 0.5).part(np.array([0.0, 0.6]), np.array([0]))
    assert not part.collides(np.array([0.4]))
    assert part.collides(np.array([0.6]))
