"""A run on the shelf cell as it is shown: arm and boxes, and no cable."""

import base64
import json
import re

import numpy as np
import pytest

from executive.app.scenes import SHELF_EYE, SceneFollower
from robots.descriptions import DESCRIPTIONS
from robots.shelf_arm.scene import ROBOT, ShelfSize, open_scene
from robots.viewer import Stage, write_html
from robots.viewer.html import METRE
from simulation.shelf_cell.cell import ShelfCell


def test_replay_shows_the_arm_and_every_box_where_it_is(tmp_path) -> None:
    cell = ShelfCell({}, {"count": 6}, 2)
    follower = SceneFollower()
    for message in cell.drain_streams():
        if message.topic == "/scene":
            follower.on_stream(message)
    frame = follower.frame(0.0)
    truth = cell.truth()
    cell.close()
    assert frame is not None
    assert set(frame.boxes) == set(truth.poses)
    stage = Stage(DESCRIPTIONS[ROBOT](), open_scene(ShelfSize()), SHELF_EYE)
    path = tmp_path / "run.html"
    write_html(stage, [frame], path)
    page = path.read_text(encoding="utf-8")
    found = re.search(r'id="recording"[^>]*>(.*?)</script>', page)
    assert found is not None
    recording = json.loads(found[1])
    row = np.frombuffer(base64.b64decode(recording["frames"]), dtype="<i2")
    assert len(row) == 7 * len(recording["links"]) == recording["width"]
    for name, pose in truth.poses.items():
        at = 7 * recording["links"].index(name)
        assert row[at : at + 3] * METRE == pytest.approx(pose[:3], abs=2 * METRE)
