"""Two robots whose clocks differ, over a network that delays as it likes."""

import random
import struct

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.fleet.clocks import UNMEASURED_S, Clocks, WordAges, clocks_from, clocks_to_bytes


class Network:
    """Carries words between two robots; times are the network's own, clocks are ahead by an offset."""

    def __init__(self, ahead_s: dict[str, float], delay_s: dict[str, tuple[float, float]], seed: int) -> None:
        self.ages = {name: WordAges(name, 1) for name in ahead_s}
        self.ahead_s, self.delay_s, self.chance = ahead_s, delay_s, random.Random(seed)
        self.under_way: list[tuple[float, str, float, Clocks | None]] = []

    def say(self, sender: str, time_s: float, told: Clocks | None) -> None:
        self.under_way.append((time_s + self.chance.uniform(*self.delay_s[sender]), sender, time_s, told))

    def deliver(self, time_s: float) -> list[tuple[float, float]]:
        """True age and bound of every word that has come, but for those that nobody could bound."""
        found = []
        for word in sorted(word for word in self.under_way if word[0] <= time_s):
            self.under_way.remove(word)
            _, sender, said_s, told = word
            (hearer,) = set(self.ages) - {sender}
            if told is not None:
                self.ages[hearer].hear(sender, told)
            stamp_s, now_s = said_s + self.ahead_s[sender], time_s + self.ahead_s[hearer]
            bound_s = self.ages[hearer].bound_s(sender, stamp_s, now_s)
            if bound_s != UNMEASURED_S:
                found.append((time_s - said_s, bound_s))
        return found

    def talk(self, begin_s: float, end_s: float) -> list[tuple[float, float]]:
        found = []
        for step in range(round(20 * begin_s), round(20 * end_s)):
            time_s = step / 20
            for name, ages in self.ages.items():
                self.say(name, time_s, ages.tell() if step % 20 == 0 else None)
            found += self.deliver(time_s)
        return found


@settings(max_examples=25, deadline=None)
@given(
    ahead_s=st.floats(-1e4, 1e4),
    there=st.tuples(st.floats(0.0, 0.45), st.floats(0.0, 1.0)),
    back=st.tuples(st.floats(0.0, 0.45), st.floats(0.0, 1.0)),
    seed=st.integers(0, 1000),
)
def test_no_word_is_older_than_its_bound_whatever_clocks_and_network(
    ahead_s: float, there: tuple[float, float], back: tuple[float, float], seed: int
) -> None:
    delays = {"a": (there[0], sum(there)), "b": (back[0], sum(back))}
    words = Network({"a": 0.0, "b": ahead_s}, delays, seed).talk(0.0, 20.0)
    assert len(words) > 400
    assert all(bound_s > age_s - 1e-6 for age_s, bound_s in words)
    fastest_s = there[0] + back[0]
    later = words[len(words) // 2 :]
    assert min(bound_s - age_s for age_s, bound_s in later) <= fastest_s + 0.15, "and it says something"


def test_of_a_mate_that_has_told_its_clocks_and_nothing_else_nothing_is_told() -> None:
    ages = WordAges("a", 1)
    ages.hear("b", Clocks(7))
    assert ages.tell() == Clocks(1)
    ages.bound_s("b", 10.0, 12.5)
    assert ages.tell() == Clocks(1, {"b": (7, 2.5)})


def test_a_robot_that_comes_back_with_another_clock_is_not_measured_by_its_life_before() -> None:
    """It was dead for 8 s and goes on where its clock stood: its words look 8 s older than they are."""
    network = Network({"a": 0.0, "b": 5.0}, {"a": (0.2, 0.2), "b": (0.2, 0.2)}, 1)
    network.talk(0.0, 10.0)
    network.under_way.clear()
    network.ages["b"], network.ahead_s["b"] = WordAges("b", 2), -3.0
    words = network.talk(18.0, 24.0)
    assert all(bound_s > age_s - 1e-6 for age_s, bound_s in words)
    assert max(bound_s for _, bound_s in words[-20:]) < 0.6


def test_clocks_come_as_they_were_sent() -> None:
    told = Clocks(2**63 + 5, {"ada": (7, -1234.5), "bärbel": (2**64 - 1, 0.25)})
    body = clocks_to_bytes(told)
    assert clocks_from(body) == told
    for cut in range(len(body)):
        with pytest.raises((ValueError, struct.error)):
            clocks_from(body[:cut])
