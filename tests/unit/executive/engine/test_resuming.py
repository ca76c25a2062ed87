"""A run that goes on from any of its checkpoints is the run that never was interrupted."""

import numpy as np
import pytest
from killed_toys import Part, RealCell, WorldCell, resume, run, write_mission

from executive.core.errors import InputError
from executive.engine.checkpoints.choosing import checkpoints
from executive.engine.checkpoints.resuming import Consent
from executive.engine.recording.decoding import decode
from executive.engine.recording.fingerprint import status_fingerprint

# Checkpoints below every kind of node that remembers something.
TREES = {
    "sequence": """
        sequence:
          - {skill: work, name: one, in: {label: one}, out: {part: $part}}
          - {set: {seen: part.name}}
          - {skill: work, name: two, checkpoint: true, in: {label: $seen, ticks: 3}}
          - {skill: work, name: three, checkpoint: true, in: {label: three, ticks: 2}}
        """,
    "selector": """
        selector:
          - {skill: work, name: one, in: {label: one, fails: 9}}
          - sequence:
              checkpoint: true
              children:
                - {skill: work, in: {label: two, ticks: 2}}
                - {skill: work, name: no, checkpoint: true, in: {label: no, fails: 9}}
          - {skill: work, name: last, checkpoint: true, in: {label: last, ticks: 2}}
        """,
    "loops": """
        retry:
          times: 4
          delay_s: 0.25
          child:
            repeat:
              times: 2
              child:
                sequence:
                  - {skill: work, checkpoint: true, in: {label: a, ticks: 2}}
                  - {skill: work, name: b, checkpoint: true, in: {label: b, fails: 3}}
        """,
    "for_each": """
        for_each:
          item: $item
          in: $list
          child: {skill: work, checkpoint: true, in: {label: $item, ticks: 2}}
        """,
    "clocks": """
        sequence:
          - timeout:
              seconds: 0.95
              child:
                sequence:
                  - {skill: work, in: {label: a, ticks: 3}}
                  - {skill: work, name: b, checkpoint: true, in: {label: b, ticks: 4}}
          - force_success:
              child:
                timeout:
                  seconds: 0.35
                  child: {skill: work, name: late, checkpoint: true, in: {label: c, ticks: 9}}
          - retry:
              times: 20
              child:
                sequence:
                  - {skill: work, name: d, checkpoint: true, in: {label: d}}
                  - {cooldown: {seconds: 0.4, child: {skill: work, in: {label: e}}}}
                  - {skill: work, name: f, in: {label: f, fails: 2}}
        """,
    "once": """
        retry:
          times: 5
          child:
            sequence:
              - {run_once: {child: {skill: work, in: {label: only}}}}
              - {skill: work, name: b, checkpoint: true, in: {label: b, fails: 2}}
        """,
    "parallel": """
        parallel:
          succeed: 2
          fail: 2
          children:
            - {skill: work, name: a, in: {label: a}}
            - {skill: work, name: b, in: {label: b, fails: 9}}
            - sequence:
                - {wait: 0.35}
                - {skill: work, name: c, checkpoint: true, in: {label: c, ticks: 3}}
        """,
    "guards": """
        sequence:
          - {set: {n: 0}}
          - retry:
              times: 5
              child:
                sequence:
                  if: n < 3
                  while: n < 9
                  on_failure: {n: n + 1}
                  on_success: {n: n + 10}
                  children:
                    - {skill: work, checkpoint: true, in: {label: a, ticks: 2}}
                    - {skill: work, name: b, in: {label: b, fails: 2}}
        """,
    "reactive": """
        reactive_sequence:
          - {when: size(list) == 3}
          - reactive_selector:
              - {when: size(list) == 4}
              - {skill: work, checkpoint: true, in: {label: a, ticks: 4}}
        """,
    "chance": """
        retry:
          times: 30
          child:
            sequence:
              - {skill: draw, out: {drawn: $drawn}}
              - {skill: draw, name: again, checkpoint: true, out: {drawn: $drawn}}
              - {chance: 0.3}
        """,
    "choosing": """
        repeat:
          times: 2
          child:
            if_then_else:
              - {when: size(list) == 3}
              - sequence:
                  - {skill: work, in: {label: a}}
                  - {skill: work, name: b, checkpoint: true, in: {label: b, ticks: 2}}
              - {skill: work, name: c, in: {label: c}}
        """,
    "root": "{skill: work, checkpoint: true, in: {label: a, ticks: 3}}",
    "unset": """
        sequence:
          - {set: {a: 1, b: 2}}
          - {skill: work, in: {label: x, ticks: 2}}
          - {unset: a}
          - {skill: work, name: y, checkpoint: true, in: {label: y}}
          - {when: not written(a) and b == 2}
        """,
}


# A selector forgets its failed children with the tick after theirs, a resumed one at once.
FORGETS_EARLIER = ("selector",)


def gone_on(recording, tick):
    """Return what was visited in the ticks after one, and all statuses after each."""
    later = range(tick + 1, len(recording))
    return [(recording.tick(i).visited, recording.statuses(i)) for i in later]


def held_at_the_end(recording):
    """Return every value with its writer and its tick; images by what they show."""
    held = recording.blackboard(len(recording) - 1).items()
    return {
        key: (repr(decode(state.value, recording, (Part,))), state.writer, state.tick)
        for key, state in held
    }


@pytest.mark.parametrize("name", TREES)
def test_every_checkpoint_leads_to_the_same_end_tick_for_tick(tmp_path, name):
    file = write_mission(tmp_path, TREES[name])
    whole, cell = run(file, tmp_path / "whole.mcap")
    found = checkpoints(whole)
    assert found
    assert not any(info.message.refused for info in found)
    for info in found:
        again, other = resume(whole.path, tmp_path / "again.mcap", wanted=str(info))
        tick = info.message.progress.tick
        assert gone_on(again, tick) == gone_on(whole, tick), str(info)
        if name not in FORGETS_EARLIER:
            assert status_fingerprint(again) == status_fingerprint(whole), str(info)
        assert other.world.journal == cell.world.journal
        assert other.clock.now_s() == cell.clock.now_s()
        assert again.header.resumed_from.tick == tick
        assert held_at_the_end(again) == held_at_the_end(whole)
        assert [str(each) for each in checkpoints(again)] == [str(each) for each in found]
        before, after = whole.result.report, again.result.report
        assert (after.outcome, after.ticks) == (before.outcome, before.ticks)
        assert after.actions == before.actions
        assert after.sim_s == before.sim_s


def test_a_resumed_run_can_be_resumed(tmp_path):
    file = write_mission(tmp_path, TREES["loops"])
    whole, _ = run(file, tmp_path / "whole.mcap")
    names = [str(info) for info in checkpoints(whole)]
    path = whole.path
    for i, name in enumerate(names):
        again, _ = resume(path, tmp_path / f"{i}.mcap", wanted=name)
        path = again.path
    assert status_fingerprint(again) == status_fingerprint(whole)
    assert again.header.resumed_from.file == str(tmp_path / f"{len(names) - 2}.mcap")


def test_values_come_back_as_what_they_were(tmp_path):
    file = write_mission(
        tmp_path,
        """
        sequence:
          - {skill: work, in: {label: one}, out: {part: $part}}
          - {skill: work, name: two, checkpoint: true, in: {label: $part.name, ticks: 2}}
          - {when: part.name == "one"}
        """,
    )
    whole, _ = run(file, tmp_path / "whole.mcap")
    again, _ = resume(whole.path, tmp_path / "again.mcap", wanted="two")
    assert again.result.report.outcome == "success"
    images = [np.array(again.image(image.number)) for image in again.images()]
    assert len(images) == len(list(whole.images()))


def test_a_checkpoint_where_something_is_held_is_none(tmp_path):
    file = write_mission(
        tmp_path,
        """
        sequence:
          - {skill: work, name: first, checkpoint: true, in: {label: a}}
          - {skill: hold, in: {what: a cup}}
          - {skill: work, name: second, checkpoint: true, in: {label: b}}
          - {skill: work, name: bad, in: {label: c, fails: 1}}
        """,
    )
    whole, _ = run(file, tmp_path / "whole.mcap")
    assert [info.message.refused for info in checkpoints(whole)] == ["", "the toy holds a cup"]
    with pytest.raises(InputError, match=r"m/second@\d cannot be gone on from: the toy holds"):
        resume(whole.path, tmp_path / "again.mcap", wanted="second")


def test_a_leaf_that_runs_beside_a_checkpoint_cannot_be_taken_up(tmp_path):
    file = write_mission(
        tmp_path,
        """
        parallel:
          - {skill: work, name: long, in: {label: long, ticks: 9}}
          - sequence:
              - {skill: work, name: short, in: {label: short, ticks: 2}}
              - {skill: work, name: safe, checkpoint: true, in: {label: safe}}
        """,
    )
    whole, _ = run(file, tmp_path / "whole.mcap")
    with pytest.raises(InputError, match="m/long: still ran, and cannot be taken up again"):
        resume(whole.path, tmp_path / "again.mcap", wanted="safe")


def test_a_cell_that_cannot_be_put_back_is_taken_as_it_stands_only_when_told(tmp_path):
    file = write_mission(tmp_path, TREES["clocks"])
    whole, _ = run(file, tmp_path / "whole.mcap", RealCell())
    with pytest.raises(InputError, match=r"cannot be put back .* try --as-it-stands"):
        resume(whole.path, tmp_path / "again.mcap", wanted="d", cell=RealCell())


def test_a_cell_taken_as_it_stands_goes_on_in_the_time_of_the_mission(tmp_path):
    file = write_mission(tmp_path, TREES["clocks"])
    whole, _ = run(file, tmp_path / "whole.mcap", RealCell())
    cell = RealCell()
    cell.clock.sleep_until(1000.0)
    cell.world.journal[:] = ["a starts", "a ends"]
    consent = Consent(as_it_stands=True)
    again, _ = resume(whole.path, tmp_path / "x.mcap", wanted="b", cell=cell, consent=consent)
    before, after = whole.result.report, again.result.report
    assert after.outcome == before.outcome
    assert after.sim_s == pytest.approx(before.sim_s, abs=0.11)  # clocks round differently
    times_s = [message.time_s for message in again.streams()]
    assert times_s == sorted(times_s)
    assert times_s[-1] == pytest.approx(before.sim_s, abs=0.11)


def test_the_timeout_of_the_mission_goes_on(tmp_path):
    root = """
        sequence:
          - {skill: work, in: {label: a, ticks: 10}}
          - {skill: work, name: b, checkpoint: true, in: {label: b, ticks: 50}}
        """
    whole, _ = run(write_mission(tmp_path, root, timeout_s=2.0), tmp_path / "whole.mcap")
    again, _ = resume(whole.path, tmp_path / "again.mcap")
    assert whole.result.report.outcome == again.result.report.outcome == "timeout"
    assert status_fingerprint(again) == status_fingerprint(whole)


def test_a_mission_that_ended_is_not_resumed_unless_from_a_checkpoint_that_is_named(tmp_path):
    whole, _ = run(write_mission(tmp_path, TREES["sequence"]), tmp_path / "whole.mcap")
    with pytest.raises(InputError, match=r"ended with success after \d+ ticks.*--from m/three@"):
        resume(whole.path, tmp_path / "again.mcap")
    with pytest.raises(InputError, match=r"no checkpoint 'tree'; did you mean 'm/three@"):
        resume(whole.path, tmp_path / "again.mcap", wanted="tree")
    for wanted in ("m/two", "two", "two@0", "@0"):
        again, _ = resume(whole.path, tmp_path / "again.mcap", wanted=wanted)
        assert again.header.resumed_from.node == "m/two"


def test_a_mission_without_a_checkpoint_says_so(tmp_path):
    root = """
        sequence:
          - {skill: work, in: {label: a, ticks: 99}}
          - {skill: work, checkpoint: true, in: {label: b}}
        """
    whole, _ = run(write_mission(tmp_path, root, timeout_s=0.5), tmp_path / "whole.mcap")
    with pytest.raises(
        InputError, match=r"no checkpoint yet; the run was over before m/work_2 \(.*m.yaml:"
    ):
        resume(whole.path, tmp_path / "again.mcap")
    root = "{skill: work, in: {label: a, ticks: 99}}"
    whole, _ = run(write_mission(tmp_path, root, timeout_s=0.5), tmp_path / "whole.mcap")
    with pytest.raises(InputError, match="no node of this mission says 'checkpoint: true'"):
        resume(whole.path, tmp_path / "again.mcap")


def test_changed_files_are_refused_with_their_lines(tmp_path):
    root = TREES["sequence"]
    file = write_mission(tmp_path, root)
    whole, _ = run(file, tmp_path / "whole.mcap")
    file.write_text(file.read_text().replace("ticks: 3", "ticks: 4"))
    with pytest.raises(InputError, match=r"m.yaml:\d+: was '.*ticks: 3.*', is '.*ticks: 4"):
        resume(whole.path, tmp_path / "again.mcap", wanted="two")
    again, _ = resume(
        whole.path, tmp_path / "again.mcap", wanted="two", consent=Consent(anyway=True)
    )
    assert again.result.report.ticks == whole.result.report.ticks + 1


def test_other_nodes_are_refused_whatever_is_consented_to(tmp_path):
    file = write_mission(tmp_path, TREES["sequence"])
    whole, _ = run(file, tmp_path / "whole.mcap")
    file.write_text(file.read_text().replace("name: two", "name: zwei"))
    with pytest.raises(InputError, match=r"m/two\.checkpoint is gone; m/two is gone; .* is new"):
        resume(whole.path, tmp_path / "x.mcap", wanted="two", consent=Consent(anyway=True))
    file.unlink()
    with pytest.raises(InputError, match="cannot be loaded as it was recorded"):
        resume(whole.path, tmp_path / "x.mcap", wanted="two")


def test_a_value_that_was_not_kept_is_named(tmp_path, monkeypatch):
    file = write_mission(
        tmp_path,
        """
        sequence:
          - {skill: work, in: {label: one}, out: {part: $part}}
          - {skill: work, name: two, checkpoint: true, in: {label: two}}
        """,
    )
    monkeypatch.setattr(
        "executive.engine.recording.large.LargeValues.image", lambda *_: None, raising=True
    )
    whole, _ = run(file, tmp_path / "whole.mcap")
    with pytest.raises(InputError, match=r"m:part: a value of type 'image' was not kept"):
        resume(whole.path, tmp_path / "again.mcap", wanted="two")
    again, _ = resume(
        whole.path, tmp_path / "again.mcap", wanted="two", consent=Consent(anyway=True)
    )
    assert again.result.report.outcome == "success"


def test_another_cell_is_refused(tmp_path):
    class OtherCell(WorldCell):
        def restore(self, snapshot):
            raise InputError("another cable")

    whole, _ = run(write_mission(tmp_path, TREES["sequence"]), tmp_path / "whole.mcap")
    with pytest.raises(InputError, match="another cable"):
        resume(whole.path, tmp_path / "again.mcap", wanted="two", cell=OtherCell())


def test_a_checkpoint_stands_inside_the_guards_and_has_a_path_of_its_own(tmp_path):
    root = "{skill: work, checkpoint: true, if: size(list) == 4, in: {label: a}}"
    whole, _ = run(write_mission(tmp_path, root), tmp_path / "whole.mcap")
    paths = [(node.path, node.kind, node.type) for node in whole.header.nodes]
    assert paths == [
        ("m.guard", "guard", "guard"),
        ("m.checkpoint", "checkpoint", "checkpoint"),
        ("m", "skill", "work"),
    ]
    assert checkpoints(whole) == ()  # a node that does not start has none
