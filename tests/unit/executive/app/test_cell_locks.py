"""A cell is used by one service alone, or by runs that were started by hand."""

import os
from contextlib import nullcontext

import pytest

from executive.app.cell_locks import HELD_VARIABLE, lock_of, running, serving
from executive.app.missions import load
from executive.core.errors import InputError


@pytest.fixture
def mission(toy):
    return load("toy")


@pytest.fixture
def lock(mission):
    return lock_of(mission.cell.name, mission.cell_file)


def test_no_run_is_let_in_beside_a_service(mission, lock):
    refused = rf"'toy_cell' is held by .*process {os.getpid()}, cellwright serve"
    with serving("toy_cell", lock), pytest.raises(InputError, match=refused):
        running(mission).__enter__()


def test_no_service_is_let_in_beside_a_run(mission, lock):
    refused = rf"'toy_cell' is held by .*process {os.getpid()}, cellwright run toy"
    with running(mission), pytest.raises(InputError, match=refused):
        serving("toy_cell", lock).__enter__()
    with serving("toy_cell", lock):
        pass


def test_runs_beside_each_other_have_worlds_of_their_own(mission):
    with running(mission), running(mission):
        pass


def test_the_missions_of_a_service_run_on_its_cell(mission, lock, monkeypatch):
    monkeypatch.setenv(HELD_VARIABLE, str(lock))
    with serving("toy_cell", lock):
        with running(mission):
            pass
        assert isinstance(running(mission), nullcontext)


def test_cells_of_one_name_in_two_projects_are_two(tmp_path):
    assert lock_of("own", tmp_path / "a" / "own.yaml") != lock_of("own", tmp_path / "own.yaml")
