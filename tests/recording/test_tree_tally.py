from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from explore_bt.interfaces import NodeState
from explore_bt.recording import McapRecorder, NodeTally, TreeTally, read_recording

IDLE, RUNNING = NodeState("idle", ""), NodeState("running", "", ticks=1)
SUCCESS, FAILURE = (
    NodeState("success", "", ticks=1, successes=1),
    NodeState("failure", "", ticks=1, failures=1),
)
PASSED_OVER = NodeState("success", "")


def tally(*states: NodeState) -> NodeTally:
    """Of one node, a tick of 0.1 s each."""
    tree = TreeTally()
    for k, state in enumerate(states):
        tree.on_tick(0.1 * k, (state,))
    (node,) = tree.nodes
    return replace(node, running_s=round(node.running_s, 6), longest_s=round(node.longest_s, 6))


def test_time_counts_from_the_first_tick_of_a_round_to_its_end():
    node = tally(IDLE, RUNNING, RUNNING, SUCCESS, IDLE, RUNNING, FAILURE)
    assert node == NodeTally(5, successes=1, failures=1, running_s=0.3, longest_s=0.2)


def test_a_node_that_is_passed_over_is_not_counted_again():
    assert tally(SUCCESS, PASSED_OVER, PASSED_OVER) == NodeTally(1, successes=1)


def test_a_node_that_is_halted_while_it_runs_is_cut_off():
    assert tally(RUNNING, RUNNING, IDLE) == NodeTally(2, cut_off=1, running_s=0.2, longest_s=0.2)


def test_rounds_within_one_tick_are_all_counted():
    thrice = NodeState("running", "", ticks=3, successes=1, failures=1)
    assert tally(RUNNING, thrice, SUCCESS) == NodeTally(
        5, successes=2, failures=1, running_s=0.2, longest_s=0.1
    )


@given(st.lists(st.sampled_from([IDLE, RUNNING, SUCCESS, FAILURE, PASSED_OVER]), min_size=1))
def test_every_round_has_one_end_unless_it_still_runs(states: list[NodeState]):
    node = tally(*states)
    began = sum(
        bool(state.ticks) and (k == 0 or states[k - 1] is not RUNNING) for k, state in enumerate(states)
    )
    assert node.successes + node.failures + node.cut_off == began - (states[-1] is RUNNING)
    assert node.longest_s <= node.running_s + 1e-9
    assert node.ticks == sum(state.ticks for state in states)


def test_the_recording_ends_with_the_counts_of_every_node(recorded_drive, tmp_path):
    drive = replace(recorded_drive, ticks=recorded_drive.ticks[:400]).in_folder(tmp_path)
    drive.show_to(McapRecorder(McapRecorder.Options()))
    messages = list(read_recording(tmp_path / "recording.mcap").messages("/robot/nodes"))
    assert [round(message.stamp_s) for message in messages] == [0, 10, 20, 30, 40]
    expected = TreeTally()
    for tick in drive.ticks:
        expected.on_tick(tick.stamp_s, tick.robots[0].nodes)
    for told, node in zip(messages[-1].value["nodes"], expected.nodes, strict=True):
        assert (told["ticks"], told["successes"], told["cut_off"]) == (
            node.ticks, node.successes, node.cut_off
        )  # fmt: skip
        assert told["running_s"] == pytest.approx(node.running_s, abs=1e-3)
