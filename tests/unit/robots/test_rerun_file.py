"""A file for Rerun holds the cell, each thing where it was and when."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from executive.core.errors import RecordingError
from robots.descriptions.model import Capsule
from robots.descriptions.yumi import yumi
from robots.placement import table_scene
from robots.viewer.frame import SceneFrame
from robots.viewer.rerun_file import TIMELINE, RerunFile

rerun = pytest.importorskip("rerun")
HAND = "left_gripper_base"


def frame(time_s, height_m):
    pose = np.array([0.1, 0.2, height_m, 0.0, 0.0, 0.0, 1.0])
    cable_m = np.column_stack([np.linspace(0.0, 0.3, 31), np.zeros((31, 2))])
    return SceneFrame(time_s, {HAND: pose}, cable_m, 0.0035)


def written(path, frames=()):
    with RerunFile(path, "a run") as file:
        file.set_stage(yumi(), table_scene())
        for each in frames:
            file.show(each)
        file.curve("joints/left_joint_1", [0.0, 0.5, 1.0], [0.1, 0.2, 0.3])
        file.text("doing", 0.5, "look")
    return rerun.chunk.RrdReader(str(path)).stream().to_chunks()


def columns(chunks, entity, static=False):
    """Return the columns of an entity by name, as lists over its rows."""
    found = {}
    for chunk in chunks:
        if chunk.entity_path == entity and chunk.is_static == static:
            for name, values in chunk.to_record_batch().to_pydict().items():
                found.setdefault(name, []).extend(values)
    return found


def column(chunks, entity, ending, static=False):
    (found,) = (
        values for name, values in columns(chunks, entity, static).items() if name.endswith(ending)
    )
    return found


def test_every_link_and_box_is_there_once_and_for_all(tmp_path):
    chunks = written(tmp_path / "run.rrd")
    still = {chunk.entity_path for chunk in chunks if chunk.is_static}
    links = [link for link in yumi().links if link.shapes]
    assert {f"/world/cell/{box.name}" for box in table_scene().boxes} <= still
    for link in links:
        kinds = {"capsules" if isinstance(one, Capsule) else "boxes" for one in link.shapes}
        assert {f"/world/robot/{link.name}/{kind}" for kind in kinds} <= still


def test_capsules_reach_from_end_to_end(tmp_path):
    chunks = written(tmp_path / "run.rrd")
    for link in yumi().links:
        capsules = [shape for shape in link.shapes if isinstance(shape, Capsule)]
        if not capsules:
            continue
        entity = f"/world/robot/{link.name}/capsules"
        (lengths_m,) = column(chunks, entity, ":lengths", static=True)
        (starts_m,) = column(chunks, entity, ":translations", static=True)
        (quats_xyzw,) = column(chunks, entity, ":quaternions", static=True)
        along_m = np.column_stack([*np.zeros((2, len(capsules))), lengths_m])
        ends_m = np.array(starts_m) + Rotation.from_quat(quats_xyzw).apply(along_m)
        assert starts_m == pytest.approx(np.array([one.start_m for one in capsules]), abs=1e-6)
        assert ends_m == pytest.approx(np.array([one.end_m for one in capsules]), abs=1e-6)


def test_a_link_is_written_when_it_has_moved(tmp_path):
    heights_m = [0.3, 0.3, 0.4, 0.4, 0.3]
    frames = [frame(0.1 * number, height_m) for number, height_m in enumerate(heights_m)]
    chunks = written(tmp_path / "run.rrd", frames)
    places = column(chunks, f"/world/robot/{HAND}", ":translation")
    assert [place[0][2] for place in places] == pytest.approx([0.3, 0.4, 0.3])
    times = column(chunks, f"/world/robot/{HAND}", TIMELINE)
    assert [time.total_seconds() for time in times] == pytest.approx([0.0, 0.2, 0.4])
    assert len(column(chunks, "/world/cable", ":strips")) == 5


def test_curves_and_texts_have_their_times(tmp_path):
    chunks = written(tmp_path / "run.rrd")
    assert column(chunks, "/joints/left_joint_1", ":scalars") == [[0.1], [0.2], [0.3]]
    assert column(chunks, "/doing", ":text") == [["look"]]


def test_a_file_that_cannot_be_written_is_an_error(tmp_path):
    with pytest.raises(RecordingError, match="cannot write it; got No such file"):
        RerunFile(tmp_path / "missing" / "run.rrd", "a run")
