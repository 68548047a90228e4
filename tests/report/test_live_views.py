from __future__ import annotations

import io
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from explore_bt.interfaces import Event, NodeState
from explore_bt.report import ProgressLines, TerminalView
from explore_bt.report.live.map_dots import MapDots, RobotMark
from explore_bt.report.live.narrator import Narrator
from explore_bt.report.live.screen import Screen
from explore_bt.types import Estimate, Health, OccupancyGrid, Pose2


class Wall:
    """A clock on the wall that moves when told."""

    def __init__(self):
        self.now_s = 1000.0

    def __call__(self):
        return self.now_s


def terminal(width=80, height=24, **options):
    return Console(
        file=io.StringIO(),
        width=width,
        height=height,
        force_terminal=True,
        color_system="truecolor",
        **options,
    )


def screen_of(drive, count, width=79, height=23, events=()):
    screen = Screen(drive.run, width, height)
    for tick in drive.ticks[:count]:
        screen.on_tick(tick)
    for event in events:
        screen.on_event(event)
    return screen.lines(drive.ticks[count - 1], 63.2)


def plain(lines):
    return "\n".join(line.plain.rstrip() for line in lines)


@pytest.mark.parametrize(("width", "height"), [(79, 23), (40, 10), (200, 60), (20, 5)])
def test_no_screen_is_larger_than_its_terminal(flat_drive, pair_drive, width, height):
    for drive in (flat_drive, pair_drive):
        lines = screen_of(drive, 400, width, height)
        assert len(lines) <= max(height, 10)
        assert all(line.cell_len <= max(width, 40) for line in lines)
        assert all("\n" not in line.plain for line in lines)


def test_the_screen_tells_branch_reason_figures_and_time(flat_drive):
    text = plain(screen_of(flat_drive, 700))
    assert "explore-bt 01_apartment" in text
    assert "1:09   63.2 × real time" in text
    assert "% mapped" in text
    assert " m  0.40 m/s  0 contacts" in text
    assert "        └ drive_to" in text
    assert "find_next_heading" in text
    assert "widest 62° rejected" in text


def test_the_last_warning_stands_in_the_last_line(flat_drive):
    events = [
        Event(3.0, "robot", "warning", "gate", "clearance ahead\n0.27 m"),
        Event(4.0, "robot", "info", "slam", "loop closed"),
    ]
    assert plain(screen_of(flat_drive, 100, events=events)).endswith("0:03 gate: clearance ahead 0.27 m")


def test_braking_and_a_degraded_slam_are_shown_with_their_reason(flat_drive):
    robot = flat_drive.ticks[99].robots[0]
    estimate = Estimate(9.9, robot.estimate.T_map_base, health=Health.DEGRADED, reason="few returns")
    ticks = [*flat_drive.ticks]
    ticks[99] = replace(ticks[99], robots=(replace(robot, estimate=estimate, gate_reason="0.27 m ahead"),))
    text = plain(screen_of(replace(flat_drive, ticks=ticks), 100))
    assert "braking: 0.27 m ahead" in text
    assert "SLAM degraded: few returns" in text


def test_a_mission_name_is_not_taken_for_markup(flat_drive):
    drive = replace(flat_drive, run=replace(flat_drive.run, mission="[red]x[/red]"))
    console = terminal()
    console.print(*screen_of(drive, 10))
    assert "[red]x[/red]" in console.file.getvalue()


def test_two_robots_share_the_screen(pair_drive):
    text = plain(screen_of(pair_drive, 300))
    assert "anna" in text
    assert "bert <b>" in text


def test_the_view_draws_by_the_wall_clock_not_by_ticks(flat_drive):
    wall, console = Wall(), terminal()
    view = TerminalView(TerminalView.Options(), console, wall)
    view.open(flat_drive.run)
    pictures = 0
    for tick in flat_drive.ticks[:1000]:
        wall.now_s += 0.001
        before = console.file.tell()
        view.on_tick(tick)
        pictures += console.file.tell() > before
    view.close(flat_drive.result)
    assert 4 <= pictures <= 6


def test_the_last_picture_is_left_standing_and_the_cursor_comes_back(flat_drive):
    console = terminal()
    view = TerminalView(TerminalView.Options(), console, Wall())
    flat_drive.show_to(view)
    view.close(flat_drive.result)
    written = console.file.getvalue()
    assert written.rindex("\x1b[?25h") > written.rindex("\x1b[?25l")
    assert "2:14" in written


def test_where_there_is_no_terminal_the_view_is_silent(flat_drive):
    console = Console(file=io.StringIO(), force_terminal=False)
    flat_drive.show_to(TerminalView(TerminalView.Options(), console, Wall()))
    assert console.file.getvalue() == ""


CRASHED = """
import pathlib, sys
from rich.console import Console
from tests.report.flat_drive import make_drive
from explore_bt.report import TerminalView

drive = make_drive(pathlib.Path("."), speed_mps=4.0)
view = TerminalView(TerminalView.Options(), Console(force_terminal=True, width=80, height=24))
view.open(drive.run)
view.on_tick(drive.ticks[0])
raise SystemExit(7)
"""


def test_a_program_that_ends_without_closing_gives_the_cursor_back():
    done = subprocess.run([sys.executable, "-c", CRASHED], capture_output=True, check=False)
    assert done.returncode == 7
    assert done.stdout.rindex(b"\x1b[?25h") > done.stdout.rindex(b"\x1b[?25l")


def test_progress_is_one_plain_line_every_ten_seconds_of_wall_time(flat_drive):
    wall, console = Wall(), Console(file=io.StringIO(), width=60)
    lines = ProgressLines(ProgressLines.Options(), console, wall)
    lines.open(flat_drive.run)
    for tick in flat_drive.ticks[:900]:
        wall.now_s += 0.05
        lines.on_tick(tick)
    lines.close(flat_drive.result)
    written = console.file.getvalue().splitlines()
    assert len(written) == 4
    assert written[0].startswith("0:20  53 % mapped · 7.5 m · find_next_heading: 3 sectors")
    assert "\x1b" not in console.file.getvalue()


def test_a_room_is_drawn_with_its_walls_and_its_robot():
    cells = np.zeros((16, 16), dtype=np.int8)
    cells[0], cells[-1], cells[:, 0], cells[:, -1] = 100, 100, 100, 100
    grid = OccupancyGrid(cells, 0.25, (-2.0, -2.0))
    mark = RobotMark(Pose2(-0.9, 0.9, 0.0), np.array([[-0.9, 0.9]]), Pose2(1.1, -0.9, 0.0), "cyan")
    lines = [line.plain for line in MapDots(8, 4).lines(grid, [mark])]
    assert lines == ["⡏⠉⠉⠉⠉⠉⠉⢹", "⡇ →    ⢸", "⡇     ◎⢸", "⣇⣀⣀⣀⣀⣀⣀⣸"]


def test_a_map_without_a_known_cell_is_blank():
    grid = OccupancyGrid(np.full((4, 4), -1, dtype=np.int8), 0.05, (0.0, 0.0))
    mark = RobotMark(Pose2(float("nan"), 0.0, 0.0), np.empty((0, 2)), None, "cyan")
    assert {line.plain.strip() for line in MapDots(6, 3).lines(grid, [mark])} == {""}


def test_a_leaf_that_only_counts_keeps_its_place_among_the_reasons(flat_drive):
    infos = flat_drive.run.trees["robot"][:3]
    narrator = Narrator(infos)

    def tick(stamp_s, *said):
        narrator.on_tick(stamp_s, tuple(NodeState(status, message) for status, message in said))

    idle = ("idle", "")
    tick(0.0, ("running", ""), ("running", "1.2 m to go"), idle)
    tick(1.0, ("running", ""), ("success", "there"), ("running", "turning 40°"))
    tick(2.0, ("running", ""), ("success", "there"), ("running", "turning 20°"))
    assert [(reason.stamp_s, reason.words) for reason in narrator.reasons(5)] == [
        (1.0, "turning 20°"),
        (1.0, "there"),
    ]
    assert narrator.newest() == f"{infos[2].name}: turning 20°"
