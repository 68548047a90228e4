"""The outside distribution: installed by pip into a folder of its own, found, used, run."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "hello_plugin"
EXPLORE_BT = [sys.executable, "-c", "from explore_bt.cli import main; main()"]


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The environment of a process in which hello-plugin is installed."""
    pytest.importorskip("hatchling", reason="hatchling builds the example; it is in the extra dev")
    folder = tmp_path_factory.mktemp("site-packages")
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps"]
    command += ["--disable-pip-version-check", "--no-build-isolation", "--target", str(folder), str(EXAMPLE)]
    subprocess.run(command, check=True)
    return {**os.environ, "PYTHONPATH": str(folder), "COLUMNS": "200"}


def explore_bt(*arguments: object, env: dict[str, str], cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [*EXPLORE_BT, *map(str, arguments)]
    return subprocess.run(command, env=env, cwd=cwd, capture_output=True, text=True, check=False)


def test_it_is_listed_with_its_origin_and_version(installed, tmp_path):
    ran = explore_bt("plugins", env=installed, cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    rows = [line.split() for line in ran.stdout.splitlines()]
    assert ["behaviour", "hello", "0.3.0", "hello-plugin", "(hello_plugin)"] in [row[:5] for row in rows]
    assert ["sink", "visitors_book", "0.3.0", "hello-plugin", "(hello_plugin)"] in [row[:5] for row in rows]
    assert "left out  hello" not in ran.stdout


def test_its_ports_are_shown_with_types_and_defaults(installed, tmp_path):
    ran = explore_bt("plugins", "--kind", "behaviour", "--options", env=installed, cwd=tmp_path)
    rows = [" ".join(line.split()) for line in ran.stdout.splitlines()]
    assert "to str world whom to greet" in rows
    assert "times int 1 how many ticks it takes" in rows
    assert "greeting writes str $greeting what was said" in rows


def test_a_mission_uses_its_leaf_and_a_run_its_sink(installed, tmp_path):
    mission, out = EXAMPLE / "hello.yaml", tmp_path / "out"
    ran = explore_bt(
        *("run", mission, "--set", "whom=Ada", "--sink", "visitors_book", "--out", out, "--headless"),
        env=installed,
        cwd=tmp_path,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert (out / "visitors.txt").read_text() == "robot: hello Ada\n"
    assert json.loads((out / "result.json").read_text())["reason"] == "hello: hello Ada (3 of 3)"


def test_its_own_tests_pass(installed, tmp_path):
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-W",
        "error",
        "-p",
        "no:cacheprovider",
        EXAMPLE / "tests",
    ]
    ran = subprocess.run(command, env=installed, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stdout + ran.stderr


def test_without_it_the_mission_says_what_is_missing(tmp_path):
    ran = explore_bt("check", EXAMPLE / "hello.yaml", env=dict(os.environ), cwd=tmp_path)
    assert ran.returncode == 2
    assert f'{EXAMPLE / "hello.yaml"}:19:9  there is no control node or leaf "hello"' in ran.stderr
