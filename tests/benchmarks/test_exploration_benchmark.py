import json
import re
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest
from exploration_runs import PLAIN, Store, Task, run_task
from exploration_table import per_strategy

ROOT = Path(__file__).parents[2]
ROOM = ROOT / "missions" / "worlds" / "room.yaml"
COLUMNS = [
    "strategy",
    "map",
    "start",
    "seed",
    "outcome",
    "coverage",
    "path_m",
    "ratio_90",
    "ratio_95",
    "ratio_99",
    "mean_clearance_m",
    "min_clearance_m",
    "contacts",
    "turning_rad",
    "goal_changes_per_100m",
]


def bench(json_file, *more):
    command = [sys.executable, "benchmarks/exploration.py", "--maps", str(ROOM), "--strategies", PLAIN]
    command += ["--starts", "2", "--rounds", "3", "--jobs", "1", "--json", str(json_file), *more]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    file = tmp_path_factory.mktemp("bench") / "results.json"
    return file, bench(file)


def test_it_leaves_a_row_for_each_run_a_table_and_two_plots(done):
    file, run = done
    assert run.returncode == 0, run.stderr
    rows = json.loads(file.read_text())["table"]
    assert [(row["map"], row["start"]) for row in rows] == [("room", 0), ("room", 1)]
    for row in rows:
        assert set(COLUMNS) <= set(row)
        assert row["outcome"] == "explored"
        assert row["coverage"] >= 0.99
        assert row["contacts"] == 0
    assert f"| {PLAIN} | 2 | 2 | 2 |" in run.stdout
    for name in ("distance", "time"):
        assert (file.parent / f"results_{name}.png").read_bytes().startswith(b"\x89PNG")


def test_killed_and_started_again_it_does_only_what_is_missing(done):
    file, _ = done
    content = json.loads(file.read_text())
    del content["rows"][f"{PLAIN} room 1 0"]
    again = file.with_name("again.json")
    again.write_text(json.dumps(content))
    shutil.copytree(file.with_suffix(".curves"), again.with_suffix(".curves"))
    run = bench(again)
    assert run.returncode == 0, run.stderr
    assert re.findall(r"^\d+/\d+ (.*?):", run.stdout, re.MULTILINE) == [f"{PLAIN} room 1 0"]
    table = json.loads(again.read_text())["table"]
    timed = {"decision_ms_median", "decision_ms_p99"}
    told = [{key: row[key] for key in row if key not in timed} for row in table]
    first = json.loads(file.read_text())["table"]
    assert told == [{key: row[key] for key in row if key not in timed} for row in first]


def test_results_of_other_settings_are_not_mixed_in(done):
    run = bench(done[0], "--range", "4")
    assert run.returncode == 1
    assert "name another file" in run.stderr
    assert "Traceback" not in run.stderr


def test_without_ray_the_message_names_what_to_install(tmp_path):
    if find_spec("ray"):
        pytest.skip("ray is installed here")
    run = bench(tmp_path / "ray.json", "--ray")
    assert run.returncode == 1
    assert 'pip install "explore-bt[ray]"' in run.stderr


def test_a_strategy_that_fails_is_a_row_and_not_the_end(tmp_path):
    task = Task("no_such_strategy", str(ROOM), 0, 1, 0)
    store = Store(tmp_path / "rows.json", {"machine": "here", "settings": {}})
    row = store.add(task, run_task(task))
    assert row["outcome"].startswith("failed: ")
    assert "| no_such_strategy | 1 | failed: " in per_strategy(store.rows)
