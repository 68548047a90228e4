import functools
import re
from pathlib import Path

import numpy as np
import pytest
from explore_bt_drivers.world import load_world
from explore_bt_drivers.world.observable import reachable_cells
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.errors import WorldError
from explore_bt.worlds import KINDS, generate_world
from explore_bt.worlds.generate import draw_plan
from explore_bt.worlds.passages import GAPS_M
from explore_bt.worlds.world_text import world_text

SEEDS = range(30)

plan_of = functools.cache(draw_plan)


def loaded(kind, seed, folder):
    path = Path(folder) / f"{kind}_{seed}.yaml"
    path.write_text(world_text(plan_of(kind, seed), "for a test"))
    return load_world(path)


def share_reached(world, plan, radius_m):
    """Of the floor of each space where the footprint fits, the share it can come to from the start."""
    reached = reachable_cells(world, world.start.xy, radius_m)
    shares = {}
    for space in plan.spaces:
        low, high = world.floor.cells_of(
            np.array([[space.floor.x0, space.floor.y0], [space.floor.x1, space.floor.y1]])
        )
        window = (slice(low[0] + 1, high[0]), slice(low[1] + 1, high[1]))
        shares[space.name] = reached[window].sum() / reached[window].size
    return shares


@pytest.mark.parametrize("kind", ["apartment", "office"])
def test_thirty_worlds_load_and_every_room_can_be_reached(kind, tmp_path):
    for seed in SEEDS:
        plan, world = plan_of(kind, seed), loaded(kind, seed, tmp_path)
        shares = share_reached(world, plan, 0.25)
        assert min(shares.values()) > 0.1, (seed, shares)
        assert world.clearance_m(*world.start.xy) > 0.4


@pytest.mark.parametrize("kind", ["apartment", "office"])
def test_doors_are_as_wide_as_doors_are(kind):
    for seed in SEEDS:
        plan = plan_of(kind, seed)
        widths = [
            door.width_m
            for door in plan.doors
            if not {"living room", "kitchen"} <= set(door.name.split(" - "))
        ]
        assert min(widths) >= 0.8
        assert max(widths) <= 1.0


@pytest.mark.parametrize("kind", KINDS)
def test_a_seed_gives_one_world_and_another_seed_another(kind):
    texts = [generate_world(kind, seed) for seed in range(6)]
    assert texts == [generate_world(kind, seed) for seed in range(6)]
    assert len({re.sub(r"--seed \d+", "", text) for text in texts}) == 6


@pytest.mark.parametrize("kind", ["apartment", "office"])
def test_rooms_are_furnished(kind):
    for seed in SEEDS:
        plan = plan_of(kind, seed)
        bare = [
            s.name for s in plan.spaces if s.walled and not any(p.name.endswith(s.name) for p in plan.pieces)
        ]
        assert len(bare) <= 1, (seed, bare)


def test_the_course_has_every_gap_and_each_lets_through_who_fits(tmp_path):
    plan, world = draw_plan("passages", 3), loaded("passages", 3, tmp_path)
    assert sorted(door.width_m for door in plan.doors) == sorted(GAPS_M)
    assert (GAPS_M[0], GAPS_M[-1], len(GAPS_M)) == (0.5, 1.2, 15)
    for radius_m in (0.26, 0.36, 0.46):
        shares = share_reached(world, plan, radius_m)
        for gap_m in GAPS_M:
            passed = shares[f"chamber {100 * gap_m:.0f}"] > 0.1
            assert passed == (gap_m > 2.0 * radius_m), (gap_m, radius_m)


def test_the_command_writes_the_file_and_names_what_is_wrong(tmp_path):
    out = tmp_path / "flat.yaml"
    run = CliRunner().invoke(app, ["world", "--kind", "apartment", "--seed", "3", "--out", str(out)])
    assert run.exit_code == 0
    assert out.read_text() == generate_world("apartment", 3)
    for words, said in (
        (["--kind", "castle", "--out", str(out)], "choose one of apartment, office, passages"),
        (["--seed", "-1", "--out", str(out)], "expected 0 or more"),
        (["--out", str(tmp_path / "no" / "flat.yaml")], "make it first"),
        (["--out", str(tmp_path)], "is a folder"),
    ):
        run = CliRunner().invoke(app, ["world", *words])
        assert run.exit_code == 2
        assert said in run.stderr
    with pytest.raises(WorldError):
        generate_world("castle", 0)
