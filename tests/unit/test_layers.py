"""Every folder has its layer, and the light layers load no heavy library."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
HEAVY = {"torch", "cv2", "pybullet", "pinocchio", "coal", "meshcat", "ruckig", "numba"}
SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
CONTRACTS = SETTINGS["importlinter"]["contracts"]


def packages() -> set[str]:
    """Return the packages that must have a layer: the top ones, and the executive's folders."""
    top = {path.parent.name for path in ROOT.glob("*/__init__.py")} - {"trees", "benchmarks"}
    inside = {f"executive.{path.parent.name}" for path in ROOT.glob("executive/*/__init__.py")}
    return (top - {"executive"}) | inside


def modules_of(*names: str) -> list[str]:
    """Return all modules of packages, as import names."""
    paths = [path for name in names for path in ROOT.glob(f"{name.replace('.', '/')}/**/*.py")]
    parts = [path.relative_to(ROOT).with_suffix("").parts for path in paths]
    return sorted(".".join(each).removesuffix(".__init__") for each in parts)


def test_every_package_has_a_layer():
    rows = next(contract["layers"] for contract in CONTRACTS if contract["type"] == "layers")
    placed = {name for row in rows for name in row.split(" | ")}
    assert placed == packages()


def test_the_contract_on_heavy_libraries_names_them_all():
    forbidden = next(contract for contract in CONTRACTS if contract["type"] == "forbidden")
    assert set(forbidden["forbidden_modules"]) == HEAVY


@pytest.mark.parametrize("package", ["executive.core", "executive.engine", "skills"])
def test_light_layers_load_no_heavy_library(package):
    modules = [name for name in modules_of(package) if not name.endswith("__main__")]
    code = f"import sys, {', '.join(modules)}; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split()
    assert HEAVY.intersection(loaded) == set()
