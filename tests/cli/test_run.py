from __future__ import annotations

import json
import tempfile
import textwrap
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from explore_bt.cli import app
from explore_bt.plugin import INLINE_FILE

WORLD = """
    format: explore-bt-world/1
    name: box
    start: [1.5, 1.5, 0 deg]
    rooms:
      - {name: room, box: [0.0, 0.0, 3.0, 3.0]}
"""

MISSION = """
    format: explore-bt/1
    name: box
    params:
      wait: {type: duration, default: 0.3 s}
    robots:
      robot:
        driver: {use: sim2d, world: box.yaml}
        slam: {use: ground_truth}
        planner: {use: grid_astar}
        controller: {use: pursuit}
    limits: {time: 2 s}
    tree: main
    trees:
      main: {wait: {duration: $params.wait}}
"""

INTERRUPT = """
    import os
    import signal

    from explore_bt import hookimpl
    from explore_bt.tree import Leaf, Status


    class Interrupt(Leaf):
        '''Presses Ctrl-C.'''

        type_key = "interrupt"

        def update(self):
            if not self.robot.stop_requested:
                os.kill(os.getpid(), signal.SIGINT)
            return Status.RUNNING


    @hookimpl
    def explore_bt_register():
        return [Interrupt]
"""

FALLING = """
    from explore_bt import hookimpl
    from explore_bt_planners import GridAstar


    class Falling(GridAstar):
        '''Falls over when it is set up.'''

        name = "falling"

        def setup(self, context):
            1 / 0


    @hookimpl
    def explore_bt_register():
        return [Falling]
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "box.yaml").write_text(textwrap.dedent(WORLD))
    write_mission(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write_mission(folder: Path, before: str = "", after: str = "") -> None:
    assert before in MISSION
    (folder / "mission.yaml").write_text(
        textwrap.dedent(MISSION.replace(before, after) if before else MISSION)
    )


def write_inline(folder: Path, code: str) -> None:
    (folder / INLINE_FILE).write_text(textwrap.dedent(code))


def run(*arguments: object) -> Result:
    return CliRunner().invoke(app, ["run", "mission.yaml", "--headless", *map(str, arguments)])


def test_an_explored_mission_ends_with_0_its_figures_and_its_files(folder):
    shown = run("--out", "out", "--seed", "3")
    assert shown.exit_code == 0, shown.output
    lines = shown.stdout.splitlines()
    assert lines[0] == "mission.yaml, seed 3: getting ready (the first time takes longer, it compiles)"
    assert lines[-6].startswith("explored   ")
    assert lines[-6].endswith(" · 0 contacts · closest 1.45 m · home within 0 cm")
    assert lines[-5].startswith("reason     main: ")
    assert lines[-4:] == [
        "map        out/map.yaml",
        "report     out/report.html",
        "recording  out/recording.mcap",
        "replay     explore-bt replay out",
    ]
    result = json.loads((folder / "out" / "result.json").read_text())
    assert (result["outcome"], result["seed"]) == ("explored", 3)
    assert "\x1b" not in shown.output


def test_a_run_without_out_lands_in_runs_under_the_missions_name(folder):
    assert run().exit_code == 0
    (made,) = (folder / "runs").iterdir()
    assert made.name.startswith("mission-")


def test_a_spent_budget_ends_with_1(folder):
    shown = run("--out", "out", "--set", "wait=10 min")
    assert shown.exit_code == 1
    assert "reason     the time budget of 2 s is spent" in shown.stdout.splitlines()


def test_a_failed_tree_ends_with_1(folder):
    wait = "{wait: {duration: $params.wait}}"
    write_mission(folder, f"main: {wait}", f"main: {{invert: {wait}}}")
    shown = run("--out", "out")
    assert shown.exit_code == 1, shown.output
    assert any(line.startswith("failed     ") for line in shown.stdout.splitlines())


def test_ctrl_c_ends_with_130_and_the_results_are_saved(folder):
    write_inline(folder, INTERRUPT)
    write_mission(folder, "main: {wait: {duration: $params.wait}}", "main: {interrupt: {}}")
    shown = run("--out", "out")
    assert shown.exit_code == 130, shown.output
    assert "reason     stopped by hand (Ctrl-C)" in shown.stdout.splitlines()
    assert json.loads((folder / "out" / "result.json").read_text())["outcome"] == "stopped"


def test_a_fault_in_the_mission_is_told_with_2_and_nothing_is_written(folder):
    before = set(folder.iterdir())
    shown = run("--out", "out", "--set", "wit=3 s")
    assert shown.exit_code == 2
    assert shown.stderr.splitlines()[0].startswith('--set wit=3 s  there is no parameter "wit"')
    assert set(folder.iterdir()) == before


def test_a_start_in_a_wall_is_told_with_2_and_nothing_is_written(folder):
    (folder / "box.yaml").write_text(textwrap.dedent(WORLD.replace("[1.5, 1.5, 0 deg]", "[0.1, 0.1, 0 deg]")))
    before = set(folder.iterdir())
    shown = run("--out", "out")
    assert shown.exit_code == 2
    assert "box.yaml" in shown.stderr
    assert "Traceback" not in shown.stderr
    assert set(folder.iterdir()) == before


def test_a_folder_that_holds_something_is_left_alone(folder):
    (folder / "out").mkdir()
    (folder / "out" / "map.yaml").write_text("mine")
    shown = run("--out", "out")
    assert (shown.exit_code, shown.stderr) == (
        2,
        "out is not empty; nothing is ever overwritten, name a new folder with --out\n",
    )
    assert (folder / "out" / "map.yaml").read_text() == "mine"


def test_an_unknown_sink_is_told_with_2(folder):
    shown = run("--sink", "mcp")
    assert shown.exit_code == 2
    assert shown.stderr.startswith('no sink is called "mcp"; did you mean "mcap"? Installed: ')


def test_a_broken_inline_plugin_is_told_with_2_and_its_line(folder):
    write_inline(folder, "import nothing_like_it\n")
    shown = run()
    assert (shown.exit_code, shown.stderr) == (
        2,
        f"{INLINE_FILE}:1: ModuleNotFoundError: No module named 'nothing_like_it'\n",
    )


def test_a_plugin_that_falls_over_is_an_apology_with_a_log_and_no_folder(
    folder, monkeypatch, tmp_path_factory
):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path_factory.mktemp("elsewhere")))
    write_inline(folder, FALLING)
    write_mission(folder, "use: grid_astar", "use: falling")
    shown = run("--out", "out")
    assert shown.exit_code == 1
    assert shown.stderr.startswith("Sorry, explore-bt itself failed (ZeroDivisionError: division by zero).")
    assert not (folder / "out").exists()


def test_check_counts_what_a_good_mission_holds(folder):
    shown = CliRunner().invoke(app, ["check", "mission.yaml"])
    assert (shown.exit_code, shown.stdout) == (
        0,
        "mission.yaml is fine: 1 robot, 1 node, plugins sim2d, ground_truth, grid_astar, pursuit\n",
    )


def test_check_tells_all_faults_at_once_with_2(folder):
    write_mission(folder, "use: grid_astar", "use: grid_star")
    shown = CliRunner().invoke(app, ["check", "mission.yaml", "--set", "wait=3 m"])
    assert shown.exit_code == 2
    assert 'no planner is called "grid_star"' in shown.stderr
    assert "wait" in shown.stderr
    assert shown.stderr.splitlines()[-1] == "2 faults, nothing was run"


def test_show_draws_the_tree_as_text_or_as_a_graph(folder):
    text = CliRunner().invoke(app, ["show", "mission.yaml"])
    assert (text.exit_code, "wait" in text.stdout) == (0, True)
    dot = CliRunner().invoke(app, ["show", "mission.yaml", "--dot"])
    assert (dot.exit_code, dot.stdout.split()[0]) == (0, "digraph")


def test_schema_is_json_and_knows_the_installed_plugins(folder):
    shown = CliRunner().invoke(app, ["schema"])
    assert "sim2d" in json.dumps(json.loads(shown.stdout))
    written = CliRunner().invoke(app, ["schema", "--out", "schema.json"])
    assert written.stdout == "schema.json written\n"
    assert (folder / "schema.json").read_text() == shown.stdout


def test_schema_in_place_of_a_folder_is_told_with_2(folder):
    shown = CliRunner().invoke(app, ["schema", "--out", "."])
    assert (shown.exit_code, shown.stderr) == (
        2,
        ". is a folder; name a file in it, for example schema.json\n",
    )


def test_schema_into_a_folder_that_is_not_there_is_told_with_2(folder):
    shown = CliRunner().invoke(app, ["schema", "--out", "a/schema.json"])
    assert (shown.exit_code, shown.stderr) == (
        2,
        "there is no folder a to write schema.json into; make it first\n",
    )


def test_plugins_lists_what_is_installed_and_the_inline_plugin(folder):
    write_inline(folder, INTERRUPT)
    shown = CliRunner().invoke(app, ["plugins"])
    rows = [line.split() for line in shown.stdout.splitlines()]
    assert ["driver", "sim2d", "0.1.0", "explore-bt", "(explore_bt_drivers)"] in [row[:5] for row in rows]
    assert f"behaviour interrupt {INLINE_FILE} Presses Ctrl-C.".split() in rows


def test_plugins_of_an_unknown_kind_is_told_with_2(folder):
    shown = CliRunner().invoke(app, ["plugins", "--kind", "motor"])
    assert shown.exit_code == 2
    assert shown.stderr.startswith('there is no plugin kind "motor"; kinds are driver, slam, ')
