"""What is written for Rerun is read back by Rerun's own reader."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import pyarrow
import pytest
from explore_bt_sinks.rerun import RerunLive

from tests.report.flat_drive import make_drive

TICKS = 60


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    return make_drive(tmp_path_factory.mktemp("drive"), speed_mps=0.8)


@pytest.fixture(scope="module")
def columns(drive):
    """Entity -> component -> the values logged, in order."""
    from rerun.chunk import RrdReader

    sink = RerunLive(RerunLive.Options(to="file"))
    sink.open(drive.run)
    for event in drive.events:
        sink.on_event(event)
    for tick in drive.ticks[:TICKS]:
        sink.on_tick(tick)
    sink.close(drive.result)
    sink.close(drive.result)
    found: dict[str, dict[str, list[object]]] = defaultdict(lambda: defaultdict(list))
    for chunk in RrdReader(drive.run.folder / "rerun.rrd").stream():
        batch = pyarrow.record_batch(chunk.to_record_batch())
        for name, column in zip(batch.schema.names, batch.columns, strict=True):
            if ":" in name:  # else the timelines and row numbers
                found[chunk.entity_path][name.rpartition(":")[2]] += column.to_pylist()
    return found


def test_the_robot_is_where_it_was_at_every_tick(columns, drive):
    places = [place for (place,) in columns["/robot/pose"]["positions"]]
    assert len(places) == TICKS
    for place, tick in zip(places, drive.ticks, strict=False):
        assert place == pytest.approx([*tick.robots[0].estimate.T_map_base.xy, 0.0], abs=1e-4)


def test_the_map_is_the_map_with_its_lower_left_corner_where_the_grid_begins(columns, drive):
    logged = columns["/robot/map"]
    grids = [tick.robots[0].grid for tick in drive.ticks[:TICKS]]
    pixels = np.array(logged["data"][-1], dtype=np.uint8).reshape(*grids[-1].shape, 4)[::-1]
    (shown,) = {id(grid): grid for grid in grids if np.array_equal(pixels[..., 0] == 255, grid.free)}.values()
    assert ((pixels[..., 0] == 43) == shown.occupied).all()
    assert logged["translation"][-1][0][:2] == pytest.approx(shown.origin_xy)
    assert logged["cell_size"][-1] == pytest.approx([shown.resolution_m])


def test_the_scan_lies_on_the_map(columns, drive):
    first = drive.ticks[0].robots[0]
    expected = first.estimate.T_map_base.apply(first.scan.points())
    np.testing.assert_allclose(np.array(columns["/robot/scan"]["positions"][0])[:, :2], expected, atol=1e-4)


def test_sectors_and_views_carry_their_reasons(columns):
    assert columns["/robot/sectors"]["labels"][-1] == ["rejected: visited", "taken: → the goal"]
    assert columns["/robot/views"]["labels"][-1] == ["taken: the next goal"]


def test_tree_figures_and_events_are_told(columns, drive):
    (text,) = columns["/robot/tree"]["text"][-1]
    nodes = drive.ticks[TICKS - 1].robots[0].nodes
    assert len(text.splitlines()) == len(nodes)
    assert sum(line.lstrip().startswith("▶") for line in text.splitlines()) == sum(
        node.status == "running" for node in nodes
    )
    assert columns["/robot/figures/coverage"]["scalars"][-1][0] > 0.2
    words = [line for (line,) in columns["/events"]["text"]]
    assert words == [
        *(f"{event.robot}/{event.source}: {event.message}" for event in drive.events),
        f"explored: {drive.result.reason}",
    ]
    assert {level for (level,) in columns["/events"]["level"]} >= {"INFO", "WARN"}
