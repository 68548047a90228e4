"""Small plugins and leaves, a host of them, and a mission that uses them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
from pydantic import Field

from explore_bt.clock import ManualClock
from explore_bt.interfaces import Controller, Driver, Planner, PluginOptions, Slam
from explore_bt.mission import Mission, load_mission
from explore_bt.plugin import Registry
from explore_bt.tree import REQUIRED, Input, Key, Leaf, Output, Status
from explore_bt.types import Waypoint
from explore_bt.units import Angle, FilePath, Length

GOOD = """\
format: explore-bt/1
name: flat
doc: A small flat.
params:
  world:  {type: file, default: worlds/flat.yaml, doc: what the simulator shows}
  start:  {type: pose, default: [1.0 m, 2.0 m, 90 deg]}
  slam:   {type: plugin, kind: slam, default: icp}
  stride: {type: length, default: 1.5 m, min: 0.3 m, max: 5 m}
robots:
  robot:
    start: $params.start
    driver: {use: sim, world: $params.world}
    slam: {use: $params.slam}
    planner: {use: lines}
    controller: pursuit
tick: {tree: 10 Hz, control: 20 Hz}
limits: {speed: 0.5 m/s, time: 30 min}
tree: explore
trees:
  explore:
    sequence:
      - name: until nothing is left
        fallback:
          - look: {half_planes: all, stride: $params.stride, goal: $goal}
          - timeout: 60 s
            retry: 2
            drive: {goal: $goal}
            on_failure: {reset: {}}
      - subtree: go_home
  go_home:
    sequence: [home, {drive: {goal: $goal}}]
"""


class Look(Leaf):
    """Looks for a waypoint."""

    type_key = "look"
    half_planes: Input[int | str] = Input(
        Literal["all"] | Annotated[int, Field(ge=1)], default="all", doc="how many"
    )
    stride: Input[float] = Input(Length, default=1.5, ge=0.1, le=10.0, doc="distance to the next waypoint")
    turn: Input[float] = Input(Angle, default=0.0, doc="extra turn")
    eager: Input[bool] = Input(bool, default=False, doc="take the first")
    label: Input[str] = Input(str, default="", doc="shown")
    visited: Input[tuple[Waypoint, ...]] = Input(tuple, default=Key("visited"), doc="where it was")
    goal: Output[Waypoint] = Output(Waypoint, default=Key("goal"), doc="where to")
    visited_too: Output[tuple[Waypoint, ...]] = Output(tuple, default=Key("visited"), doc="the same")

    def update(self) -> Status:
        return Status.FAILURE


class Drive(Leaf):
    """Drives."""

    type_key = "drive"
    goal: Input[Waypoint] = Input(Waypoint, default=REQUIRED, doc="where to")
    failure: Output[str] = Output(str, default=Key("failure"), doc="why not")

    def update(self) -> Status:
        return Status.SUCCESS


class Home(Leaf):
    """Chooses home."""

    type_key = "home"
    goal: Output[Waypoint] = Output(Waypoint, default=Key("goal"), doc="home")

    def update(self) -> Status:
        return Status.SUCCESS


class Reset(Leaf):
    """Forgets the half-planes."""

    type_key = "reset"

    def update(self) -> Status:
        return Status.SUCCESS


class SimOptions(PluginOptions):
    world: FilePath = Field(description="the world file")
    radius: Length = Field(0.25, ge=0.05, le=5.0, description="of the footprint")
    beams: int = Field(360, ge=8, description="of the lidar")
    noise: Literal["none", "default", "high"] = Field("default", description="how noisy")
    offset: tuple[float, float] = Field((0.0, 0.0), description="of the lidar")
    slip: bool = Field(False, description="whether wheels slip")


def _plugin(base: type, key: str, model: type[PluginOptions] = PluginOptions) -> type:
    """A concrete class of one kind; its methods do nothing, for nothing here runs them."""
    methods: dict[str, Any] = dict.fromkeys(base.__abstractmethods__, lambda self, *_: None)
    return type(key, (base,), {**methods, "name": key, "api_version": 1, "Options": model, "__doc__": key})


@pytest.fixture(scope="session")
def catalog() -> Registry:
    registry = Registry()
    for leaf in (Look, Drive, Home, Reset):
        registry.add(leaf, origin="test")
    registry.add(_plugin(Driver, "sim", SimOptions), origin="test")
    registry.add(_plugin(Slam, "icp"), origin="test")
    registry.add(_plugin(Slam, "truth"), origin="test")
    registry.add(_plugin(Planner, "lines"), origin="test")
    registry.add(_plugin(Controller, "pursuit"), origin="test")
    return registry


Load = Callable[..., Mission]


@pytest.fixture
def load(catalog: Registry, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Load:
    """Writes a mission (and other files) into an empty current directory and loads it."""
    monkeypatch.chdir(tmp_path)

    def write_and_load(text: str = GOOD, overrides: Sequence[str] = (), **files: str) -> Mission:
        Path("m.yaml").write_text(text)
        for name, content in files.items():
            Path(f"{name}.yaml").write_text(content)
        return load_mission(Path("m.yaml"), catalog, overrides, environ={"WORLD": "w.yaml", "COUNT": "72"})

    return write_and_load


@pytest.fixture(scope="session")
def good() -> str:
    return GOOD


class FakeRobot:
    """A robot of which only the time matters."""

    name = "robot"

    def __init__(self) -> None:
        self.clock = ManualClock()

    def now_s(self) -> float:
        return self.clock.now_s()


@pytest.fixture
def robot() -> FakeRobot:
    return FakeRobot()


@pytest.fixture
def furnish() -> Callable[[Path], None]:
    """Puts the world file that ``good`` names into a mission's folder."""

    def furnish(folder: Path) -> None:
        (folder / "worlds").mkdir(parents=True)
        (folder / "worlds/flat.yaml").touch()

    return furnish


@pytest.fixture(autouse=True)
def furnished(furnish: Callable[[Path], None], tmp_path: Path) -> None:
    """Most missions of these tests lie in ``tmp_path`` itself."""
    furnish(tmp_path)
