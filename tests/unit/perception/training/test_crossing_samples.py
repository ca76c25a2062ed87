import numpy as np
import pytest

pytest.importorskip("torch")

import torch

from perception.cable.classifiers.passes import path_through
from perception.cable.polyline import arc_lengths, point_at
from perception.training.crossing import CrossingTask, scene_ribbons
from perception.training.crossing_samples import MeetingConfig, meetings
from perception.training.scenes import SceneConfig, make_scene
from perception.training.thesis_crossing import ThesisCrossingTask, crossing_visits

SMALL = SceneConfig(extent=24.0, narrowest_px=5.0, widest_px=7.0)
EXACT = MeetingConfig(aside=0.0, jitter=0.0, coarse=0.0)


def _drawn(config, seeds=range(8)):
    for seed in seeds:
        rng = np.random.default_rng(seed)
        scene = make_scene(rng, SMALL)
        yield rng, scene, meetings(rng, scene, config)


def _place(strand):
    return point_at(strand.line, arc_lengths(strand.line), strand.at)


@pytest.mark.parametrize("config", [EXACT, MeetingConfig()])
def test_both_lines_go_through_the_meeting(config):
    gaps = [
        np.linalg.norm(_place(meeting.passes[0]) - _place(meeting.passes[1]))
        for _, _, found in _drawn(config)
        for meeting in found
    ]
    assert len(gaps) > 30
    assert max(gaps) < 1e-6


def test_the_first_line_of_a_crossing_is_on_top():
    known = 0
    for _, scene, found in _drawn(EXACT):
        places = [
            [_node(scene, node) for node in (crossing.over, crossing.under)]
            for crossing in scene.crossings
        ]
        for meeting in (meeting for meeting in found if meeting.real):
            first = _place(meeting.passes[0])
            true = min(places, key=lambda pair: np.linalg.norm(pair[0] - first))
            if sum(np.linalg.norm(pair[0] - first) < 2.0 * scene.width_px for pair in places) == 1:
                along = [_direction(strand) for strand in meeting.passes]
                crossing = scene.crossings[[pair[0] is true[0] for pair in places].index(True)]
                upper = _scene_direction(scene, crossing.over)
                assert abs(along[0] @ upper) > 0.95
                known += 1
    assert known > 8


def _node(scene, place):
    line = scene.cables[place[0]].points_px
    return np.array([np.interp(place[1], np.arange(len(line)), axis) for axis in line.T])


def _scene_direction(scene, place):
    line, node = scene.cables[place[0]].points_px, int(place[1])
    chord = line[min(node + 1, len(line) - 1)] - line[node]
    return chord / np.linalg.norm(chord)


def _direction(strand):
    path = path_through(strand, 1.0, 0.5)
    return (path[-1] - path[0]) / np.linalg.norm(path[-1] - path[0])


def test_lines_go_over_where_as_a_rule_no_strands_cross():
    apart = []
    for _, scene, found in _drawn(EXACT, range(20)):
        for meeting in (meeting for meeting in found if not meeting.real):
            place = _place(meeting.passes[0])
            gaps = [
                np.linalg.norm(_node(scene, crossing.over) - place) for crossing in scene.crossings
            ]
            apart.append(min(gaps, default=np.inf) > scene.width_px)
    assert len(apart) > 5
    # Elsewhere a third strand crosses one of them.
    assert np.mean(apart) > 0.6


def test_a_task_draws_what_its_network_reads():
    torch.manual_seed(0)
    for task in (CrossingTask(), ThesisCrossingTask()):
        batch = next(task.batches(5, 0, 1, 16))
        figures = task.metrics(task.network(), [batch])
        assert len(batch[0]) == 16
        assert 0.0 < figures["loss"] < 2.0
        assert float(task.loss(task.network(), batch).detach()) > 0.0


def test_both_views_of_a_crossing_are_of_one_image():
    for rng, scene, found in _drawn(EXACT):
        ribbons = scene_ribbons(rng, scene, found)
        assert len(ribbons) == len(found)
        for pair in ribbons:
            assert abs(float(pair[:, 0].mean())) < 0.2
            # Each ribbon's middle place is on both lines.
            assert np.abs(pair[:, 1, 32, 12]).max() < 0.2
        for visits in crossing_visits(rng, scene):
            assert visits.shape == (2, 3, 20, 20)
            assert visits.min() >= 0.0
            assert visits.max() <= 1.0
