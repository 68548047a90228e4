from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from explore_bt.cli import app
from explore_bt.comparison import comparison_page, figures_of, notes_on, read_run
from explore_bt.maps import write_map
from explore_bt.types import FREE, OCCUPIED, OccupancyGrid

RESULT = {
    "outcome": "explored",
    "reason": "nothing is left",
    "mission": "flat",
    "coverage": 0.99,
    "contacts": 0,
    "touched_by_people": None,
    "ate_rmse_m": 0.003,
    "path_length_m": 60.0,
    "mission_time_s": 200.0,
    "wall_time_s": 30.0,
    "min_clearance_m": 0.27,
    "mean_clearance_m": 0.5,
    "distance_to_home_m": 0.01,
    "seed": 0,
    "mission_sha256": "ab",
    "version": "1.0",
    "left_open": [],
    "slam": {"keyframes": 12.0},
}


def write_run(folder: Path, **changes: object) -> Path:
    folder.mkdir()
    (folder / "result.json").write_text(json.dumps({**RESULT, **changes}))
    cells = np.full((40, 60), FREE, dtype=np.int8)
    cells[0], cells[:, -1] = OCCUPIED, OCCUPIED
    write_map(OccupancyGrid(cells, 0.05, (-1.0, -1.0)), folder)
    (folder / "trajectory.tum").write_text("0.1 0 0 0 0 0 0 1\n0.2 0.5 0.25 0 0 0 0 1\n")
    return folder


@pytest.fixture
def two(tmp_path: Path) -> list[Path]:
    return [
        write_run(tmp_path / "first"),
        write_run(tmp_path / "second", path_length_m=66.0, slam={"keyframes": 15.0, "loop_closures": 3.0}),
    ]


def invoke(*words: object) -> Result:
    return CliRunner().invoke(app, ["compare", *map(str, words)], env={"COLUMNS": "200"})


def test_what_differs_is_marked_and_told_against_the_first(two: list[Path]) -> None:
    rows = {row.key: row for row in figures_of([read_run(path) for path in two])}
    assert rows["path_length_m"].differs
    assert rows["path_length_m"].texts == ("60.0 m", "66.0 m")
    assert rows["path_length_m"].differences == ("", "+6.00 m")
    assert not rows["coverage"].differs
    assert rows["slam.keyframes"].differences[1] == "+3"


def test_what_only_one_run_knows_is_a_gap_and_what_none_knows_no_row(two: list[Path]) -> None:
    rows = {row.key: row for row in figures_of([read_run(path) for path in two])}
    assert rows["slam.loop_closures"].texts == ("–", "3")
    assert "touched_by_people" not in rows


def test_a_run_with_itself_differs_in_nothing(two: list[Path]) -> None:
    run = read_run(two[0])
    assert not any(row.differs for row in figures_of([run, run]))
    assert notes_on([run, run]) == []


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"mission": "hall"}, "different missions: flat, hall"),
        ({"mission_sha256": "cd"}, "its text or parameters differ"),
        ({"seed": 4}, "different seeds: 0, 4"),
        ({"version": "2.0"}, "different versions of explore-bt: 1.0, 2.0"),
    ],
)
def test_runs_of_different_things_are_pointed_out(
    tmp_path: Path, changes: dict[str, object], words: str
) -> None:
    runs = [read_run(write_run(tmp_path / "a")), read_run(write_run(tmp_path / "b", **changes))]
    assert any(words in note for note in notes_on(runs))


def test_the_page_needs_no_network_and_shows_every_map(two: list[Path], tmp_path: Path) -> None:
    third = write_run(tmp_path / "<script>alert(1)</script>".replace("/", "_"))
    page = comparison_page([read_run(path) for path in (*two, third)])
    assert not re.findall(r'(?:src|href)="(?!data:)', page)
    assert page.count("<svg") == 3
    assert page.count("<polyline") == 3
    assert "<script" not in page


def test_two_runs_also_show_where_they_differ(two: list[Path]) -> None:
    page = comparison_page([read_run(path) for path in two])
    assert page.count("<svg") == 3
    assert "Where they differ" in page


def test_the_command_prints_the_table_and_writes_the_page(two: list[Path], tmp_path: Path) -> None:
    shown = invoke(*two, "--out", tmp_path / "page.html")
    assert shown.exit_code == 0, shown.output
    assert re.search(r"≠ +driven +60\.0 m +66\.0 m +\+6\.00 m", shown.stdout)
    assert re.search(r"= +contacts +0 +0", shown.stdout)
    assert f"maps  {tmp_path / 'page.html'}" in shown.stdout.replace("\n", "")
    assert (tmp_path / "page.html").stat().st_size > 1000


def test_for_programs_there_is_json(two: list[Path]) -> None:
    told = json.loads(invoke(*two, "--json").stdout)
    assert [run["name"] for run in told["runs"]] == ["first", "second"]
    assert told["runs"][1]["path_length_m"] == 66.0
    assert "path_length_m" in told["differing"]
    assert "coverage" not in told["differing"]


def test_runs_of_the_same_name_are_told_apart(two: list[Path], tmp_path: Path) -> None:
    (tmp_path / "elsewhere").mkdir()
    twin = shutil.copytree(two[0], tmp_path / "elsewhere" / "first")
    told = json.loads(invoke(two[0], twin, "--json").stdout)
    assert [run["name"] for run in told["runs"]] == [str(two[0]), str(twin)]


@pytest.mark.parametrize("content", ["{", "[]", "{}"])
def test_a_folder_without_a_result_is_refused(two: list[Path], content: str) -> None:
    (two[1] / "result.json").write_text(content)
    shown = invoke(*two)
    assert shown.exit_code == 2
    assert str(two[1]) in shown.stderr


def test_one_run_alone_is_refused(two: list[Path]) -> None:
    shown = invoke(two[0])
    assert shown.exit_code == 2
    assert "cannot be compared" in shown.stderr
