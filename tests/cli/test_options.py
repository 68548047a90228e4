from __future__ import annotations

from pathlib import Path
from typing import Literal

from pydantic import Field

from explore_bt.cli.options import Option, options_of
from explore_bt.interfaces import API_VERSION, PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.tree import Input, Key, Leaf, Output, Status
from explore_bt.types import Result, Waypoint
from explore_bt.units import AngularRate, FilePath, Length, PoseTriple


class Odd(Sink):
    name = "odd"
    api_version = API_VERSION

    class Options(PluginOptions):
        clearance: Length = Field(0.3, description="how near it may come")
        turn: AngularRate = 1.5707963267948966
        far: Length | None = None
        start: PoseTriple | None = None
        world: FilePath
        mode: Literal["fast", "exact"] = "fast"
        beams: int = 360
        gain: float = 1e-3
        noise: bool = True

    def open(self, run: RunInfo) -> None: ...

    def on_tick(self, tick: TickSnapshot) -> None: ...

    def close(self, result: Result | None) -> None: ...


class Look(Leaf):
    type_key = "look"
    stride: Input[float] = Input(Length, default=1.5, doc="how far")
    visited: Input[tuple[Waypoint, ...]] = Input(tuple, default=Key("visited"), doc="where it was")
    whom: Input[str] = Input(str, doc="whom to tell")
    goal: Output[Waypoint] = Output(Waypoint, default=Key("goal"), doc="where to go")

    def update(self) -> Status:
        return Status.SUCCESS


def test_options_have_types_units_defaults_and_descriptions():
    assert options_of(Odd) == [
        Option("clearance", "length", "0.3 m", "how near it may come"),
        Option("turn", "angular rate", "90 deg/s", ""),
        Option("far", "length or none", "none", ""),
        Option("start", "pose [x, y, heading] or none", "none", ""),
        Option("world", "file", "required", ""),
        Option("mode", "fast | exact", "fast", ""),
        Option("beams", "int", "360", ""),
        Option("gain", "float", "0.001", ""),
        Option("noise", "bool", "true", ""),
    ]
    assert Odd.Options.model_fields["world"].annotation is Path


def test_a_leafs_options_are_its_ports():
    assert options_of(Look) == [
        Option("stride", "length", "1.5 m", "how far"),
        Option("visited", "tuple", "$visited", "where it was"),
        Option("whom", "str", "required", "whom to tell"),
        Option("goal", "writes Waypoint", "$goal", "where to go"),
    ]
