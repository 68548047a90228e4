from __future__ import annotations

from pathlib import Path

import pytest

from explore_bt.mission import MissionError, load_mission
from explore_bt.types import Pose2


def test_an_override_takes_the_place_of_the_default(load) -> None:
    mission = load(overrides=["stride=1.2", "start=[3 m, 4 m, 0 deg]", "slam=truth"])
    assert mission.params["stride"] == 1.2
    assert mission.robots[0].start == Pose2(3.0, 4.0, 0.0)
    assert mission.robots[0].slam.name == "truth"


def test_limits_and_rates_are_set_by_their_dotted_names(load) -> None:
    mission = load(overrides=["limits.speed=0.2 m/s", "limits.distance=5", "tick.control=40 Hz"])
    assert (mission.limits.speed_mps, mission.limits.time_s, mission.limits.distance_m) == (0.2, 1800.0, 5.0)
    assert mission.control_rate_hz == 40.0


def test_an_override_can_take_a_value_away(load) -> None:
    assert load(overrides=["start=null"]).robots[0].start is None
    assert load(overrides=["start="]).robots[0].start is None


def test_files_in_overrides_are_relative_to_the_current_directory(catalog, tmp_path, good) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "maps").mkdir()
    (tmp_path / "maps/a b.yaml").touch()
    (tmp_path / "sub" / "m.yaml").write_text(good)
    mission = load_mission(tmp_path / "sub" / "m.yaml", catalog, ["world=maps/a b.yaml"], cwd=tmp_path)
    assert mission.params["world"] == tmp_path / "maps" / "a b.yaml"


def test_numbers_are_text_where_text_is_asked_for(load, good) -> None:
    text = good.replace("  stride:", "  label: {type: text, default: x}\n  stride:")
    assert load(text, ["label=0012"]).params["label"] == "0012"


def test_overrides_may_come_as_a_mapping(load, catalog) -> None:
    load()
    assert load_mission(Path("m.yaml"), catalog, {"stride": "2"}).params["stride"] == 2.0


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        (
            "strid=2",
            '--set strid=2  there is no parameter "strid"    did you mean "stride"?\n'
            "       | strid=2\n"
            "       | ^^^^^",
        ),
        (
            "stride=2 s",
            "--set stride=2 s  stride: 2 s is not a length    write 0.30 m or 30 cm\n"
            "       | stride=2 s\n"
            "       |        ^^^",
        ),
        (
            "stride=30",
            "--set stride=30  stride: 30 is not a length between 0.3 m and 5 m    write 0.30 m or 30 cm\n"
            "       | stride=30\n"
            "       |        ^^",
        ),
        (
            "start=[1, 2, 3 m]",
            "--set start=[1, 2, 3 m]  start: 3 m is not an angle    write 90 deg or 1.57 rad\n"
            "       | start=[1, 2, 3 m]\n"
            "       |              ^^^",
        ),
        (
            "start=[1, 2",
            "--set start=[1, 2  not YAML: did not find expected ',' or ']'"
            "    check brackets, quotes and indentation\n"
            "       | start=[1, 2\n"
            "       |            ^",
        ),
        (
            "slam=trooth",
            '--set slam=trooth  slam: trooth is not an installed slam    did you mean "truth"?'
            "  (see explore-bt plugins)\n"
            "       | slam=trooth\n"
            "       |      ^^^^^^",
        ),
        (
            "limits.sped=1",
            '--set limits.sped=1  limits has no key "sped"    did you mean "speed"?\n'
            "       | limits.sped=1\n"
            "       | ^^^^^^^^^^^",
        ),
        (
            "robots.x=1",
            '--set robots.x=1  "robots.x" cannot be set    sections: limits.x, params.x, tick.x\n'
            "       | robots.x=1\n"
            "       | ^^^^^^^^",
        ),
        (
            "stride",
            "--set stride  not of the form name=value    for example --set stride=1.2\n"
            "       | stride\n"
            "       | ^",
        ),
        (
            "stride=$goal",
            "--set stride=$goal  stride: $goal is a blackboard entry; a parameter is a constant\n"
            "       | stride=$goal\n"
            "       |        ^^^^^",
        ),
    ],
)
def test_a_faulty_override_is_shown_as_it_was_typed(load, override, expected) -> None:
    with pytest.raises(MissionError) as caught:
        load(overrides=[override])
    assert str(caught.value) == f"{expected}\n1 fault, nothing was run"


def test_setting_a_parameter_twice_is_refused(load) -> None:
    with pytest.raises(MissionError, match="stride is set twice"):
        load(overrides=["stride=1", "stride=2"])


def test_overrides_and_file_are_faulted_together(load, good) -> None:
    with pytest.raises(MissionError) as caught:
        load(good.replace("- look:", "- lok:"), ["stride=2 s", "nothing=1"])
    assert len(caught.value.faults) == 3
