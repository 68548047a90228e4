"""A mission in a small world, whose folder is copied in the middle: what a killed process leaves."""

from __future__ import annotations

import shutil
import textwrap
from pathlib import Path

import pytest

from .drives import CutAt, drive

WORLD = """
    format: explore-bt-world/1
    name: two rooms
    start: [1.0, 1.5, 0 deg]
    rooms:
      - {name: left, box: [0.0, 0.0, 3.0, 3.0]}
      - {name: right, box: [3.0, 0.0, 6.0, 3.0]}
    doors:
      - {name: door, at: [3.0, 1.5], width: 1.2}
"""

MISSION = """
    format: explore-bt/1
    name: rooms
    params:
      pause: {type: duration, default: 0.5 s}
    robots:
      robot:
        driver: {use: sim2d, world: world.yaml, battery_life: 10 min}
        slam: {use: kiss_gtsam}
        planner: {use: skeleton}
        controller: {use: pursuit}
    limits: {time: 3 min, battery: 0.1}
    include: [trees.yaml]
    tree: main
"""

TREES = """
    format: explore-bt/1
    trees:
      main:
        sequence:
          - wait: {duration: $params.pause}
          - record_waypoint: {place: here}
          - force_success:
              repeat:
                times: forever
                child:
                  sequence:
                    - find_view
                    - drive_to
                    - record_waypoint
          - choose_home
          - drive_to
"""


@pytest.fixture(scope="session")
def mission(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("mission")
    for name, text in (("world.yaml", WORLD), ("rooms.yaml", MISSION), ("trees.yaml", TREES)):
        (folder / name).write_text(textwrap.dedent(text))
    return folder / "rooms.yaml"


@pytest.fixture(scope="session")
def runs(mission: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """``whole``: a run to its end; ``cut``: what a kill at 13.3 s leaves of it. Do not change them."""
    folder = tmp_path_factory.mktemp("runs")
    drive(mission, folder / "whole", cut=CutAt(132, folder / "cut"))
    return folder


@pytest.fixture
def cut(runs: Path, tmp_path: Path) -> Path:
    """A cut run of one's own."""
    return Path(shutil.copytree(runs / "cut", tmp_path / "cut"))
