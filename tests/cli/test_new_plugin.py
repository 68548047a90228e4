from __future__ import annotations

import os
import subprocess
import sys
import tomllib

import pytest
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.cli.skeleton import KINDS, write_skeleton
from explore_bt.plugin import KINDS as CONTRACT_KINDS
from explore_bt.plugin import Registry
from explore_bt.plugin.inline import load_inline


def invoke(*arguments: object) -> tuple[int, str, str]:
    shown = CliRunner().invoke(app, ["new-plugin", *map(str, arguments)])
    return shown.exit_code, shown.stdout, shown.stderr


def test_there_is_a_template_for_every_kind():
    assert {*KINDS, "bridge"} == set(CONTRACT_KINDS)  # a bridge is half of a driver of its family


def test_it_writes_four_files_and_says_what_to_type_next(tmp_path):
    folder = tmp_path / "my_slam"
    code, said, _ = invoke("slam", "my_slam", "--out", folder)
    assert code == 0
    assert said.splitlines() == [
        str(folder / "my_slam.py"),
        str(folder / "pyproject.toml"),
        str(folder / "test_my_slam.py"),
        str(folder / "README.md"),
        "",
        f"Next: pip install -e {folder}",
        f"      pytest {folder}",
        "      explore-bt plugins --kind slam",
    ]
    assert sorted(path.name for path in folder.iterdir()) == [
        "README.md",
        "my_slam.py",
        "pyproject.toml",
        "test_my_slam.py",
    ]


@pytest.mark.parametrize("kind", KINDS)
def test_the_module_registers_one_class_of_its_kind_under_its_name(tmp_path, kind):
    write_skeleton(kind, "thing_2", tmp_path / "thing")
    registry = Registry()
    load_inline(registry, tmp_path / "thing" / "thing_2.py")
    (entry,) = registry.entries()
    assert (entry.kind, entry.name, entry.cls.__name__) == (kind, "thing_2", "Thing2")


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_of_the_template_is_left(tmp_path, kind):
    for path in write_skeleton(kind, "thing", tmp_path / "thing"):
        text = path.read_text()
        assert [
            word for word in ("my_plugin", "MyPlugin", "my_kind", "my_usage", "noqa") if word in text
        ] == []


def test_the_toml_names_the_module_in_the_entry_point_group(tmp_path):
    write_skeleton("planner", "my_planner", tmp_path / "p")
    project = tomllib.loads((tmp_path / "p" / "pyproject.toml").read_text())["project"]
    assert project["entry-points"] == {"explore_bt": {"my_planner": "my_planner"}}
    assert project["dependencies"] == ["explore-bt"]


def test_the_tests_of_every_skeleton_pass(tmp_path):
    for kind in KINDS:
        write_skeleton(kind, f"my_{kind}", tmp_path / f"my_{kind}")
    path = os.pathsep.join(str(tmp_path / f"my_{kind}") for kind in KINDS)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    ran = subprocess.run(
        [*command, "-W", "error", str(tmp_path)],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr


def test_an_unknown_kind_gets_a_suggestion(tmp_path):
    code, _, said = invoke("planer", "mine", "--out", tmp_path / "mine")
    assert (code, said) == (
        2,
        f'there is no plugin kind "planer"; did you mean "planner"? Kinds: {", ".join(KINDS)}\n',
    )


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("class", '"class" is a word of Python itself; choose another name, for example my_slam'),
        ("match", '"match" is a word of Python itself; choose another name, for example my_slam'),
        ("numpy", 'a Python module "numpy" is installed already; choose another name, for example my_slam'),
        *(
            (
                name,
                f'"{name}" cannot be a plugin\'s name; write small letters, digits and underscores, '
                "a letter first, for example my_slam",
            )
            for name in ("my-slam", "2slam", "MySlam", "_slam", "../slam", "my slam", "ümlaut")
        ),
    ],
)
def test_a_bad_name_is_refused_and_nothing_is_written(tmp_path, name, said):
    code, _, stderr = invoke("slam", name, "--out", tmp_path / "new")
    assert (code, stderr) == (2, said + "\n")
    assert list(tmp_path.iterdir()) == []


def test_an_existing_folder_is_refused_and_left_as_it_is(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    code, _, said = invoke("slam", "my_slam", "--out", tmp_path)
    assert (code, said) == (2, f"{tmp_path} exists already; choose another folder with --out\n")
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_a_folder_in_a_folder_that_is_not_there_is_refused(tmp_path):
    code, _, said = invoke("slam", "my_slam", "--out", tmp_path / "a" / "b")
    assert (code, said) == (2, f"there is no folder {tmp_path}/a to put b into; make it first\n")
