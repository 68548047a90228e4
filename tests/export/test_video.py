from __future__ import annotations

from dataclasses import replace
from itertools import islice

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.export.video import film
from explore_bt.export.video.canvas import Canvas
from explore_bt.export.video.film import HEIGHT, WIDTH, frame_count
from explore_bt.export.video.map_pane import FREE, UNKNOWN, WALL, MapPane
from explore_bt.export.video.scene import Scene
from explore_bt.export.video.tree_pane import STATUS_COLOURS, TreePane
from explore_bt.recording import McapRecorder, read_recording
from explore_bt.report.palette import robot_colour
from explore_bt.types import FREE as FREE_CELL
from explore_bt.types import OCCUPIED, OccupancyGrid, Pose2
from tests.report.flat_drive import make_drive

STEP_S = 5.0


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    drive = make_drive(tmp_path_factory.mktemp("drive"), speed_mps=0.8)
    drive.show_to(McapRecorder(McapRecorder.Options()))
    return drive


@pytest.fixture(scope="module")
def recording(drive):
    return read_recording(drive.run.folder / "recording.mcap")


@pytest.fixture(scope="module")
def frames(recording):
    return list(film(recording, STEP_S))


def scene_at(recording, stamp_s):
    scene = Scene(recording.info["trees"])
    for message in recording.messages(end_s=stamp_s + 1e-9):
        scene.take(message)
    return scene


def has_colour(part, colour):
    return bool((np.abs(part.astype(int) - colour).max(axis=-1) <= 2).any())


def test_there_is_a_frame_for_every_step_and_one_for_the_end(frames, recording):
    assert len(frames) == frame_count(recording, STEP_S) == int(recording.duration_s / STEP_S) + 2
    assert {frame.shape for frame in frames} == {(HEIGHT, WIDTH, 3)}


def test_the_same_recording_gives_the_same_pixels(frames, recording):
    again = film(recording, STEP_S)
    assert all(np.array_equal(one, other) for one, other in zip(islice(frames, 6), again, strict=False))
    assert not np.array_equal(frames[1], frames[2])


def test_a_scene_is_the_run_at_that_moment(drive, recording):
    tick = drive.ticks[len(drive.ticks) // 2]
    shown, robot = scene_at(recording, tick.stamp_s).robots["robot"], tick.robots[0]
    assert shown.nodes == [(node.status, node.message) for node in robot.nodes]
    assert shown.pose is not None
    assert shown.pose.xy == pytest.approx(robot.estimate.T_map_base.xy, abs=1e-4)
    assert len(shown.trail) == drive.ticks.index(tick) + 1
    assert [mark["state"] for mark in shown.layers["sectors"]] == ["rejected", "taken"]
    scan = drive.ticks[drive.ticks.index(tick) // 5 * 5].robots[0].scan
    assert len(shown.scan) == int(scan.is_return.sum())


def test_the_map_stands_where_its_coordinates_say():
    cells = np.full((40, 60), FREE_CELL, dtype=np.int8)
    cells[30, 5] = OCCUPIED
    scene = Scene({"robot": []})
    scene.robots["robot"].grid = OccupancyGrid(cells, 0.1, (1.0, 2.0))
    pane = MapPane((0, 0, 740, 600), (0.0, 0.0, 10.0, 8.0), {"robot": 0.25})
    canvas = Canvas(740, 600, (0, 0, 0))
    pane.draw(canvas, scene)
    for metres, colour in (
        ((1.55, 5.05), WALL),
        ((1.65, 5.05), FREE),
        ((6.9, 5.9), FREE),
        ((0.5, 1.0), UNKNOWN),
    ):
        x, y = np.floor(pane.pixels_of(np.array(metres))).astype(int)
        assert tuple(canvas.pixels[y, x]) == colour, metres


def test_the_robot_stands_on_the_map_where_it_is():
    scene = Scene({"robot": []})
    scene.robots["robot"].pose = Pose2(3.0, 4.0, 0.0)
    pane = MapPane((0, 0, 740, 600), (0.0, 0.0, 10.0, 8.0), {"robot": 0.25})
    canvas = Canvas(740, 600, (0, 0, 0))
    pane.draw(canvas, scene)
    blue = np.argwhere((canvas.pixels == Canvas(1, 1, _rgb(robot_colour(0))).pixels[0, 0]).all(axis=-1))
    x, y = pane.pixels_of(np.array((3.0, 4.0)))
    assert blue.mean(axis=0) == pytest.approx((y, x), abs=3.0)
    assert len(blue) > 0.7 * np.pi * (0.25 * pane.scale) ** 2


def _rgb(text):
    return tuple(int(text[k : k + 2], 16) for k in (1, 3, 5))


def test_every_node_has_a_dot_of_its_status(recording):
    scene = scene_at(recording, 20.0)
    canvas = Canvas(WIDTH, HEIGHT, (255, 255, 255))
    TreePane((740, 0, 540, 600)).draw(canvas, scene)
    for row, (status, _) in enumerate(scene.robots["robot"].nodes):
        line = canvas.pixels[8 + 19 * row : 8 + 19 * (row + 1), 740:]  # the words come later
        others = [colour for name, colour in STATUS_COLOURS.items() if name != status]
        assert has_colour(line, STATUS_COLOURS[status]), row
        assert not any(has_colour(line, colour) for colour in others), row


def test_of_a_large_tree_the_branch_that_runs_is_shown():
    tree = [{"path": "root", "name": "root", "parent": None}]
    for child in range(30):
        tree.append({"path": f"root/{child}", "name": str(child), "parent": 0})
        for leaf in range(5):
            name = f"{child}.{leaf}"
            tree.append({"path": f"root/{child}/{name}", "name": name, "parent": 6 * child + 1})
    scene = Scene({"robot": tree})
    nodes = scene.robots["robot"].nodes
    for index in (0, 6 * 12 + 1, 6 * 12 + 3):
        nodes[index] = ("running", "")
    canvas = Canvas(WIDTH, HEIGHT, (255, 255, 255))
    TreePane((740, 0, 540, 720)).draw(canvas, scene)
    words = [text for _, text, *_ in canvas._words]
    assert "12.2" in words
    assert "11.2" not in words


def test_the_file_holds_the_film(frames, drive, tmp_path):
    path = tmp_path / "new" / "film.mp4"
    told = CliRunner().invoke(
        app, ["export", str(drive.run.folder), "--video", str(path), "--speed", "50", "--rate", "10"]
    )
    assert told.exit_code == 0, told.output
    assert "at 50 ×" in told.stdout
    video = cv2.VideoCapture(str(path))
    assert round(video.get(cv2.CAP_PROP_FPS)) == 10
    shown = [cv2.cvtColor(video.read()[1], cv2.COLOR_BGR2RGB) for _ in frames]
    assert not video.read()[0]
    for one, other in zip(frames, shown, strict=True):
        assert np.abs(one.astype(int) - other).mean() < 4.0  # lossy, but the same picture
    assert [each.name for each in path.parent.iterdir()] == ["film.mp4"]
    again = CliRunner().invoke(app, ["export", str(drive.run.folder), "--video", str(path)])
    assert (again.exit_code, "is there already" in again.stderr) == (2, True)


def test_a_cut_recording_and_one_of_two_robots_are_filmed_too(tmp_path):
    drive = make_drive(tmp_path, speed_mps=0.8, robots=("anna", "bert"))
    replace(drive, ticks=drive.ticks[:150]).show_to(McapRecorder(McapRecorder.Options()))
    data = (tmp_path / "recording.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(data[: len(data) * 2 // 3])
    frame = list(film(read_recording(tmp_path / "cut.mcap"), STEP_S))[-1]
    assert has_colour(frame[:600, :740], _rgb(robot_colour(0)))
    assert has_colour(frame[:600, :740], _rgb(robot_colour(1)))
