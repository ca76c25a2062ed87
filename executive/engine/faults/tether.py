"""Ties a process to the one that started it: when that one is killed, this one ends, too."""

import os
import select
import signal
import threading

TETHER = "tether"
"""Name of the thread that watches."""

_STDIN = 0


def tie_to_stdin(number: signal.Signals = signal.SIGKILL) -> None:
    """End this process and all of its group when the writers of standard input are gone.

    Whoever starts it holds the other end of a pipe; the system closes it whatever that process
    dies of. Nothing is read from it here.

    Args:
        number: What they are ended by: SIGTERM stops a mission in order.
    """
    threading.Thread(target=_watch, args=(number,), name=TETHER, daemon=True).start()


def _watch(number: signal.Signals) -> None:
    poll = select.poll()
    poll.register(_STDIN, 0)  # an end is told without being asked for
    poll.poll()
    os.killpg(os.getpgid(0), number)
