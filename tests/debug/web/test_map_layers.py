"""Every layer of the page's map, over real recordings: its colour is where its marks are, and only then."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import pytest

from explore_bt.debug.web import Desk, PageServer, RunFeed
from explore_bt.files import missions_folder
from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.recording import McapRecorder, Recording, read_recording
from explore_bt.runtime import StopFlag, run_mission

WORLD = """
format: explore-bt-world/1
name: passage
start: [1.0, 1.0, 0 deg]
rooms:
  - {name: room, box: [0.0, 0.0, 5.0, 4.0]}
  - {name: chamber, box: [5.0, 0.0, 8.0, 4.0]}
doors:
  - {name: door, at: [5.0, 2.0], width: 1.0}
furniture:
  - {name: shelf, box: [2.4, 2.6, 2.9, 3.95], height: 1.8}
people:
  - {name: ann, route: [[4.2, 0.8], [4.2, 3.4]], speed: 0.6, pause: 0 s}
"""

Place = tuple[float, float]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A recording of ten seconds of a strategy, made once."""
    folder, made = tmp_path_factory.mktemp("layers"), dict[str, Recording]()
    (folder / "passage.yaml").write_text(WORLD)
    registry = load_plugins().registry

    def recorded(strategy: str) -> Recording:
        if strategy not in made:
            world = f"world={folder / 'passage.yaml'}"
            settings = [f"strategy={strategy}", world, "slam=ground_truth", "limits.time=10 s"]
            mission = load_mission(missions_folder() / "02_any_map.yaml", registry, settings)
            sinks, out = [McapRecorder(McapRecorder.Options())], folder / strategy
            run_mission(mission, registry=registry, out=out, seed=0, sinks=sinks, stop=StopFlag())
            made[strategy] = read_recording(out / "recording.mcap")
        return made[strategy]

    return recorded


def edges(sector: dict[str, Any]) -> list[Place]:
    """Along both of a sector's sides; where one is dashed, some of it is drawn."""
    return [
        (sector["x"] + far * math.cos(angle), sector["y"] + far * math.sin(angle))
        for angle in (sector["from_rad"], sector["to_rad"])
        for far in (0.4 * sector["range_m"], 0.45 * sector["range_m"], 0.5 * sector["range_m"])
    ]


def line(plane: dict[str, Any]) -> list[Place]:
    """Along a half-plane's line, to either side of the robot that stands on it."""
    x, y, nx, ny = (plane[name] for name in ("x", "y", "normal_x", "normal_y"))
    return [(x - far * ny, y + far * nx) for far in (-1.0, -0.7, 0.7, 1.0)]


def middle(mark: dict[str, Any]) -> list[Place]:
    return [(mark["x"], mark["y"])]


def rim(person: dict[str, Any]) -> list[Place]:
    radius = person["radius_m"]
    turns = [0.25 * math.pi * eighth for eighth in range(8)]
    return [(person["x"] + radius * math.cos(a), person["y"] + radius * math.sin(a)) for a in turns]


LAYERS = {
    "sectors": ("paper", "drawing", edges),
    "half-planes": ("information_gain", "drawing", line),
    "views": ("information_gain", "drawing", middle),
    "frontiers": ("nearest_frontier", "drawing", middle),
    "people": ("nearest_frontier", "moving", rim),
}
SHADES = {"half-planes": "plane", "people": "person"}


def marks_of(recording: Recording, topic: str, layer: str) -> Iterator[tuple[float, list[dict[str, Any]]]]:
    """Just after each message of a topic that has marks of a layer: when, and the marks."""
    for message in recording.messages(f"/robot/{topic}"):
        told = message.value
        marks = told["things"] if topic == "moving" else told["layers"].get(layer.replace("-", "_"), [])
        if marks:
            yield message.stamp_s + 1e-3, marks


def off(seen: Any, places: list[Place], shade: list[int]) -> list[float]:
    """How far from a colour the likest pixel within three pixels of each place is; 0 to 441."""
    around = [(dx, dy) for dx in range(-3, 4) for dy in range(-3, 4)]
    metre = seen.run("page.map.toScreen(1, 0)[0] - page.map.toScreen(0, 0)[0]")
    spots = [(x + dx / metre, y + dy / metre) for x, y in places for dx, dy in around]
    away = [math.dist(pixel, shade) for pixel in seen.pixels(spots)]
    return [min(away[i : i + len(around)]) for i in range(0, len(away), len(around))]


@pytest.mark.parametrize("layer", LAYERS)
def test_a_layer_puts_its_colour_where_its_marks_are(recorded, see, layer):
    strategy, topic, outline = LAYERS[layer]
    recording = recorded(strategy)
    told = list(marks_of(recording, topic, layer))
    assert told, f"{strategy} drew no {layer}"
    with PageServer(Desk(RunFeed.of(recording))) as server:
        seen = see(server.url)
        checked = 0
        for time_s, marks in [told[0], told[-1]]:
            seen.seek(time_s)
            robot = seen.run("page.state.newest.pose.pose.position")
            seen.run("page.map.layers.clear(), page.map.draw()")
            bare = [off(seen, outline(mark), shade_of(seen, layer, mark)) for mark in marks]
            seen.run(f"page.map.layers.add('{layer}'), page.map.draw()")
            for mark, before in zip(marks, bare, strict=True):
                after = off(seen, outline(mark), shade_of(seen, layer, mark))
                clear = [
                    (one, other)
                    for place, one, other in zip(outline(mark), before, after, strict=True)
                    if math.dist(place, (robot["x"], robot["y"])) > 0.45
                ]
                if clear:
                    assert min(other for _, other in clear) < 60, mark
                    assert min(one for one, _ in clear) > 90, mark
                    checked += 1
        assert checked


def shade_of(seen: Any, layer: str, mark: dict[str, Any]) -> list[int]:
    return seen.shade(SHADES.get(layer) or mark["state"])


def test_under_the_mouse_stands_what_was_decided_and_why(recorded, see):
    recording = recorded("nearest_frontier")
    time_s, (mark, *_) = next(marks_of(recording, "drawing", "frontiers"))
    with PageServer(Desk(RunFeed.of(recording))) as server:
        seen = see(server.url)
        seen.seek(time_s)
        x, y = seen.run(f"page.map.toScreen({mark['x']}, {mark['y']})")
        seen.page.hover("#map", position={"x": x, "y": y})
        told = seen.page.inner_text("#map-hint")
        assert f"taken frontier, {mark['size_m']:.1f} m: {mark['reason']}" in told


def test_a_recording_that_was_just_opened_shows_its_timeline(recorded, see):
    with PageServer(Desk(RunFeed.of(recorded("paper")))) as server:
        seen = see(server.url)
        seen.until("page.timeline.lanes.length > 3")
