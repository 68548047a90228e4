from __future__ import annotations

from explore_bt.interfaces import HeldBy
from explore_bt.runtime.gate_news import GateNews

WALL, PERSON = HeldBy.OBSTACLE, HeldBy.SOMEONE


def told(steps: dict[int, tuple[str, HeldBy]], count: int) -> list[tuple[float, str]]:
    """News of ``count`` control steps of 0.1 s, of which those in ``steps`` are held."""
    news = GateNews()
    free = ("", HeldBy.NOTHING)
    lines = [(0.1 * k, news.of(*steps.get(k, free), 0.1 * k)) for k in range(count)]
    return [(round(at_s, 1), line) for at_s, line in lines if line]


def test_an_intervention_is_told_when_it_begins_and_once_it_has_been_over_for_a_second() -> None:
    assert told(dict.fromkeys(range(3, 8), ("0.2 m from a wall", WALL)), 40) == [
        (0.3, "held by an obstacle: 0.2 m from a wall"),
        (1.7, "free again: was held for 0.4 s by an obstacle"),
    ]


def test_a_gate_that_flickers_is_one_intervention() -> None:
    flicker = {k: (f"someone {k} cm away", PERSON) for k in range(0, 50, 3)}
    assert told(flicker, 80) == [
        (0.0, "held by someone who moves: someone 0 cm away"),
        (5.8, "free again: was held for 4.8 s by someone who moves"),
    ]


def test_another_reason_meanwhile_is_told_too() -> None:
    steps = {0: ("a wall", WALL), 1: ("another wall", WALL), 2: ("someone", PERSON)}
    assert [line for _, line in told(steps, 5)] == [
        "held by an obstacle: a wall",
        "held by someone who moves: someone",
    ]
