"""Weights are those that were trained, to the last bit."""

import shutil
import subprocess

import numpy as np
import pytest

from executive.core.errors import InputError
from perception.models.checksums import check_checksum, write_checksum


@pytest.fixture
def weights(tmp_path):
    file = tmp_path / "weights.safetensors"
    file.write_bytes(np.random.default_rng(0).bytes(4000))
    write_checksum(file)
    return file


@pytest.mark.parametrize("bit", [0, 12345, 31999])
def test_any_bit_that_flips_is_found(weights, bit):
    check_checksum(weights)
    data = bytearray(weights.read_bytes())
    data[bit // 8] ^= 1 << bit % 8
    weights.write_bytes(data)
    with pytest.raises(InputError, match=r"weights\.safetensors: is not the file that was trained"):
        check_checksum(weights)


def test_weights_that_are_gone_are_told_and_ones_without_checksum_taken(weights):
    weights.with_suffix(".sha256").unlink()
    check_checksum(weights)
    write_checksum(weights)
    weights.unlink()
    with pytest.raises(InputError, match="is not there"):
        check_checksum(weights)


@pytest.mark.skipif(shutil.which("sha256sum") is None, reason="a tool of GNU")
def test_the_file_is_one_that_sha256sum_reads(weights):
    beside = weights.with_suffix(".sha256").name
    subprocess.run(["sha256sum", "--check", beside], cwd=weights.parent, check=True)
