import os
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers.world import World, load_world, read_world_file
from explore_bt_drivers.world.observable import reachable_cells

from explore_bt.errors import WorldError
from explore_bt.types import Pose2

HEAD = "format: explore-bt-world/1\n"
HALL = HEAD + "rooms:\n  - {name: hall, box: [0, 0, 4, 3]}\n"
WORLDS = Path(__file__).parents[2] / "missions" / "worlds"


def load(folder: Path, text: str) -> World:
    (folder / "world.yaml").write_text(text)
    return load_world(folder / "world.yaml")


def refusal(folder: Path, text: str) -> str:
    with pytest.raises(WorldError) as caught:
        load(folder, text)
    return str(caught.value).replace(str(folder) + os.sep, "")


def test_a_room_is_closed_by_walls_of_the_given_thickness(tmp_path: Path) -> None:
    world = load(tmp_path, HALL + "wall: {thickness: 20 cm}\n")
    ranges = world.cast(1.0, 1.0, np.radians([0.0, 90.0, 180.0, 270.0]), 10.0)
    assert ranges == pytest.approx([2.9, 1.9, 0.9, 0.9])
    around = world.cast(1.0, 1.0, np.linspace(0.0, 2 * np.pi, 3600), 10.0)
    assert np.isfinite(around).all()


def test_a_door_opens_both_of_two_walls_that_lie_upon_each_other(tmp_path: Path) -> None:
    text = HALL + "  - {name: study, box: [4, 0, 7, 3]}\n"
    shut = load(tmp_path, text)
    assert shut.cast(1.0, 1.5, np.zeros(1), 10.0)[0] == pytest.approx(2.95)
    opened = load(tmp_path, text + "doors: [{at: [4, 1.5], width: 0.9}]\n")
    assert opened.cast(1.0, 1.5, np.zeros(1), 10.0)[0] == pytest.approx(5.95)
    assert opened.clearance_m(4.0, 1.5) == pytest.approx(0.45)


def test_furniture_is_solid_and_known_by_name(tmp_path: Path) -> None:
    furniture = """\
furniture:
  - {name: bed, box: [2, 2, 3, 2.5]}
  - {name: lamp, circle: [1, 2, 20 cm]}
  - {name: corner bench, polygon: [[3, 0.5], [3.5, 0.5], [3.5, 1]]}
  - {name: rug stand, box: [0.5, 0.5, 1.5, 0.7], turn: 90 deg}
"""
    world = load(tmp_path, HALL + furniture)
    assert world.nearest_thing(2.5, 2.2) == (0.0, "bed")
    assert world.nearest_thing(2.5, 1.5) == (pytest.approx(0.5), "bed")
    assert world.nearest_thing(1.0, 2.1) == (0.0, "lamp")
    assert world.nearest_thing(3.4, 0.6)[1] == "corner bench"
    assert world.nearest_thing(1.0, 1.05) == (0.0, "rug stand")
    assert world.is_free(0.6, 0.6)


def test_legs_leave_the_floor_under_a_table_free(tmp_path: Path) -> None:
    table = "furniture: [{name: table, box: [1, 1, 2, 2], legs: 5 cm, height: 75 cm}]\n"
    world = load(tmp_path, HALL + table)
    assert world.is_free(1.5, 1.5)
    assert world.nearest_thing(1.02, 1.98) == (0.0, "table")
    assert world.clearance_m(1.5, 1.025) == pytest.approx(0.45)


def test_heights_are_kept_for_worlds_in_three_dimensions(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(
        HALL + "wall: {height: 2.4 m}\nfurniture: [{name: bed, box: [1, 1, 2, 2], height: 50 cm}]\n"
    )
    assert {solid.name: solid.height_m for solid in read_world_file(path).solids} == {
        "wall of hall": 2.4,
        "bed": 0.5,
    }


def test_the_world_ends_at_its_bounds(tmp_path: Path) -> None:
    world = load(tmp_path, HEAD + "bounds: [-1, -1, 1, 1]\n")
    assert world.cast(0.0, 0.0, np.zeros(1), 5.0)[0] == pytest.approx(1.0)
    assert world.nearest_thing(3.0, 0.0) == (0.0, "the edge of the world")
    assert world.floor.free.sum() == 40 * 40


def test_a_start_in_the_file_is_kept(tmp_path: Path) -> None:
    assert load(tmp_path, HALL + "start: [1, 2, 90 deg]\n").start == Pose2(1.0, 2.0, pytest.approx(np.pi / 2))


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("dors: []", "world.yaml:4:1  the world has no key 'dors'; did you mean 'doors'?"),
        ("rooms: []", "world.yaml:4:1  the world has rooms twice; keep one of them"),
        ("start: [1, 2]", "world.yaml:4:8  found 2 values; expected [x, y, heading]"),
        ("start: [1, 2, 3 m]", "heading: 3 m is not an angle; write 90 deg or 1.57 rad"),
        ("doors: {at: [4, 1]}", "world.yaml:4:8  doors is a mapping; expected a list"),
        ("doors: [{width: 1}]", "world.yaml:4:9  a door lacks 'at'; add a line 'at: ...'"),
        ("doors: [{at: [2, 1]}]", "door 1 lies in no wall; the nearest one is wall of hall, at [2.00, 0.00]"),
        ("doors: [{at: [4, 0.2]}]", "door 1 is 0.9 m wide and reaches 0.25 m past the end of wall of hall"),
        ("walls: [{path: [[1, 1]]}]", "the path of wall 1 needs two or more points, none twice in a row"),
        ("walls: [{path: [[1, 1], [1, 1]]}]", "needs two or more points"),
        ("walls: [{path: [[1, 1], [1, x]]}]", "world.yaml:4:29  y: x is not a length; write 0.30 m or 30 cm"),
        ("walls: [{path: [[1, 1], [2, 1]], closed: maybe}]", "closed is neither true nor false"),
        ("wall: {thickness: 0}", "thickness is 0 m; expected at least 0.005 m"),
        ("furniture: [sofa]", "furniture is a value 'sofa'; expected a mapping such as {name: ..., box: ..."),
        ("furniture: [{name: a}]", "furniture has no shape; expected one of box, polygon, circle"),
        ("furniture: [{box: [0, 0, 1, 1]}]", "furniture lacks 'name'"),
        ("furniture: [{name: a, box: [1, 1, 1, 2]}]", "the box is 0 m by 1 m; its two corners must differ"),
        ("furniture: [{name: a, box: [1, 1, 2, 2], circle: [1, 1, 1]}]", "furniture has box and circle"),
        ("furniture: [{name: a, circle: [1, 1, 0]}]", "the radius is 0 m; expected more than 0"),
        (
            "furniture: [{name: a, polygon: [[1, 1], [2, 2]]}]",
            "the polygon has 2 corners; expected 3",
        ),
        ("furniture: [{name: a, polygon: [[1, 1], [2, 2], [3, 3]]}]", "the polygon has no area"),
        (
            "furniture: [{name: a, polygon: [[1, 1], [2, 2], [2, 1], [1, 2]]}]",
            "edges 1 and 3 of the polygon cross; list its corners in order round it",
        ),
        ("furniture: [{name: a, circle: [1, 1, 1], legs: 5 cm}]", "legs goes with a box, not with a circle"),
        (
            "furniture: [{name: a, box: [1, 1, 1.2, 2], legs: 0.2}]",
            "legs of 0.2 m do not fit twice into",
        ),
        ("bounds: [1, 1, 0, 0]", "bounds run from the lower left corner to the upper right one"),
        ("furniture: [{name: [a], box: [1, 1, 2, 2]}]", "name is a list; expected a text"),
        ("start: &a [*a, *a, *a]", "x is a list; write 0.30 m or 30 cm"),
    ],
)
def test_a_fault_is_named_with_its_place_and_a_hint(line: str, message: str, tmp_path: Path) -> None:
    assert message in refusal(tmp_path, HALL + line + "\n")


def test_a_wall_across_a_door_is_a_fault(tmp_path: Path) -> None:
    blocked = "walls: [{name: fin, path: [[4, 1.5], [5, 1.5]]}]\ndoors: [{name: exit, at: [4, 1.5]}]\n"
    assert "door exit is blocked by fin, which crosses it; move the door" in refusal(tmp_path, HALL + blocked)


def test_all_faults_of_a_world_come_at_once_in_its_order(tmp_path: Path) -> None:
    text = refusal(tmp_path, HALL + "dors: []\nstart: [1, 2]\nfurniture: [{name: a}]\n")
    assert [line.split(":")[1] for line in text.splitlines()] == ["4", "5", "6"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "world.yaml:1:1  is empty; expected a world"),
        ("[1]", "holds a list; expected a world"),
        (
            "format: explore-bt-world/9\nbounds: [0, 0, 1, 1]\n",
            "world.yaml:1:9  format is explore-bt-world/9;",
        ),
        ("rooms: []\n", "the world lacks 'format'"),
        (HEAD, "the world is empty; draw rooms, walls or furniture, or give its bounds"),
        (HEAD + "furniture: [{name: block, box: [0, 0, 1, 1]}]\n", "has no free floor; everything is solid"),
        (
            HEAD + "rooms: [{name: a, box: [0, 0, 0.1, 3]}]\n",
            "room a is 0.1 m by 3 m; its walls leave",
        ),
        (HEAD + "bounds: [0, 0, 5000, 4000]\n", "the world is 5000 m by 4000 m, more than 100000 m² can be"),
        (HEAD + "rooms: {\n", "is not YAML"),
        (HEAD + "---\na: 1\n", "is not YAML"),
        ("format: !!python/object/apply:os.getcwd []\n", "format is []"),
    ],
)
def test_a_world_that_is_none_is_refused(text: str, message: str, tmp_path: Path) -> None:
    assert message in refusal(tmp_path, text)


@pytest.mark.parametrize("name", ["apartment", "room"])
def test_the_worlds_of_the_missions_can_be_explored_whole(name: str) -> None:
    world = load_world(WORLDS / f"{name}.yaml")
    plan = read_world_file(WORLDS / f"{name}.yaml")
    assert world.start is not None
    assert world.clearance_m(*world.start.xy) > 0.5
    reachable = reachable_cells(world, world.start.xy, 0.25)
    rooms = {solid.name for solid in plan.solids if solid.name.startswith("wall of ")}
    assert len(rooms) == {"apartment": 7, "room": 2}[name]
    for room in rooms:
        corners = np.concatenate([solid.corners for solid in plan.solids if solid.name == room])
        low, high = corners.min(axis=0), corners.max(axis=0)
        (row0, col0), (row1, col1) = world.floor.cell_of(*low), world.floor.cell_of(*high)
        assert reachable[row0 + 5 : row1 - 5, col0 + 5 : col1 - 5].mean() > 0.15, room
