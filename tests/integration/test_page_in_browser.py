"""The page in a real browser: what a person clicks, and what then stands there."""

import shutil
import threading

import pytest
from toy_runs import busy_tree, record

from executive.engine.blackboard import Blackboard
from executive.engine.recording.reader import Recording
from executive.engine.running.remote import CommandServer
from executive.inspector.web.server import PageServer, application
from executive.inspector.web.session import Session

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
# Headless, offline, and as root in containers.
FLAGS = (
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-sync"),
    *("--disable-background-networking", "--disable-component-update"),
)

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    board = Blackboard()
    file = tmp_path_factory.mktemp("run") / "run.mcap"
    record(file, busy_tree(board), board)
    return file


class Served:
    """A page that is served in a thread of its own."""

    def __init__(self, path):
        self.server = PageServer(application(Session(path)), "127.0.0.1", 0)
        self.address = f"http://127.0.0.1:{self.server.port}/"
        self._thread = threading.Thread(target=self.server.serve, daemon=True)
        self._thread.start()

    def stop(self):
        self.server.stop()
        self._thread.join(10.0)


@pytest.fixture(scope="module")
def browser():
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield chromium
        chromium.close()


@pytest.fixture
def open_page(browser, request):
    def opened(path, query=""):
        served = Served(path)
        request.addfinalizer(served.stop)
        page = browser.new_page(viewport={"width": 1400, "height": 850})
        request.addfinalizer(page.close)
        page.troubles = []
        page.on("pageerror", lambda error: page.troubles.append(str(error)))
        page.on(
            "console",
            lambda message: message.type == "error" and page.troubles.append(message.text),
        )
        page.goto(served.address + query)
        page.wait_for_selector(".row .mark:not(:empty)")
        return page

    return opened


def place(page):
    return page.text_content("#place").split()[1]


def mark(page, name):
    row = page.locator(".row", has=page.locator(f".name:text-is('{name}')"))
    return row.locator(".mark").get_attribute("class").split()[-1]


def test_the_page_opens_at_the_end_with_the_outcome(open_page, path):
    page, recording = open_page(path), Recording.open(path)
    assert page.text_content("#outcome") == "failure"
    assert place(page) == str(len(recording) - 1)
    assert page.is_hidden("#commands")
    assert page.troubles == []


def test_keys_and_buttons_move_through_the_ticks(open_page, path):
    page, recording = open_page(path, "?tick=100"), Recording.open(path)
    paths = [node.path for node in recording.header.nodes]
    for key, tick in (("ArrowRight", 101), ("ArrowLeft", 100), ("Home", 0)):
        page.keyboard.press(key)
        page.wait_for_function(f"document.querySelector('#place').value.startsWith('tick {tick} ')")
    page.click("#forward")
    page.wait_for_function("document.querySelector('#place').value.startsWith('tick 1 ')")
    guard = recording.statuses(1)[paths.index("mission/wait/guard")]
    assert mark(page, "guard") == guard.value
    assert page.troubles == []


def test_a_click_into_the_lanes_goes_there_and_selects_the_node(open_page, path):
    page, recording = open_page(path), Recording.open(path)
    box = page.locator("#codes").bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 5)
    last = f"tick {len(recording) - 1} "
    page.wait_for_function(f"!document.querySelector('#place').value.startsWith('{last}')")
    assert abs(int(place(page)) - len(recording) / 2) < 5
    assert "selected" in page.locator(".row").first.get_attribute("class")


def test_why_names_the_leaf_and_leads_there(open_page, path):
    page = open_page(path, "?tick=300")
    page.locator(".row", has_text="wait").click()
    page.click("[data-tab=why]")
    page.wait_for_selector("#why .answer")
    page.locator("#why .chain a").first.click()
    page.wait_for_selector(".row.selected")
    assert page.troubles == []


def test_a_search_finds_a_tick_and_bad_words_are_answered(open_page, path):
    page = open_page(path, "?tick=0")
    page.fill("#expression", "count > 100")
    page.click("#search button")
    page.wait_for_function("!document.querySelector('#place').value.startsWith('tick 0 ')")
    page.fill("#expression", "count >")
    page.click("#search button")
    page.wait_for_function("document.querySelector('#note').textContent.includes('expression')")


def test_the_blackboard_shows_who_wrote_a_value(open_page, path):
    page = open_page(path, "?tick=300")
    page.locator("#states tr").first.click()
    page.wait_for_function("document.querySelector('#value').textContent.includes('written by')")
    assert "guard" in page.text_content("#value")


def test_tree_folds_and_filters(open_page, path):
    page = open_page(path, "?tick=300")
    assert page.locator(".row").count() == 5
    page.locator(".row .twist").nth(1).click()
    assert page.locator(".row").count() == 3
    page.fill("#filter", "hold")
    assert page.locator(".row.hit").count() == 1
    page.fill("#filter", "")
    page.click("#unfold")
    page.click("[data-tab=graph]")
    assert page.locator("#graph .box").count() == 5


def test_a_live_run_is_followed_and_commanded(open_page, path, tmp_path):
    whole, growing = path.read_bytes(), tmp_path / "growing.mcap"
    growing.write_bytes(whole[: len(whole) // 2])
    state = {"paused": False, "stopping": "", "standing": None, "breakpoints": [], "forced": {}}

    def pause(_):
        state.update(
            paused=True, standing={"why": "test", "tick": 5, "node": "", "answered": False}
        )
        return state

    def add(sent):
        state["breakpoints"] = [{"number": 1, "text": sent["text"], "hits": 0}]
        return state

    commands = {"pause": pause, "break": add, "state": lambda _: state}
    with CommandServer(growing, commands):
        page = open_page(growing)
        page.wait_for_function("document.querySelector('#outcome').textContent === 'live'")
        before = int(place(page))
        page.click("[data-command=pause]")
        page.wait_for_function("document.querySelector('#outcome').textContent === 'paused'")
        page.click("[data-tab=debug]")
        page.fill("#debug input", "guard on failure")
        page.click("#debug form button")
        page.wait_for_selector("#debug li code:has-text('guard on failure')")
        with growing.open("ab") as file:
            file.write(whole[len(whole) // 2 :])
        page.wait_for_function("document.querySelector('#outcome').textContent === 'failure'")
    page.wait_for_function(
        f"Number(document.querySelector('#place').value.split(' ')[1]) > {before}"
    )
    assert page.is_hidden("#commands")
    assert page.troubles == []


def test_a_run_whose_process_is_gone_is_called_killed(open_page, path, tmp_path):
    whole, cut = path.read_bytes(), tmp_path / "cut.mcap"
    cut.write_bytes(whole[: len(whole) // 2])
    page = open_page(cut)
    page.wait_for_function("document.querySelector('#outcome').textContent === 'killed'")
    assert page.is_hidden("#commands")
