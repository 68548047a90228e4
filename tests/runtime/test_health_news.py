from explore_bt.runtime.health_news import HealthNews
from explore_bt.types import Estimate, Health, Pose2


def told(states: list[tuple[float, Health]]) -> list[tuple[float, str]]:
    news = HealthNews()
    lines = [(at_s, news.of(estimate(health), at_s)) for at_s, health in states]
    return [(at_s, line) for at_s, line in lines if line]


def estimate(health: Health) -> Estimate:
    return Estimate(0.0, Pose2.identity(), health=health, reason="" if health is Health.OK else "why")


def test_worse_is_told_at_once_and_better_after_a_second() -> None:
    states = [(0.1 * k, Health.DEGRADED if 5 <= k < 20 else Health.OK) for k in range(60)]
    states[40:42] = [(4.0, Health.LOST), (4.1, Health.LOST)]
    lines = told(states)
    assert [line for _, line in lines] == [
        "ok → degraded: why",
        "degraded → ok after 1.5 s",
        "ok → lost: why",
        "lost → ok after 0.2 s",
    ]
    assert [round(at_s, 1) for at_s, _ in lines] == [0.5, 3.0, 4.0, 5.2]


def test_a_flicker_is_told_once() -> None:
    lines = told([(0.1 * k, Health.OK if k % 2 else Health.DEGRADED) for k in range(50)])
    assert len(lines) == 1
