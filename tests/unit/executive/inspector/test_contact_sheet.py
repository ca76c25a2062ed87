"""Contact sheets show what was recorded as it was recorded."""

import numpy as np
from PIL import Image
from toy_runs import Leaf, built, header_of

from executive.engine.blackboard import Write
from executive.engine.recording.writer import RecordingWriter
from executive.engine.ticks import Tick
from executive.inspector.sheet import write_sheet


def test_colours_of_a_look_are_those_of_the_camera(tmp_path):
    tree = built(Leaf("look", []))
    look = np.full((120, 160, 3), (200, 40, 10), np.uint8)
    file, sheet = tmp_path / "run.mcap", tmp_path / "looks.png"
    with RecordingWriter(file, header_of(tree)) as writer:
        writer.on_tick(Tick(0, 0.0, 0.001, writes=(Write("toy:picture", look, "look"),)))
    write_sheet(file, sheet)
    drawn = np.asarray(Image.open(sheet))
    assert tuple(drawn[200, 100]) == (200, 40, 10)
    assert not drawn[:, 320:].any()
