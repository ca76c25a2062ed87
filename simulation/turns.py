"""Whose turn it is to let a world go on: one thread at a time, and an emergency stop goes first."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager


class Turns:
    """Turns that threads take with one world."""

    def __init__(self) -> None:
        """Nobody has the turn."""
        self._world = threading.RLock()
        self._open = threading.Event()
        self._open.set()

    @contextmanager
    def step(self) -> Iterator[None]:
        """Have the world for a step; waits until who goes first is done."""
        self._open.wait()
        with self._world:
            yield

    @contextmanager
    def look(self) -> Iterator[None]:
        """Have the world between two steps, without letting it go on."""
        with self._world:
            yield

    @contextmanager
    def first(self) -> Iterator[None]:
        """Have the world next, and alone until this is done."""
        self._open.clear()
        try:
            with self._world:
                yield
        finally:
            self._open.set()
