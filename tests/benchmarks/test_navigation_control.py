"""The part of the navigation benchmark that drives: one path, by the command that a user gives."""

import json
import subprocess
import sys
from pathlib import Path

BENCHMARK = Path(__file__).resolve().parents[2] / "benchmarks/navigation.py"


def test_each_controller_drives_a_path_within_its_limits(tmp_path: Path) -> None:
    out = tmp_path / "figures.json"
    command = [sys.executable, BENCHMARK, "--parts", "control", "--paths", "1", "--seed", "1", "--json", out]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    figures = json.loads(out.read_text())["control"]
    for name in ("pursuit", "mppi"):
        row = figures[name]
        assert row["arrived"] == row["paths"] == 1
        assert row["contacts"] == 0
        assert row["largest_error_mean_m"] < 0.08
        assert row["acceleration_share"] <= 1.0 + 1e-6
        assert row["jerk_share"] <= 1.0 + 1e-6
        assert f"| {name} | 1 of 1 |" in run.stdout


def test_an_unknown_part_is_named(tmp_path: Path) -> None:
    command = [sys.executable, BENCHMARK, "--parts", "controll"]
    run = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert run.returncode == 2
    assert "there is no part controll; choose from planner, control, people" in run.stderr
