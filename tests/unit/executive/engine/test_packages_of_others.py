"""Trees and skills of other packages, found by their entry points, and folders of the user."""

import os
import subprocess
import sys
from textwrap import dedent

import pytest
from toy_language import toy_skills, toy_types

from executive.core.errors import InputError
from executive.core.registry import Registry
from executive.engine.loading.loader import load_program
from executive.engine.loading.packages import (
    PATH_VARIABLE,
    add_packaged_skills,
    add_packaged_types,
    package_folders,
)

COMMAND = "from executive.cli.main import main; main()"
FILES = {
    "packing/__init__.py": "",
    "packing/types.py": """
        from dataclasses import dataclass

        @dataclass(frozen=True)
        class Box:
            width_m: float
        """,
    "packing/skills.py": """
        from executive.core.outcome import success
        from executive.core.skill import Port, Skill, SkillRun
        from packing.types import Box

        class FindBox(Skill):
            \"\"\"Find a box.\"\"\"
            OUT = {"box": Port(Box)}

            def run(self) -> SkillRun:
                return success(box=Box(0.3))
                yield
        """,
    "packing/leaves.py": """
        from py_trees.behaviour import Behaviour
        from py_trees.common import Status
        from py_trees.ports import PortInformation, PortsMixin

        class CloseBox(PortsMixin, Behaviour, register=False):
            \"\"\"Close a box.\"\"\"
            INPUT_PORTS = {"force_n": PortInformation(float, default_value=2.0)}
            OUTPUT_PORTS = {}

            def update(self):
                return Status.SUCCESS
        """,
    "packing/trees/__init__.py": "",
    "packing/trees/pack_box.yaml": """
        format: 1
        tree: pack_box
        out: {box: {type: Box}}
        root:
          sequence:
            - {skill: find_box, out: {box: $box}}
            - {skill: close_box, in: {force_n: 3}}
        """,
    "packing-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: packing\nVersion: 1.0\n",
    "packing-1.0.dist-info/entry_points.txt": """
        [cellwright.trees]
        packing = packing.trees
        [cellwright.skills]
        find_box = packing.skills:FindBox
        close_box = packing.leaves:CloseBox
        [cellwright.types]
        Box = packing.types:Box
        """,
}


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """Return a folder on Python's path with a package that offers trees, skills and types."""
    for name, text in FILES.items():
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(dedent(text).lstrip())
    monkeypatch.syspath_prepend(tmp_path)
    yield tmp_path
    for name in [name for name in sys.modules if name.partition(".")[0] == "packing"]:
        del sys.modules[name]


def declare(folder, text):
    (folder / "packing-1.0.dist-info/entry_points.txt").write_text(text)


def test_trees_skills_and_types_of_a_package_are_found_by_name(installed, bench):
    file = bench.write(
        "top",
        """
        format: 1
        tree: top
        root: {sequence: [{subtree: pack_box, out: {box: $b}}, {when: b.width_m > 0.1}]}
        """,
    )
    program = load_program(
        file,
        skills=add_packaged_skills(toy_skills()),
        types=add_packaged_types(toy_types()),
    )
    assert set(program.subtrees) == {"pack_box"}
    assert installed / "packing/trees" in package_folders()


def test_the_command_line_knows_them(installed, tmp_path):
    tree = tmp_path / "top.yaml"
    tree.write_text("format: 1\ntree: top\nroot: {sequence: [{subtree: pack_box}, {wait: 1}]}\n")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(installed), *sys.path])}
    done = subprocess.run(
        [sys.executable, "-c", COMMAND, "check", str(tree)],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr.count("Traceback")) == (0, 0), done.stderr


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (
            "[cellwright.skills]\nfind = packing.skills:FindBox\n",
            "packing: entry point 'find' of cellwright.skills (packing.skills:FindBox): "
            "skill 'find' is registered twice; try another name",
        ),
        ("[cellwright.skills]\nx = packing.nothing:X\n", "cannot be imported: ModuleNotFoundError"),
        ("[cellwright.skills]\nx = packing.types:Box\n", "expected a Skill or a py_trees leaf"),
    ],
)
def test_what_a_package_gets_wrong_names_the_package(installed, points, message):
    declare(installed, points)
    with pytest.raises(InputError) as refused:
        add_packaged_skills(toy_skills())
    assert message in str(refused.value)


def test_a_package_without_the_folder_it_declares_is_named(installed):
    declare(installed, "[cellwright.trees]\npacking = packing.more\n")
    with pytest.raises(InputError, match=r"packing: .*: there is no package 'packing\.more'"):
        package_folders()
    declare(installed, "[cellwright.types]\nBox = packing.types:__doc__\n")
    with pytest.raises(InputError, match="expected a class"):
        add_packaged_types(Registry("port type"))


def test_folders_of_the_user_come_before_packages(bench, tmp_path, monkeypatch):
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "look_and_act.yaml").write_text("format: 1\ntree: look_and_act\nroot: {when: true}\n")
    monkeypatch.setenv(PATH_VARIABLE, str(folder))
    program = bench.load("{subtree: look_and_act}")
    assert program.subtrees["look_and_act"].source.file == str(folder / "look_and_act.yaml")
    monkeypatch.setenv(PATH_VARIABLE, str(tmp_path / "missing"))
    with pytest.raises(InputError, match=r"CELLWRIGHT_PATH: .*missing' is no folder"):
        bench.load("{when: true}")
