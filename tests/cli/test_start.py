from __future__ import annotations

import subprocess
import sys

import pytest
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.version import __version__

COMMANDS = (
    "run",
    "debug",
    "replay",
    "resume",
    "recover",
    "compare",
    "check",
    "show",
    "convert",
    "slam",
    "export",
    "stats",
    "world",
    "ros2-sim",
    "router",
    "schema",
    "plugins",
    "new-plugin",
)


def test_explore_bt_alone_shows_five_commands_and_an_example():
    shown = CliRunner().invoke(app, [])
    assert shown.exit_code == 0
    lines = [line.split() for line in shown.stdout.splitlines()]
    begun_with = [words[1] for words in lines if words[:1] == ["explore-bt"] and len(words) > 2]
    assert begun_with[1:] == ["run", "check", "show", "plugins", "new-plugin"]
    assert "Example: explore-bt run 01_apartment --seed 3 --out runs/first" in shown.stdout


def test_the_version_is_said():
    shown = CliRunner().invoke(app, ["--version"])
    assert (shown.exit_code, shown.stdout) == (0, f"explore-bt {__version__}\n")


@pytest.mark.parametrize("command", COMMANDS)
def test_every_help_has_an_example_of_its_command(command):
    shown = CliRunner().invoke(app, [command, "--help"])
    assert shown.exit_code == 0
    assert f"Example: explore-bt {command}" in shown.stdout


def test_the_list_of_commands_is_complete_and_no_line_is_cut():
    shown = CliRunner().invoke(app, ["--help"])
    listed = shown.stdout.split("Commands:\n")[1].split("\n\n")[0].splitlines()
    assert tuple(line.split()[0] for line in listed) == COMMANDS
    assert all(line.endswith(".") and not line.endswith("...") for line in listed)


def test_an_unknown_command_is_wrong_input():
    assert CliRunner().invoke(app, ["explode"]).exit_code == 2


def test_help_brings_in_nothing_heavy():
    code = (
        "import sys; from explore_bt.cli import app; "
        "heavy = {'numpy', 'numba', 'cv2', 'gtsam', 'pydantic', 'matplotlib', 'py_trees'}; "
        "print(sorted(heavy & set(sys.modules)))"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert shown.stdout == "[]\n"
