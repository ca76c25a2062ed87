"""A search that is stuck clears its way, and one that is not goes on as it would."""

import numpy as np
from shelf_search import drawn_scenes

from benchmarks.search_trials import Way, WaySearcher, search_by
from benchmarks.searching import Trial
from perception.shelf.planning.clearing import ReductionWithClearing
from perception.shelf.planning.dar import DistributionAreaReduction
from perception.shelf.planning.room import Reach
from perception.shelf.types import Box, Shelf
from simulation.shelf.scenes import Scene, SceneRules

NOTHING_MET = np.zeros((0, 4))


def test_it_does_as_the_published_policy_wherever_that_has_a_move():
    for scene in drawn_scenes("pharmacy", SceneRules(15), range(4)):
        searcher = WaySearcher(scene, Way())
        searcher.look()
        view, seen = searcher.view, searcher.seen
        heat = searcher.occupancy(view, seen)
        moves = [
            policy(scene.shelf, searcher.caster, Reach()).choose(heat, view, seen, NOTHING_MET)
            for policy in (DistributionAreaReduction, ReductionWithClearing)
        ]
        assert moves[0] is not None
        assert moves[0] == moves[1]


def blocked_scene():
    """The target stands behind a tall object, which two lower ones shut in."""
    boxes = {
        "tall": Box(0.4, 0.2, (0.1, 0.08, 0.25)),
        "left": Box(0.34, 0.1, (0.1, 0.05, 0.05)),
        "right": Box(0.46, 0.1, (0.1, 0.05, 0.05)),
        "target": Box(0.4, 0.29, (0.05, 0.05, 0.06)),
    }
    return Scene(Shelf(), tuple(boxes), tuple(boxes.values()), "target")


def test_what_stands_in_the_way_is_moved_out_of_it():
    labels = []
    searcher = WaySearcher(blocked_scene(), Way(policy="clearing"))
    published = DistributionAreaReduction(searcher.shelf, searcher.caster, Reach())
    for stuck in (True, False):
        searcher.look()
        view, seen = searcher.view, searcher.seen
        heat = np.zeros(view.depth_m.shape)
        heat[next(one.mask for one in seen if one.label == "tall")] = 1.0
        assert (published.choose(heat, view, seen, NOTHING_MET) is None) == stuck
        move = searcher.policy.choose(heat, view, seen, NOTHING_MET)
        assert searcher.act(move).failure is None
        labels.append(move.label)
    assert labels[0] in ("left", "right")
    assert labels[1] == "tall"
    assert searcher.shows()


def test_where_no_move_helps_it_says_so():
    row = [Box(0.1 + 0.2 * i, 0.1, (0.199, 0.15, 0.2)) for i in range(4)]
    behind = Box(0.4, 0.25, (0.04, 0.04, 0.06))
    names = ("a", "b", "c", "d", "target")
    scene = Scene(Shelf(), names, (*row, behind), "target")
    found = search_by(scene, Way(policy="clearing", reach=Reach(suction=False)))
    assert found == Trial(False, 0, stuck=True)


def test_searches_that_got_stuck_are_solved():
    scenes = drawn_scenes("pharmacy", SceneRules(15), (5, 17, 22, 24))
    plain = [search_by(scene) for scene in scenes]
    cleared = [search_by(scene, Way(policy="clearing")) for scene in scenes]
    assert sum(found.stuck for found in plain) >= 2
    assert all(found.success for found in cleared)
