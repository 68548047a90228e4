from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from explore_bt.mission import LimitsSpec, MissionError, load_mission
from explore_bt.tree import Key
from explore_bt.types import MotionLimits, Pose2


def fault_lines(error: pytest.ExceptionInfo[MissionError]) -> list[str]:
    return [f"{fault.place}  {fault.message}" for fault in error.value.faults]


def test_a_good_mission_is_resolved_to_si(load) -> None:
    mission = load()
    (robot,) = mission.robots
    assert (mission.name, mission.doc) == ("flat", "A small flat.")
    assert mission.params["stride"] == 1.5
    assert robot.start == Pose2(1.0, 2.0, math.pi / 2)
    assert (mission.tree_rate_hz, mission.control_rate_hz) == (10.0, 20.0)
    assert mission.limits == LimitsSpec(speed_mps=0.5, time_s=1800.0)


def test_plugins_are_chosen_with_checked_options(load) -> None:
    driver = load().robots[0].driver
    assert (driver.kind, driver.name) == ("driver", "sim")
    assert driver.options.world == Path.cwd() / "worlds" / "flat.yaml"
    assert driver.make().options is driver.options


def test_leaves_get_constants_and_keys(load) -> None:
    look, drive = load().robots[0].tree.children[0].children
    assert look.bindings == {"half_planes": "all", "stride": 1.5, "goal": Key("goal")}
    assert (drive.modifiers.timeout_s, drive.modifiers.retry) == (60.0, 2)
    assert drive.modifiers.on_failure.type == "reset"


def test_paths_are_unique_even_where_names_are_not(load, good) -> None:
    mission = load(good.replace("[home, {drive: {goal: $goal}}]", "[home, home, home]"))
    paths = [node.path for node in mission.robots[0].tree.walk()]
    assert len(paths) == len(set(paths))
    assert "explore/go_home/sequence/home#3" in paths


def test_two_faults_are_both_told_in_the_order_of_the_text(load, good) -> None:
    text = good.replace("{use: sim,", "{use: sim, radius: 30,").replace("stride: $params", "strid: $params")
    with pytest.raises(MissionError) as caught:
        load(text)
    assert fault_lines(caught) == [
        "m.yaml:12:32  radius: 30 is not a length between 0.05 m and 5 m",
        'm.yaml:24:38  look has no port "strid"',
    ]
    assert str(caught.value).endswith("2 faults, nothing was run")


def test_faults_of_every_section_come_at_once(load, good) -> None:
    changes = {
        "name: flat": "name: a b",
        "min: 0.3 m": "min: 0.3 s",
        "{use: lines}": "{use: liens}",
        "tree: 10 Hz": "tree: ten",
        "speed: 0.5": "sped: 0.5",
        "timeout: 60 s": "timeout: 60",
        "retry: 2": "retry: often",
        "[home,": "[hmoe,",
    }
    for old, new in changes.items():
        good = good.replace(old, new)
    with pytest.raises(MissionError) as caught:
        load(good, ["stride=fast", "nothing=1"])
    assert len(caught.value.faults) == 9


def test_a_fault_in_a_tree_that_no_robot_uses_is_told(load, good) -> None:
    with pytest.raises(MissionError, match=r"m\.yaml:32:10"):
        load(good + "  spare: lok\n")


def test_a_fault_in_a_shared_tree_is_told_once(load, good) -> None:
    second = good[good.index("  robot:\n") : good.index("tick:")].replace("  robot:", "  other:")
    with pytest.raises(MissionError) as caught:
        load(good.replace("tick:", second + "tick:").replace("[home,", "[hoem,"))
    assert len(caught.value.faults) == 1


def test_yaml_1_1_words_are_text(load, good) -> None:
    look = load(good.replace("half_planes: all", "label: on")).robots[0].tree.children[0].children[0]
    assert look.bindings["label"] == "on"


def test_aliases_stand_for_what_they_name(load, good) -> None:
    text = good.replace("tree: 10 Hz, control: 20 Hz", "tree: &rate 10 Hz, control: *rate")
    assert load(text).control_rate_hz == 10.0


def test_a_parameter_that_is_not_given_leaves_the_default(load, good) -> None:
    text = good.replace("default: 1.5 m, min: 0.3 m, max: 5 m", "default: null")
    mission = load(text.replace("default: [1.0 m, 2.0 m, 90 deg]", "default: null"))
    assert mission.robots[0].start is None
    assert "stride" not in mission.robots[0].tree.children[0].children[0].bindings


def test_a_required_port_is_not_met_by_a_parameter_that_is_not_given(load, good) -> None:
    text = good.replace(
        "stride: {type: length, default: 1.5 m, min: 0.3 m, max: 5 m}",
        "stride: {type: length, default: null}",
    )
    with pytest.raises(MissionError, match='drive needs the port "goal"'):
        load(text.replace("[home, {drive: {goal: $goal}}]", "[home, {drive: {goal: $params.stride}}]"))


def test_the_environment_is_read_as_yaml_scalars(load, good, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "w.yaml").touch()
    text = good.replace("world: $params.world", "world: $env.WORLD, beams: $env.COUNT")
    options = load(text).robots[0].driver.options
    assert (options.world, options.beams) == (Path.cwd() / "w.yaml", 72)


def test_each_robot_knows_its_own_name(load, good) -> None:
    second = good[good.index("  robot:\n") : good.index("tick:")].replace("  robot:", "  other:")
    text = good.replace("tick:", second + "tick:").replace("half_planes: all", "label: $robot.name")
    trees = [robot.tree for robot in load(text).robots]
    assert [tree.children[0].children[0].bindings["label"] for tree in trees] == ["robot", "other"]


def test_a_robot_may_have_a_tree_of_its_own(load, good) -> None:
    mission = load(good.replace("    controller: pursuit", "    controller: pursuit\n    tree: go_home"))
    assert mission.robots[0].tree.path == "go_home"


def test_the_digest_follows_text_and_parameters_but_not_the_folder(catalog, good, tmp_path, furnish) -> None:
    digests = []
    for folder, overrides in (("a", []), ("b", []), ("c", ["stride=2 m"])):
        furnish(tmp_path / folder)
        (tmp_path / folder / "m.yaml").write_text(good)
        digests.append(load_mission(tmp_path / folder / "m.yaml", catalog, overrides).sha256)
    assert digests[0] == digests[1] != digests[2]


def test_limits_only_ever_make_the_body_slower() -> None:
    limits = LimitsSpec(speed_mps=0.2, jerk_mps3=99.0).apply(MotionLimits())
    assert limits.speed_mps == 0.2
    assert limits.jerk_mps3 == MotionLimits().jerk_mps3


def test_the_brake_is_as_gentle_as_the_drive_unless_the_mission_says_so() -> None:
    body = MotionLimits(acceleration_mps2=2.0, jerk_mps3=20.0)
    gentle = LimitsSpec(acceleration_mps2=0.5, jerk_mps3=2.0)
    assert gentle.of_brake(body) == gentle.apply(body)
    firm = replace(gentle, braking_mps2=1.5, braking_jerk_mps3=99.0).of_brake(body)
    assert (firm.acceleration_mps2, firm.jerk_mps3) == (1.5, 20.0)
    assert firm.turn_acceleration_rps2 == body.turn_acceleration_rps2


def test_a_file_that_a_plugin_needs_must_be_there(load, good, tmp_path) -> None:
    with pytest.raises(MissionError) as caught:
        load(good.replace("world: $params.world", "world: worlds/attic.yaml"))
    assert (
        str(caught.value).splitlines()[0]
        == f"m.yaml:12:31  world: there is no file {tmp_path}/worlds/attic.yaml"
    )


def test_a_saved_map_is_a_folder_that_is_there(load, good, tmp_path) -> None:
    (tmp_path / "slam").mkdir()
    robot = load(good.replace("    start:", "    map: slam\n    start:")).robots[0]
    assert robot.saved_map == tmp_path / "slam"
    assert load(good).robots[0].saved_map is None
    with pytest.raises(MissionError) as caught:
        load(good.replace("    start:", "    map: gone\n    start:"))
    assert str(caught.value).splitlines()[0] == (
        f"m.yaml:11:10  map: there is no folder {tmp_path}/gone    give the folder slam/ of an earlier run"
    )


def test_a_missing_mission_file_is_one_plain_line(catalog, tmp_path) -> None:
    path = tmp_path / "none.yaml"
    with pytest.raises(MissionError) as caught:
        load_mission(path, catalog)
    assert str(caught.value) == (
        f"{path}  the mission cannot be read: no such file or directory\n1 fault, nothing was run"
    )


@pytest.mark.parametrize("text", ["", "- a", "word", "# only a comment"])
def test_what_is_no_mapping_is_no_mission(load, text) -> None:
    with pytest.raises(MissionError, match="a mission is a mapping"):
        load(text)


def test_a_huge_file_is_refused_unread(load, good) -> None:
    with pytest.raises(MissionError, match="larger than 1 MB"):
        load(good + "#" * 1_000_001)


def test_an_alias_bomb_is_refused(load, good) -> None:
    bomb = "doc: &a0 [x, x, x, x, x, x, x, x, x, x]\n"
    bomb += "".join(f"k{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 10)}]\n" for n in range(1, 9))
    with pytest.raises(MissionError, match="too large once its aliases are written out"):
        load(good.replace("doc: A small flat.\n", bomb))


@pytest.mark.parametrize("deep", ["[" * 100_000 + "]" * 100_000, "- " * 100_000 + "x"], ids=["flow", "block"])
def test_deep_nesting_is_refused_and_does_not_end_the_process(load, deep) -> None:
    with pytest.raises(MissionError, match="nested more than 60 levels deep"):
        load(f"trees:\n  {deep}\n" if deep[0] == "-" else f"trees: {deep}\n")


def test_trees_that_double_themselves_are_refused(load, good) -> None:
    trees = "".join(
        f"  t{n}: {{sequence: [{{subtree: t{n + 1}}}, {{subtree: t{n + 1}}}]}}\n" for n in range(40)
    )
    with pytest.raises(MissionError, match="the tree is too large"):
        load(good.replace("tree: explore\n", "tree: t0\n") + trees + "  t40: home\n")


def test_an_overlong_chain_of_subtrees_is_refused(load, good) -> None:
    trees = "".join(f"  t{n}: {{invert: {{subtree: t{n + 1}}}}}\n" for n in range(500))
    with pytest.raises(MissionError, match="over 80 deep"):
        load(good.replace("tree: explore\n", "tree: t0\n") + trees + "  t500: home\n")
