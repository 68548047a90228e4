from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from typer.testing import CliRunner

from explore_bt.cli import app

TWO = """
format: explore-bt/1
robots:
  ann:
    driver: {use: sim2d, world: w.yaml}
    slam: ground_truth
    planner: grid_astar
    controller: pursuit
    tree: one
  bob:
    driver: {use: sim2d, world: w.yaml}
    slam: ground_truth
    planner: grid_astar
    controller: pursuit
    tree: two
trees:
  one: {sequence: [choose_home, drive_to]}
  two: {name: "a\\u0007bell", wait: {duration: 1 s}}
"""
WORLD = "format: explore-bt-world/1\nname: w\nstart: [1, 1, 0]\nrooms: [{name: r, box: [0, 0, 3, 3]}]\n"


def convert(*words: object):
    return CliRunner().invoke(app, ["convert", *map(str, words)])


def test_a_mission_becomes_xml_and_xml_a_file_of_trees_that_loads(tmp_path: Path) -> None:
    xml, trees = tmp_path / "room.xml", tmp_path / "room.yaml"
    assert convert("00_room", "--xml", "--out", xml).exit_code == 0
    root = ElementTree.parse(xml).getroot()
    assert root.attrib == {"BTCPP_format": "4", "main_tree_to_execute": "complete"}
    models = {model.get("ID") for model in root.find("TreeNodesModel")}
    assert models >= {"drive_to", "find_next_heading", "entry_holds"}
    assert all("name" not in each.attrib for each in root.iter("SubTree"))
    done = convert(xml, "--yaml", "--out", trees)
    assert done.exit_code == 0
    assert done.stdout.endswith(f"include: [{trees}] and tree: complete\n")
    assert convert(xml).stdout == trees.read_text()


def test_parameters_stand_as_their_values() -> None:
    printed = convert("00_room", "--set", "strategy=paper").stdout
    assert 'main_tree_to_execute="paper"' in printed
    assert "$params" not in printed


def test_one_robot_of_several_is_chosen(tmp_path: Path) -> None:
    path = tmp_path / "two.yaml"
    path.write_text(TWO)
    (tmp_path / "w.yaml").write_text(WORLD)
    assert "has 2 robots; say whose tree: --robot ann" in convert(path).stderr
    assert 'has no robot "eve"; its robots: ann, bob' in convert(path, "--robot", "eve").stderr
    assert 'main_tree_to_execute="one"' in convert(path, "--robot", "ann").stdout
    refused = convert(path, "--robot", "bob")
    assert refused.exit_code == 2
    assert "holds the character '\\x07', which XML cannot" in refused.stderr


def test_wrong_input_is_told_before_anything_is_written(tmp_path: Path) -> None:
    bad = tmp_path / "bad.xml"
    bad.write_text('<root BTCPP_format="4">\n<BehaviorTree ID="m">\n  <drive_too/>\n</BehaviorTree></root>')
    out = tmp_path / "out.yaml"
    refused = convert(bad, "--out", out)
    assert refused.exit_code == 2
    assert f'{bad}:3:3  there is no node drive_too    did you mean "drive_to"?' in refused.stderr
    assert not out.exists()
    for words, message in {
        ("00_room", "--yaml"): "00_room goes to XML; leave out --yaml",
        (bad, "--xml"): "goes to YAML; leave out --xml",
        ("00_room", "--out", tmp_path / "no/x.xml"): "there is no folder",
        ("00_room", "--out", tmp_path): "is a folder; name a file in it",
    }.items():
        refused = convert(*words)
        assert refused.exit_code == 2
        assert message in refused.stderr


INLINE = """
from explore_bt import hookimpl
from explore_bt.tree import Leaf, Status


class Nod(Leaf):
    type_key = "nod"

    def update(self):
        return Status.SUCCESS


@hookimpl
def explore_bt_register():
    return [Nod]
"""


def test_plugins_beside_a_mission_are_known_to_its_trees(tmp_path: Path) -> None:
    beside, elsewhere = tmp_path / "beside", tmp_path / "elsewhere"
    beside.mkdir()
    elsewhere.mkdir()
    (beside / "explore_bt_inline.py").write_text(INLINE)
    (beside / "mine.yaml").write_text(TWO)
    xml = elsewhere / "nod.xml"
    xml.write_text('<root BTCPP_format="4"><BehaviorTree ID="m"><nod/></BehaviorTree></root>')
    assert "there is no node nod" in convert(xml).stderr
    assert convert(xml, "--mission", beside / "mine.yaml").stdout.endswith("trees: {m: nod}\n")
