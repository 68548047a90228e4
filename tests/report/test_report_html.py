from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
from dataclasses import replace
from html.parser import HTMLParser

import cv2
import numpy as np
import pytest

from explore_bt.interfaces import Event
from explore_bt.report import ReportSink
from explore_bt.report.what_happened import KINDS, kind_of
from explore_bt.types import UNKNOWN, OccupancyGrid, Outcome, Score

VOID = {"meta", "input", "line", "br", "link", "img"}
EVIL = "<script>alert(1)</script>&\"'"


class Checker(HTMLParser):
    """Counts open elements and collects what would be fetched or run."""

    def __init__(self):
        super().__init__()
        self.open_tags, self.links, self.scripts, self.text = [], [], 0, []

    def handle_starttag(self, tag, attributes):
        if tag not in VOID:
            self.open_tags.append(tag)
        self.scripts += tag == "script"
        self.links += [value for name, value in attributes if name in ("href", "src")]

    def handle_endtag(self, tag):
        assert self.open_tags.pop() == tag

    def handle_startendtag(self, tag, attributes):
        pass

    def handle_data(self, data):
        self.text.append(data)


def write_report(drive, folder):
    drive.in_folder(folder).show_to(ReportSink(ReportSink.Options()))
    return (folder / "report.html").read_text()


def checked(page):
    checker = Checker()
    checker.feed(page)
    checker.close()
    assert not checker.open_tags
    return checker


def data_of(page):
    return json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL)[1])


@pytest.fixture(scope="module")
def page(flat_drive, tmp_path_factory):
    return write_report(flat_drive, tmp_path_factory.mktemp("page"))


def test_the_page_is_well_formed_and_needs_no_network(page):
    checker = checked(page)
    assert checker.scripts == 2
    assert all(not re.match(r"(?:[a-z]+:)?//", link) for link in checker.links)
    assert "http" not in page
    assert "@import" not in page


def test_it_says_how_and_why_the_mission_ended_and_what_is_left(page, flat_drive):
    text = "".join(checked(page).text)
    assert "Explored" in text
    assert "No reachable frontier wider than 0.50 m is left; returned home" in text
    assert flat_drive.result.left_open[0] in text


def test_every_entry_of_result_json_stands_in_its_table(page, flat_drive):
    for name in flat_drive.result.as_dict():
        assert f"<td>{name}</td>" in page


def test_gate_events_slam_figures_and_nodes_are_listed(page):
    text = "".join(checked(page).text)
    assert "braked once, 0.8 s in all" in text
    assert "few returns in <corridor> & beyond" in text
    assert "loop_closures" in text
    assert "nodes were never ticked" in text


def test_what_happened_has_a_switch_for_every_kind_and_leads_to_the_moment(page, flat_drive):
    table = page.partition("What happened and why")[2].partition("</section>")[0]
    for event in flat_drive.events:
        row = f'<tr class="{kind_of(event)}"><td><a href="#t={event.stamp_s:.1f}">'
        assert row in table
        assert f'id="show-{kind_of(event)}" checked' in table
    style = page.partition("<style>")[2].partition("</style>")[0]
    assert all(f"#show-{kind}:not(:checked)" in style for kind in KINDS)


def test_what_leaves_say_is_there_but_hidden_at_first(flat_drive, tmp_path):
    saying = Event(3.0, "robot", "debug", "complete/find_view", "12 views to go")
    text = write_report(replace(flat_drive, events=[saying]), tmp_path)
    assert '<input type="checkbox" id="show-saying">' in text
    assert '<tr class="saying">' in text
    assert '<span title="complete/find_view">find_view</span>' in text


def test_the_drive_in_the_page_is_the_drive(page, flat_drive):
    data = data_of(page)
    robot = data["robots"][0]
    assert len(robot["t"]) == len(robot["x"]) == len(robot["clearance"]) == len(flat_drive.ticks)
    last = flat_drive.ticks[-1].robots[0]
    assert robot["x"][-1] == pytest.approx(last.estimate.T_map_base.x, abs=1e-3)
    assert len(robot["waypoints"]) == len(last.blackboard["visited"])
    fourth = next(t.stamp_s for t in flat_drive.ticks if len(t.robots[0].blackboard["visited"]) == 4)
    assert robot["waypoints"][3][0] == pytest.approx(fourth, abs=0.01)
    assert data["end_s"] == pytest.approx(flat_drive.ticks[-1].stamp_s)


def decoded(uri):
    import base64

    raw = np.frombuffer(base64.b64decode(uri.partition(",")[2]), dtype=np.uint8)
    return cv2.imdecode(raw, cv2.IMREAD_UNCHANGED)[::-1]


def test_the_map_in_the_page_is_the_last_map_and_grows_with_time(page, flat_drive):
    shown = data_of(page)["map"]
    cells, seen = decoded(shown["cells"]), decoded(shown["seen"])
    grid = flat_drive.ticks[-1].robots[0].grid
    assert (cells == 255).sum() == grid.free.sum()
    assert (cells == 128).sum() == grid.occupied.sum()
    assert ((seen < 255) == (cells > 0)).all()
    half = flat_drive.ticks[len(flat_drive.ticks) // 2].robots[0].grid
    assert (seen < 127).sum() == pytest.approx((half.cells != UNKNOWN).sum(), rel=0.05)


def test_foreign_text_cannot_become_markup(flat_drive, tmp_path):
    run = replace(
        flat_drive.run,
        mission=EVIL,
        version=EVIL,
        trees={
            "robot": tuple(replace(node, name=EVIL, place=EVIL) for node in flat_drive.run.trees["robot"])
        },
    )
    events = [Event(0.0, EVIL, EVIL, EVIL, EVIL)]
    result = replace(
        flat_drive.result, reason=EVIL, left_open=(EVIL, "{{style}}"), mission=EVIL, slam={EVIL: 1.0}
    )
    ticks = [
        replace(tick, robots=tuple(replace(robot, gate_reason=EVIL) for robot in tick.robots))
        for tick in flat_drive.ticks[:30]
    ]
    page = write_report(replace(flat_drive, run=run, events=events, result=result, ticks=ticks), tmp_path)
    checker = checked(page)
    assert checker.scripts == 2
    assert "<script>alert" not in page
    assert "".join(checker.text).count(EVIL) > 20
    assert "{{style}}" in page


def test_a_robots_name_cannot_end_the_script(pair_drive, tmp_path):
    run = replace(pair_drive.run)
    page = write_report(replace(pair_drive, run=run), tmp_path)
    assert [robot["name"] for robot in data_of(page)["robots"]] == ["anna", "bert <b>"]
    assert "<b>" not in page.replace("<b></b>", "").replace(f"<b>{run.mission}</b>", "")


def test_several_robots_have_a_colour_and_a_tree_each(pair_drive, tmp_path):
    page = write_report(pair_drive, tmp_path)
    data = data_of(page)
    assert len({robot["colour"] for robot in data["robots"]}) == 2
    assert "Tree of anna" in page
    assert "Tree of bert &lt;b&gt;" in page


def test_only_files_that_exist_are_linked(flat_drive, tmp_path):
    (tmp_path / "map.yaml").touch()
    (tmp_path / "secret.txt").touch()
    (tmp_path / "my robot").mkdir()
    (tmp_path / "my robot" / "trajectory.tum").touch()
    links = checked(write_report(flat_drive, tmp_path)).links
    assert [link for link in links if not link.startswith(("data:", "#t="))] == [
        "result.json",
        "map.yaml",
        "map_view.png",
        "my%20robot/trajectory.tum",
    ]


def test_what_nobody_knows_is_left_out(flat_drive, tmp_path):
    result = replace(
        flat_drive.result,
        outcome=Outcome.FAILED,
        reason="",
        coverage=None,
        contacts=None,
        ate_rmse_m=None,
        min_clearance_m=None,
        mean_clearance_m=None,
        left_open=(),
        slam={},
    )
    ticks = [
        replace(tick, robots=tuple(replace(robot, score=Score(), gate_reason="") for robot in tick.robots))
        for tick in flat_drive.ticks[:200]
    ]
    page = write_report(replace(flat_drive, result=result, ticks=ticks, events=[]), tmp_path)
    text = "".join(checked(page).text)
    assert "No reason was given." in text
    assert "Nothing was left open." in text
    assert "It never had to brake." in text
    assert "contacts" not in text.partition("Why it stopped")[0]
    assert "<figcaption>Mapped" not in page
    assert all(value is not None for value in data_of(page)["robots"][0]["clearance"])  # taken from the map


def test_touches_by_people_stand_beside_the_contacts(flat_drive, tmp_path):
    told = {}
    for touches in (0, 2):
        result = replace(flat_drive.result, touched_by_people=touches)
        text = "".join(checked(write_report(replace(flat_drive, result=result), tmp_path)).text)
        told[touches] = text.partition("Why it stopped")[0]
    assert "touched by people: 2" in told[2]
    assert "touched by people" not in told[0]


@pytest.mark.parametrize("count", [0, 1, 2])
def test_a_run_that_ended_at_once_still_has_a_report(flat_drive, tmp_path, count):
    checked(write_report(replace(flat_drive, ticks=flat_drive.ticks[:count]), tmp_path))
    assert (tmp_path / "map_view.png").exists() == (count > 0)


def test_a_map_of_nothing_and_a_lost_pose_are_survived(flat_drive, tmp_path):
    robot = flat_drive.ticks[0].robots[0]
    nothing = OccupancyGrid(np.full((5, 5), UNKNOWN, dtype=np.int8), 0.05, (0.0, 0.0))
    pose = replace(robot.estimate.T_map_base, x=math.nan)
    lost = replace(robot, grid=nothing, estimate=replace(robot.estimate, T_map_base=pose))
    ticks = [replace(flat_drive.ticks[i], robots=(lost,)) for i in range(5)]
    page = write_report(replace(flat_drive, ticks=ticks), tmp_path)
    assert data_of(page)["robots"][0]["t"] == []
    assert "NaN" not in page


def test_without_a_result_nothing_is_written(flat_drive, tmp_path):
    sink = ReportSink(ReportSink.Options())
    sink.close(None)
    sink.open(flat_drive.in_folder(tmp_path).run)
    sink.close(None)
    assert list(tmp_path.iterdir()) == []


def test_a_second_close_writes_nothing_again(flat_drive, tmp_path):
    sink = ReportSink(ReportSink.Options())
    flat_drive.in_folder(tmp_path).show_to(sink)
    (tmp_path / "report.html").unlink()
    sink.close(flat_drive.result)
    assert not (tmp_path / "report.html").exists()


def test_a_flood_of_events_does_not_make_a_page_that_no_browser_opens(flat_drive, tmp_path):
    events = [Event(0.0, "robot", "info", "driver", f"line {i}") for i in range(5000)]
    page = write_report(replace(flat_drive, ticks=flat_drive.ticks[:20], events=events), tmp_path)
    assert "3000 more are in the recording" in page
    assert len(page) < 1e6


def test_the_picture_is_a_large_png(flat_drive, tmp_path):
    write_report(flat_drive, tmp_path)
    picture = cv2.imread(str(tmp_path / "map_view.png"))
    assert picture.shape[1] == 1200
    colours = picture.astype(np.int64) @ (1, 256, 65536)
    assert len(np.unique(colours)) > 100


@pytest.mark.skipif(shutil.which("chromium") is None, reason="chromium is not installed")
@pytest.mark.parametrize(("hash_", "clock"), [("", "2:14"), ("#t=42", "0:42")])
def test_in_a_real_browser_the_script_draws_and_says_no_error(flat_drive, tmp_path, hash_, clock):
    write_report(flat_drive, tmp_path)
    flags = "--headless --no-sandbox --disable-gpu --disable-background-networking --no-first-run"
    done = subprocess.run(
        [
            *("chromium", *flags.split(), f"--user-data-dir={tmp_path / 'profile'}"),
            *("--enable-logging=stderr", "--virtual-time-budget=3000", "--dump-dom"),
            f"file://{tmp_path}/report.html{hash_}",
        ],
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    assert f'<output id="clock">{clock}</output>' in done.stdout
    assert re.search(r'<canvas[^>]* width="\d+"', done.stdout)  # the script has fitted it
    assert "CONSOLE" not in done.stderr
