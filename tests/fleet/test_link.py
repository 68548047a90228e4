"""A robot's end of the team, over a board in this process."""

from dataclasses import replace

import numpy as np
import pytest

from explore_bt.fleet import Alone, Presence, TeamLink, TeamMap
from explore_bt.interfaces import (
    API_VERSION,
    Commons,
    GraphShare,
    Letter,
    PluginOptions,
    Resumption,
    RobotContext,
    Slam,
    Team,
)
from explore_bt.plugin import load_plugins
from explore_bt.types import FREE, OCCUPIED, UNKNOWN, Doing, GridWindow, OccupancyGrid, Pose2, Twist2

NOWHERE = np.empty((0, 2))


class Board(Team):
    """A list of all that was said; one fleet for each test."""

    name = "board"
    api_version = API_VERSION
    budget_bytes_per_s = 20_000.0

    def __init__(
        self, said: list[Letter], budget_bytes_per_s: float = 20_000.0, *, shares_clock: bool = True
    ) -> None:
        super().__init__(PluginOptions())
        self.shares_clock = shares_clock  # type: ignore[misc]  # of the class in the contract
        self.said, self.robot, self.read = said, "", 0
        self.budget_bytes_per_s = budget_bytes_per_s  # type: ignore[misc]  # a property in the contract

    def setup(self, context: RobotContext) -> None:
        self.robot = context.robot

    def say(self, topic: str, payload: bytes) -> None:
        self.said.append(Letter(self.robot, topic, payload))

    def hear(self) -> list[Letter]:
        fresh, self.read = self.said[self.read :], len(self.said)
        return [letter for letter in fresh if letter.sender != self.robot]

    def close(self) -> None: ...


class Drawn:
    """A SLAM of which only the map is asked for."""

    def __init__(self, cells: int = 200) -> None:
        rng = np.random.default_rng(3)
        self.cells = rng.choice([UNKNOWN, FREE, OCCUPIED], (cells, cells)).astype(np.int8)
        self.map = OccupancyGrid(self.cells, 0.05, (0.0, 0.0), 1)

    def grid(self) -> OccupancyGrid:
        return self.map

    def changed_since(self, revision: int) -> GridWindow | None:
        return None

    def graph_share(self) -> GraphShare:
        return GraphShare()


class Member:
    """A link with all that it says and hears."""

    def __init__(
        self,
        name: str,
        said: list[Letter],
        slam: Drawn | None = None,
        budget: float = 20_000.0,
        *,
        shares_clock: bool = True,
        resumed: Resumption | None = None,
    ) -> None:
        self.slam, self.told = slam or Drawn(2), []
        self.map = TeamMap(self.slam)
        slam_as_plugin: Slam = self.slam  # type: ignore[assignment]  # only its map is asked for
        team = Board(said, budget, shares_clock=shares_clock)
        self.link = TeamLink(
            name, team, Alone().allocator, slam_as_plugin, lambda *event: self.told.append(event)
        )
        self.link.setup(RobotContext(robot=name, commons=Commons(), resumed=resumed), self.map)

    def speak(self, now_s: float, xy: tuple[float, float] = (0.0, 0.0)) -> None:
        pose = Pose2(*xy, 0.0)
        told = Presence(now_s, now_s + 0.05, pose, Twist2(), 0.25, 0.5, np.array([xy]), NOWHERE)
        self.link.send(now_s, lambda: told, self.slam.grid())


@pytest.fixture
def said() -> list[Letter]:
    return []


def test_what_a_robot_is_about_comes_to_the_others(said: list[Letter]) -> None:
    ada, bob = Member("ada", said), Member("bob", said)
    ada.link.claim([(1.0, 2.0)])
    ada.link.say_doing(Doing.IDLE)
    ada.link.insist(9.0)
    ada.link.receive(1.0)
    ada.speak(1.0, (3.0, 4.0))
    bob.link.receive(1.05)
    (mate,) = bob.link.mates
    assert (mate.name, mate.T_map_base.xy, mate.claims, mate.doing) == (
        "ada",
        (3.0, 4.0),
        ((1.0, 2.0),),
        Doing.IDLE,
    )
    assert mate.yields < bob.link.yields
    assert ada.link.mates == ()


def test_who_is_silent_is_first_not_driven_by_and_then_gone_with_its_claims(said: list[Letter]) -> None:
    ada, bob = Member("ada", said), Member("bob", said)
    ada.speak(1.0)
    bob.link.receive(1.1)
    assert bob.link.near
    bob.link.receive(3.1)
    assert not bob.link.near
    assert bob.link.mates, "its claims stand for a while"
    bob.link.receive(6.1)
    assert not bob.link.mates
    assert [message for _, _, message in bob.told if "merged" not in message] == [
        "robot ada is there",
        "robot ada is silent: what it had claimed is free",
    ]
    ada.speak(7.0)
    bob.link.receive(7.1)
    assert bob.link.near, "it has come back"


def test_a_word_that_comes_late_does_not_undo_a_newer_one(said: list[Letter]) -> None:
    ada, bob = Member("ada", said), Member("bob", said)
    ada.speak(1.0, (1.0, 0.0))
    ada.speak(2.0, (2.0, 0.0))
    said.reverse()
    bob.link.receive(2.1)
    assert bob.link.mates[0].T_map_base.x == 2.0


def test_the_map_comes_over_within_the_budget(said: list[Letter]) -> None:
    """A map of noise, which no compression helps: it takes a while, and no more than was allowed."""
    budget = 4000.0
    ada, bob = Member("ada", said, Drawn(), budget), Member("bob", said)
    for step in range(400):
        now_s = 0.05 * step
        ada.speak(now_s)
        size = sum(len(letter.payload) for letter in said)
        assert size <= budget * (now_s + 2.0) + 2000
    bob.link.receive(20.0)
    ada.link.sum_up()
    level, source, message = ada.told[-1]
    assert (level, source) == ("info", "team")
    assert message.startswith("told presence ")
    grid, own = bob.map.grid(), ada.slam.grid()
    for row, col in np.argwhere(own.cells != UNKNOWN)[::97]:
        assert grid.value_at(*own.center_of(int(row), int(col))) == own.cells[row, col]


def test_another_version_is_told_of_once_and_the_rest_goes_on(said: list[Letter]) -> None:
    bob = Member("bob", said)
    said += [Letter("old", "presence", bytes([99, 1])), Letter("old", "presence", bytes([99, 1]))]
    bob.link.receive(1.0)
    assert [event[0] for event in bob.told] == ["warning"]
    assert "robot old is not understood: a message of version 99" in bob.told[0][2]


def test_the_usual_team_and_allocator_are_installed() -> None:
    registry = load_plugins().registry
    assert {"local"} <= set(registry.names("team"))
    assert {"auction", "greedy", "independent"} <= set(registry.names("allocator"))


def test_without_a_common_clock_a_word_counts_as_old_as_the_way_there_and_back(said: list[Letter]) -> None:
    """Bob's clock is 100 s ahead; each hears the other 0.2 s and 0.1 s late."""
    ada, bob = (Member(name, said, shares_clock=False) for name in ("ada", "bob"))
    for step in range(60):
        now_s = 0.1 * step
        ada.speak(now_s)
        bob.link.receive(now_s + 100.2)
        bob.speak(now_s + 100.2)
        ada.link.receive(now_s + 0.3)
        if step == 0:
            assert bob.link.mates[0].stamp_s == pytest.approx(100.2 - 1.0), "nothing is measured yet"
    assert ada.link.mates[0].stamp_s == pytest.approx(now_s)
    assert bob.link.mates[0].stamp_s == pytest.approx(now_s + 99.9)
    assert bob.link.figures()["word_age_mean_s"] == pytest.approx(0.3)


def test_a_resumed_robot_replaces_the_tiles_it_told_before_its_clock_was_set_back(said: list[Letter]) -> None:
    """It was killed at 20 s and goes on at 16 s; in between a wall was drawn that is none."""
    ada, bob = Member("ada", said, Drawn(64)), Member("bob", said)
    ada.speak(20.0)
    goes_on = Resumption(16.0, Pose2.identity(), part=2)
    again = Member("ada", said, Drawn(64), resumed=goes_on)
    again.slam.map = replace(again.slam.map, cells=np.zeros_like(again.slam.cells))
    for step in range(100):
        again.speak(16.0 + 0.05 * step)
    bob.link.receive(21.0)
    assert (bob.map.grid().cells[:64, :64] <= FREE).all()


def test_a_resumed_robot_tells_again_what_it_had_claimed(said: list[Letter]) -> None:
    ada, again, bob = Member("ada", said), Member("ada", said), Member("bob", said)
    ada.link.claim([(1.0, 2.0)])
    ada.link.say_doing(Doing.IDLE)
    again.link.restore(ada.link.memory())
    again.speak(3.0)
    bob.link.receive(3.0)
    assert (bob.link.mates[0].claims, bob.link.mates[0].doing) == (((1.0, 2.0),), Doing.IDLE)


def test_a_paused_robot_is_seen_standing_with_nothing_claimed_and_nowhere_to_go(said: list[Letter]) -> None:
    ada, bob = Member("ada", said), Member("bob", said)
    ada.link.claim([(1.0, 2.0)])
    ada.link.is_paused = True
    ada.speak(1.0)
    bob.link.receive(1.0)
    seen = bob.link.mates[0]
    assert (seen.doing, seen.claims, seen.is_parked) == (Doing.PAUSED, (), True)
    ada.link.is_paused = False
    ada.speak(1.1)
    bob.link.receive(1.1)
    assert (bob.link.mates[0].doing, bob.link.mates[0].claims) == (Doing.AT_WORK, ((1.0, 2.0),))


def test_how_old_words_are_is_asked_only_where_there_is_a_network(said: list[Letter]) -> None:
    """On a cable that takes no time the way back takes a step, and a word is driven by until the next one."""
    for shares_clock, expected_s in ((True, 0.0), (False, 0.25)):
        said.clear()
        ada, bob = (Member(name, said, shares_clock=shares_clock) for name in ("ada", "bob"))
        assert bob.link.lag_s == 0.0, "it is alone"
        for step in range(60):
            for member in (ada, bob):
                member.speak(0.05 * step)
                member.link.receive(0.05 * step)
        assert bob.link.lag_s == pytest.approx(expected_s, abs=1e-6)
