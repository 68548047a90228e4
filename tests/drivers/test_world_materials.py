import math
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers.world import Material, World, load_world, read_world_file

from explore_bt.errors import WorldError

HALL = "format: explore-bt-world/1\nrooms:\n  - {name: hall, box: [0, 0, 6, 4]}\n"
PANE = "walls: [{name: pane, path: [[3, 1], [3, 3]], thickness: 2 cm, material: %s}]\n"


def load(folder: Path, text: str) -> World:
    (folder / "world.yaml").write_text(HALL + text)
    return load_world(folder / "world.yaml")


def test_beams_pass_through_glass_that_bodies_run_into(tmp_path: Path) -> None:
    world = load(tmp_path, PANE % "glass")
    assert world.cast(1.0, 2.0, np.zeros(1), 9.0)[0] == pytest.approx(4.95)
    assert world.nearest_thing(2.5, 2.0) == (pytest.approx(0.49), "pane")


def test_a_mirror_shows_the_room_before_it_behind_it(tmp_path: Path) -> None:
    matt, mirror = load(tmp_path, PANE % "matt"), load(tmp_path, PANE % "mirror")
    for angle in np.radians([-25.0, -10.0, 0.0, 5.0, 20.0]):
        there = matt.cast(1.2, 2.0, np.array([angle]), 9.0)[0]
        x, y = 1.2 + there * math.cos(angle), 2.0 + there * math.sin(angle)
        onwards = matt.cast(x - 1e-9, y, np.array([math.pi - angle]), 9.0)[0]
        assert mirror.cast(1.2, 2.0, np.array([angle]), 9.0)[0] == pytest.approx(there + onwards, abs=1e-6)


def test_a_beam_between_two_mirrors_is_lost(tmp_path: Path) -> None:
    world = load(
        tmp_path,
        "walls:\n"
        "  - {path: [[2, 1], [2, 3]], thickness: 2 cm, material: mirror}\n"
        "  - {path: [[3, 1], [3, 3]], thickness: 2 cm, material: mirror}\n",
    )
    assert world.cast(2.5, 2.0, np.zeros(1), 100.0)[0] == math.inf


def test_the_door_of_a_glass_wall_is_of_glass(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(HALL + PANE % "glass" + "doors: [{at: [3, 2], width: 0.8, shut: [[1, 2]], sill: 1 cm}]\n")
    plan = read_world_file(path)
    assert plan.things[0].stands[1].solids[0].material is Material.GLASS
    (sill,) = plan.sills
    assert (sill.material, sill.height_m, np.ptp(sill.corners, axis=0).tolist()) == (
        Material.MATT,
        0.01,
        pytest.approx([0.02, 0.8]),
    )


def test_legs_carry_a_plate_and_cupboards_hang(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(
        HALL + "furniture:\n"
        "  - name: table\n    box: [1, 1, 2, 3]\n    legs: 5 cm\n    height: 0.7\n    material: glass\n"
        "    moved: [{at: 5, to: [4, 2, 90 deg]}]\n"
        "  - {name: cupboard, box: [0.05, 3.6, 2, 3.9], underside: 1.4 m, height: 2 m}\n"
    )
    plan = read_world_file(path)
    plate, cupboard = plan.overhangs
    assert (plate.low_m, plate.height_m, plate.material) == (pytest.approx(0.66), 0.7, Material.GLASS)
    assert (cupboard.low_m, cupboard.height_m, cupboard.material) == (1.4, 2.0, Material.MATT)
    assert {solid.material for solid in plan.solids} == {Material.MATT}
    moved = plan.things[0].stands[1]
    low, high = moved.overhangs[0].corners.min(axis=0), moved.overhangs[0].corners.max(axis=0)
    assert [*low, *high] == pytest.approx([3.0, 1.5, 5.0, 2.5])
    assert load_world(path).is_free(1.0, 3.8)
    assert load_world(path).cast(1.5, 2.0, np.array([math.pi / 2]), 9.0)[0] == pytest.approx(1.95)


def test_a_ramp_rises_lies_level_and_falls(tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(HALL + "ramps: [{name: a, box: [2, 1, 4, 3], turn: 90 deg, slope: 3 deg, level: 1 m}]\n")
    (ramp,) = read_world_file(path).ramps
    assert ramp.rise_m == pytest.approx(0.5 * math.tan(math.radians(3.0)))
    assert ramp.corners[:4].min(axis=0) == pytest.approx([2.0, 1.0, 0.0])
    assert ramp.corners[4:].min(axis=0) == pytest.approx([2.0, 1.5, ramp.rise_m])
    assert ramp.corners[4:].max(axis=0) == pytest.approx([4.0, 2.5, ramp.rise_m])


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("walls: [{path: [[1, 1], [2, 1]], material: glas}]", "4:44  material is glas; expected one of matt"),
        (
            "furniture: [{name: a, box: [1, 1, 2, 2], material: 1}]",
            "material is 1; expected one of matt",
        ),
        ("doors: [{at: [6, 2], sill: 4 cm}]", "4:28  sill is 0.04 m; expected 0.001 to 0.03 m"),
        ("furniture: [{name: a, box: [1, 1, 2, 2], top: 4 cm}]", "top is the thickness of a plate on legs"),
        (
            "furniture: [{name: a, box: [1, 1, 2, 2], legs: 5 cm, top: 90 cm}]",
            "the top of a is 0.9 m thick, its height 0.8 m; that leaves no legs",
        ),
        (
            "furniture: [{name: a, circle: [1, 1, 0.2], underside: 1 m}]",
            "the underside of a is at 1 m, its height 0.8 m; expected an underside below it: give a height",
        ),
        (
            "furniture: [{name: a, box: [1, 1, 2, 2], underside: 1 m, legs: 5 cm}]",
            "4:53  furniture has legs or an underside, not both; leave one out",
        ),
        ("ramps: [{name: r, box: [1, 1, 2, 2], slope: 4 deg}]", "slope is 0.0698132 rad; expected 0.001 to"),
        ("ramps: [{name: r, box: [1, 1, 2, 2], level: 1 m}]", "4:24  ramp r is 1 m long, 1 m of it level"),
        ("ramps: [{name: r}]", "4:9  a ramp lacks 'box'; add a line 'box: ...'"),
    ],
)
def test_faults_of_materials_and_heights_have_a_place_and_a_hint(
    line: str, message: str, tmp_path: Path
) -> None:
    with pytest.raises(WorldError) as refused:
        load(tmp_path, line + "\n")
    assert message in str(refused.value)
