"""Ties a process to the one that started it: when that one is killed, this one ends, too."""

import os
import signal
import threading

_STDIN = 0


def tie_to_stdin(number: signal.Signals = signal.SIGKILL) -> None:
    """End this process and all of its group when standard input comes to its end.

    Whoever starts it holds the other end of a pipe and writes nothing; the system closes it
    whatever that process dies of.

    Args:
        number: What they are ended by: SIGTERM stops a mission in order.
    """
    threading.Thread(target=_watch, args=(number,), name="tether", daemon=True).start()


def _watch(number: signal.Signals) -> None:
    # Not by `sys.stdin`, whose lock a thread that ends with the process would keep.
    while os.read(_STDIN, 1):
        pass
    os.killpg(os.getpgid(0), number)
