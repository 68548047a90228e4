"""Lines of text: what stands in them for the person who reads them."""

from __future__ import annotations

from explore_bt.debug import DebugState
from explore_bt.debug.terminal.views import board_lines, state_lines, tree_lines, value_text
from explore_bt.interfaces import NodeInfo, NodeState
from explore_bt.types import Pose2

INFOS = (
    NodeInfo(0, "main", "main", "sequence", None, "m.yaml:1:1"),
    NodeInfo(1, "main/go@timeout", "timeout 3 s", "timeout", 0, "m.yaml:2:1"),
    NodeInfo(2, "main/go", "go", "drive_to", 1, "m.yaml:2:1"),
    NodeInfo(3, "main/wait", "wait", "wait", 0, "m.yaml:3:1"),
)
NODES = (
    NodeState("running", ""),
    NodeState("running", ""),
    NodeState("failure", "no path"),
    NodeState("idle", ""),
)


def plain(lines) -> list[str]:
    return [line.plain for line in lines]


def test_a_tree_is_indented_with_statuses_reasons_and_a_mark():
    assert plain(tree_lines(INFOS, NODES, "", "main/go")) == [
        "  RUNNING main (sequence)",
        "    RUNNING timeout 3 s",
        ">     FAILURE go (drive_to)  no path",
        "    IDLE    wait",
    ]


def test_a_part_of_a_tree_begins_at_its_left():
    assert plain(tree_lines(INFOS, NODES, "go@*", "")) == [
        "  RUNNING timeout 3 s",
        "    FAILURE go (drive_to)  no path",
    ]
    assert plain(tree_lines(INFOS, NODES, "nothing", "")) == []


def test_a_state_says_where_it_stands_and_of_several_robots_which():
    state = DebugState(
        paused=True,
        why="breakpoint 2",
        is_simulated=False,
        robot="bob",
        path="main/go",
        moment="after",
        status="failure",
        tick=12,
        stamp_s=1.25,
    )
    assert plain(state_lines(state, robots=2)) == [
        "paused at tick 12, 1.25 s: breakpoint 2",
        "  time goes on: the robots are held, the trees wait",
        "  bob: after main/go  FAILURE",
    ]
    assert plain(state_lines(DebugState(over=True, why="explored: done"), robots=1)) == [
        "over at tick 0, 0.00 s: explored: done"
    ]


def test_a_blackboard_is_a_line_an_entry():
    assert plain(board_lines({"goal": Pose2(1.0, 2.0, 0.0), "a": "ä"})) == [
        '$a     "ä"',
        '$goal  {"class": "Pose2", "x": 1.0, "y": 2.0, "yaw_rad": 0.0}',
    ]
    assert value_text(float("inf")) == '"inf"'
