"""Train any network: batches from workers, schedule, running average, checkpoints, resume."""

import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Protocol

import torch
from safetensors.torch import load_file
from torch import Tensor, nn
from torch.optim.swa_utils import AveragedModel
from torch.utils.data import DataLoader, IterableDataset, get_worker_info

Batch = tuple[Tensor, ...]


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


@dataclass(frozen=True, slots=True)
class Recipe:
    """How to train.

    Attributes:
        seed: Of the initial weights and of every scene.
        samples: Samples to see in all.
        hours: Stop after this much work, even with fewer samples.
        batch: Samples a step.
        rate: Highest learning rate (AdamW, cosine after a short warm-up).
        decay: Weight decay.
        average: Decay of the running average of the weights.
        threads: Threads of the network's own work.
        workers: Processes that draw samples.
        held_out_seed: Of the scenes that are only measured on.
        held_out_batches: How many batches of them.
        report_s: Time between reports and checkpoints [s].
        start: Weights to start from, empty for random ones.
    """

    seed: int = 1
    samples: int = 3_000_000
    hours: float = 2.0
    batch: int = 128
    rate: float = 2e-3
    decay: float = 1e-4
    average: float = 0.998
    threads: int = 1
    workers: int = 1
    held_out_seed: int = 900_001
    held_out_batches: int = 24
    report_s: float = 240.0
    start: str = ""


class _Stream(IterableDataset[Batch]):
    def __init__(self, task: Task, seed: int, first: int, size: int) -> None:
        self.task, self.seed, self.first, self.size = task, seed, first, size

    def __iter__(self) -> Iterator[Batch]:
        torch.set_num_threads(1)
        info = get_worker_info()
        index, stride = (info.id, info.num_workers) if info else (0, 1)
        return self.task.batches(self.seed, self.first + index, stride, self.size)


def _growing_average(decay: float) -> Callable[[Tensor, Tensor, Tensor], Tensor]:
    """Return a running average that forgets its random start quickly."""

    def update(average: Tensor, value: Tensor, count: Tensor) -> Tensor:
        kept = min(decay, (1.0 + float(count)) / (10.0 + float(count)))
        return kept * average + (1.0 - kept) * value

    return update


class Trainer:
    """One training, from its checkpoint if there is one.

    Args:
        task: What is trained.
        recipe: How.
        folder: Where `checkpoint.pt` lies.
    """

    def __init__(self, task: Task, recipe: Recipe, folder: Path) -> None:
        torch.manual_seed(recipe.seed)
        torch.set_num_threads(recipe.threads)
        self.task, self.recipe, self.path = task, recipe, folder / "checkpoint.pt"
        self.network = task.network().to(memory_format=torch.channels_last)
        if recipe.start:
            self.network.load_state_dict(load_file(recipe.start))
        self.average = AveragedModel(
            self.network, avg_fn=_growing_average(recipe.average), use_buffers=True
        )
        self.optimiser = torch.optim.AdamW(
            self.network.parameters(), lr=recipe.rate, weight_decay=recipe.decay
        )
        self.seen, self.hours = 0, 0.0
        if self.path.exists():
            self._load()

    def run(self) -> dict[str, float]:
        """Train to the end and return the figures of the averaged network."""
        held_out = self._held_out()
        started, reported = time.perf_counter(), time.perf_counter()
        before, figures = self.hours, {}
        for batch in self._loader():
            loss = self._step(batch)
            now = time.perf_counter()
            self.hours = before + (now - started) / 3600.0
            finished = self._progress() >= 1.0
            if finished or now - reported > self.recipe.report_s:
                figures = self.task.metrics(self.average.module, held_out)
                self._report(loss, figures)
                self._save()
                reported = time.perf_counter()
            if finished:
                break
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

    def _progress(self) -> float:
        return max(self.seen / self.recipe.samples, self.hours / self.recipe.hours)

    def _rate(self) -> float:
        warm = min(self.seen / (200.0 * self.recipe.batch), 1.0)
        turn = torch.pi * min(self._progress(), 1.0)
        return (
            self.recipe.rate
            * warm
            * (0.01 + 0.99 * 0.5 * (1.0 + float(torch.cos(torch.tensor(turn)))))
        )

    def _loader(self) -> Iterator[Batch]:
        # A resumed training goes on with scenes that it has not seen.
        first = 10 * self.seen
        stream = _Stream(self.task, self.recipe.seed, first, self.recipe.batch)
        workers = self.recipe.workers
        return iter(
            DataLoader(
                stream, batch_size=None, num_workers=workers, prefetch_factor=8 if workers else None
            )
        )

    def _held_out(self) -> list[Batch]:
        stream = self.task.batches(self.recipe.held_out_seed, 0, 1, self.recipe.batch)
        return [next(stream) for _ in range(self.recipe.held_out_batches)]

    def _report(self, loss: float, figures: dict[str, float]) -> None:
        shown = "  ".join(f"{name} {value:.4f}" for name, value in figures.items())
        print(  # noqa: T201  # progress of a command that runs for hours
            f"{self.hours:.2f} h  {self.seen} samples  loss {loss:.4f}  {shown}", flush=True
        )

    def _save(self) -> None:
        state = {
            "network": self.network.state_dict(),
            "average": self.average.state_dict(),
            "optimiser": self.optimiser.state_dict(),
            "seen": self.seen,
            "hours": self.hours,
            "recipe": asdict(self.recipe),
        }
        unfinished = self.path.with_suffix(".new")
        torch.save(state, unfinished)
        unfinished.replace(self.path)

    def _load(self) -> None:
        state = torch.load(self.path, weights_only=True)
        self.network.load_state_dict(state["network"])
        self.average.load_state_dict(state["average"])
        self.optimiser.load_state_dict(state["optimiser"])
        self.seen, self.hours = state["seen"], state["hours"]
