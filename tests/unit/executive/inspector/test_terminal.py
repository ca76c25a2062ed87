"""The inspector in the terminal: what is shown after keys, on runs of toy trees."""

import asyncio
import re
import shutil
import time

import pytest
from inspector_pilot import ROOT, looking, recorded, rows_of, screen_text, settle

from executive.engine.running.remote import CommandServer
from executive.inspector.terminal.app import InspectorApp
from executive.inspector.terminal.board import BoardRows
from executive.inspector.terminal.keys import GROUPS, TABS, bindings
from executive.inspector.terminal.told import Told

SIZES = [(80, 24), (140, 45)]


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return recorded(tmp_path_factory.mktemp("runs"), ROOT)


def shown_page(app, name):
    return "\n".join(rows_of(app.query_one(f"#{name}", Told)))


@pytest.mark.parametrize("size", SIZES)
def test_it_opens_at_the_end_and_says_why_it_ended(path, size):
    async def look(app, pilot):
        text = screen_text(app)
        assert "failure" in text
        assert f"tick {app.tick}/" in text
        assert "✗ grasp act  act.failed" in text
        assert shown_page(app, "why").startswith("t ended in failure")

    looking(path, look, size=size)


def test_arrows_home_and_end_move_through_the_ticks_and_stop_at_the_ends(path):
    async def look(app, pilot):
        last = app.tick
        for keys, tick in (
            (["right"], last), (["home"], 0), (["left"], 0), (["right", "right"], 2),
            (["left"], 1), (["shift+right"], last), (["home", "end"], last),
        ):  # fmt: skip
            await pilot.press(*keys)
            assert app.tick == tick, keys

    looking(path, look)


def test_every_tick_is_shown_as_the_recording_has_it(path):
    async def look(app, pilot):
        recording = app._opened.recording
        marks = {"RUNNING": "▶", "SUCCESS": "✓", "FAILURE": "✗", "INVALID": "·"}
        for number in range(len(recording)):
            app.go(number)
            drawn = [re.search("[▶✓✗·]", row)[0] for row in rows_of(app.tree_rows)]
            assert drawn == [marks[status] for status in recording.statuses(number)]
            keys = [app.board._shown[i] for i in range(app.board.count)]
            assert keys == list(recording.blackboard(number))

    looking(path, look)


@pytest.mark.parametrize(
    ("key", "back"), [("c", "C"), ("f", "F"), ("w", "W")], ids=["change", "failure", "write"]
)
def test_what_is_found_forwards_is_found_backwards(path, key, back):
    async def look(app, pilot):
        await pilot.press("home")
        ticks = [app.tick]
        for _ in range(app._opened.last):
            await pilot.press(key)
            await settle(app, pilot)
            ticks.append(app.tick)
        assert "nothing further" in app.prompt.said
        ticks = list(dict.fromkeys(ticks))
        assert ticks == sorted(set(ticks))
        assert len(ticks) > 1
        for tick in reversed(ticks[1:-1]):
            await pilot.press(back)
            await settle(app, pilot)
            assert app.tick == tick

    looking(path, look)


def test_a_search_goes_to_the_next_tick_and_n_to_the_one_after(path):
    async def look(app, pilot):
        recording = app._opened.recording
        asked = [
            number
            for number in range(len(recording))
            if any(w.key == "t:seen" for w in recording.tick(number).writes)
        ]
        await pilot.press("home", "e", *"wrote('seen')", "enter")
        await settle(app, pilot)
        assert app.tick == asked[0]
        assert f"{len(asked)} ticks" in app.prompt.said
        await pilot.press("n")
        await settle(app, pilot)
        assert app.tick == asked[1]
        await pilot.press("e")
        assert app.prompt.typed.value == "wrote('seen')"

    looking(path, look)


def test_a_wrong_expression_is_told_and_can_be_mended(path):
    async def look(app, pilot):
        await pilot.press("home", "e", *"sean > 2", "enter")
        await settle(app, pilot)
        assert "did you mean 'seen'" in app.prompt.said
        assert app.prompt.asking
        assert app.tick == 0
        await pilot.press(*["backspace"] * 8, *"seen > 2", "enter")
        await settle(app, pilot)
        assert app.tick > 0
        await pilot.press("e", *["backspace"] * 8, "up")
        assert app.prompt.typed.value == "seen > 2"
        await pilot.press("up")
        assert app.prompt.typed.value == "sean > 2"

    looking(path, look)


@pytest.mark.parametrize(("typed", "tick"), [("3", 3), ("0.2s", 2), ("first", 0)])
def test_g_goes_to_a_tick_or_a_time(path, typed, tick):
    async def look(app, pilot):
        await pilot.press("g", *typed, "enter")
        await settle(app, pilot)
        assert app.tick == tick
        await pilot.press("g", *"99999", "enter")
        await settle(app, pilot)
        assert "expected 0 to" in app.prompt.said
        await pilot.press("escape")
        assert not app.prompt.asking
        assert app.tick == tick

    looking(path, look)


def test_folding_and_filtering_keep_the_selected_node_in_sight(path):
    async def look(app, pilot):
        tree = app.tree_rows
        count = tree.count
        await pilot.press("down", "enter")
        assert tree.count < count
        assert "▸" in rows_of(tree)[1]
        await pilot.press("enter")
        assert tree.count == count
        await pilot.press("slash", *"grasp")
        names = [tree.outline.nodes[node].name for node in tree.outline.shown]
        assert names[-1] == "grasp"
        assert len(names) < count
        await pilot.press("enter", "down", "down", "down", "escape")
        assert tree.outline.nodes[app.node].name == "grasp"
        await pilot.press("slash", "escape")
        assert tree.count == count
        assert tree.outline.nodes[tree.selected].name == "grasp"

    looking(path, look)


def test_what_never_ran_is_folded_away(tmp_path):
    path = recorded(tmp_path, ROOT, letters={"look": "F", "grasp": "S", "open": "S"})

    async def look(app, pilot):
        tree, count = app.tree_rows, app.tree_rows.count
        await pilot.press("h")
        idle = list(tree.outline.folded)
        assert [tree.outline.nodes[node].name for node in idle] == ["get"]
        await pilot.press("h")
        assert tree.count == count

    looking(path, look)


def test_a_key_shows_who_wrote_it_and_leads_to_the_write(path):
    async def look(app, pilot):
        app.board.focus()
        await pilot.press("enter")
        await settle(app, pilot)
        page = shown_page(app, "key")
        assert "t:seen = 2.5" in page
        assert "written by look" in page
        assert "read by near" in page
        told = app.query_one("#key", Told)
        at = next(i for i, row in enumerate(rows_of(told)) if row.startswith("written by"))
        told.focus()
        told.put_cursor(at)
        await pilot.press("enter")
        await settle(app, pilot)
        assert app._opened.recording.header.nodes[app.node].name == "look"
        assert any(write.key == "t:seen" for write in app._opened.recording.tick(app.tick).writes)
        fresh = next(row for row in rows_of(app.query_one(BoardRows)) if "seen" in row)
        assert fresh.startswith("●")

    looking(path, look)


def test_the_source_is_shown_at_the_line_of_the_node(path):
    async def look(app, pilot):
        await pilot.press(str(1 + TABS.index("yaml")))
        nodes = app._opened.recording.header.nodes
        for index, node in enumerate(nodes):
            app.select(index)
            here = [row for row in rows_of(app.query_one("#yaml", Told)) if row.startswith("▸")]
            assert [int(row[1:6]) for row in here] == [node.line]

    looking(path, look)


def test_a_tick_tells_its_faults_with_traceback(tmp_path):
    from py_trees.common import Status
    from toy_runs import Leaf, record

    def broken():
        raise ValueError("broken wire")

    path = record(tmp_path / "a.mcap", Leaf("work", Status.RUNNING, broken))[0].path

    async def look(app, pilot):
        await pilot.press("home", "right", str(1 + TABS.index("tick")))
        page = shown_page(app, "tick")
        assert "! work: ValueError: broken wire" in page
        assert "Traceback" in page

    looking(path, look)


def test_the_report_is_that_of_the_command_line(path):
    async def look(app, pilot):
        await pilot.press(str(1 + TABS.index("report")))
        await settle(app, pilot)
        assert "cycle time" in shown_page(app, "report")

    looking(path, look)


def test_playing_goes_to_the_end_and_stops(path):
    async def look(app, pilot):
        await pilot.press("home", "<", "space")
        assert app.playing == "play x0.5"
        await pilot.press(">", ">", ">")
        for _ in range(100):
            await pilot.pause(0.05)
            if not app.playing:
                break
        assert app.tick == app._opened.last
        assert not app.playing

    looking(path, look)


def test_the_mouse_scrubs_selects_and_folds(path):
    async def look(app, pilot):
        await pilot.click("#lanes", offset=(12, 1))
        assert app.tick == 0
        await pilot.click("#tree", offset=(6, 2))
        assert app.node == 2
        count = app.tree_rows.count
        await pilot.click("#tree", offset=(4, 1))
        assert app.tree_rows.count < count
        await pilot.click("#tabs", offset=(12, 0))
        assert app._tab != "why"

    looking(path, look, size=(140, 45))


def test_the_help_lists_every_key_and_every_key_is_bound(path):
    bound = {binding.key for binding in bindings()}
    listed = {key.keys for keys in GROUPS.values() for key in keys}
    assert bound - listed == {str(number) for number in range(1, len(TABS) + 1)}

    async def look(app, pilot):
        await pilot.press("?")
        text = screen_text(app)
        for keys in GROUPS.values():
            for key in keys:
                assert key.told[:40] in text
        await pilot.press("escape")
        assert len(app.screen_stack) == 1

    looking(path, look, size=(100, 60))


def test_a_file_that_is_no_recording_is_said_to_be_none(tmp_path):
    (tmp_path / "a.mcap").write_bytes(b"nothing")

    async def run():
        app = InspectorApp(tmp_path / "a.mcap")
        async with app.run_test() as pilot:
            await pilot.pause(0.5)
        return app.return_value

    assert "not a readable recording" in asyncio.run(run())


class Debugger:
    """Stands for the process that runs a mission: keeps what it was told."""

    def __init__(self, node):
        self.told = []
        self.state = {
            "paused": False, "stopping": None, "standing": None, "breakpoints": [], "forced": {},
        }  # fmt: skip
        self._node = node

    def commands(self):
        names = ("state", "pause", "resume", "step", "stop", "emergency_stop", "break", "force")
        return {name: lambda asked, name=name: self._do(name, asked) for name in names}

    def _do(self, name, asked):
        if name == "state":
            return self.state
        self.told.append((name, {k: v for k, v in asked.items() if k != "by"}))
        if name == "pause":
            place = {"tick": 1, "node": self._node, "answered": False, "why": "asked to"}
            self.state = {**self.state, "paused": True, "standing": place}
        if name == "resume":
            self.state = {**self.state, "paused": False, "standing": None}
        if name == "break":
            one = {"number": 1, "text": asked["text"], "hits": 0}
            self.state = {**self.state, "breakpoints": [one]}
        return self.state


@pytest.fixture
def growing(path, tmp_path):
    """The first half of a recording, as a writer leaves it in the middle, and the whole."""
    from mcap.reader import NonSeekingReader
    from mcap.writer import CompressionType, Writer

    live = tmp_path / "live.mcap"
    with path.open("rb") as source, live.open("wb") as file:
        writer = Writer(file, compression=CompressionType.NONE, use_chunking=False)
        writer.start()
        channels = {}
        messages = [*NonSeekingReader(source).iter_messages(log_time_order=False)]
        for schema, channel, message in messages:
            if channel.topic not in channels:
                number = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.topic] = writer.register_channel(channel.topic, "json", number)
            if channel.topic == "/result" or (channel.topic == "/ticks" and message.sequence > 3):
                continue
            writer.add_message(
                channels[channel.topic], message.log_time, message.data, message.log_time,
                message.sequence,
            )  # fmt: skip
        file.flush()
        writer_bytes = live.read_bytes()
    live.write_bytes(writer_bytes)
    return live


def test_a_live_run_is_followed_commanded_and_seen_to_end(growing, path):
    async def look(app, pilot):
        await shows(app, pilot, "live")
        assert app.tick == 3
        # The run can be commanded once it has told its state.
        await shows(app, pilot, "Debug", line=None)
        await pilot.press("p")
        await shows(app, pilot, "paused")
        assert app._opened.recording.header.nodes[app.node].path == debugger._node
        await pilot.press("s", "b", "enter")
        await shows(app, pilot, "paused")
        await pilot.press("X")
        await pilot.press("n")
        await pilot.press(str(1 + TABS.index("debug")))
        await pilot.pause(0.3)
        assert "hit 0 times" in shown_page(app, "debug")
        assert [name for name, _ in debugger.told] == ["pause", "step", "break"]
        await pilot.press("X", "y")
        await pilot.press("x", "p")
        await shows(app, pilot, "live")
        assert [name for name, _ in debugger.told][3:] == ["emergency_stop", "stop", "resume"]
        shutil.copy(path, growing.with_suffix(".new"))
        growing.with_suffix(".new").replace(growing)
        await shows(app, pilot, "failure")
        assert app.tick == app._opened.last

    debugger = Debugger("t/pick/look")
    with CommandServer(growing, debugger.commands()):
        looking(growing, look, settle_first=False)


def test_a_run_that_nothing_runs_is_killed_and_takes_no_commands(growing):
    async def look(app, pilot):
        await shows(app, pilot, "killed")
        await pilot.press("p", "X")
        assert len(app.screen_stack) == 1
        assert "Debug" not in screen_text(app)

    looking(growing, look, settle_first=False)


async def shows(app, pilot, word, line=0):
    """Wait until a line, or any for None, shows a word."""
    end_s = time.monotonic() + 10.0
    while word not in (screen_text(app) if line is None else screen_text(app).splitlines()[line]):
        assert time.monotonic() < end_s, screen_text(app)
        await pilot.pause(0.05)


def test_it_can_be_left_at_any_time(path):

    async def look(app, pilot):
        await pilot.press("q")

    looking(path, look, settle_first=False)
