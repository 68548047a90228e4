from pathlib import Path

import pytest

from explore_bt.errors import UserError
from explore_bt.mission import load_mission, only_robot
from explore_bt.plugin import load_plugins

ROBOT = (
    "driver: {use: sim2d, world: w.yaml}, slam: ground_truth, planner: skeleton, "
    "controller: pursuit, tree: wait1"
)
HEAD = "format: explore-bt/1\nname: two\ntrees: {wait1: {wait: {duration: 1 s}}}\n"
STARTS = ("start: [1 m, 1 m, 0 deg], ", "start: [3 m, 1 m, 0 deg], ")


def mission(folder: Path, team: str, starts: tuple[str, str] = STARTS):  # type: ignore[no-untyped-def]  # a Mission
    (folder / "w.yaml").write_text("format: explore-bt-world/1\nrooms: [{name: r, box: [0, 0, 4, 4]}]\n")
    file = folder / "two.yaml"
    file.write_text(
        f"{HEAD}robots:\n  a: {{{starts[0]}{ROBOT}}}\n  b: {{{starts[1]}{ROBOT}}}\nteam: {team}\n"
    )
    return load_mission(file, load_plugins().registry)


def test_the_others_are_left_to_their_own_processes(tmp_path: Path) -> None:
    both = mission(tmp_path, "zenoh")
    alone = only_robot(both, "b")
    assert [robot.name for robot in alone.robots] == ["b"]
    assert alone.team == both.team
    assert alone.sha256 == both.sha256


@pytest.mark.parametrize(
    ("team", "starts", "name", "words"),
    [
        ("zenoh", STARTS, "bb", 'there is no robot "bb".*did you mean "b"'),
        ("local", STARTS, "b", "write team: {use: zenoh}"),
        ("zenoh", ("", STARTS[1]), "b", "nobody knows where a begins.*or start: unknown"),
    ],
)
def test_what_cannot_be_is_said_before_anything_runs(
    tmp_path: Path, team: str, starts: tuple[str, str], name: str, words: str
) -> None:
    with pytest.raises(UserError, match=words):
        only_robot(mission(tmp_path, team, starts), name)


def test_a_start_that_nobody_knows_is_said_so(tmp_path: Path) -> None:
    both = mission(tmp_path, "zenoh", ("start: unknown, ", STARTS[1]))
    assert [(robot.start is None, robot.knows_start) for robot in both.robots] == [
        (True, False),
        (False, True),
    ]
    assert [robot.name for robot in only_robot(both, "a").robots] == ["a"]
