"""The page in a real Chromium, against what Python reads from the same recording."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from explore_bt.debug import AddBreakpoint, Breakpoint, Look, Resume
from explore_bt.debug.web import Controls, Desk, LiveSink, PageServer, RunFeed
from explore_bt.files import missions_folder
from explore_bt.mission import load_mission
from explore_bt.recording import McapRecorder, RobotState, decode_grid, read_recording, state_at
from explore_bt.runtime import StopFlag, run_mission
from tests.debug.web.seen import DESK, Seen

PHONE = {"width": 390, "height": 844}
SHOTS = os.environ.get("EXPLORE_BT_SCREENSHOTS", "")
"""A folder: the screenshot in the documentation is made anew into it."""


def plain(value: object) -> object:
    return json.loads(json.dumps(value), parse_constant=lambda _: "inf")


def assert_holds(seen: Seen, robot: str, state: RobotState) -> None:
    """The page holds that state, and its tree shows it."""
    held = seen.held(robot)
    nodes = [{"id": i, "status": n.status, "message": n.message} for i, n in sorted(state.nodes.items())]
    assert held["nodes"] == nodes
    assert held["board"] == plain(state.blackboard)
    assert held["visited"] == plain(state.visited)
    newest = {name: plain(message.value) for name, message in state.newest.items()}
    assert held["newest"].keys() == newest.keys()
    for name, value in newest.items():
        assert held["newest"][name] == value, name
    shown = [(status, words) for _, status, words in seen.rows()]
    assert shown == [(node["status"], node["message"]) for node in nodes]


def assert_drawn(seen: Seen, state: RobotState) -> None:
    """The map on the screen has free floor, walls and unknown where the recorded map has them."""
    seen.run("page.map.layers.clear(), page.map.draw()")
    grid = decode_grid(state.newest["map"].value)
    shades = {name: seen.shade(name) for name in ("free", "wall", "unknown")}
    pose = state.newest["pose"].value["pose"]["position"]
    expected = []
    for row in range(2, grid.shape[0] - 2, 9):
        for col in range(2, grid.shape[1] - 2, 9):
            around = grid.cells[row - 1 : row + 2, col - 1 : col + 2]
            x = grid.origin_xy[0] + (col + 0.5) * grid.resolution_m
            y = grid.origin_xy[1] + (row + 0.5) * grid.resolution_m
            if (around == around[1, 1]).all() and math.hypot(x - pose["x"], y - pose["y"]) > 0.6:
                name = {-1: "unknown", 0: "free"}.get(int(around[1, 1]), "wall")
                expected.append((x, y, shades[name]))
    assert len(expected) > 40
    assert seen.pixels([(x, y) for x, y, _ in expected]) == [shade for *_, shade in expected]
    assert seen.pixels([(pose["x"], pose["y"])]) != [shades["free"]]  # the robot stands there
    seen.run("['scan', 'driven', 'path', 'waypoints'].forEach((each) => page.map.layers.add(each))")
    seen.run("page.map.draw()")


@pytest.fixture
def shown(feed) -> Iterator[PageServer]:
    with PageServer(Desk(feed)) as server:
        yield server


def test_a_recording_is_shown_as_it_was_at_every_moment_sought(shown, see, feed):
    seen = see(shown.url)
    assert seen.run("page.live") is False
    assert seen.run("document.title") == "01_apartment – explore-bt"
    for time_s in (75.0, 15.0, 60.3):
        seen.seek(time_s)
        state = state_at(feed.log, "anna", round(time_s * 1e9))
        assert_holds(seen, "anna", state)
        assert_drawn(seen, state)
    seen.page.click("text=bert <b>")
    seen.settle()
    assert_holds(seen, "bert <b>", state_at(feed.log, "bert <b>", 60_300_000_000))


def test_played_to_a_moment_it_shows_what_is_shown_when_that_moment_is_sought(shown, see, feed):
    seen = see(shown.url)
    seen.seek(20.0)
    seen.key("3", " ")
    seen.until("page.player.time > 40")
    seen.key(" ")
    seen.until("!page.player.playing")
    seen.settle()
    time_s = seen.run("page.player.time")
    assert_holds(seen, "anna", state_at(feed.log, "anna", math.floor(time_s * 1e9)))
    seen.run("page.player.rate = 16, page.player.play(true)")
    seen.until("!page.player.playing")
    assert seen.run("page.player.time") == pytest.approx(feed.end_ns / 1e9)


def test_time_is_moved_by_keys_by_mouse_and_by_what_was_said(shown, see, feed):
    seen = see(f"{shown.url}#t=30")
    assert seen.run("page.player.time") == pytest.approx(30.0)
    for key, time_s in (("ArrowRight", 31.0), ("Shift+ArrowRight", 41.0), ("ArrowLeft", 40.0), ("Home", 0.0)):
        seen.key(key)
        seen.until(f"Math.abs(page.player.time - {time_s}) < 1e-6")
    seen.key("c")
    seen.until("page.player.time > 0")
    first = seen.run("page.player.time")
    changes = [json.loads(item)[2] for item in feed.timeline.items if item.startswith('["node","anna"')]
    assert first in changes
    seen.key("n")
    seen.until(f"page.player.time > {first}")
    assert seen.run("page.player.time") == pytest.approx(first + 0.1, abs=1e-6)
    seen.key("b")
    seen.until(f"page.player.time < {first} + 0.05")
    box = seen.page.locator("#timeline").bounding_box()
    seen.page.mouse.click(box["x"] + box["width"] * 0.75, box["y"] + 60)
    seen.until("page.player.time > 40")
    seen.key("End")
    seen.until("page.player.time === page.player.end")
    seen.page.click("#tabs >> text=Reasons")
    seen.page.click("text=loop closed: 41 keyframes")
    seen.until("page.player.time < page.player.end")
    assert seen.run("page.player.time") == pytest.approx(61.2, abs=0.01)


def test_a_node_tells_its_reason_its_ports_and_its_line(see, recording_of_the_box):
    with PageServer(Desk(RunFeed.of(recording_of_the_box))) as server:
        seen = see(f"{server.url}#t=2")
        seen.page.fill("#search", "drive")
        assert seen.run("document.querySelectorAll('#tree .row:not([hidden])').length") == 2
        seen.page.click(".row.leaf:not([hidden])")
        seen.settle()
        told = seen.page.inner_text("#node")
        assert "$goal" in told
        assert "mission.yaml:" in told
        assert seen.page.inner_text(".yaml .marked").endswith("- drive_to")
        assert "(3.5, 1.5" in told


def test_the_bar_says_what_holds_the_robot_and_how_full_its_battery_is(shown, see, drive):
    held = next(tick for tick in drive.ticks if tick.robots[0].gate_reason)
    seen = see(shown.url)
    for time_s, held_by in ((held.stamp_s - 5.0, ""), (held.stamp_s + 0.2, "an obstacle")):
        seen.seek(time_s)
        told = seen.run(
            "Object.fromEntries([...document.querySelectorAll('#figures div')]"
            ".map((each) => [...each.children].map((part) => part.textContent)))"
        )
        assert told.get("held by", "") == held_by
        assert float(told["battery"].removesuffix(" %")) == pytest.approx(100 - time_s / 36, abs=0.1)


def test_folding_hides_what_does_not_run_and_searching_finds_it(shown, see):
    seen = see(f"{shown.url}#t=30")
    count = "document.querySelectorAll('#tree .row:not([hidden])').length"
    everything = seen.run(count)
    seen.key("f")
    assert 0 < seen.run(count) < everything
    seen.key("u")
    assert seen.run(count) == everything
    seen.page.click(".row .twist >> nth=0")
    assert seen.run(count) == 1


def test_the_keys_are_listed_and_the_list_closes_again(shown, see):
    seen = see(shown.url)
    seen.key("?")
    assert "status" in seen.page.inner_text("dialog")
    seen.key("Escape")
    assert seen.run("document.getElementById('help').open") is False


TO_AND_FRO = """
trees:
  main:
    repeat:
      times: 9
      child:
        sequence:
          - choose_place: {x: 3.5 m, y: 1.5 m}
          - drive_to: {}
            name: out
          - wait: {duration: $params.first}
            name: rest
          - choose_place: {x: 1.0 m, y: 1.0 m}
          - drive_to: {}
            name: back
"""


@pytest.fixture
def recording_of_the_box(debug):
    run = debug()
    run.finish()
    return read_recording(run.out / "recording.mcap")


@pytest.fixture
def live(debug) -> Iterator[tuple[Any, LiveSink, PageServer]]:
    """A robot that drives to and fro in the box, paused before its first tick, and its page."""
    sink = LiveSink()
    run = debug("budget=20 min", tree=TO_AND_FRO, sinks=[sink])
    with PageServer(Desk(sink.feed, Controls(run.session)), share=0.5) as server:
        yield run, sink, server


def test_a_mission_is_paused_stepped_broken_and_looked_back_at(live, see):
    run, sink, server = live
    seen = see(server.url)
    seen.until("page.debug.paused && page.debug.why === 'before the first tick'")
    for _ in range(3):
        before = seen.run("page.debug.tick")
        seen.key("n")
        seen.until(
            f"page.debug.paused && page.debug.tick === {before + 1} && page.player.time === page.player.end"
        )
        assert run.session.state().tick == before + 1
    seen.key("N")
    seen.until("page.debug.path !== '' && document.querySelector(\".row[data-paused='after']\")")

    seen.page.click("#tabs >> text=Breakpoints")
    seen.page.fill("[aria-label='Node']", "rest")
    seen.page.select_option("[aria-label='Status']", "success")
    seen.page.fill("[aria-label='Condition']", "time > 62")
    seen.page.click(".adder button")
    seen.until("page.debug.breakpoints.length === 1")
    seen.page.click("#map")
    seen.key(" ")
    seen.until("page.debug.paused && page.debug.path.endsWith('rest')")
    seen.until("document.querySelector('.item .count').textContent.startsWith('1 hit')")
    assert run.session.state().breakpoints[0].hits == 1
    assert run.session.state().stamp_s > 62.0

    seen.until("page.player.time === page.player.end")
    now_s = seen.run("page.player.time")
    seen.seek(now_s - 60)
    assert seen.page.inner_text("#why") == "looking back"
    past = state_at(sink.feed.log, "robot", round((now_s - 60) * 1e9))
    assert_holds(seen, "robot", past)
    assert_drawn(seen, past)
    seen.key("End")
    seen.until(f"page.player.following && page.player.time === {now_s}")
    seen.until("document.querySelector(\".row[data-paused='after']\")")
    assert seen.rows() == [(i.name, n.status, n.message) for i, n in looked_at(run)]

    seen.page.click("#tabs >> text=Breakpoints")
    seen.page.click("#breakpoints .remove")
    seen.until("page.debug.breakpoints.length === 0")
    run.finish()
    seen.until("page.debug.over && !page.player.live")
    file = read_recording(run.out / "recording.mcap")
    seen.seek(now_s - 60)
    assert_holds(seen, "robot", state_at(file.log(file.topics), "robot", round((now_s - 60) * 1e9)))
    seen.seek(file.duration_s)
    assert seen.page.inner_text("#why").startswith("over: explored")


def looked_at(run):
    view = run.do(Look("robot"))
    return zip(run.history.run.trees["robot"], view.nodes, strict=True)


def test_what_is_forced_and_what_is_changed_is_done(live, see):
    run, _, server = live
    seen = see(server.url)
    seen.until("page.debug.paused")
    seen.page.click(".row:has-text('rest')")
    seen.page.click("text=Force failure")
    seen.until("page.debug.forced.length === 1")
    (forced,) = run.session.state().forced
    assert (forced.path.endswith("rest"), forced.status) == (True, "failure")
    assert seen.page.locator(".row[data-forced='failure']").count() == 1
    seen.page.click("#node >> text=Release")
    seen.until("page.debug.forced.length === 0")
    seen.page.click("#tabs >> text=Parameters")
    seen.page.fill("[aria-label='first']", "0.2 s")
    seen.page.press("[aria-label='first']", "Enter")
    seen.until("page.debug.params.find((each) => each.name === 'first').value === '0.2 s'")
    seen.page.fill("[aria-label='first']", "3 m")
    seen.page.press("[aria-label='first']", "Enter")
    seen.page.wait_for_selector("#notice:has-text('is not a duration')")
    seen.page.click(".row:has-text('rest') .margin")
    seen.until("page.debug.breakpoints.length === 1")
    assert seen.page.locator(".row[data-breaks='on']").count() == 1
    seen.page.click("#stop")
    seen.until("page.debug.over")
    assert run.result.result().outcome == "stopped"


def test_a_page_that_comes_late_or_loses_the_server_shows_what_there_is(live, see, feed):
    run, _, server = live
    run.do(AddBreakpoint(Breakpoint("rest", status="success")))
    run.go(Resume())
    seen = see(server.url)
    seen.until("page.player.time === page.player.end && page.player.time > 3")
    assert len(seen.rows()) == len(run.history.run.trees["robot"])
    server.__exit__(None, None, None)
    seen.page.wait_for_selector("#notice:has-text('connection is lost')")
    assert len(seen.rows()) == len(run.history.run.trees["robot"])
    seen.complaints.clear()  # the browser says that nobody answers


def test_on_another_address_the_page_opens_with_the_address_that_was_printed_and_no_other(see, feed, browser):
    with PageServer(Desk(feed), host="0.0.0.0") as server:
        url = urlsplit(server.url)
        see(f"http://127.0.0.1:{url.port}/#{url.fragment}")
        stranger = browser.new_page()
        stranger.goto(f"http://127.0.0.1:{url.port}/")
        stranger.wait_for_selector("#notice:has-text('does not admit this page')")
        assert stranger.evaluate("page.run") is None
        stranger.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_on_a_phone_every_pane_fits_the_width(shown, see, scheme):
    seen = see(f"{shown.url}#t=40", PHONE, color_scheme=scheme, has_touch=True, is_mobile=True)
    for pane, inside in (("Tree", "#tree .row"), ("Map", "#map"), ("Details", "#tabs")):
        seen.page.click(f".panes >> text={pane}")
        seen.settle()
        assert seen.page.locator(inside).first.is_visible()
        assert seen.run("document.documentElement.scrollWidth") <= PHONE["width"]
        assert seen.run(
            "[...document.querySelectorAll('header, .panes, main, footer, header button, footer button')]"
            ".filter((each) => each.offsetParent).every((each) => { const box = each.getBoundingClientRect();"
            " return box.left >= 0 && box.right <= innerWidth + 0.5 && box.bottom <= innerHeight + 0.5; })"
        )
    seen.page.click(".panes >> text=Map")
    seen.settle()
    assert seen.run("document.getElementById('map').clientHeight") > 300
    box = seen.page.locator("#timeline").bounding_box()
    seen.page.touchscreen.tap(box["x"] + box["width"] / 2, box["y"] + 50)
    seen.until("Math.abs(page.player.time - 40) > 0.5")


def test_at_1280_by_800_everything_is_in_sight(shown, see):
    seen = see(f"{shown.url}#t=40")
    for part in ("#tree", "#map", "#timeline", "#tabs", "#figures", "#play"):
        box = seen.page.locator(part).bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= DESK["width"]
        assert box["y"] + box["height"] <= DESK["height"]
    assert seen.page.locator("#map").bounding_box()["height"] > 400


@pytest.mark.skipif(not SHOTS, reason="EXPLORE_BT_SCREENSHOTS names no folder: the picture stays as it is")
def test_the_picture_in_the_documentation_is_the_page_over_a_run_of_the_apartment(see, registry, tmp_path):
    out, mission = tmp_path / "run", load_mission(missions_folder() / "01_apartment.yaml", registry)
    sinks = [McapRecorder(McapRecorder.Options())]
    run_mission(mission, registry=registry, out=out, seed=1, sinks=sinks, stop=StopFlag())
    with PageServer(Desk(RunFeed.of(read_recording(out / "recording.mcap")))) as server:
        seen = see(f"{server.url}#t=95")
        seen.page.click(".row.active.leaf")
        seen.settle()
        picture = seen.page.screenshot(path=Path(SHOTS) / "debugger.png")
    assert len(picture) < 250_000
