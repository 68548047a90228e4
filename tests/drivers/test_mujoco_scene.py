import math
import os
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers.people import Town
from explore_bt_drivers.world import World, load_world
from explore_bt_drivers.world.index import clearance_of
from explore_bt_drivers.world.solid import outline_edges

os.environ.setdefault("MUJOCO_GL", "egl")
mujoco = pytest.importorskip("mujoco")

from explore_bt_drivers.mujoco.scene import GeomGroup, Scene, Surroundings, build_scene  # noqa: E402  # after the skip
from explore_bt_drivers.mujoco.scene.atlas import Atlas  # noqa: E402
from explore_bt_drivers.mujoco.scene.cells import boxes_of, open_space  # noqa: E402
from explore_bt_drivers.mujoco.scene.matter import fixed_matter  # noqa: E402

WORLDS = Path(__file__).parents[2] / "missions" / "worlds"
FLAT = """\
format: explore-bt-world/1
rooms:
  - {name: hall, box: [0, 0, 4, 3]}
  - {name: study, box: [4, 0, 7, 3]}
doors:
  - {name: study door, at: [4, 1.5], width: 0.9, shut: [[1 s, 2 s]], sill: 15 mm}
walls:
  - {name: pane, path: [[5, 1], [5, 2]], material: glass}
  - {name: looking glass, path: [[6, 1], [6, 2]], material: mirror}
furniture:
  - {name: corner, polygon: [[0.1, 0.1], [1.5, 0.1], [1.5, 0.5], [0.5, 0.5], [0.5, 1.5], [0.1, 1.5]]}
  - {name: table, box: [2, 2, 3, 2.8], legs: 5 cm, height: 70 cm}
ramps:
  - {name: hump, box: [2, 0.1, 3, 1.5], slope: 3 deg, level: 20 cm}
people:
  - {name: ada, route: [[1, 1], [1, 2.5]], speed: 1 m/s}
"""


def scene_of(world: World) -> Scene:
    return build_scene(
        world, Town(world, (1.0, 1.0)).crowd(np.random.default_rng(0)), np.random.default_rng(0)
    )


@pytest.fixture(name="flat")
def _flat(tmp_path: Path) -> Scene:
    (tmp_path / "flat.yaml").write_text(FLAT)
    return scene_of(load_world(tmp_path / "flat.yaml"))


def down(model: "mujoco.MjModel", data: "mujoco.MjData", x: float, y: float, group: GeomGroup) -> float:
    """Height of the uppermost surface of a group under 5 m, metres."""
    groups = np.zeros(6, np.uint8)
    groups[group] = 1
    hit = np.zeros(1, np.int32)
    distance = mujoco.mj_ray(model, data, [x, y, 5.0], [0.0, 0.0, -1.0], groups, 1, -1, hit, None)
    return 5.0 - distance


def settled(scene: Scene) -> tuple["mujoco.MjModel", "mujoco.MjData", Surroundings]:
    model = scene.spec.compile()
    data = mujoco.MjData(model)
    surroundings = Surroundings(scene, model, 0.25)
    surroundings.settle(data, 0, 0.0, 0.0)
    mujoco.mj_forward(model, data)
    return model, data, surroundings


@pytest.mark.parametrize("group", [GeomGroup.WORLD, GeomGroup.UNSEEN])
def test_what_is_seen_and_what_is_run_into_have_the_heights_of_the_file(
    flat: Scene, group: GeomGroup
) -> None:
    model, data, _ = settled(flat)
    expected = {
        (2.5, 3.0): 2.5,  # a wall
        (4.0, 1.5): 0.015,  # the sill
        (0.3, 1.2): 0.8,  # one arm of the corner
        (1.2, 0.3): 0.8,
        (1.0, 1.0): 0.0,  # between its arms
        (2.5, 2.4): 0.7,  # the plate
        (2.5, 0.8): 0.4 * math.tan(math.radians(3.0)),  # the level part of the ramp
        (2.2, 0.8): 0.2 * math.tan(math.radians(3.0)),  # half way up
        (3.5, 2.0): 0.0,
    }
    for person in range(len(flat.crowd)):
        data.mocap_pos[model.body(flat.person_name(person)).mocapid[0], 2] = -50.0
    mujoco.mj_forward(model, data)
    found = {place: down(model, data, *place, group) for place in expected}
    assert found == {place: pytest.approx(height, abs=1e-4) for place, height in expected.items()}


def test_glass_and_mirrors_have_groups_of_their_own(flat: Scene) -> None:
    model, data, _ = settled(flat)
    assert down(model, data, 5.0, 1.5, GeomGroup.GLASS) == pytest.approx(2.5, abs=1e-4)
    assert down(model, data, 6.0, 1.5, GeomGroup.MIRROR) == pytest.approx(2.5, abs=1e-4)
    for x in (5.0, 6.0):
        assert down(model, data, x, 1.5, GeomGroup.WORLD) == pytest.approx(0.0, abs=1e-4)
        assert down(model, data, x, 1.5, GeomGroup.UNSEEN) == pytest.approx(2.5, abs=1e-4)


def test_bodies_fill_the_outlines_of_what_stands_on_the_floor(flat: Scene) -> None:
    model, data, _ = settled(flat)
    plan = flat.world.plan
    assert plan is not None
    outlines = [outline_edges(solid.corners) for solid in plan.solids]
    rng = np.random.default_rng(1)
    for x, y in rng.uniform((0.0, 0.0), (7.0, 3.0), (300, 2)):
        gap = min(clearance_of(edges, x, y) for edges in outlines)
        height = down(model, data, x, y, GeomGroup.UNSEEN)
        assert gap > 0.0 or height > 0.699
        assert gap < 1e-3 or height < 0.1 or height == pytest.approx(0.7, abs=1e-4)  # the plate


def test_a_door_shuts_when_it_is_due_and_the_robot_is_clear_of_it(flat: Scene) -> None:
    model, data, surroundings = settled(flat)
    heights = []
    for step, x in ((499, 4.0), (500, 4.0), (600, 4.0), (601, 3.0), (999, 3.0), (1000, 3.0)):
        surroundings.settle(data, step, x, 1.5)
        mujoco.mj_forward(model, data)
        heights.append(down(model, data, 4.0, 1.5, GeomGroup.WORLD))
    assert heights == pytest.approx([0.015, 0.015, 0.015, 2.5, 2.5, 0.015], abs=1e-4)
    assert surroundings.stands_at(1.1) == (0,)
    assert surroundings.stands_at(1.3) == (1,)
    assert surroundings.changes_between(0.0, 1.5) == [pytest.approx(1.202)]


def test_people_walk_through_the_scene(flat: Scene) -> None:
    model, data, surroundings = settled(flat)
    for time_s in (0.5, 1.0, 1.5, 2.5):
        surroundings.settle(data, round(time_s / 0.002), 6.0, 2.0)
        mujoco.mj_forward(model, data)
        x, y = flat.crowd.at(time_s)[0, :2]
        assert down(model, data, x, y, GeomGroup.WORLD) == pytest.approx(1.76, abs=1e-3)
        assert down(model, data, x + 0.2, y, GeomGroup.WORLD) == pytest.approx(1.5, abs=1e-3)


def test_no_two_patches_share_texels_and_none_repeats(flat: Scene) -> None:
    surface = fixed_matter(flat.world, np.random.default_rng(0)).surfaces[0]
    atlas = Atlas(surface, np.random.default_rng(0))
    rows, cols, _ = atlas.pixels.shape
    taken = np.zeros((rows, cols), dtype=np.int64)
    places = atlas.uv * (cols, rows)
    for patch in range(len(surface.sizes)):
        own = places[surface.patches == patch]
        (x0, y0), (x1, y1) = np.floor(own.min(axis=0)).astype(int), np.ceil(own.max(axis=0)).astype(int)
        assert not taken[y0:y1, x0:x1].any()
        taken[y0:y1, x0:x1] = patch + 1
    tiles = [
        tile
        for row in np.array_split(atlas.pixels, rows // 20)
        for tile in np.array_split(row, cols // 20, 1)
    ]
    shapes = {tile.tobytes() for tile in tiles if tile.std() > 0}
    assert len(shapes) > 0.99 * sum(tile.std() > 0 for tile in tiles)


def test_boxes_cover_the_solid_cells_of_a_map_once_each() -> None:
    rng = np.random.default_rng(2)
    for share in (0.1, 0.5, 0.9):
        solid = rng.random((40, 60)) < share
        covered = np.zeros(solid.shape, dtype=np.int64)
        for row, col, last_row, last_col in boxes_of(solid):
            covered[row:last_row, col:last_col] += 1
        assert np.array_equal(covered, solid)


def test_specks_of_a_map_are_no_open_space() -> None:
    free = np.zeros((100, 100), dtype=np.bool_)
    free[10:60, 10:60] = free[80:85, 80:85] = True
    assert np.argwhere(open_space(free, 0.05)).max() == 59


@pytest.mark.parametrize("name", ["sdgrm/intel_lab", "ros/willow_garage_full"])
def test_walls_of_a_real_map_stand_where_the_map_is_not_free(name: str) -> None:
    folder = os.environ.get("EXPLORE_BT_DATA")
    if not folder:
        pytest.skip("EXPLORE_BT_DATA is not set")
    world = load_world(Path(folder) / "floorplans" / f"{name}.yaml")
    model, data, _ = settled(scene_of(world))
    space = open_space(world.floor.free, world.floor.resolution_m)
    rng = np.random.default_rng(3)
    for row, col in rng.integers(0, space.shape, (200, 2)):
        x, y = world.floor.center_of(int(row), int(col))
        expected = 0.0 if space[row, col] else 2.5
        for group in (GeomGroup.WORLD, GeomGroup.UNSEEN):
            assert down(model, data, x, y, group) == pytest.approx(expected, abs=1e-3)


def test_the_same_seed_paints_the_same_scene(flat: Scene) -> None:
    again = scene_of(flat.world)
    one, other = flat.spec.compile(), again.spec.compile()
    assert np.array_equal(one.tex_data, other.tex_data)
    assert np.array_equal(one.mesh_vert, other.mesh_vert)
