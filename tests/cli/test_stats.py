from __future__ import annotations

import json
from dataclasses import replace

import pytest
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.interfaces import NodeInfo, NodeState
from explore_bt.recording import McapRecorder
from tests.report.flat_drive import make_drive

RUNNING, SUCCESS, IDLE = (
    NodeState("running", "", ticks=1),
    NodeState("success", "", ticks=1, successes=1),
    NodeState("idle", ""),
)


def recorded(drive, folder, states):
    """A run of ten ticks over a root with leaves; each node has a state for even and one for odd ticks."""
    folder.mkdir()
    infos = tuple(
        NodeInfo(k, path, path, "leaf", 0 if k else None, "mission.yaml:1:1") for k, path in enumerate(states)
    )
    ticks = []
    for k, tick in enumerate(drive.ticks[:10]):
        nodes = tuple(state[k % 2] for state in states.values())
        ticks.append(replace(tick, robots=(replace(tick.robots[0], nodes=nodes),)))
    run = replace(drive.run, trees={"robot": infos}, folder=folder)
    replace(drive, run=run, ticks=ticks).show_to(McapRecorder(McapRecorder.Options()))
    return folder


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Two runs of one tree, of which each ticks another leaf, and one of another tree."""
    folder = tmp_path_factory.mktemp("runs")
    drive = make_drive(folder, speed_mps=2.0)
    busy, asleep, root = (RUNNING, SUCCESS), (IDLE, IDLE), (RUNNING, RUNNING)
    trees = {
        "a": {"root": root, "root/x": busy, "root/y": asleep, "root/z": asleep},
        "b": {"root": root, "root/x": asleep, "root/y": busy, "root/z": asleep},
        "c": {"root": root, "root/x": busy, "root/w": asleep},
    }
    return {name: recorded(drive, folder / name, states) for name, states in trees.items()}


def stats(*arguments):
    return CliRunner().invoke(app, ["stats", *map(str, arguments)])


def test_counts_are_added_up_over_runs(runs):
    told = json.loads(stats(runs["a"], runs["b"] / "recording.mcap", "--json").stdout)
    nodes = {node["path"]: node for node in told["nodes"]}
    assert told["runs"] == 2
    assert [(nodes[p]["runs"], nodes[p]["ticked_in"]) for p in ("root", "root/x", "root/y")] == [
        (2, 2), (2, 1), (2, 1)
    ]  # fmt: skip
    assert (nodes["root"]["ticks"], nodes["root/x"]["ticks"], nodes["root/x"]["successes"]) == (20, 10, 5)
    assert nodes["root/x"]["running_s"] == pytest.approx(0.5)
    assert nodes["root/x"]["longest_s"] == pytest.approx(0.1)
    assert told["never_ticked"] == ["root/z"]
    assert told["notes"] == []


def test_nodes_of_trees_that_differ_count_where_they_are_and_it_is_said(runs):
    told = json.loads(stats(*runs.values(), "--json").stdout)
    nodes = {node["path"]: node for node in told["nodes"]}
    assert [nodes[p]["runs"] for p in ("root/x", "root/z", "root/w")] == [3, 2, 1]
    assert told["notes"][0] == "the runs have 2 different trees; a node counts in those that have it"
    assert "4 nodes, 2 of them not in every tree" in told["notes"][1]


def test_the_table_shows_every_node_or_only_those_that_were_never_ticked(runs):
    whole, never = stats(runs["a"], runs["b"]).stdout, stats(runs["a"], runs["b"], "--never").stdout
    assert "3 of 4 nodes ticked in 2 runs (75 %)" in whole
    assert "root/z" in never
    assert "root/x" not in never


def test_a_cut_recording_counts_up_to_its_end_and_says_so(runs, tmp_path):
    data = (runs["a"] / "recording.mcap").read_bytes()
    (tmp_path / "recording.mcap").write_bytes(data[: len(data) * 2 // 3])
    told = stats(tmp_path)
    assert told.exit_code == 0, told.stderr
    assert "cut off after byte" in told.stdout


def test_a_folder_without_a_recording_is_refused(tmp_path):
    told = stats(tmp_path)
    assert told.exit_code == 2
    assert "holds no recording.mcap; name the folder of a run" in told.stderr
