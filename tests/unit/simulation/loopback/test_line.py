"""A line delays, reorders and loses as it is set, by seed."""

import numpy as np

from simulation.loopback.line import Line
from simulation.loopback.settings import LoopbackSettings


def line(seed=0, **settings):
    return Line(LoopbackSettings(**settings), np.random.default_rng(seed))


def test_a_perfect_line_hands_on_at_once_and_in_order():
    perfect = line()
    for number in range(5):
        perfect.put(number, 1.0)
    assert perfect.due(1.0) == [0, 1, 2, 3, 4]
    assert perfect.due(9.0) == []


def test_nothing_arrives_before_its_time_or_after_the_longest():
    slow = line(latency_s=0.1, jitter_s=0.05)
    for number in range(200):
        slow.put(number, 0.0)
    assert slow.due(0.0999) == []
    early = slow.due(0.125)
    assert 50 < len(early) < 150
    assert early != sorted(early)
    assert sorted(early + slow.due(0.1501)) == list(range(200))


def test_loses_its_share_and_the_same_by_the_same_seed():
    def arrived(seed):
        lossy = line(seed, loss=0.2)
        for number in range(2000):
            lossy.put(number, 0.0)
        return lossy.due(0.0)

    assert 1500 < len(arrived(1)) < 1700
    assert arrived(1) == arrived(1) != arrived(2)


def test_what_is_under_way_can_be_lost_at_once():
    slow = line(latency_s=0.1)
    slow.put(1, 0.0)
    slow.clear()
    assert slow.due(1.0) == []
