"""The page on drivers: its examples run, its tables are those of the code."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np

from executive.core.world import StreamMessage
from executive.engine.recording.messages import MissionHeader
from executive.engine.recording.writer import RecordingWriter
from robots.drivers import messages
from robots.drivers.link import LinkSettings
from robots.interfaces import ArmsState
from robots.placement import HOME_RAD
from simulation.loopback.settings import LoopbackSettings
from simulation.streams import joint_states_json

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "drivers.md").read_text(encoding="utf-8")
SNIPPETS = re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
COMMANDS = re.findall(r"^```sh\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
SUITE = (ROOT / "tests" / "contract" / "test_arms_driver.py").read_text(encoding="utf-8")


def section(title):
    return re.search(rf"^## {title}\n(.*?)(?=^## |\Z)", PAGE, re.MULTILINE | re.DOTALL)[1]


def cells(text):
    """Return the cells of the rows of a section's tables."""
    rows = re.findall(r"^\| (.*) \|$", text, re.MULTILINE)
    return [row.split(" | ") for row in rows if not row.startswith(("rule", "name"))]


def words(text):
    return re.findall(r"`(\w+)`", text)


def test_the_example_with_a_planner_runs():
    exec(compile(SNIPPETS[0], "docs/drivers.md, example 1", "exec"), {})


def test_the_rig_of_the_page_passes(tmp_path):
    (tmp_path / "rigs").mkdir()
    (tmp_path / "rigs" / "my_rig.py").write_text(SNIPPETS[1])
    assignment, _, *arguments = shlex.split(COMMANDS[1])
    name, _, folder = assignment.partition("=")
    done = subprocess.run(
        [sys.executable, *arguments, "-k", "begins or rests_does", "-p", "no:cacheprovider"],
        cwd=ROOT, env={**os.environ, name: str(tmp_path / folder)},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    assert "passed" in done.stdout


def test_the_command_of_the_page_starts_a_controller():
    command = shlex.split(COMMANDS[0].replace("port=5600", "port=0"))
    with subprocess.Popen(
        [sys.executable, *command[1:], "--until-input-ends"],
        cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        assert process.stdout.readline().startswith("listening on ")
        process.stdin.close()
        assert process.wait(20.0) == 0


def test_the_example_with_a_recording_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    still = ArmsState(HOME_RAD, 0 * HOME_RAD, 0 * HOME_RAD, {"left": 0.05, "right": 0.05}, False, 0)
    data = joint_states_json(still)
    header = MissionHeader(
        format=1, mission="m", seed=0, tick_hz=10.0, timeout_s=None, nodes=(), started_utc="now"
    )
    with RecordingWriter(Path("runs/demo.mcap"), header) as writer:
        writer.on_streams([StreamMessage("/joint_states", "JointStates", 1.0, data)])
    names = {}
    exec(compile(SNIPPETS[2], "docs/drivers.md, example 3", "exec"), names)
    assert np.allclose(names["state"].positions_rad, HOME_RAD, atol=1e-4)


def test_every_rule_names_its_tests_and_every_test_has_a_rule():
    named = [word for _, tests in cells(section("What a driver owes")) for word in words(tests)]
    assert sorted(named) == sorted(re.findall(r"^def test_(\w+)", SUITE, re.MULTILINE))


def test_every_setting_is_told_with_its_default():
    rows = [row for row in cells(section("A controller to try things on")) if len(row) == 2]
    assert [name for names, _ in rows for name in words(names)] == [*LoopbackSettings.model_fields]
    told = {words(name)[0]: about.rsplit("; ", 1)[-1] for name, about in rows}
    defaults = LoopbackSettings()
    for name in ("cycle_s", "silence_s", "overrun_s"):
        assert float(told[name]) == getattr(defaults, name)


def test_every_message_is_told_with_its_fields():
    told = {}
    for kinds, fields, _ in (row for row in cells(section("The protocol")) if len(row) == 3):
        told.update({kind: words(fields) for kind in words(kinds)})
    kinds = [
        kind for kind in vars(messages).values() if "kind" in getattr(kind, "model_fields", {})
    ]
    assert told == {
        kind.model_fields["kind"].default: [name for name in kind.model_fields if name != "kind"]
        for kind in kinds
    }
    assert f"Version {messages.VERSION} is" in PAGE


def test_the_times_of_a_driver_are_those_of_the_code():
    settings = LinkSettings()
    assert f"not taken after {settings.resend_s:g} s" in PAGE
    assert f"beats every {settings.beat_s:g} s" in PAGE
