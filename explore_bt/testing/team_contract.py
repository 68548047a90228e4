"""Contract suite of team plugins: every robot comes to know everybody's newest word."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import pytest

from explore_bt.errors import PluginError
from explore_bt.interfaces import API_VERSION, Commons, Letter, RobotContext, Team

__all__ = ["TeamContract"]

_DEADLINE_S = 10.0
_TIES = 64


class TeamContract(ABC):
    """Subclass it as ``Test...`` and say how to make your plugin.

    Attributes:
        settle_s: how long to wait for what must not come; 0 where nothing is under way.
    """

    settle_s = 0.0

    @abstractmethod
    def make(self) -> Team:
        """A new plugin; all that one test asks for are one fleet, strangers to any other's."""

    def test_it_is_registered_under_a_name(self) -> None:
        """Kind, name and version as the host asks for them."""
        team = self.make()
        assert (team.kind, team.api_version) == ("team", API_VERSION)
        assert team.name

    def test_what_one_says_all_others_hear_and_the_speaker_does_not(self) -> None:
        """Bytes come unchanged, with sender and topic."""
        with self._joined("a", "b", "c") as (a, b, c):
            a.say("tile/-3/7", bytes(range(256)))
            expected = Letter("a", "tile/-3/7", bytes(range(256)))
            assert self._until(b, lambda heard: expected in heard) == [expected]
            assert self._until(c, lambda heard: expected in heard) == [expected]
            self._settle()
            assert a.hear() == [] or all(letter.sender != "a" for letter in a.hear())

    def test_the_newest_word_on_a_topic_is_heard_last(self) -> None:
        """In between some may be left out, none may come late."""
        with self._joined("a", "b") as (a, b):
            for number in range(50):
                a.say("presence", b"%d" % number)
            heard = self._until(b, lambda heard: bool(heard) and heard[-1].payload == b"49")
            numbers = [int(letter.payload) for letter in heard]
            assert numbers == sorted(numbers)

    def test_who_comes_late_hears_the_newest_of_every_topic(self) -> None:
        """What was said before, once each, without being asked for."""
        with self._joined("a", "b") as (a, _):
            for topic in range(_TIES):
                a.say(f"tile/{topic}", b"old")
                a.say(f"tile/{topic}", b"new%d" % topic)
            with self._joined("late", commons=self._commons) as (late,):
                wanted = {f"tile/{topic}": b"new%d" % topic for topic in range(_TIES)}
                heard = self._until(
                    late, lambda heard: {letter.topic: letter.payload for letter in heard} == wanted
                )
                assert len(heard) >= _TIES

    def test_nothing_is_heard_twice(self) -> None:
        """A second ``hear`` has nothing left."""
        with self._joined("a", "b") as (a, b):
            a.say("presence", b"here")
            assert self._until(b, bool) == [Letter("a", "presence", b"here")]
            self._settle()
            assert b.hear() == []

    def test_names_are_unique(self) -> None:
        """A second robot of the same name is refused, with the name."""
        with self._joined("a"):
            twin = self.make()
            with pytest.raises(PluginError, match="robot a"):
                twin.setup(RobotContext(robot="a", commons=self._commons))
            twin.close()

    def test_close_is_idempotent_and_nobody_minds_who_speaks_after_it(self) -> None:
        """A robot that is gone says nothing; one that comes back is heard."""
        with self._joined("a", "b") as (a, b):
            a.close()
            a.close()
            a.say("presence", b"ghost")
            self._settle()
            assert all(letter.payload != b"ghost" for letter in b.hear())
            with self._joined("a", commons=self._commons) as (again,):
                again.say("presence", b"back")
                assert self._until(b, lambda heard: any(letter.payload == b"back" for letter in heard))

    def test_there_is_a_budget(self) -> None:
        """Above zero, in bytes per second."""
        with self._joined("a") as (a,):
            assert a.budget_bytes_per_s > 0.0

    # --- inside ---------------------------------------------------------------------------------------

    @contextmanager
    def _joined(self, *names: str, commons: Commons | None = None) -> Iterator[tuple[Team, ...]]:
        self._commons = commons or Commons()
        teams = tuple(self.make() for _ in names)
        try:
            for name, team in zip(names, teams, strict=True):
                team.setup(RobotContext(robot=name, commons=self._commons))
            yield teams
        finally:
            for team in teams:
                team.close()

    def _until(self, team: Team, holds: Callable[[list[Letter]], bool]) -> list[Letter]:
        """All that is heard until something holds of it; fails after a deadline."""
        heard: list[Letter] = []
        deadline_s = time.monotonic() + _DEADLINE_S
        while True:
            fresh: Sequence[Letter] = team.hear()
            heard += fresh
            if holds(heard):
                return heard
            assert time.monotonic() < deadline_s, f"after {_DEADLINE_S:.0f} s only {heard!r} was heard"
            time.sleep(0.01)

    def _settle(self) -> None:
        if self.settle_s:
            time.sleep(self.settle_s)
