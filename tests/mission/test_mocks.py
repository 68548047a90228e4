from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.mission import MissionError, with_mocks
from explore_bt.tree import Key, MockedLeaf, Round, Status
from explore_bt.types import Pose2, Waypoint

S, F = Status.SUCCESS, Status.FAILURE

GOOD_MOCKS = """\
format: explore-bt-mocks/1
mocks:
  - leaf: "*/look"
    ticks: [running*20, success, failure*2, running]
    at_end: last
    say: a kitchen
    set: {goal: [1 m, 2 m, 0 deg]}
  - leaf: "*/drive"
    after: 3 s
    then: failure
    set: {failure: held}
"""


def mocked(load, text: str = GOOD_MOCKS):
    mission = load()
    Path("mocks.yaml").write_text(text)
    return with_mocks(mission, Path("mocks.yaml"), environ={})


def scripts(mission):
    leaves = [node for node in mission.robots[0].tree.walk() if node.leaf is not None]
    return {node.path: node.leaf.script for node in leaves if issubclass(node.leaf, MockedLeaf)}


def test_every_leaf_that_matches_plays_its_script_also_one_with_modifiers_around_it(load):
    found = scripts(mocked(load))
    place = "explore/until nothing is left"
    assert list(found) == [f"{place}/look", f"{place}/drive", "explore/go_home/sequence/drive"]
    look, drive = found[f"{place}/look"], found[f"{place}/drive"]
    assert look.rounds == (Round(20, 0.0, S), Round(0, 0.0, F), Round(0, 0.0, F), Round(1, 0.0, None))
    assert (look.cycles, look.say) == (False, "a kitchen")
    assert look.outputs == {"goal": Waypoint(Pose2(1.0, 2.0, 0.0), "mocked")}
    assert (drive.rounds, drive.cycles, drive.outputs) == ((Round(0, 3.0, F),), True, {"failure": "held"})


def test_a_handler_and_a_condition_can_be_mocked(load, good):
    mission = load(good.replace("- look:", "- if: {home: {}}\n            look:"))
    Path("mocks.yaml").write_text(
        "format: explore-bt-mocks/1\n"
        'mocks: [{leaf: "*/home", ticks: [failure]}, {leaf: "*/reset", after: 1 s}]\n'
    )
    assert {path.rpartition("/")[2] for path in scripts(with_mocks(mission, Path("mocks.yaml")))} == {
        "home", "reset"
    }  # fmt: skip


def test_the_last_rule_that_matches_counts(load):
    more = '  - leaf: "explore/go_home/sequence/drive"\n    after: $params.stride\n'
    with pytest.raises(MissionError, match="is not a duration"):
        mocked(load, GOOD_MOCKS + more.replace("$params.stride", "1 m"))
    found = scripts(mocked(load, GOOD_MOCKS + more.replace("$params.stride", "7 s")))
    assert found["explore/go_home/sequence/drive"].rounds == (Round(0, 7.0, S),)
    assert found["explore/until nothing is left/drive"].rounds == (Round(0, 3.0, F),)


def test_an_entry_may_be_copied_and_a_parameter_put_in(load):
    text = GOOD_MOCKS.replace("[1 m, 2 m, 0 deg]", "$other").replace("after: 3 s", "after: $params.stride")
    found = scripts(mocked(load, text))
    assert found["explore/until nothing is left/look"].outputs == {"goal": Key("other")}
    assert found["explore/go_home/sequence/drive"].rounds == (Round(0, 1.5, F),)


def test_the_hash_tells_a_dry_run_from_the_mission_and_from_another_dry_run(load):
    hashes = {load().sha256, mocked(load).sha256, mocked(load, GOOD_MOCKS + "# other\n").sha256}
    assert len(hashes) == 3


@pytest.mark.parametrize(
    ("old", "new", "place", "message"),
    [
        ("mocks/1", "mocks/2", "1:9", "format explore-bt-mocks/2 is not known    write explore-bt-mocks/1"),
        ("mocks:\n", "mock:\n", "2:1", 'a mock file has no key "mock"    did you mean "mocks"?'),
        ("*/look", "*/lok", "3:11", 'no leaf is at */lok    did you mean "*/look"?'),
        ("*/look", "look", "3:11", 'no leaf is at look    did you mean "*/look"?'),
        ("*/look", "*/go_home", "3:11", "no leaf is at */go_home    "),
        ("- leaf: \"*/look\"\n    ", "- ", "3:5", 'a mock needs the key leaf    write leaf: "*/drive_to"'),
        ("ticks:", "tiks:", "4:5", 'a mock has no key "tiks"    did you mean "ticks"?'),
        ("running*20", "runing*20", "4:13", 'ticks: runing*20 is not a status    did you mean "running"?'),
        ("running*20", "running*0", "4:13", 'ticks: running*0 is not a status    did you mean "running"?'),
        ("[running*20, success, failure*2, running]", "[]", "4:12", "ticks: nothing is in it    write"),
        ("[running*20, success, failure*2, running]", "x", "4:12", "ticks: x is not a list    write [runn"),
        ("at_end: last", "at_end: lst", "5:13", 'at_end: "lst" is not known    did you mean "last"?'),
        ("at_end: last", "after: 2 s", "5:12", "a mock has ticks or after, not both    remove it, or ticks:"),
        ("at_end: last", "then: failure", "5:5", "then belongs to after    put the answer into ticks"),
        ("say: a kitchen", "say: 3", "6:10", "say: 3 is not text    put it in quotes"),
        ("{goal:", "{goall:", "7:11", 'look has no output "goall"    did you mean "goal"?'),
        ("{goal: [1 m, 2 m, 0 deg]}", "{goal: kitchen}", "7:17", "goal: kitchen is not a pose"),
        ("{goal: [1 m, 2 m, 0 deg]}", "{visited_too: []}", "7:24", "visited_too: a list is no tuple"),
        ("2 m, 0 deg", "2 s, 0 deg", "7:23", "goal: 2 s is not a length"),
        ("after: 3 s", "after: -3 s", "9:12", "after: -3 s is below zero    write after: 3 s"),
        ("after: 3 s", "after: soon", "9:12", "after: soon is not a duration"),
        ("after: 3 s\n    ", "", "8:5", "a mock needs ticks or after    write ticks: [running*20, success]"),
        ("failure: held", "failure: 3", "11:20", "failure: 3 is not text"),
    ],
)  # fmt: skip
def test_a_faulty_mock_file_is_told_by_line_and_column(load, old, new, place, message):
    assert old in GOOD_MOCKS
    with pytest.raises(MissionError) as caught:
        mocked(load, GOOD_MOCKS.replace(old, new, 1))
    assert f"mocks.yaml:{place}  {message}" in str(caught.value)
    assert str(caught.value).endswith("nothing was run")


def test_all_faults_come_at_once(load):
    text = GOOD_MOCKS.replace("running*20", "run").replace("goal:", "goll:").replace("3 s", "3 m")
    with pytest.raises(MissionError) as caught:
        mocked(load, text)
    assert [(fault.line, fault.column) for fault in caught.value.faults] == [(4, 13), (7, 11), (9, 12)]


def test_a_rule_that_others_have_overtaken_is_a_fault(load):
    with pytest.raises(MissionError, match=r"3:11  every leaf that \*/look matches is mocked again below"):
        mocked(load, GOOD_MOCKS + '  - {leaf: "*/look", ticks: [success]}\n')


def test_a_missing_and_an_empty_file_are_told(load):
    with pytest.raises(MissionError, match="the mock file cannot be read: no such file"):
        with_mocks(load(), Path("nowhere.yaml"))
    with pytest.raises(MissionError, match="a mock file is a mapping; this is empty"):
        mocked(load, "")


@given(st.text(max_size=200))
@settings(max_examples=60, deadline=None)
def test_any_text_is_a_mock_file_or_a_fault(tmp_path_factory, catalog, text):
    from explore_bt.mission import load_mission
    from tests.mission.conftest import GOOD

    folder = tmp_path_factory.getbasetemp()
    (folder / "worlds").mkdir(exist_ok=True)
    (folder / "worlds/flat.yaml").touch()
    (folder / "m.yaml").write_text(GOOD)
    (folder / "mocks.yaml").write_bytes(text.encode("utf-8", "surrogatepass"))
    mission = load_mission(folder / "m.yaml", catalog)
    with pytest.raises(MissionError):
        with_mocks(mission, folder / "mocks.yaml")


def test_the_mocks_of_the_docs_are_fine(tmp_path):
    from explore_bt.files import missions_folder
    from explore_bt.mission import load_mission
    from explore_bt.plugin import load_plugins

    page = (Path(__file__).parents[2] / "docs" / "mocks.md").read_text()
    (tmp_path / "mocks.yaml").write_text(page.partition("```yaml\n")[2].partition("```")[0])
    mission = load_mission(missions_folder() / "01_apartment.yaml", load_plugins().registry)
    assert len(scripts(with_mocks(mission, tmp_path / "mocks.yaml"))) > 5
