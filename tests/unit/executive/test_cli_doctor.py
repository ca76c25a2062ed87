"""`cellwright doctor` tries everything, says what is broken, and how to mend it."""

import pytest
from typer.testing import CliRunner

from executive.cli import cmd_doctor, main
from executive.cli.doctor_checks import CHECKS, Check, CheckError


def broken():
    raise CheckError("a ball does not fall")


def missing():
    raise ImportError("No module named 'gravity'")


def doctor(monkeypatch, *checks):
    monkeypatch.setattr(cmd_doctor, "CHECKS", checks)
    return CliRunner().invoke(main.app, ["doctor"])


def test_a_machine_that_is_well_exits_with_0(monkeypatch):
    result = doctor(monkeypatch, Check("gravity", lambda: "9.81 m/s2", "look down"))
    assert result.exit_code == 0
    assert "✓  gravity  9.81 m/s2" in result.stdout
    assert "look down" not in result.stdout


@pytest.mark.parametrize(
    ("attempt", "message"), [(broken, "a ball does not fall"), (missing, "ImportError: No module")]
)
def test_what_is_broken_is_named_with_its_remedy_and_the_rest_is_tried(
    monkeypatch, attempt, message
):
    checks = (Check("gravity", attempt, "look down"), Check("light", lambda: "on", ""))
    result = doctor(monkeypatch, *checks)
    assert result.exit_code == 3
    assert message in result.stdout
    assert "look down" in result.stdout
    assert "✓  light" in result.stdout


def test_a_warning_breaks_nothing(monkeypatch):
    result = doctor(monkeypatch, Check("threads", broken, "export OMP_NUM_THREADS=1"))
    assert result.exit_code == 0
    assert "export OMP_NUM_THREADS=1" in result.stdout


@pytest.mark.parametrize(
    "check", [check for check in CHECKS if check.name not in ("threads", "table cell")],
    ids=lambda check: check.name,
)  # fmt: skip
def test_every_library_passes_its_own_check(check, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert check.attempt()
