from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.interfaces import Event, HeldBy
from explore_bt.report.charts import Series, chart
from explore_bt.report.first_seen import FirstSeen
from explore_bt.report.history import RobotHistory
from explore_bt.report.overlay import cropped, overlaid
from explore_bt.report.run_history import RunHistory
from explore_bt.report.words import clock, duration, figure, length, percent
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, OccupancyGrid


def grid_of(draw_rows, origin_xy, revision=0):
    return OccupancyGrid(np.array(draw_rows, dtype=np.int8), 0.5, origin_xy, revision)


cells = st.sampled_from([UNKNOWN, FREE, OCCUPIED])
grids = st.builds(
    lambda values, x, y: grid_of(values, (x * 0.5, y * 0.5)),
    st.tuples(st.integers(1, 5), st.integers(1, 5)).flatmap(
        lambda shape: st.lists(
            st.lists(cells, min_size=shape[1], max_size=shape[1]), min_size=shape[0], max_size=shape[0]
        )
    ),
    st.integers(-4, 4),
    st.integers(-4, 4),
)


@settings(deadline=None)
@given(st.lists(grids, min_size=1, max_size=4))
def test_an_overlay_knows_at_each_place_what_any_map_knows(maps):
    union = overlaid(maps)
    for x in np.arange(-2.75, 6.0, 0.5):
        for y in np.arange(-2.75, 6.0, 0.5):
            assert union.value_at(x, y) == max(one.value_at(x, y) for one in maps)


@settings(deadline=None)
@given(grids)
def test_cropping_changes_no_place(grid):
    small = cropped(grid, margin_m=0.5)
    for x in np.arange(-2.75, 6.0, 0.5):
        for y in np.arange(-2.75, 6.0, 0.5):
            assert small.value_at(x, y) == grid.value_at(x, y)
    known = np.argwhere(small.cells != UNKNOWN)
    if len(known):
        assert known.min() == 1
        assert tuple(known.max(axis=0)) == (small.shape[0] - 2, small.shape[1] - 2)


@settings(deadline=None)
@given(st.lists(grids, min_size=1, max_size=5))
def test_first_seen_agrees_with_a_look_at_every_place(maps):
    seen = FirstSeen()
    expected: dict[tuple[float, float], float] = {}
    window: dict[tuple[float, float], float] = {}
    for stamp, grid in enumerate(maps):
        places = {
            grid.center_of(row, col): (row, col)
            for row in range(grid.shape[0])
            for col in range(grid.shape[1])
        }
        # what a grid no longer covers is forgotten
        window = {place: expected[place] for place in places if place in expected}
        for place, cell in places.items():
            if grid.cells[cell] != UNKNOWN:
                window.setdefault(place, float(stamp))
        expected = window
        seen.note(float(stamp), grid)
    last = maps[-1]
    for (row, col), stamp in np.ndenumerate(seen.on(last)):
        assert stamp == expected.get(last.center_of(row, col), np.inf)


def test_a_chart_is_well_formed_and_stays_inside_its_frame():
    stamps = np.linspace(0.0, 100.0, 1001)
    values = np.abs(np.sin(stamps)) * 7.3
    values[300:320] = np.nan
    page = chart("Driven <far>", "m", [Series("a & b", "#123456", stamps, values)], 100.0)
    figure_ = ET.fromstring(page)
    lines = figure_.findall(".//polyline")
    assert len(lines) == 2  # a gap where nobody knows
    points = np.array([[float(v) for v in pair.split(",")] for pair in lines[0].attrib["points"].split()])
    assert (points >= 0).all()
    assert (points <= (420, 210)).all()
    assert figure_.find("figcaption").text == "Driven <far> "


def test_a_chart_of_what_nobody_knows_is_no_chart():
    assert chart("Mapped", "%", [Series("a", "#000", np.arange(3.0), np.full(3, np.nan))], 2.0) == ""


@pytest.mark.parametrize("span", [1e-9, 0.004, 0.7, 1.0, 99.0, 12345.0])
def test_axes_have_a_handful_of_round_marks_at_any_scale(span):
    line = Series("a", "#000", np.array([0.0, span]), np.array([0.0, span]))
    texts = [text.text for text in ET.fromstring(chart("x", "m", [line], span)).iter("text")]
    assert 3 <= len(texts) <= 14


def test_figures_read_as_people_say_them():
    assert [clock(s) for s in (0, 59.9, 61, 3725)] == ["0:00", "0:59", "1:01", "1:02:05"]
    assert [duration(s) for s in (41.73, 59.99, 232, 3900)] == [
        "41.7 s",
        "60.0 s",
        "3 min 52 s",
        "1 h 05 min",
    ]
    assert [length(m) for m in (None, 0.034, 0.31, 61.27, float("nan"))] == [
        "–",
        "3.4 cm",
        "0.31 m",
        "61.3 m",
        "–",
    ]
    assert [percent(s) for s in (None, 0.9891, 1.0)] == ["–", "98.9 %", "100.0 %"]
    assert [figure(v) for v in (1404.0, 2.3149, 0.00412)] == ["1 404", "2.315", "0.00412"]
    assert re.fullmatch(r"\S+", figure(float("inf")))


def test_a_gate_that_flickers_is_one_intervention_until_something_else_holds_the_robot(flat_drive):
    robot = flat_drive.ticks[0].robots[0]
    history = RobotHistory("robot", 0.25, flat_drive.run.trees["robot"])
    for k in range(60):
        held_by = HeldBy.SOMEONE if k < 20 else HeldBy.OBSTACLE
        reason = f"{k} cm" if k < 40 and k % 3 == 0 else ""
        history.on_tick(0.1 * k, replace(robot, gate_reason=reason, held_by=held_by))
    told = [(each.held_by, round(each.begin_s, 1), round(each.end_s, 1)) for each in history.interventions]
    assert told == [(HeldBy.SOMEONE, 0.0, 1.8), (HeldBy.OBSTACLE, 2.1, 3.9)]


def test_what_leaves_say_cannot_push_out_what_matters(flat_drive):
    history = RunHistory.of(flat_drive.run)
    for k in range(1500):
        history.on_event(Event(float(k), "robot", "debug", "a/b", f"saying {k}"))
    history.on_event(Event(9.0, "robot", "warning", "safety gate", "held"))
    assert len(history.events) == 1001
    assert history.events_left_out == 500
    assert history.events[-1].message == "held"
