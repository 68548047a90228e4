from __future__ import annotations

import csv
import math
from dataclasses import replace

import pyarrow.parquet
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.export import TABLES, Table, read_tables, write_csv
from explore_bt.interfaces import Event
from explore_bt.recording import McapRecorder, read_recording
from tests.report.flat_drive import make_drive


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    """Half a minute of two robots, recorded."""
    drive = make_drive(tmp_path_factory.mktemp("drive"), speed_mps=0.8, robots=("anna", "bert"))
    said = Event(2.0, "bert", "debug", "root/drive_to", 'two "lines",\nof it')
    events = sorted([*drive.events, said], key=lambda event: event.stamp_s)
    drive = replace(drive, ticks=drive.ticks[:300], events=events)
    drive.show_to(McapRecorder(McapRecorder.Options()))
    return drive


@pytest.fixture(scope="module")
def tables(drive):
    return read_tables(read_recording(drive.run.folder / "recording.mcap"))


def rows(table: Table, **where: object) -> list[dict[str, object]]:
    named = [dict(zip(table.columns, row, strict=True)) for row in table.rows()]
    return [row for row in named if all(row[name] == value for name, value in where.items())]


def test_there_is_a_pose_for_every_tick_of_every_robot(tables, drive):
    for robot, name in enumerate(("anna", "bert")):
        told = rows(tables["poses"], robot=name)
        assert len(told) == len(drive.ticks)
        for row, tick in list(zip(told, drive.ticks, strict=True))[::37]:
            pose = tick.robots[robot].estimate.T_map_base
            assert (row["x_m"], row["y_m"]) == pytest.approx((pose.x, pose.y), abs=1e-4)
            assert math.cos(row["yaw_rad"] - pose.yaw_rad) == pytest.approx(1.0)


def test_states_hold_way_coverage_battery_and_budgets(tables, drive):
    last = rows(tables["states"], robot="bert")[-1]
    tick = min(drive.ticks, key=lambda tick: abs(tick.stamp_s - last["time_s"]))
    shown = tick.robots[1]
    assert last["distance_m"] == pytest.approx(shown.score.distance_m, abs=1e-5)
    assert last["coverage"] == pytest.approx(shown.score.coverage, abs=1e-5)
    assert last["charge"] == pytest.approx(shown.charge, abs=1e-5)
    assert last["left_time"] == pytest.approx(shown.budgets[0].left, abs=1e-5)


def test_transitions_are_changes_and_add_up_to_every_state(tables, drive):
    table, infos = rows(tables["transitions"], robot="anna"), drive.run.trees["anna"]
    shown: dict[str, tuple[object, object]] = {}
    for tick in drive.ticks:
        while table and table[0]["time_s"] <= tick.stamp_s + 1e-9:
            row = table.pop(0)
            state = (row["status"], row["message"])
            assert shown.get(row["path"]) != state
            shown[row["path"]] = state
        states = {info.path: node for info, node in zip(infos, tick.robots[0].nodes, strict=True)}
        assert shown == {path: (node.status, node.message) for path, node in states.items()}
    assert not table


def test_numbers_of_the_blackboard_are_told_when_they_change(tables, drive):
    left = rows(tables["blackboard"], robot="anna", entry="left_m")
    board = [tick.robots[0].blackboard["left_m"] for tick in drive.ticks]
    changes = [value for k, value in enumerate(board) if k == 0 or value != board[k - 1]]
    assert [row["value"] for row in left] == pytest.approx(changes, abs=1e-5)
    assert rows(tables["blackboard"], entry="goal.pose.x")


def test_events_keep_robot_source_and_words_apart(tables, drive):
    told = [(row["robot"], row["level"], row["source"], row["message"]) for row in rows(tables["events"])]
    shown = [event for event in drive.events if event.stamp_s <= drive.ticks[-1].stamp_s]
    assert len(shown) > 1
    assert {(e.robot, e.level, e.source, e.message) for e in shown} <= set(told)


def test_nodes_hold_the_last_counts(tables, drive):
    told = rows(tables["nodes"], robot="anna")
    assert [row["path"] for row in told] == [info.path for info in drive.run.trees["anna"]]
    assert told[0]["ticks"] == len(drive.ticks)


def test_the_same_tables_come_out_as_csv_and_as_parquet(tables, drive, tmp_path):
    arguments = ["export", str(drive.run.folder), "--csv", f"{tmp_path}/c", "--parquet", f"{tmp_path}/p"]
    told = CliRunner().invoke(app, arguments)
    assert told.exit_code == 0, told.output
    for name, table in tables.items():
        with (tmp_path / "c" / f"{name}.csv").open(newline="", encoding="utf-8") as file:
            head, *body = csv.reader(file)
        assert head == list(table.columns)
        assert head[: len(TABLES[name])] == list(TABLES[name])
        assert body == [["" if cell is None else str(cell) for cell in row] for row in table.rows()]
        columns = pyarrow.parquet.read_table(tmp_path / "p" / f"{name}.parquet").to_pydict()
        assert columns == table.columns
        assert f"{name}.csv  {len(table)} row" in told.stdout


@given(st.lists(st.text(alphabet="a é,;\"'\r\n\t→", max_size=8), max_size=5))
def test_any_words_survive_csv(tmp_path_factory, words):
    table = Table("n", "said")
    for number, said in enumerate(words):
        table.add({"n": number, "said": said})
    (path,) = write_csv({"t": table}, tmp_path_factory.getbasetemp())
    with path.open(newline="", encoding="utf-8") as file:
        assert [row["said"] for row in csv.DictReader(file)] == words


def test_a_figure_that_turns_up_later_is_empty_before():
    table = Table("a")
    table.add({"a": 1})
    table.add({"b": 2})
    assert list(table.rows()) == [(1, None), (None, 2)]


def test_a_cut_recording_is_exported_up_to_its_end(drive, tmp_path):
    data = (drive.run.folder / "recording.mcap").read_bytes()
    (tmp_path / "recording.mcap").write_bytes(data[: len(data) // 2])
    told = CliRunner().invoke(app, ["export", str(tmp_path), "--csv", str(tmp_path / "tables")])
    assert told.exit_code == 0
    assert "cut off after byte" in told.stderr
    assert 50 < len((tmp_path / "tables" / "poses.csv").read_text().splitlines()) < 2 * len(drive.ticks)


def test_nothing_to_do_and_folders_in_use_are_refused_before_anything_is_written(drive, tmp_path):
    (tmp_path / "old.txt").touch()
    for arguments, complaint in (
        ([], "nothing to export to"),
        (["--csv", str(tmp_path / "new"), "--video", "film.avi"], "videos are MP4 files; write film.mp4"),
        (["--csv", str(tmp_path / "new"), "--parquet", str(tmp_path)], "is not empty"),
    ):
        told = CliRunner().invoke(app, ["export", str(drive.run.folder), *arguments])
        assert told.exit_code == 2
        assert complaint in told.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["old.txt"]


def test_without_the_library_parquet_names_the_line_to_type(drive, tmp_path, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    told = CliRunner().invoke(app, ["export", str(drive.run.folder), "--parquet", str(tmp_path / "p")])
    assert told.exit_code == 2
    assert 'pip install "explore-bt[tables]"' in told.stderr
    assert not (tmp_path / "p").exists()
