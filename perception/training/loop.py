"""Train any network: batches from workers, schedule, running average, checkpoints, resume.

A training that was stopped goes on as if it had not been: its checkpoint holds all that it
needs, and samples come in rounds that can be begun anew.
"""

import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from io import BytesIO
from itertools import islice
from math import cos, inf, nan, pi
from pathlib import Path
from typing import Protocol

import torch
from safetensors.torch import load_file
from torch import Tensor, nn
from torch.optim.swa_utils import AveragedModel
from torch.utils.data import DataLoader, IterableDataset, get_worker_info

from executive.core.errors import InputError
from perception.training.progress import PlainReporter, Progress, Reporter
from perception.training.recipes import Recipe

Batch = tuple[Tensor, ...]

# Batches of a round, and scenes kept for it, which are more than any round needs.
ROUND = 400
SCENES_A_ROUND = 1_000_000
WARM_UP = 200.0


class Task(Protocol):
    """What is trained.

    Attributes:
        name: Of the network.
        widths: Its numbers of channels.
        zoom: Pixels of its crops a unit of `perception.models.frames`.
    """

    name: str
    widths: tuple[int, ...]
    zoom: float

    def network(self) -> nn.Module:
        """Return a fresh network."""
        ...

    def batches(self, seed: int, first: int, stride: int, size: int) -> Iterator[Batch]:
        """Yield batches of `size` samples from scenes `first`, `first + stride`, ... for ever."""
        ...

    def loss(self, network: nn.Module, batch: Batch) -> Tensor:
        """Return the mean loss of a batch."""
        ...

    def metrics(self, network: nn.Module, batches: list[Batch]) -> dict[str, float]:
        """Return figures about held-out batches."""
        ...


class TrainingStoppedError(InputError):
    """Somebody stopped a training; what it has learned is kept."""


class _Stream(IterableDataset[Batch]):
    def __init__(self, task: Task, seed: int, first: int, size: int) -> None:
        self.task, self.seed, self.first, self.size = task, seed, first, size

    def __iter__(self) -> Iterator[Batch]:
        info = get_worker_info()
        if info is not None:
            torch.set_num_threads(1)
            # The training's own process says when to stop.
            signal.signal(signal.SIGINT, signal.SIG_IGN)
        index, stride = (info.id, info.num_workers) if info else (0, 1)
        return self.task.batches(self.seed, self.first + index, stride, self.size)


def _growing_average(decay: float) -> Callable[[Tensor, Tensor, Tensor], Tensor]:
    """Return a running average that forgets its random start quickly."""

    def update(average: Tensor, value: Tensor, count: Tensor) -> Tensor:
        kept = min(decay, (1.0 + float(count)) / (10.0 + float(count)))
        return kept * average + (1.0 - kept) * value

    return update


@contextmanager
def _stop_asked() -> Iterator[threading.Event]:
    """Note that somebody wants to stop, so that the step on hand is finished first."""
    asked = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        yield asked
        return
    signals = (signal.SIGINT, signal.SIGTERM)
    before = [signal.signal(number, lambda *_: asked.set()) for number in signals]
    try:
        yield asked
    finally:
        for number, handler in zip(signals, before, strict=True):
            signal.signal(number, handler)


class Trainer:
    """One training, from its checkpoint if there is one.

    Args:
        task: What is trained.
        recipe: How.
        folder: Where `checkpoint.pt` lies.
        start: File of weights to start from, none for random ones.

    Raises:
        InputError: The checkpoint is of another training.
    """

    def __init__(self, task: Task, recipe: Recipe, folder: Path, start: Path | None = None) -> None:
        torch.manual_seed(recipe.seed)
        torch.set_num_threads(recipe.threads)
        self.task, self.recipe, self.path = task, recipe, folder / "checkpoint.pt"
        self.network = task.network().to(memory_format=torch.channels_last)
        if start is not None:
            self.network.load_state_dict(load_file(start))
        self.average = AveragedModel(
            self.network, avg_fn=_growing_average(recipe.average), use_buffers=True
        )
        self.optimiser = torch.optim.AdamW(
            self.network.parameters(), lr=recipe.rate, weight_decay=recipe.decay
        )
        self.seen, self.hours = 0, 0.0
        if self.path.exists():
            self._load()

    def run(self, reporter: Reporter | None = None) -> dict[str, float]:
        """Train to the end and return the figures of the averaged network.

        Raises:
            TrainingStoppedError: The process was asked to stop; its checkpoint is written.
        """
        told, held_out = reporter or PlainReporter(), self._held_out()
        pace, reported, loss = _Pace(self), time.perf_counter(), nan
        with _stop_asked() as stop:
            for batch in self._batches():
                loss = self._step(batch)
                self.hours = pace.hours()
                told.step(pace.progress(loss))
                if stop.is_set():
                    self._save()
                    raise TrainingStoppedError(f"{self.path}: stopped after {self.seen} samples")
                if time.perf_counter() - reported > self.recipe.report_s:
                    self._save()
                    told.figures(pace.progress(loss), self._figures(held_out))
                    reported = time.perf_counter()
        self._save()
        figures = self._figures(held_out)
        told.figures(pace.progress(loss), figures)
        return figures

    def _step(self, batch: Batch) -> float:
        self.network.train()
        for group in self.optimiser.param_groups:
            group["lr"] = self._rate()
        with torch.autocast("cpu", torch.bfloat16):
            loss = self.task.loss(self.network, batch)
        self.optimiser.zero_grad()
        loss.backward()
        self.optimiser.step()
        self.average.update_parameters(self.network)
        self.seen += self.recipe.batch
        return float(loss.detach())

    def _share(self) -> float:
        """Return how much of the way the learning rate has come."""
        return max(self.seen / self.recipe.samples, self.hours / (self.recipe.hours or inf))

    def _is_done(self) -> bool:
        return self._share() >= 1.0 or self.seen >= (self.recipe.stop or inf)

    def _rate(self) -> float:
        warm = min(self.seen / (WARM_UP * self.recipe.batch), 1.0)
        fallen = 0.5 * (1.0 + cos(pi * min(self._share(), 1.0)))
        return self.recipe.rate * warm * (0.01 + 0.99 * fallen)

    def _batches(self) -> Iterator[Batch]:
        """Yield batches until it is done, after a stop from where it was stopped."""
        workers, size = self.recipe.workers, self.recipe.batch
        while not self._is_done():
            number, had = divmod(self.seen // size, ROUND)
            stream = _Stream(self.task, self.recipe.seed, number * SCENES_A_ROUND, size)
            loader = DataLoader(
                stream,
                batch_size=None,
                num_workers=workers,
                prefetch_factor=8 if workers else None,
                # A loader takes a number from a generator, and must leave the training's alone.
                generator=torch.Generator(),
            )
            for batch in islice(loader, had, ROUND):
                yield batch
                if self._is_done():
                    return

    def _held_out(self) -> list[Batch]:
        with torch.random.fork_rng():
            stream = self.task.batches(self.recipe.held_out_seed, 0, 1, self.recipe.batch)
            return [next(stream) for _ in range(self.recipe.held_out_batches)]

    def _figures(self, held_out: list[Batch]) -> dict[str, float]:
        with torch.random.fork_rng():
            return self.task.metrics(self.average.module, held_out)

    def _save(self) -> None:
        state = {
            "task": self.task.name,
            "network": self.network.state_dict(),
            "average": self.average.state_dict(),
            "optimiser": self.optimiser.state_dict(),
            "chance": torch.get_rng_state(),
            "seen": self.seen,
            "hours": self.hours,
        }
        unfinished = self.path.with_suffix(".new")
        # PyTorch's own writer does not say why a disk did not take it.
        packed = BytesIO()
        torch.save(state, packed)
        unfinished.write_bytes(packed.getvalue())
        unfinished.replace(self.path)

    def _load(self) -> None:
        state = torch.load(self.path, weights_only=True)
        if state["task"] != self.task.name:
            raise InputError(
                f"{self.path}: another training's checkpoint; got {state['task']!r}; "
                f"expected {self.task.name!r}; try another folder"
            )
        self.network.load_state_dict(state["network"])
        self.average.load_state_dict(state["average"])
        self.optimiser.load_state_dict(state["optimiser"])
        torch.set_rng_state(state["chance"])
        self.seen, self.hours = state["seen"], state["hours"]


class _Pace:
    """How fast a training goes from here on."""

    def __init__(self, trainer: Trainer) -> None:
        self._trainer, self._seen, self._hours = trainer, trainer.seen, trainer.hours
        self._wall_s, self._process_s = time.perf_counter(), time.process_time()

    def hours(self) -> float:
        """Return the training's process time so far."""
        return self._hours + (time.process_time() - self._process_s) / 3600.0

    def progress(self, loss: float) -> Progress:
        """Return where the training stands."""
        trainer, recipe = self._trainer, self._trainer.recipe
        wall_s = max(time.perf_counter() - self._wall_s, 1e-9)
        goal = min(recipe.samples, recipe.stop or recipe.samples)
        rate_per_s = (trainer.seen - self._seen) / wall_s
        left_s = max(goal - trainer.seen, 0) / rate_per_s if rate_per_s > 0.0 else inf
        if recipe.hours is not None:
            speed = max(trainer.hours - self._hours, 1e-12) / wall_s
            left_s = min(left_s, max(recipe.hours - trainer.hours, 0.0) / speed)
        return Progress(trainer.seen, goal, trainer.hours, recipe.hours, rate_per_s, left_s, loss)
