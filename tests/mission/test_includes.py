from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from explore_bt.mission import MissionError, load_mission, load_tree

TREES = """\
params:
  pause: {type: duration, default: 2 s}
trees:
  spare: home
"""


@pytest.fixture
def folder(tmp_path: Path, good: str, furnish: Callable[[Path], None]) -> Path:
    """A mission in a folder of its own, with a file outside that it must not reach."""
    furnish(tmp_path / "missions")
    (tmp_path / "missions" / "trees").mkdir()
    (tmp_path / "secret.yaml").write_text("doc: secret\n")
    (tmp_path / "missions" / "m.yaml").write_text(good + "include: [trees/more.yaml]\n")
    return tmp_path / "missions"


def load_with(folder: Path, catalog, included: str | None = None, include: str = "trees/more.yaml"):
    if included is not None:
        (folder / "trees" / "more.yaml").write_text(included)
    text = (folder / "m.yaml").read_text().replace("[trees/more.yaml]", f"[{include}]")
    (folder / "m.yaml").write_text(text)
    return load_mission(folder / "m.yaml", catalog)


def test_trees_and_parameters_come_with_an_included_file(folder, catalog) -> None:
    (folder / "m.yaml").write_text(
        (folder / "m.yaml").read_text().replace("tree: explore\n", "tree: spare\n")
    )
    mission = load_with(folder, catalog, TREES)
    assert mission.params["pause"] == 2.0
    assert mission.robots[0].tree.type == "home"
    assert str(mission.robots[0].tree.place) == f"{folder}/trees/more.yaml:4:10"
    assert mission.included == (folder / "trees" / "more.yaml",)


def test_an_included_text_is_part_of_the_digest(folder, catalog) -> None:
    before = load_with(folder, catalog, TREES).sha256
    assert load_with(folder, catalog, TREES + "# changed\n").sha256 != before


def test_files_are_relative_to_the_file_that_names_them(folder, catalog) -> None:
    included = "params: {floor: {type: file, default: plan.pgm}}\n"
    mission = load_with(folder, catalog, included)
    assert mission.params["floor"] == folder / "trees" / "plan.pgm"
    assert mission.params["world"] == folder / "worlds" / "flat.yaml"


def test_faults_in_an_included_file_have_its_place(folder, catalog) -> None:
    with pytest.raises(MissionError) as caught:
        load_with(folder, catalog, TREES.replace("home", "hoem"))
    (fault,) = caught.value.faults
    assert fault.place == f"{folder}/trees/more.yaml:4:10"
    assert fault.hint == 'did you mean "home"?'


def test_an_included_file_holds_no_robots(folder, catalog) -> None:
    with pytest.raises(MissionError, match=r'more\.yaml:1:1  "robots" belongs into the mission itself'):
        load_with(folder, catalog, "robots: {}\n")


def test_a_name_with_two_owners_names_both(folder, catalog) -> None:
    with pytest.raises(MissionError, match=r"trees.explore has two owners .*/m\.yaml:20:3") as caught:
        load_with(folder, catalog, "trees: {explore: home}\n")
    assert "more.yaml:1:9" in str(caught.value)


@pytest.mark.parametrize(
    "include", ["../secret.yaml", "trees/../../secret.yaml", "trees/../../missions/../secret.yaml"]
)
def test_an_include_cannot_climb_out(folder, catalog, include) -> None:
    with pytest.raises(MissionError, match="lies outside the mission's folder"):
        load_with(folder, catalog, "", include)


def test_an_include_cannot_be_absolute(folder, catalog) -> None:
    with pytest.raises(MissionError, match="lies outside the mission's folder"):
        load_with(folder, catalog, TREES, str(folder / "trees" / "more.yaml"))


def test_a_symlink_cannot_lead_out(folder, catalog) -> None:
    (folder / "trees" / "more.yaml").symlink_to(folder.parent / "secret.yaml")
    with pytest.raises(MissionError, match="lies outside the mission's folder"):
        load_with(folder, catalog)


def test_a_linked_folder_cannot_lead_out(folder, catalog) -> None:
    (folder / "linked").symlink_to(folder.parent)
    with pytest.raises(MissionError, match="lies outside the mission's folder"):
        load_with(folder, catalog, "", "linked/secret.yaml")


def test_a_sibling_folder_with_the_same_beginning_is_outside(folder, catalog) -> None:
    (folder.parent / "missions2").mkdir()
    (folder.parent / "missions2" / "x.yaml").write_text("doc: x\n")
    with pytest.raises(MissionError, match="lies outside the mission's folder"):
        load_with(folder, catalog, "", "../missions2/x.yaml")


def test_a_mission_folder_that_is_a_link_itself_is_fine(folder, catalog) -> None:
    (folder / "trees" / "more.yaml").write_text(TREES)
    (folder.parent / "link").symlink_to(folder)
    assert load_mission(folder.parent / "link" / "m.yaml", catalog).params["pause"] == 2.0


def test_files_that_include_one_another_are_refused(folder, catalog) -> None:
    (folder / "trees" / "b.yaml").write_text("include: [more.yaml]\n")
    with pytest.raises(MissionError, match=r"files include one another: more.yaml -> b.yaml -> more.yaml"):
        load_with(folder, catalog, "include: [b.yaml]\n")


def test_a_file_included_twice_is_read_once(folder, catalog) -> None:
    (folder / "trees" / "b.yaml").write_text("include: [more.yaml]\n")
    mission = load_with(folder, catalog, TREES, "trees/b.yaml, trees/more.yaml")
    assert len(mission.included) == 2


@pytest.mark.parametrize("include", ["trees", '"a\\0b"', '""', "null", "{}"])
def test_what_is_no_file_is_refused(folder, catalog, include) -> None:
    with pytest.raises(MissionError):
        load_with(folder, catalog, "", include)


def test_what_an_unread_file_would_have_held_is_not_missed_too(folder, catalog) -> None:
    text = (folder / "m.yaml").read_text().replace("tree: explore\n", "tree: spare\n")
    (folder / "m.yaml").write_text(text)
    with pytest.raises(MissionError) as caught:
        load_with(folder, catalog, include="trees/gone.yaml")
    assert [fault.message for fault in caught.value.faults] == [
        "trees/gone.yaml cannot be read: no such file or directory"
    ]


def test_a_parameter_picks_the_tree(folder, catalog) -> None:
    text = (folder / "m.yaml").read_text().replace("tree: explore\n", "tree: $params.which\n")
    declared = "  which: {type: choice, choices: [explore, spare], default: spare}\n  stride:"
    (folder / "m.yaml").write_text(text.replace("  stride:", declared))
    assert load_with(folder, catalog, TREES).robots[0].tree.type == "home"


def test_a_file_of_trees_can_be_read_by_itself(folder, catalog) -> None:
    path = folder / "trees" / "more.yaml"
    path.write_text(TREES)
    assert load_tree(path, ("missing", "spare"), catalog).type == "home"
    with pytest.raises(MissionError, match='there is no tree "missing"'):
        load_tree(path, ("missing",), catalog)
