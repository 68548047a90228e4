from __future__ import annotations

import pytest

from explore_bt.testing.fake_robot import FakeRobot, open_floor
from explore_bt.tree import (
    Blackboard,
    Input,
    Key,
    Leaf,
    Output,
    PortUnsetError,
    Round,
    Script,
    Status,
    mocked,
)

R, S, F = Status.RUNNING, Status.SUCCESS, Status.FAILURE


class Look(Leaf):
    """Looks."""

    type_key = "look"
    depth: Input[float] = Input(float, default=1.0, doc="how far")
    goal: Output[str] = Output(str, default=Key("goal"), doc="where to")

    def update(self) -> Status:
        raise AssertionError("the leaf itself must not be asked")


def leaf(script: Script, **bindings: object) -> Leaf:
    return mocked(Look, script)("look", FakeRobot(open_floor(2.0)), Blackboard(), bindings)


def answers(played: Leaf, ticks: int, step_s: float = 0.1) -> str:
    """A letter a tick: R, S or F."""
    told = ""
    for _ in range(ticks):
        played.tick_once()
        told += played.status.name[0]
        assert isinstance(played.robot, FakeRobot)
        played.robot.time_s += step_s
    return told


TWO_ROUNDS = (Round(2, 0.0, S), Round(0, 0.0, F))


def test_rounds_are_played_one_after_the_other_and_begin_again():
    assert answers(leaf(Script(TWO_ROUNDS)), 9) == "RRSFRRSFR"


def test_the_last_round_is_repeated_if_so_wanted():
    assert answers(leaf(Script(TWO_ROUNDS, cycles=False)), 7) == "RRSFFFF"


def test_a_round_that_is_cut_off_is_over():
    played = leaf(Script(TWO_ROUNDS))
    assert answers(played, 1) == "R"
    played.stop(Status.INVALID)
    assert answers(played, 4) == "FRRS"


def test_a_round_without_an_answer_runs_for_ever():
    assert answers(leaf(Script((Round(2, 0.0, None),))), 50) == "R" * 50


def test_a_round_may_last_a_mission_time():
    assert answers(leaf(Script((Round(0, 0.3, F),))), 8) == "RRRFRRRF"


def test_outputs_are_written_when_a_round_ends_and_may_copy_an_entry():
    played = leaf(Script((Round(1, 0.0, S),), outputs={"goal": Key("other")}), goal=Key("mine"))
    played.blackboard.write("other", "the kitchen")
    played.tick_once()
    assert "mine" not in played.blackboard
    played.tick_once()
    assert played.blackboard["mine"] == "the kitchen"


def test_an_entry_that_nobody_has_written_cannot_be_copied():
    played = leaf(Script((Round(0, 0.0, S),), outputs={"goal": Key("other")}))
    with pytest.raises(PortUnsetError, match=r"look: mocked goal copies \$other"):
        played.tick_once()


def test_it_has_the_name_the_ports_and_the_words_of_its_part():
    played = leaf(Script((Round(0, 0.0, S),), say="3 views to go"), depth=2.0)
    played.tick_once()
    assert (played.type_key, played.feedback_message, type(played).__doc__) == (
        "look", "3 views to go", "Looks."
    )  # fmt: skip
    assert (played.inputs.keys(), played.outputs.keys()) == ({"depth"}, {"goal"})
    assert played.bindings["depth"] == 2.0
