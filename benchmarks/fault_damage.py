"""Damaged recordings, trees and weights: what is read of them, and what is refused."""

import shutil
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from benchmarks.fault_missions import call, write_work
from benchmarks.fault_trials import Answer
from executive.app.missions import load
from executive.core.errors import CellwrightError, InputError
from executive.engine.loading.library import packaged_trees
from executive.engine.recording.reader import Recording


def damaged_recording(folder: Path, rng: np.random.Generator) -> Answer:
    """Cut or change a recording anywhere: it is read as far as it is sound, or refused."""
    file = folder / "damaged.mcap"
    data = bytearray(_sound_recording())
    if rng.uniform() < 0.5:
        del data[int(rng.integers(len(data))) :]
    for place in rng.integers(max(1, len(data)), size=int(rng.integers(1, 20))):
        if data:
            data[place % len(data)] ^= int(rng.integers(1, 256))
    file.write_bytes(data)
    try:
        recording = Recording.open(file)
        for number in range(len(recording)):
            recording.tick(number)
    except CellwrightError as error:
        return Answer(bool(str(error)), "refused it, or a tick of it, with the reason")
    except Exception as error:  # what the trial is about
        return Answer(False, f"broke: {type(error).__name__}")
    return Answer(True, "read what is sound")


def damaged_tree(folder: Path, rng: np.random.Generator) -> Answer:
    """Change a mission's file anywhere: it is refused with its place, or still sound."""
    text = bytearray((packaged_trees() / "missions" / "untangle.yaml").read_bytes())
    for place in rng.integers(len(text), size=int(rng.integers(1, 8))):
        text[place] = int(rng.integers(256))
    file = folder / "untangle.yaml"
    file.write_bytes(text)
    try:
        load(file)
    except CellwrightError as error:
        return Answer(file.name in str(error), "refused it, with its place")
    except Exception as error:  # what the trial is about
        return Answer(False, f"broke: {type(error).__name__}")
    return Answer(True, "loaded it: it was sound still")


def damaged_weights(folder: Path, rng: np.random.Generator) -> Answer:
    """Cut off the file of a network's weights, or flip a bit of it."""
    from perception.models import store

    source = min(store.FOLDER.glob("**/weights.safetensors"), key=lambda one: one.stat().st_size)
    shutil.copytree(source.parent, folder / "model")
    weights = folder / "model" / source.name
    data = bytearray(weights.read_bytes())
    if rng.uniform() < 0.5:
        data[int(rng.integers(len(data)))] ^= 1 << int(rng.integers(8))
    else:
        del data[int(rng.integers(len(data))) :]
    weights.write_bytes(data)
    try:
        store.load_network(folder / "model")
    except InputError as error:
        return Answer(source.name in str(error), "refused it with its name")
    return Answer(False, "took it")


@cache
def _sound_recording() -> bytes:
    """Return the bytes of a sound recording."""
    with tempfile.TemporaryDirectory() as name:
        write_work(Path(name))
        call(Path(name), "run", "work.yaml", "--record", "sound.mcap", "--set", "parts=30")
        return (Path(name) / "sound.mcap").read_bytes()
