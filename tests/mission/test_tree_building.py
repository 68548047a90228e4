from __future__ import annotations

from py_trees.common import Status

from explore_bt.mission import build_tree
from explore_bt.tree import Blackboard, Guard, OnFailure, Retry, Sequence, Timeout

EVERYTHING = """\
    sequence:
      - name: guarded
        if: not $failure
        reactive_sequence: [home]
      - if: {invert: reset}
        drive: {goal: $goal}
      - parallel: {success: 1, failure: 2, children: [home, reset]}
      - repeat: {times: 2, child: {force_success: look}}
      - repeat: {times: forever, child: {force_failure: {fallback: [look, home]}}}
      - reactive_fallback: [home]
      - subtree: go_home
"""


def test_infos_go_with_nodes_and_parents_come_first(load, robot) -> None:
    built = build_tree(load().robots[0].tree, robot, Blackboard())
    assert [info.id for info in built.infos] == list(range(len(built.nodes)))
    assert [info.name for info in built.infos] == [node.name for node in built.nodes]
    for info, node in zip(built.infos, built.nodes, strict=True):
        parent = None if info.parent is None else built.nodes[info.parent]
        assert node.parent is parent
        assert info.parent is None or info.parent < info.id
    assert len({info.path for info in built.infos}) == len(built.infos)


def test_modifiers_are_wrapped_in_their_order(load, robot) -> None:
    built = build_tree(load().robots[0].tree, robot, Blackboard())
    around = {info.path: node for info, node in zip(built.infos, built.nodes, strict=True)}
    place = "explore/until nothing is left/drive"
    assert isinstance(around[f"{place}@on_failure"], OnFailure)
    assert around[f"{place}@on_failure"].children[0] is around[f"{place}@retry"]
    assert isinstance(around[f"{place}@retry"], Retry)
    assert isinstance(around[f"{place}@timeout"], Timeout)
    assert around[f"{place}@timeout"].children == [around[place]]


def test_every_control_node_and_condition_can_be_built_and_ticked(load, good, robot) -> None:
    start, end = good.index("    sequence:\n"), good.index("  go_home:\n")
    mission = load(good[:start] + EVERYTHING + good[end:])
    built = build_tree(mission.robots[0].tree, robot, Blackboard())
    built.root.tick_once()
    assert built.root.status is Status.FAILURE
    types = {info.type for info in built.infos}
    assert {"if", "entry", "parallel", "repeat", "force_failure", "reactive_fallback"} <= types
    assert isinstance(built.nodes[1], Guard)


def test_two_trees_of_one_specification_share_nothing(load, robot) -> None:
    spec = load().robots[0].tree
    one, other = build_tree(spec, robot, Blackboard()), build_tree(spec, robot, Blackboard())
    one.root.tick_once()
    assert isinstance(other.root, Sequence)
    assert {node.status for node in other.nodes} == {Status.INVALID}
    assert not {id(node) for node in one.nodes} & {id(node) for node in other.nodes}


def test_a_timeout_counts_the_robots_time(load, good, robot, monkeypatch) -> None:
    text = good.replace("  go_home:\n    sequence: [home, {drive: {goal: $goal}}]", "  go_home: home")
    text = text.replace("retry: 2\n", "doc: no retry\n").replace("tree: explore\n", "tree: only\n")
    mission = load(text + "  only: {timeout: 3 s, look: {}}\n")
    built = build_tree(mission.robots[0].tree, robot, Blackboard())
    monkeypatch.setattr(built.nodes[1], "update", lambda: Status.RUNNING)
    statuses = []
    for now in (0.0, 2.9, 3.0):
        robot.clock.wait_until(now)
        built.root.tick_once()
        statuses.append(built.root.status)
    assert statuses == [Status.RUNNING, Status.RUNNING, Status.FAILURE]
    assert built.root.feedback_message == "gave up after 3 s"
