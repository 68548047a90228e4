"""Contract suite of allocators: all work is done by somebody, and the same offers give the same answer."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
import pytest

from explore_bt.interfaces import API_VERSION, Allocator, Offers

__all__ = ["AllocatorContract", "offers_of"]


def offers_of(seed: int, robots: int, places: int, asker: int = 0) -> Offers:
    """Robots and places at random in a square of 20 m, ways as the crow flies; seen by one of the robots."""
    rng = np.random.default_rng(seed)
    bodies, spots = rng.uniform(0.0, 20.0, (robots, 2)), rng.uniform(0.0, 20.0, (places, 2))
    names = [f"r{number}" for number in range(robots)]
    order = [asker, *(number for number in range(robots) if number != asker)]
    from_robots = np.hypot(*(bodies[order][:, None] - spots[None]).transpose(2, 0, 1))
    between = np.hypot(*(spots[:, None] - spots[None]).transpose(2, 0, 1))
    return Offers(
        tuple(names[number] for number in order),
        rng.uniform(0.1, 8.0, places),
        between,
        from_robots,
        np.zeros(robots),
        np.zeros(places, dtype=np.bool_),
    )


class AllocatorContract(ABC):
    """Subclass it as ``Test...`` and say how to make your plugin."""

    @abstractmethod
    def make(self) -> Allocator:
        """A new plugin."""

    def test_it_is_registered_under_a_name(self) -> None:
        """Kind, name and version as the host asks for them."""
        allocator = self.make()
        assert (allocator.kind, allocator.api_version) == ("allocator", API_VERSION)
        assert allocator.name

    def test_without_places_there_is_nothing(self) -> None:
        """No offers, no answer."""
        assert list(self.make().allot(offers_of(0, 3, 0))) == []

    def test_a_robot_alone_is_given_work(self) -> None:
        """Nobody else would do it."""
        assert list(self.make().allot(offers_of(1, 1, 5)))

    @pytest.mark.parametrize("seed", range(30))
    def test_somebody_is_given_work_whoever_asks(self, seed: int) -> None:
        """Indices are valid and unique, the answer repeats, and not all robots wait for one another."""
        robots, places = (int(most) for most in np.random.default_rng(seed).integers(1, (7, 15)))
        allocator = self.make()
        shares = [list(allocator.allot(offers_of(seed, robots, places, asker))) for asker in range(robots)]
        assert shares == [
            list(allocator.allot(offers_of(seed, robots, places, asker))) for asker in range(robots)
        ]
        for share in shares:
            assert len(set(share)) == len(share)
            assert all(0 <= number < places for number in share)
        assert any(shares), "nobody would do anything: the mission would stand still"
