from __future__ import annotations

from typing import Self

import pytest
from pydantic import Field, model_validator

from explore_bt.errors import PluginError
from explore_bt.interfaces import PluginOptions
from explore_bt.mission import MissionError, load_mission
from explore_bt.plugin import Registry
from explore_bt.tree import Input, Key, Leaf, Output, Status
from explore_bt.units import Angle, Length


class Remember(Leaf):
    """Reads shared memory that starts empty."""

    type_key = "remember"
    memory: Input[tuple[int, ...]] = Input(tuple, default=Key("memory"), initial=(), doc="so far")

    def update(self) -> Status:
        return Status.SUCCESS


class Measure(Leaf):
    """Writes a length and a whole number."""

    type_key = "measure"
    gap: Output[float] = Output(Length, default=Key("gap"), doc="width")
    count: Output[int] = Output(int, default=Key("count"), doc="how many")

    def update(self) -> Status:
        return Status.SUCCESS


class Spend(Leaf):
    """Reads numbers of several kinds."""

    type_key = "spend"
    turn: Input[float] = Input(Angle, default=0.0, doc="an angle")
    way: Input[float] = Input(Length, default=0.0, doc="a length")
    share: Input[float] = Input(float, default=0.0, doc="a plain number")

    def update(self) -> Status:
        return Status.SUCCESS


class Span(PluginOptions):
    """Options that only make sense together."""

    low: Length = Field(1.0, description="lower end")
    high: Length = Field(2.0, description="upper end")

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.low > self.high:
            raise ValueError("low lies above high; swap them")
        return self


class Extended:
    """A catalog with a few classes more; ``stale`` is named but cannot be had."""

    def __init__(self, catalog: Registry, planner: type) -> None:
        self._catalog = catalog
        self._more = {cls.type_key: cls for cls in (Remember, Measure, Spend)}
        self._planner = planner

    def get(self, kind: str, name: str) -> type:
        if (kind, name) == ("planner", "lines"):
            return self._planner
        if name == "stale":
            raise PluginError("stale: written for another version")
        return self._more[name] if name in self._more else self._catalog.get(kind, name)

    def names(self, kind: str) -> tuple[str, ...]:
        more = (*self._more, *self._catalog.names(kind)) if kind == "behaviour" else self._catalog.names(kind)
        return (*more, "stale") if kind == "slam" else tuple(more)


@pytest.fixture
def load_tree(catalog, good, tmp_path):
    planner = catalog.get("planner", "lines")
    spanning = type("Spanning", (planner,), {"Options": Span})

    def load(node: str, planner: str = "lines", slam: str = "icp"):
        text = good[: good.index("tree: explore")].replace("{use: lines}", planner)
        path = tmp_path / "m.yaml"
        path.write_text(f"{text}tree:\n  sequence: [{node}]\n")
        return load_mission(path, Extended(catalog, spanning), [f"slam={slam}"])

    return load


def messages(error: pytest.ExceptionInfo[MissionError]) -> list[str]:
    return [f"{fault.line}:{fault.column} {fault.message}" for fault in error.value.faults]


def test_shared_memory_with_an_initial_value_needs_no_writer(load_tree) -> None:
    assert load_tree("remember").robots[0].tree.children[0].bindings == {}


def test_but_an_entry_that_the_mission_names_does(load_tree) -> None:
    with pytest.raises(MissionError) as caught:
        load_tree("remember: {memory: $memroy}")
    assert messages(caught) == ["19:33 remember reads $memroy (memory), which no leaf of the tree writes"]


def test_a_length_is_no_angle_though_both_are_numbers(load_tree) -> None:
    with pytest.raises(MissionError) as caught:
        load_tree("measure, spend: {turn: $gap}")
    assert messages(caught) == ["19:37 spend wants an angle in $gap (turn), measure writes a length"]


def test_lengths_fit_lengths_and_whole_numbers_fit_numbers(load_tree) -> None:
    load_tree("measure, spend: {way: $gap, share: $count}")
    load_tree("measure, spend: {share: $gap}")


def test_a_writer_anywhere_in_the_tree_counts(load_tree) -> None:
    load_tree("spend: {way: $gap}, {invert: {reset: {}, on_failure: measure}}")


def test_options_that_contradict_one_another_are_told_at_the_plugin(load_tree) -> None:
    with pytest.raises(MissionError) as caught:
        load_tree("remember", planner="{use: lines, low: 3 m}")
    (fault,) = caught.value.faults
    assert (fault.message, fault.hint) == ("lines: low lies above high", "swap them")


def test_a_plugin_that_the_host_refuses_is_a_fault_like_others(load_tree) -> None:
    with pytest.raises(MissionError, match="stale: written for another version"):
        load_tree("remember", slam="stale")
