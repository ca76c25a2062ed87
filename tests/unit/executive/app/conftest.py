"""A toy mission with its skill and a cell of its own, found as those of a package are."""

from contextlib import contextmanager

import pytest
from toy_campaigns import write_toy

from executive.app import catalogue
from executive.engine.loading.packages import PATH_VARIABLE


@contextmanager
def toy_in(folder):
    """Write the mission to a folder; it runs in this process and in those it starts."""
    with pytest.MonkeyPatch.context() as patch:
        environment = write_toy(folder, "toy_cell")
        patch.setenv("PYTHONPATH", environment["PYTHONPATH"])
        patch.setenv(PATH_VARIABLE, str(folder))
        patch.setenv("OMP_NUM_THREADS", "1")
        patch.syspath_prepend(str(folder))
        patch.chdir(folder)
        catalogue.skills.cache_clear()
        yield folder
        catalogue.skills.cache_clear()


@pytest.fixture
def toy(tmp_path):
    """Return the folder of the mission."""
    with toy_in(tmp_path) as folder:
        yield folder
