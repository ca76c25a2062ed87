from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("torch")

from benchmarks.crossing_scenes import drawn_scenes, settled_scenes
from benchmarks.crossings import judged, scored
from benchmarks.photographs import LabelledImage
from perception.cable.crossings import decide, find_sites
from perception.cable.types import Crossing, Trace, TraceEnd


def _turned(crossing):
    return replace(
        crossing,
        trace_over=crossing.trace_under,
        arc_over=crossing.arc_under,
        trace_under=crossing.trace_over,
        arc_under=crossing.arc_over,
    )


@pytest.mark.parametrize("source", ["drawn", "camera", "strokes"])
def test_what_is_right_one_way_round_is_wrong_the_other(source):
    scenes = drawn_scenes(3, 5) if source == "drawn" else settled_scenes(source, 3, 2)
    total = 0
    for scene in scenes:
        found = [decide(site, 0.9) for site in find_sites(scene.traces, scene.width_px)]
        there = [answer.right for answer in scored(scene, found)]
        back = [answer.right for answer in scored(scene, [_turned(item) for item in found])]
        assert there == [not right for right in back]
        total += len(there)
    assert total > 2


def test_the_truth_itself_is_right():
    for scene in drawn_scenes(4, 4, exact=True):
        answers = scored(
            scene,
            [Crossing(np.zeros(2), *true.over, *true.under, 0.7) for true in scene.crossings],
        )
        assert all(answer.right and answer.probability == 0.7 for answer in answers)
        assert len(answers) >= 0.5 * len(scene.crossings)


def test_labels_say_which_cable_is_on_top():
    labels = np.zeros((60, 60), np.uint8)
    labels[27:33] = 1
    labels[:, 27:33] = 2
    lines = ([[2.0, 30.0], [58.0, 30.0]], [[30.0, 2.0], [30.0, 58.0]])
    traces = [Trace(np.array(line), TraceEnd.EDGE, 1.0) for line in lines]
    image = LabelledImage(np.zeros((60, 60, 3), np.uint8), labels)
    (site,) = find_sites(traces, 6.0)
    for belief, right in ((0.9, False), (0.1, True)):
        assert judged(image, traces, [decide(site, belief)]) == [right]
    # A line on the table crosses no second cable.
    traces[0] = Trace(np.array([[2.0, 10.0], [58.0, 10.0]]), TraceEnd.EDGE, 1.0)
    (site,) = find_sites(traces, 6.0)
    assert judged(image, traces, [decide(site, 0.9)]) == []
