"""``explore-bt debug --terminal``: commands from a pipe, and Ctrl-C at a real terminal."""

from __future__ import annotations

import contextlib
import json
import os
import pty
import select
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from explore_bt.cli import app
from tests.debug.conftest import HEAD, TREE, WORLD

DRIVE = "break drive_to running if speed > 0.2\ncontinue\n"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "box.yaml").write_text(WORLD)
    (tmp_path / "mission.yaml").write_text(HEAD + TREE)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def debug(*lines: str, arguments: tuple[str, ...] = ()) -> Result:
    typed = "".join(f"{line}\n" for line in lines)
    return CliRunner().invoke(
        app, ["debug", "mission.yaml", "--terminal", "--out", "out", *arguments], input=typed
    )


def answers(shown: Result) -> list[list[str]]:
    """What was answered to each command; the first is what is said before any."""
    parts: list[list[str]] = [[]]
    for line in shown.stdout.splitlines():
        if line.startswith("debug> "):
            parts.append([])
        else:
            parts[-1].append(line)
    return parts


def test_a_mission_is_stepped_looked_at_and_driven_to_its_end(folder):
    shown = debug("step", "s 3", "n", "", "where", "tree first", "continue", "where", "quit")
    assert shown.exit_code == 0, shown.output
    said = answers(shown)
    assert said[0] == [
        "mission.yaml, seed 0: getting ready (the first time takes longer, it compiles)",
        "paused at tick 1, 0.20 s: before the first tick",
    ]
    assert said[1] == ["paused at tick 2, 0.30 s: stepped 1 tick"]
    assert said[2] == ["paused at tick 5, 0.60 s: stepped 3 ticks"]
    assert said[3][1] == "  after main/first  RUNNING"
    assert said[4][1] == "  after main/first@timeout  RUNNING"
    assert said[5][0].startswith("tick 4, 0.50 s  robot at (1.00, 1.00) m, heading 0 deg, 0.00 m/s")
    assert said[5][1:] == [
        "main  mission.yaml:22:5",
        "  retry 1  mission.yaml:23:9",
        "    timeout 10 s  mission.yaml:23:9",
    ]
    assert said[6] == ["  RUNNING first (wait)  0.1 s to go"]
    assert said[7][0].startswith("over at tick ")
    assert "heading" in said[8][0]
    assert said[-1][0].startswith("explored   ")
    assert json.loads((folder / "out" / "result.json").read_text())["outcome"] == "explored"
    assert "\x1b" not in shown.output


def test_breakpoints_are_set_hit_listed_and_deleted():
    shown = debug(
        "b drive_to running if speed > 0.2",
        "b second",
        "breaks",
        "disable 2",
        "c",
        "breaks",
        "delete 1",
        "enable 2",
        "delete all",
        "breaks",
        "c",
        "q",
    )
    said = answers(shown)
    assert said[1] == ["breakpoint 1: drive_to after RUNNING if speed > 0.2  at 1 node"]
    assert said[3] == [
        "  1  drive_to after RUNNING if speed > 0.2  1 node, 0 hits",
        "  2  second after  1 node, 0 hits",
    ]
    assert said[5][0].startswith("paused at tick ")
    assert ": breakpoint 1: main/drive_to gave RUNNING (to (3.5, 1.5): " in said[5][0]
    assert said[6][0].endswith("1 node, 1 hit")
    assert said[6][1].endswith("0 hits  (disabled)")
    assert said[10] == ["no breakpoints, no forced nodes"]
    assert shown.exit_code == 0


def test_values_are_printed_by_entry_and_by_expression():
    shown = debug(*DRIVE.splitlines(), "p goal", "p $goal.pose.x - 0.5", "p nothing", "p", "q")
    said = answers(shown)
    assert json.loads(said[3][0])["pose"] == {"class": "Pose2", "x": 3.5, "y": 1.5, "yaw_rad": 0.0}
    assert said[4] == ["3.0"]
    assert said[5][0].startswith('column 1: there is no name "nothing"')
    assert [line.split()[0] for line in said[6]] == ["$goal"]


def test_looking_back_shows_the_run_as_it_was():
    shown = debug(*DRIVE.splitlines(), "back 3", "tree second", "back 0.1 s", "p goal", "p x", "now", "q")
    said = answers(shown)
    assert said[3][0] == "looking back 0.3 s; now leads to the present"
    assert said[4] == ["  SUCCESS second (wait)  0.0 s to go"]
    assert said[5][0] == "looking back 0.4 s; now leads to the present"
    assert json.loads(said[6][0])["class"] == "Waypoint"
    assert said[7] == ["an expression has a value only now; look at entries here, or say now"]
    assert said[8][0].startswith("paused at tick ")


def test_a_forced_failure_ends_the_mission_and_is_in_its_last_words(folder):
    shown = debug("force drive_to failure", "breaks", "c", "log", "q")
    said = answers(shown)
    assert said[1] == ["1 node forced to FAILURE, until released"]
    assert said[2] == ["forced to FAILURE until released, 0 answers: robot main/drive_to"]
    assert any("drive_to: forced to FAILURE by the debugger" in line for line in said[4])
    assert shown.exit_code == 1
    assert "reason     drive_to: forced to FAILURE by the debugger" in said[-1]


def test_parameters_are_listed_and_changed():
    shown = debug("param", "param first=0.9 s", "param frist=1", "param first", "q")
    said = answers(shown)
    assert "first = 0.5 s  (duration)" in said[1]
    assert said[2] == ["first = 0.9 s, was 0.5 s: duration of main/first"]
    assert 'did you mean "first"?' in said[3][0]
    assert "for example: param stride=1.2 m" in said[4][0]


MOCKS = """
format: explore-bt-mocks/1
mocks:
  - leaf: "*/drive_to"
    ticks: [running*3, success]
    say: played
"""


def test_a_dry_run_is_debugged_like_any_other(folder):
    (folder / "mocks.yaml").write_text(MOCKS)
    shown = debug(
        "param first=0.9 s",
        "break drive_to success",
        "c",
        "tree drive_to",
        "c",
        "q",
        arguments=("--mock", "mocks.yaml"),
    )
    assert shown.exit_code == 0, shown.output
    said = answers(shown)
    assert said[1] == ["first = 0.9 s, was 0.5 s: duration of main/first"]
    assert any("played" in line for line in said[4])
    assert json.loads((folder / "out" / "result.json").read_text())["mocked"] == ["main/drive_to"]


def test_a_mock_file_with_a_fault_is_told_before_anything_is_written(folder):
    (folder / "mocks.yaml").write_text(MOCKS.replace("drive_to", "drive_too"))
    shown = debug(arguments=("--mock", "mocks.yaml"))
    assert shown.exit_code == 2
    assert "mocks.yaml:4:" in shown.stderr
    assert not (folder / "out").exists()


def test_what_is_mistyped_gets_a_hint_and_the_next_line_is_read():
    shown = debug("stpe", "step 3 tiks", "break", "break x y", "back far", "delete", "robot bob", "de 7", "q")
    said = answers(shown)
    assert [lines[0] for lines in said[1:9]] == [
        'there is no command "stpe"; did you mean "step"?',
        'there is no step "tiks"; did you mean "tick"?',
        "break where? For example: break drive_to failure",
        '"y" is not understood here; words: after, before, failure, idle, if, ignore, once, robot, running, '
        "success",
        '"far" is not a number of ticks, or seconds as in: back 30 s; write a whole number',
        "delete which? For example: delete 1, or delete all",
        'there is no robot "bob"; robots: robot',
        "there is no breakpoint 7; known: none is set",
    ]


def test_help_lists_every_command_and_explains_each():
    shown = debug("help", "help break", "h nothing", "map", "step", "map", "q")
    said = answers(shown)
    assert any(line.split()[:2] == ["q", "quit"] for line in said[1])
    assert "coverage" in "".join(said[2])
    assert said[3][0].startswith('there is no command "nothing"')
    assert any("→" in line for line in said[4])
    assert any("→" in line for line in said[6])


def test_the_end_of_the_commands_stops_the_run_safely_and_saves_its_results(folder):
    shown = debug("step 5")
    assert shown.exit_code == 130
    assert "stopping: the robots brake, then the results are saved" in shown.stdout
    assert json.loads((folder / "out" / "result.json").read_text())["reason"] == "stopped by hand (debugger)"


def test_what_is_asked_of_a_run_that_is_over_is_answered_from_its_history():
    shown = debug("c", "s", "p goal", "back 3 s", "tree", "param first=1 s", "q")
    said = answers(shown)
    assert said[2] == ["the run is over; tree, print, where, map and back still show it"]
    assert json.loads(said[3][0])["class"] == "Waypoint"
    assert said[4][0] == "looking back 3.0 s; now leads to the present"
    assert any("drive_to" in line for line in said[5])
    assert said[6] == ["the run is over"]
    assert shown.exit_code == 0


def test_wrong_input_is_told_as_by_run_and_nothing_is_written(folder):
    before = set(folder.iterdir())
    shown = debug("c", arguments=("--set", "frist=3 s"))
    assert (shown.exit_code, 'there is no parameter "frist"' in shown.stderr) == (2, True)
    shown = debug("c", "q", arguments=("--set", "radius=1.5 m"))
    assert shown.exit_code == 2, shown.output
    assert "over" not in shown.stdout
    assert set(folder.iterdir()) == before


class Terminal:
    """The program at a terminal of its own."""

    def __init__(self, *arguments: str) -> None:
        self._own, theirs = pty.openpty()
        self.shown, self._read = "", 0
        command = "from explore_bt.cli import main; main()"
        self.process = subprocess.Popen(
            [sys.executable, "-c", command, *arguments],
            stdin=theirs,
            stdout=theirs,
            stderr=theirs,
            start_new_session=True,
            env={**os.environ, "TERM": "dumb"},
            preexec_fn=lambda: _take_terminal(theirs),
        )
        os.close(theirs)

    def expect(self, words: str, within_s: float = 120.0) -> None:
        while words not in self.shown[self._read :]:
            if not select.select([self._own], [], [], within_s)[0]:
                raise TimeoutError(f"{words!r} never came: {self.shown}")
            try:
                self.shown += os.read(self._own, 65536).decode()
            except OSError:
                raise AssertionError(f"{words!r} never came: {self.shown}") from None
        self._read = self.shown.index(words, self._read) + len(words)

    def type(self, text: str) -> None:
        os.write(self._own, text.encode())

    def interrupt(self, answer: str) -> None:
        """Ctrl-C until it is answered: CPython's ``input`` sleeps over one that comes just as it begins."""
        for _ in range(12):
            self.type("\x03")
            with contextlib.suppress(TimeoutError):
                self.expect(answer, within_s=5)
                return
        raise AssertionError(f"Ctrl-C was never answered by {answer!r}: {self.shown}")

    def hang_up(self) -> None:
        os.close(self._own)


def _take_terminal(terminal: int) -> None:
    import fcntl
    import termios

    fcntl.ioctl(terminal, termios.TIOCSCTTY, 0)
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # it is ignored below a shell's &


def test_ctrl_c_pauses_and_only_the_next_ones_stop_the_robot(folder):
    terminal = Terminal("debug", "mission.yaml", "--terminal", "--out", "out", "--set", "first=59 s")
    terminal.expect("debug> ")
    terminal.type("c\n")
    terminal.expect("running; Ctrl-C pauses")
    terminal.type("where\n")
    terminal.expect("first")
    terminal.type("pause\n")
    terminal.expect("paused by hand")
    terminal.expect("debug> ")
    terminal.type("c\n")
    terminal.expect("running")
    terminal.interrupt("paused by hand")
    terminal.expect("debug> ")
    terminal.interrupt("once more")
    terminal.expect("debug> ")
    terminal.interrupt("stopping: the robots brake")
    terminal.expect("stopped by hand")
    assert terminal.process.wait(60) == 130
    assert json.loads((folder / "out" / "result.json").read_text())["outcome"] == "stopped"


def test_a_lost_connection_stops_the_robot_and_saves_the_results(folder):
    terminal = Terminal("debug", "mission.yaml", "--terminal", "--out", "out", "--set", "first=59 s")
    terminal.expect("debug> ")
    terminal.type("c\n")
    terminal.expect("running; Ctrl-C pauses")
    terminal.hang_up()
    terminal.process.wait(60)
    assert json.loads((folder / "out" / "result.json").read_text())["outcome"] == "stopped"


def test_sigterm_stops_a_paused_run_and_saves_its_results(folder):
    terminal = Terminal("debug", "mission.yaml", "--terminal", "--out", "out")
    terminal.expect("debug> ")
    terminal.process.terminate()
    terminal.expect("stopped by hand (SIGTERM)")
    assert terminal.process.wait(60) == 130
    assert json.loads((folder / "out" / "result.json").read_text())["outcome"] == "stopped"
