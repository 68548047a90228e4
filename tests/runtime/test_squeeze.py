import numpy as np
import pytest

from explore_bt.errors import GoalBlocked, NoPath, PlanningFailure
from explore_bt.runtime.squeeze import plan_or_squeeze
from explore_bt.types import Path


def line(length_m: float) -> Path:
    return Path(np.array([[0.0, 0.0, 0.0], [length_m, 0.0, 0.0]]), np.array([0.5, 0.5]))


def planner(lengths_m: dict[float, float], refusal: type[PlanningFailure] = NoPath):
    """Ways by the footprint's radius; a refusal for any other."""

    def plan(radius_m: float) -> Path:
        if round(radius_m, 3) not in lengths_m:
            raise refusal(f"nothing for {radius_m:.2f} m")
        return line(lengths_m[round(radius_m, 3)])

    return plan


@pytest.mark.parametrize(
    ("lengths_m", "expected_m"),
    [
        ({0.25: 12.0, 0.22: 5.0}, 12.0),  # no detour to speak of
        ({0.25: 70.0, 0.22: 14.0}, 14.0),
        ({0.25: 70.0, 0.22: 40.0}, 70.0),  # does not halve it
        ({0.25: 70.0}, 70.0),
        ({0.22: 14.0, 0.2: 5.0}, 14.0),
        ({0.2: 14.0}, 14.0),
    ],
)
def test_a_squeeze_is_for_no_way_or_a_long_one(lengths_m: dict[float, float], expected_m: float) -> None:
    assert plan_or_squeeze(planner(lengths_m), 0.25, straight_m=5.0).length_m == expected_m


def test_the_refusal_of_the_true_footprint_is_what_is_told() -> None:
    with pytest.raises(NoPath, match=r"0\.25"):
        plan_or_squeeze(planner({}), 0.25, straight_m=5.0)


def test_a_blocked_goal_is_not_squeezed_at() -> None:
    with pytest.raises(GoalBlocked):
        plan_or_squeeze(planner({0.22: 5.0}, GoalBlocked), 0.25, straight_m=5.0)
