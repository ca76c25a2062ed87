"""Runs the inspector without a terminal, and reads what it shows."""

import asyncio
import time

from toy_pasts import act, past

from executive.inspector.terminal.app import InspectorApp

ROOT = f"""
retry:
  times: 2
  child:
    sequence:
      name: pick
      children:
        - {act("look", value=2.5)[:-1]}, out: {{value: $seen}}}}
        - {{when: seen > 2, name: near}}
        - sequence:
            name: get
            children:
              - {act("open")}
              - {act("grasp")}
"""
LETTERS = {"look": "RS", "open": "S", "grasp": "RRF"}


def recorded(folder, root, letters=None):
    """Record a run of a toy tree and return its file."""
    return past(folder, root, letters or LETTERS).recording.path


def looking(path, look, *, size=(80, 24), settle_first=True):
    """Open a recording in the inspector, and do something with it."""

    async def run():
        app = InspectorApp(path)
        async with app.run_test(size=size) as pilot:
            if settle_first:
                await settle(app, pilot)
            await look(app, pilot)

    asyncio.run(run())


async def settle(app, pilot):
    """Wait until nothing is being read, asked or searched."""
    end_s = time.monotonic() + 20.0
    await pilot.pause(0.06)
    while any(worker.is_running for worker in app.workers):
        assert time.monotonic() < end_s
        await pilot.pause(0.01)
    await pilot.pause()


def screen_text(app):
    """Return what the screen shows, line by line."""
    strips = app.screen._compositor.render_strips()
    return "\n".join(strip.text.rstrip() for strip in strips)


def rows_of(rows):
    """Return the text of all rows of a pane."""
    return [rows.row(index).plain for index in range(rows.count)]
