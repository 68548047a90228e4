import math
import os
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers.world import World, load_world, with_every_stand, with_solids

from explore_bt.errors import WorldError

FLAT = """\
format: explore-bt-world/1
rooms:
  - {name: hall, box: [0, 0, 4, 3]}
  - {name: study, box: [4, 0, 7, 3]}
doors:
  - {name: study door, at: [4, 1.5], width: 0.9, shut: [[20 s, 1 min], [90, 100]]}
furniture:
  - {name: plant, circle: [1, 2, 0.2]}
  - name: table
    box: [5, 1, 6, 1.6]
    legs: 5 cm
    moved: [{at: 10 s, to: [2, 2]}, {at: 30 s, to: [2, 2, 90 deg]}]
people:
  - {name: ada, route: [[0.5, 0.5], [3, 0.5], [3, 1.5], [4.5, 1.5], [4.5, 2.3]], speed: 3.6 km/h, pause: 2}
  - {name: bob, route: [[0.5, 0.5], [3, 0.5]], radius: 20 cm, begin: 1 min}
"""
HALL = "format: explore-bt-world/1\nrooms:\n  - {name: hall, box: [0, 0, 4, 3]}\n"


def load(folder: Path, text: str) -> World:
    (folder / "world.yaml").write_text(text)
    return load_world(folder / "world.yaml")


def stood(world: World, *stands: int) -> World:
    """The world with every thing at the stand of that number."""
    pairs = zip(world.things, stands, strict=True)
    return with_solids(world, [solid for thing, stand in pairs for solid in thing.stands[stand].solids])


def test_people_are_read_with_their_defaults(tmp_path: Path) -> None:
    ada, bob = load(tmp_path, FLAT).people
    assert ada.route == ((0.5, 0.5), (3.0, 0.5), (3.0, 1.5), (4.5, 1.5), (4.5, 2.3))
    assert (ada.speed_mps, ada.radius_m, ada.pause_s, ada.begin_s) == (1.0, 0.25, 2.0, 0.0)
    assert (bob.speed_mps, bob.radius_m, bob.pause_s, bob.begin_s) == (1.2, 0.2, 0.0, 60.0)


def test_a_drawn_world_is_that_of_a_file_without_its_changes(tmp_path: Path) -> None:
    lines = [line for line in FLAT.split("people:")[0].splitlines() if "moved" not in line]
    plain = load(tmp_path, "\n".join(lines).replace(", shut: [[20 s, 1 min], [90, 100]]", ""))
    world = load(tmp_path, FLAT)
    angles = np.linspace(-math.pi, math.pi, 500)
    assert np.array_equal(world.cast(2.0, 1.5, angles, 9.0), plain.cast(2.0, 1.5, angles, 9.0))
    assert np.array_equal(world.floor.cells, plain.floor.cells)


def test_the_leaf_of_a_door_fills_its_opening(tmp_path: Path) -> None:
    world = load(tmp_path, FLAT)
    assert [stand.begin_s for stand in world.things[0].stands] == [0.0, 20.0, 60.0, 90.0, 100.0]
    shut, opened = stood(world, 1, 0), stood(world, 2, 0)
    assert shut.cast(3.0, 1.5, np.zeros(1), 9.0)[0] == pytest.approx(0.98)
    assert opened.cast(3.0, 1.5, np.zeros(1), 9.0)[0] == pytest.approx(3.95)
    assert shut.nearest_thing(4.0, 1.2) == (0.0, "door study door")
    assert not np.isinf(shut.cast(3.0, 1.5, np.linspace(-1.2, 1.2, 999), 2.0)).any()


def test_a_moved_thing_stands_with_its_middle_at_the_place_and_turned(tmp_path: Path) -> None:
    world = load(tmp_path, FLAT)
    assert [stand.begin_s for stand in world.things[1].stands] == [0.0, 10.0, 30.0]
    for stand, half in [(1, (0.475, 0.275)), (2, (0.275, 0.475))]:
        moved = stood(world, 0, stand)
        assert moved.is_free(5.025, 1.025)
        for side in (-1, 1):
            assert moved.nearest_thing(2 + side * half[0], 2 - side * half[1]) == (0.0, "table")
        assert moved.nearest_thing(1.0, 2.0) == (0.0, "plant")


def test_the_floor_with_every_stand_is_what_is_free_at_any_time(tmp_path: Path) -> None:
    world = load(tmp_path, FLAT)
    whole = with_every_stand(world)
    versions = [stood(world, door, table) for door in (0, 1) for table in (0, 1, 2)]
    for row, col in np.argwhere(world.floor.free)[::7]:
        x, y = world.floor.center_of(int(row), int(col))
        clearance = min(version.clearance_m(x, y) for version in versions)
        assert whole.clearance_m(x, y) == pytest.approx(clearance)
        assert whole.floor.free[row, col] == (clearance >= 0.025 - 1e-6)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("doors: [{at: [4, 1], shot: []}]", "4:22  a door has no key 'shot'; did you mean 'shut'?"),
        ("doors: [{at: [4, 1], shut: [5, 9]}]", "4:29  found a value '5'; expected [begin, end]"),
        ("doors: [{at: [4, 1], shut: [[5 m, 9 s]]}]", "begin: 5 m is not a duration; write 60 s or 2 min"),
        (
            "doors: [{at: [4, 1], shut: [[1, 5], [3, 9]]}]",
            "4:37  door 1 is shut from 3 s to 9 s; expected begin < end, and no begin before 5 s: put the",
        ),
        ("doors: [{at: [4, 1], shut: [[5, 5]]}]", "door 1 is shut from 5 s to 5 s; expected begin < end"),
        ("doors: [{at: [4, 1], shut: [[-1, 5]]}]", "no begin before 0 s"),
    ],
)
def test_a_fault_of_a_door_that_shuts_is_named(line: str, message: str, tmp_path: Path) -> None:
    assert message in refusal(tmp_path, HALL + line + "\n")


@pytest.mark.parametrize(
    ("moved", "message"),
    [
        ("[{at: 3}]", "4:60  a move lacks 'to'; add a line 'to: ...'"),
        ("[{at: -3, to: [1, 1]}]", "4:65  at is -3 s; expected at least 0 s"),
        ("[{at: 3, to: [1]}]", "found 1 values; expected [x, y, turn]"),
        ("[{at: 3, to: [1, 1, 2 m]}]", "turn: 2 m is not an angle; write 90 deg"),
        ("[{at: 3, too: [1, 1]}]", "a move has no key 'too'; did you mean 'to'?"),
        (
            "[{at: 9, to: [1, 1]}, {at: 9 s, to: [2, 2]}]",
            "4:81  a is moved at 9 s, the move before it at 9 s; put the moves in order",
        ),
        (
            "[{at: 3, to: [3.9, 1]}]",
            "4:72  a would stand outside the world, which reaches from [-0.05, -0.05] to [4.05, 3.05]; move",
        ),
    ],
)
def test_a_fault_of_a_thing_that_is_moved_is_named(moved: str, message: str, tmp_path: Path) -> None:
    furniture = f"furniture: [{{name: a, box: [1.0, 1.0, 2.00, 2.00], moved: {moved}}}]\n"
    assert message in refusal(tmp_path, HALL + furniture)


@pytest.mark.parametrize(
    ("person", "message"),
    [
        ("{rout: []}", "a person has no key 'rout'; did you mean 'route'?"),
        ("{route: [[1, 1], [2, 2]]}", "4:10  a person lacks 'name'; add a line 'name: ...'"),
        ("{name: ada, route: [[1, 1]]}", "4:29  the route of ada needs two or more points, none twice"),
        ("{name: ada, route: [[1, 1], [1, 1]]}", "the route of ada needs two or more points, none twice"),
        ("{name: ada, route: [[1, 1], [2, x]]}", "4:42  y: x is not a length; write 0.30 m or 30 cm"),
        ("{name: ada, route: [[1, 1], [2, 2]], speed: 0}", "speed is 0 m/s; expected at least 0.01 m/s"),
        ("{name: ada, route: [[1, 1], [2, 2]], radius: 2}", "radius is 2 m; expected 0.05 to 1 m"),
        ("{name: ada, route: [[1, 1], [2, 2]], pause: -1}", "pause is -1 s; expected at least 0 s"),
        ("{name: ada, route: [[1, 1], [2, 2]], begin: 1 m}", "begin: 1 m is not a duration"),
        (
            "{name: ada, route: [[1, 1], [4, 1]]}",
            "4:38  [4, 1] is inside wall of hall; ada needs 0.25 m on either side: move the point",
        ),
        ("{name: ada, route: [[1, 1], [1, 0.2]]}", "[1, 0.2] is 0.150 m from wall of hall; ada needs 0.25"),
        ("{name: ada, route: [[1, 1], [9, 1]]}", "[9, 1] is outside the world, which reaches from [-0.05"),
        (
            "{name: ada, route: [[1, 1], [1, 2], [3, 2]]}",
            "4:46  the way here leads through [1.80, 2.00], which is 0.200 m from pillar; ada needs 0.25",
        ),
    ],
)
def test_a_fault_of_a_person_is_named(person: str, message: str, tmp_path: Path) -> None:
    pillar = "furniture: [{name: pillar, box: [2, 1.9, 2.2, 2.1]}]\n"
    assert message in refusal(tmp_path, f"{HALL}people: [{person}]\n{pillar}")


def refusal(folder: Path, text: str) -> str:
    with pytest.raises(WorldError) as caught:
        load(folder, text)
    return str(caught.value).replace(f"{folder}{os.sep}world.yaml:", "")
