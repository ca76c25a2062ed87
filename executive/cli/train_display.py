"""How a training shows on a terminal: a bar, and figures above it."""

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn

from executive.cli.console import chatter
from perception.training.progress import PlainReporter, Reporter, describe, duration, shown
from perception.training.progress import Progress as Standing


class BarReporter:
    """Shows a bar while training goes on."""

    def __init__(self, console: Console, bar: Progress, task: TaskID) -> None:
        self._console, self._bar, self._task = console, bar, task

    def step(self, progress: Standing) -> None:
        """Move the bar."""
        text = (
            f"{progress.seen} of {progress.samples} samples, {progress.rate_per_s:.0f}/s, "
            f"{duration(progress.left_s)} left, loss {progress.loss:.3f}"
        )
        self._bar.update(self._task, completed=progress.share, text=text)

    def figures(self, progress: Standing, figures: Mapping[str, float]) -> None:
        """Print figures above the bar."""
        self._console.print(f"{describe(progress)}  {shown(figures)}")

    def note(self, text: str) -> None:
        """Print a text above the bar."""
        self._console.print(text)


@contextmanager
def training_shown() -> Iterator[Reporter]:
    """Yield what shows a training: a bar on a terminal, plain lines elsewhere."""
    console = chatter()
    if not sys.stderr.isatty():
        yield PlainReporter(lambda text: console.print(text, soft_wrap=True))
        return
    with Progress(BarColumn(), TextColumn("{task.fields[text]}"), console=console) as bar:
        yield BarReporter(console, bar, bar.add_task("", total=1.0, text="drawing samples"))
