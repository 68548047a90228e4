import itertools

import numpy as np
import pytest
from explore_bt_teams import Auction, AuctionOptions, Greedy, Independent, LocalTeam, TeamOptions
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.interfaces import Allocator, Offers, PluginOptions, Team
from explore_bt.testing import AllocatorContract, TeamContract
from explore_bt.testing.allocator_contract import offers_of


class TestLocalTeam(TeamContract):
    def make(self) -> Team:
        return LocalTeam(TeamOptions())


class TestAuction(AllocatorContract):
    def make(self) -> Allocator:
        return Auction(AuctionOptions())


class TestGreedy(AllocatorContract):
    def make(self) -> Allocator:
        return Greedy(PluginOptions())


class TestIndependent(AllocatorContract):
    def make(self) -> Allocator:
        return Independent(PluginOptions())


def plainly(offers: Offers, evenness: float, follow_up_m: float) -> list[set[int]]:
    """The auction by the book: every bid of every round anew, tours as lists."""
    robots, places = offers.from_robots_m.shape
    tours: list[list[int]] = [[] for _ in range(robots)]

    def length(robot: int, tour: list[int]) -> float:
        begun_m = offers.committed_m[robot] + (follow_up_m if offers.committed_m[robot] > 0.0 else 0.0)
        if not tour:
            return float(begun_m)
        legs = sum(offers.between_m[a, b] for a, b in itertools.pairwise(tour))
        behind = sum(follow_up_m * min(offers.gains_m2[place] / 5.0, 1.0) for place in tour)
        return float(begun_m + offers.from_robots_m[robot, tour[0]] + legs + behind)

    left = set(range(places))
    while left:
        bids = []
        for place, robot in itertools.product(sorted(left), range(robots)):
            before = length(robot, tours[robot])
            at = range(len(tours[robot]) + 1)
            longer = min(length(robot, [*tours[robot][:i], place, *tours[robot][i:]]) for i in at)
            longer -= follow_up_m * min(offers.gains_m2[place] / 5.0, 1.0)  # it comes after the place
            bids.append((longer - before + evenness * longer, place, robot))
        _, place, robot = min(bids)
        options = [[*tours[robot][:i], place, *tours[robot][i:]] for i in range(len(tours[robot]) + 1)]
        tours[robot] = min(options, key=lambda tour: length(robot, tour))
        left.remove(place)
    return [set(tour) for tour in tours]


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    robots=st.integers(1, 5),
    places=st.integers(1, 12),
    follow_up_m=st.sampled_from([0.0, 3.0, 20.0]),
)
def test_the_auction_is_the_one_by_the_book(seed: int, robots: int, places: int, follow_up_m: float) -> None:
    auction = Auction(AuctionOptions(evenness=0.5, follow_up=follow_up_m))
    expected = plainly(offers_of(seed, robots, places), 0.5, follow_up_m)
    for asker in range(robots):
        assert set(auction.allot(offers_of(seed, robots, places, asker))) == expected[asker]


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 10_000), robots=st.integers(1, 6), places=st.integers(1, 14))
def test_every_place_has_one_winner_on_whom_all_agree(seed: int, robots: int, places: int) -> None:
    auction = Auction(AuctionOptions())
    shares = [list(auction.allot(offers_of(seed, robots, places, asker))) for asker in range(robots)]
    assert sorted(itertools.chain(*shares)) == list(range(places))


def test_two_robots_side_by_side_go_different_ways() -> None:
    """Two openings, one to each side: both are a shorter way for one robot, and a longer time."""
    offers = Offers(
        ("a", "b"),
        np.array([5.0, 5.0]),
        np.array([[0.0, 8.0], [8.0, 0.0]]),
        np.array([[4.0, 4.0], [4.5, 4.5]]),
        np.zeros(2),
        np.zeros(2, dtype=np.bool_),
    )
    assert len(Auction(AuctionOptions()).allot(offers)) == 1


def test_who_has_far_to_go_first_is_left_out_of_what_a_free_one_can_do() -> None:
    offers = Offers(
        ("a", "b"),
        np.array([5.0]),
        np.zeros((1, 1)),
        np.array([[5.0], [4.0]]),
        np.array([0.0, 30.0]),
        np.zeros(1, dtype=np.bool_),
    )
    assert Auction(AuctionOptions()).allot(offers) == [0]


@pytest.mark.parametrize(("kept", "share"), [(False, []), (True, [0])])
def test_who_is_on_its_way_keeps_it_unless_another_is_clearly_nearer(kept: bool, share: list[int]) -> None:
    offers = Offers(
        ("b", "a"),
        np.array([5.0]),
        np.zeros((1, 1)),
        np.array([[5.0], [4.5]]),
        np.zeros(2),
        np.array([kept]),
    )
    assert list(Auction(AuctionOptions()).allot(offers)) == share


def test_greedy_takes_the_nearest_and_independent_all() -> None:
    offers = offers_of(4, 3, 6)
    assert list(Greedy(PluginOptions()).allot(offers)) == [int(np.argmin(offers.from_robots_m[0]))]
    assert list(Independent(PluginOptions()).allot(offers)) == list(range(6))
    assert Greedy.heeds_claims
    assert not Independent.heeds_claims
