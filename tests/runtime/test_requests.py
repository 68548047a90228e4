"""What people ask of a mission through its robots."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import pytest

from explore_bt.interfaces import Request
from explore_bt.runtime import StopFlag
from explore_bt.runtime.requests import Requests


class Asked:
    """Robots through which somebody asks, once at each look."""

    def __init__(self, tmp_path: Path, **asked: list[list[Request]]) -> None:
        self.held: list[str] = []
        self.paused: dict[str, str] = {}
        self.stop = StopFlag()
        robots = [self._robot(name, looks) for name, looks in asked.items()]
        self.requests = Requests(robots, self.stop, tmp_path)  # type: ignore[arg-type]  # only drivers are asked

    def _robot(self, name: str, looks: list[list[Request]]) -> SimpleNamespace:
        driver = SimpleNamespace(asked=lambda: looks.pop(0) if looks else [])
        return SimpleNamespace(name=name, driver=driver, tell=lambda *_: None)

    def heed(self) -> None:
        self.requests.heed(self.held.append, self.paused)


def test_the_mission_of_one_robot_stands_until_somebody_lets_it_go_on(tmp_path: Path) -> None:
    asked = Asked(tmp_path, robot=[[Request.PAUSE], [], [Request.GO_ON]])
    asked.heed()
    assert asked.held == ["paused by a request to robot robot"] * 2
    assert asked.paused == {}


def test_of_several_robots_the_one_that_is_asked_stands_and_the_others_go_on(tmp_path: Path) -> None:
    asked = Asked(tmp_path, ada=[[Request.PAUSE], [], [Request.GO_ON]], bob=[])
    for expected in (["ada"], ["ada"], []):
        asked.heed()
        assert list(asked.paused) == expected
    assert asked.held == []


@pytest.mark.parametrize("robots", [("ada",), ("ada", "bob")])
def test_a_stop_is_heard_from_any_robot_and_ends_a_pause(tmp_path: Path, robots: tuple[str, ...]) -> None:
    looks: dict[str, list[list[Request]]] = {name: [] for name in robots}
    looks[robots[-1]] = [[Request.PAUSE], [Request.STOP]]
    asked = Asked(tmp_path, **looks)
    asked.heed()
    asked.heed()
    assert asked.stop.reason == f"stopped by a request to robot {robots[-1]}"
