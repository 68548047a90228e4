"""Two robots on the page: both are seen, and one is paused while the other goes on."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from explore_bt.debug import DebugSession, Quit
from explore_bt.debug.web import Controls, Desk, LiveSink, PageServer
from explore_bt.files import missions_folder
from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from tests.debug.conftest import Debugged

SHOTS = os.environ.get("EXPLORE_BT_SCREENSHOTS", "")
"""A folder: takes a screenshot for people to look at."""


@pytest.fixture
def live(tmp_path: Path) -> Iterator[tuple[Debugged, PageServer]]:
    """The flat with two robots, before the first tick."""
    registry, sink = load_plugins().registry, LiveSink()
    mission = load_mission(missions_folder() / "05_fleet.yaml", registry, ["slam=ground_truth"])
    run = Debugged(mission, registry, tmp_path / "run", DebugSession(paused=True), [sink])
    run.rest()
    with PageServer(Desk(sink.feed, Controls(run.session)), share=0.5) as server:
        yield run, server
    run.session.submit(Quit())
    run.thread.join(60.0)


def driven_m(seen: Any, robot: str) -> float:
    return float(seen.run(f"page.player.state.robots.get('{robot}').newest.state.distance_m"))


def test_one_is_paused_by_its_button_and_the_other_goes_on(live, see):
    _, server = live
    seen = see(server.url)
    seen.until("page.debug.paused && page.debug.why === 'before the first tick'")
    seen.key(" ")
    seen.until("page.player.time > 12")
    seen.page.click("#robots >> text=bob")
    seen.page.click("#hold")
    seen.until("page.debug.held.join() === 'bob'")
    stands_s, stood_m, ada_m = seen.run("page.player.time"), driven_m(seen, "bob"), driven_m(seen, "ada")
    assert seen.page.locator("#robots button.held").inner_text().startswith("bob")
    seen.until(f"page.player.time > {stands_s} + 10")
    assert driven_m(seen, "bob") < stood_m + 0.5, "it braked, and stands"
    assert driven_m(seen, "ada") > ada_m + 1.0
    assert seen.run("page.player.state.robots.get('bob').newest.team.doing") == "paused"
    assert "the debugger" in seen.page.inner_text("#figures")
    if SHOTS:
        seen.page.click("#robots >> text=ada")
        seen.settle()
        seen.page.screenshot(path=f"{SHOTS}/fleet.png")
        seen.page.click("#robots >> text=bob")
    seen.key("p")
    seen.until("page.debug.held.length === 0")
    seen.until(f"page.player.state.robots.get('bob').newest.state.distance_m > {stood_m} + 1")
    seen.page.click("#stop")
    seen.until("page.debug.over")


def test_a_robot_is_drawn_where_the_picked_one_knows_it_and_not_at_all_where_it_does_not(live, see):
    _, server = live
    seen = see(server.url)
    seen.until("page.debug.paused && page.debug.why === 'before the first tick'")
    drawn = """(mate => {
        const mates = mate ? [mate] : [], bob = { name: "bob" };
        const ada = { name: "ada", state: { newest: { team: { mates } } } };
        return import("./mate_frames.js").then(({ frameOf, moved }) => {
            const { T, merged } = frameOf(ada, bob);
            return [T && moved(T, 1, 0).map((each) => Math.round(100 * each) / 100), merged];
        });
    })"""
    place = "{x: 2, y: 3, yaw: Math.PI / 2}"
    assert seen.run(f"{drawn}(null)") == [None, False]
    assert seen.run(f"{drawn}({{name: 'bob', T_ours_theirs: null, not_merged: 'x'}})") == [None, False]
    assert seen.run(f"{drawn}({{name: 'bob', T_ours_theirs: {place}, not_merged: ''}})") == [[2, 4], True]
    assert seen.run(f"{drawn}({{name: 'bob', T_ours_theirs: {place}, not_merged: 'to be checked'}})") == [
        [2, 4],
        False,
    ]
