from __future__ import annotations

import json
import os
import signal
import textwrap
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from explore_bt.cli import app
from explore_bt.plugin import INLINE_FILE
from explore_bt.types import Pose2

SIDE_M, STEP_M, SCANS = 3.0, 0.04, 25

INTERRUPT = """
    import os
    import signal

    from explore_bt import hookimpl
    from explore_bt.types import Scan2D
    from explore_bt_slam import KissGtsam


    class Interrupted(KissGtsam):
        '''Presses Ctrl-C at the fifth scan.'''

        name = "interrupted"
        seen = 0

        def update(self, measurement):
            super().update(measurement)
            self.seen += isinstance(measurement, Scan2D)
            if self.seen == 5:
                os.kill(os.getpid(), signal.SIGINT)


    @hookimpl
    def explore_bt_register():
        return [Interrupted]
"""


def ranges_from(x: float) -> str:
    """181 beams from (x, 0) in a hall 6 m square, seen along x."""
    angles = np.radians(np.arange(-90, 91))
    cos, sin = np.maximum(np.cos(angles), 1e-9), np.maximum(np.abs(np.sin(angles)), 1e-9)
    return " ".join(f"{r:.2f}" for r in np.minimum((SIDE_M - x) / cos, SIDE_M / sin))


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A straight drive of a metre at five scans a second; the relations are exact, one is of no scan."""
    lines, stamps = [], []
    for i in range(SCANS):
        stamps.append(f"{1000.0 + 0.2 * i:.6f}")
        pose = f"{STEP_M * i:.4f} 0 0"
        lines.append(f"FLASER 181 {ranges_from(STEP_M * i)} {pose} {pose} {stamps[-1]} host 0\n")
    (tmp_path / "hall.clf").write_text("".join(lines))
    relations = [f"{stamps[0]} {stamps[i]} {STEP_M * i} 0 0 0 0 0\n" for i in range(1, SCANS)]
    (tmp_path / "hall.relations").write_text("".join(relations) + f"{stamps[0]} 7.0 1 0 0 0 0 0\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def slam(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["slam", *map(str, arguments)])


def figures(folder: Path) -> dict:
    return json.loads((folder / "out" / "result.json").read_text())


def test_a_log_becomes_the_files_of_a_mission(folder):
    shown = slam("hall.clf", "--out", "out", "--relations", "hall.relations", "--odometry")
    assert shown.exit_code == 0, shown.output
    lines = shown.stdout.splitlines()
    assert lines[0] == "hall.clf, slam kiss_gtsam: getting ready (the first time takes longer, it compiles)"
    assert lines[1].startswith("mapped     25 scans · ")
    assert lines[-4].startswith("error      0.0")
    assert lines[-3:] == [
        "map        out/map.yaml",
        "report     out/report.html",
        "figures    out/result.json",
    ]
    assert "\x1b" not in shown.output
    assert {path.name for path in (folder / "out").iterdir()} == {
        "graph.g2o",
        "map.pgm",
        "map.yaml",
        "map_view.png",
        "report.html",
        "result.json",
        "slam",
        "trajectory.tum",
    }
    result = figures(folder)
    error = result["relations"]
    assert (error["count"], error["missing"]) == (SCANS - 1, 1)
    assert 0.0 <= error["translation_mean_m"] < 0.03
    assert 0.0 <= error["rotation_mean_deg"] < 1.0
    assert result["outcome"] == "mapped"
    assert result["scans"] == SCANS
    assert result["loop_closures"] == 0
    assert 0.0 < result["ms_per_scan_median"] <= result["ms_per_scan_p99"]
    assert result["peak_memory_mb"] > 50
    assert result["health"][0]["state"] == "ok"
    assert result["path_length_m"] == pytest.approx(STEP_M * (SCANS - 1), abs=0.05)


def test_the_trajectory_has_the_logs_own_stamps(folder):
    assert slam("hall.clf", "--out", "out").exit_code == 0
    rows = np.loadtxt(folder / "out" / "trajectory.tum")
    assert rows[:, 0] == pytest.approx(1000.0 + 0.2 * np.arange(SCANS))
    start = Pose2(rows[0, 1], rows[0, 2], 2 * np.arctan2(rows[0, 6], rows[0, 7]))
    assert start.as_array() == pytest.approx([0, 0, 0], abs=1e-6)
    assert figures(folder)["relations"] is None


def test_ctrl_c_saves_what_has_been_mapped_and_ends_with_130(folder):
    (folder / INLINE_FILE).write_text(textwrap.dedent(INTERRUPT))
    before = signal.getsignal(signal.SIGINT)
    shown = slam("hall.clf", "--out", "out", "--slam", "interrupted")
    assert shown.exit_code == 130, shown.output
    assert "reason     stopped by hand (Ctrl-C)" in shown.stdout.splitlines()
    assert figures(folder)["outcome"] == "stopped"
    assert figures(folder)["scans"] == 5
    assert len(np.loadtxt(folder / "out" / "trajectory.tum")) == 5
    assert not [path for path in (folder / "out").iterdir() if path.name.startswith(".")]
    assert signal.getsignal(signal.SIGINT) is before


def test_ctrl_c_before_the_first_scan_saves_an_empty_map(folder):
    at_set_up = INTERRUPT.replace("def update(self, measurement):", "def setup(self, measurement):").replace(
        "super().update(measurement)", "super().setup(measurement)"
    )
    (folder / INLINE_FILE).write_text(
        textwrap.dedent(at_set_up.replace("self.seen += isinstance(measurement, Scan2D)", "self.seen = 5"))
    )
    shown = slam("hall.clf", "--out", "out", "--slam", "interrupted", "--relations", "hall.relations")
    assert shown.exit_code == 130, shown.output
    assert (figures(folder)["scans"], figures(folder)["relations"]) == (0, None)


def test_a_log_that_is_cut_off_is_mapped_so_far_and_ends_with_1(folder):
    text = (folder / "hall.clf").read_text()
    (folder / "hall.clf").write_text(text[: len(text) // 2])
    shown = slam("hall.clf", "--out", "out")
    assert shown.exit_code == 1, shown.output
    reason = "hall.clf:13: cut off: the file ends in the middle of this FLASER line"
    assert f"reason     {reason}" in shown.stdout.splitlines()
    assert (figures(folder)["outcome"], figures(folder)["scans"]) == ("failed", 12)
    assert os.path.getsize(folder / "out" / "map.pgm") > 1000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["none.clf"], "none.clf: there is no such log; give a log file or the folder of a ROS 2 bag"),
        (["hall.clf", "--slam", "kis_gtsam"], 'no slam is called "kis_gtsam"; did you mean "kiss_gtsam"?'),
        (["hall.clf", "--set", "voxl=0.1"], '--set voxl=0.1  kiss_gtsam has no option "voxl"'),
        (["hall.clf", "--set", "voxel=-1 m"], "--set voxel=-1 m  voxel: "),
        (["hall.clf", "--set", "voxel"], "--set voxel  not of the form name=value"),
        (["hall.clf", "--log-option", "radius=2 s"], "--log-option radius=2 s  radius: 2 s is not a length"),
        (["hall.clf", "--slam", "ground_truth", "--odometry"], "--odometry: slam ground_truth has no option"),
        (["hall.clf", "--relations", "hall.clf"], "hall.clf:1: found 192 words; expected 8"),
        (["broken.clf"], 'broken.clf:3: FLASER: range 0 is "x"; expected metres, 0 or more'),
        (["other.clf", "--relations", "hall.relations"], "none of the 25 relations has both its stamps"),
    ],
)
def test_wrong_input_is_told_with_2_and_nothing_is_written(folder, arguments, message):
    lines = (folder / "hall.clf").read_text().splitlines(keepends=True)
    (folder / "broken.clf").write_text("".join(lines[:2]) + "FLASER 1 x 0 0 0 0 0 0 1002 host 0\n")
    (folder / "other.clf").write_text("".join(lines[:2]).replace(" 1000.", " 2000."))
    shown = slam(*arguments, "--out", "out")
    assert shown.exit_code == 2, shown.output
    assert message in shown.stderr
    assert "Traceback" not in shown.stderr
    assert not (folder / "out").exists()


def test_a_folder_is_taken_for_a_bag(folder):
    (folder / "bag").mkdir()
    shown = slam("bag", "--out", "out")
    assert shown.exit_code == 2
    assert "bag: a folder without metadata.yaml; expected a ROS 2 bag" in shown.stderr


def test_help_teaches():
    shown = CliRunner().invoke(app, ["slam", "--help"]).stdout
    for word in ("LOG", "--relations", "--odometry", "Ctrl-C", "Example: explore-bt slam"):
        assert word in shown
