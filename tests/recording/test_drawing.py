from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest

from explore_bt.recording import McapRecorder, read_recording
from explore_bt.recording.drawing import drawing_message
from explore_bt.runtime.sketch import Sketch
from explore_bt.types import Drawing, HalfPlaneMark, SectorMark, ViewMark


def test_a_drawing_comes_back_layer_by_layer_and_is_written_once(recorded_drive, tmp_path):
    drive = replace(recorded_drive, ticks=recorded_drive.ticks[:400]).in_folder(tmp_path)
    drive.show_to(McapRecorder(McapRecorder.Options()))
    messages = list(read_recording(tmp_path / "recording.mcap").messages("/robot/drawing"))
    drawings = dict.fromkeys(tick.robots[0].drawing for tick in drive.ticks)
    assert len(messages) == len(drawings) > 1
    for message, drawing in zip(messages, drawings, strict=True):
        layers = message.value["layers"]
        assert layers.keys() == drawing.layers().keys()
        for told, mark in zip(layers["sectors"], drawing.sectors, strict=True):
            assert (told["state"], told["reason"]) == (mark.state, mark.reason)
            assert told["from_rad"] == pytest.approx(mark.from_rad, abs=5e-4)


def test_a_layer_that_nobody_asked_about_is_missing_and_an_empty_one_is_there():
    message = json.loads(drawing_message(0, Drawing(sectors=())))
    assert message["layers"] == {"sectors": []}


def test_a_drawing_is_bounded_and_says_what_it_leaves_out():
    planes = tuple(HalfPlaneMark(float(k), 0.0, 1.0, 0.0) for k in range(100))
    message = json.loads(drawing_message(0, Drawing(half_planes=planes)))
    assert [mark["x"] for mark in message["layers"]["half_planes"]] == list(range(64))
    assert message["left_out"] == {"half_planes": 36}


def test_what_is_not_finite_is_null():
    message = json.loads(drawing_message(0, Drawing(views=(ViewMark(0.0, math.nan, 0.0, math.inf),))))
    assert message["layers"]["views"][0] == {
        "x": 0.0, "y": None, "yaw_rad": 0.0, "gain_m2": None, "state": "open", "reason": ""
    }  # fmt: skip


def test_layers_of_one_tick_lie_over_one_another_and_those_of_a_later_tick_begin_anew():
    sketch, mark, view = Sketch(), SectorMark(0.0, 0.0, 0.0, 1.0, 1.2), ViewMark(1.0, 1.0, 0.0, 2.0)
    sketch.add(Drawing(sectors=(mark,), half_planes=()))
    sketch.add(Drawing(views=(view,), sectors=()))
    assert sketch.drawing == Drawing(sectors=(), half_planes=(), views=(view,))
    sketch.begin_tick()
    assert sketch.drawing.views == (view,)
    sketch.add(Drawing(frontiers=()))
    assert sketch.drawing == Drawing(frontiers=())
