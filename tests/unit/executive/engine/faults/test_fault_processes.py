"""Commands in processes of their own: how each ended, and that none outlives the campaign."""

import os
import signal
import subprocess
import sys
import time

import pytest

from executive.engine.faults.processes import Processes

LONG_S = 60.0


def python(text):
    return [sys.executable, "-c", text]


def alive(file):
    try:
        os.kill(int(file.read_text() or 0), 0)
    except ProcessLookupError:
        return False
    return True


def interrupted_after_the_first(runs):
    for _ in runs:
        raise KeyboardInterrupt


def test_each_ends_as_it_does_and_one_that_dies_loses_only_itself():
    commands = [
        python("print('done')"),
        python("import sys; sys.exit('no arm')"),
        python("import os; os.kill(os.getpid(), 9)"),
    ]
    ended = dict(Processes(2, LONG_S).run(commands))
    assert [ended[place].code for place in range(3)] == [0, 1, -9]
    assert ended[0].stdout == "done\n"
    assert ended[1].last_words == "no arm"
    assert not any(one.overdue for one in ended.values())


def test_one_that_takes_too_long_is_asked_to_end():
    text = (
        "import signal, sys, time\n"
        "signal.signal(signal.SIGTERM, lambda *_: (print('in order'), sys.exit(4)))\n"
        "time.sleep(60)"
    )
    ((_, ended),) = Processes(1, 1.0).run([python(text)])
    assert (ended.code, ended.stdout, ended.overdue) == (4, "in order\n", True)
    assert ended.wall_s < LONG_S / 2


def test_none_outlives_an_interrupt(tmp_path):
    pid = tmp_path / "pid"
    write = f"open({str(pid)!r}, 'w', buffering=1).write(f'{{os.getpid()}}\\n')"
    text = f"import os, time; {write}; time.sleep(60)"
    waits = f"import os, time\nwhile not os.path.exists({str(pid)!r}): time.sleep(0.05)"
    processes = Processes(2, LONG_S)
    with pytest.raises(KeyboardInterrupt):
        interrupted_after_the_first(processes.run([python(text), python(waits)]))
    end_s = time.monotonic() + LONG_S / 4
    while alive(pid) and time.monotonic() < end_s:
        time.sleep(0.05)
    assert not alive(pid)
    assert [ended.code for _, ended in processes.run([python("pass")])] == [0]


def test_one_that_is_tied_does_not_outlive_a_kill(tmp_path):
    pid = tmp_path / "pid"
    tied = "from executive.engine.faults.tether import tie_to_stdin; tie_to_stdin()"
    write = f"open({str(pid)!r}, 'w', buffering=1).write(f'{{os.getpid()}}\\n')"
    command = python(f"{tied}; import os, time; {write}; time.sleep(60)")
    runs = "from executive.engine.faults.processes import Processes\n"
    runs += f"list(Processes(1, 60.0).run([{command!r}]))"
    parent = subprocess.Popen(python(runs))
    end_s = time.monotonic() + LONG_S / 2
    while not (pid.exists() and pid.read_text()) and time.monotonic() < end_s:
        time.sleep(0.05)
    assert alive(pid)
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    while alive(pid) and time.monotonic() < end_s:
        time.sleep(0.05)
    assert not alive(pid)
