"""What the tests of the language share."""

import pytest
from toy_language import Bench


@pytest.fixture
def bench(tmp_path):
    """Return a folder of trees to write, check and tick."""
    return Bench(tmp_path)
