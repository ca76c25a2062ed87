"""Work that tests hand to other processes: functions of a module, as those have to be."""

import os
import time


class PickyError(Exception):
    """An error that cannot be made again from what it passes on."""

    def __init__(self, first, second):
        super().__init__(f"{first} and {second}")


def add(a, b):
    return a + b


def process_id():
    return os.getpid()


def broken():
    try:
        raise KeyError("inner")
    except KeyError as cause:
        raise ValueError("outer") from cause


def picky():
    raise PickyError("this", "that")


def unpicklable():
    return lambda: None


def die():
    os._exit(7)


def sleep(token, seconds):
    end_s = time.monotonic() + seconds
    while time.monotonic() < end_s:
        token.check()
        time.sleep(0.005)


def tell(path, seconds):
    """Write a process id, wait, and write that it came to the end."""
    path.write_text(str(os.getpid()))
    time.sleep(seconds)
    path.write_text("ended")
