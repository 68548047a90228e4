"""Condition: is enough left to go on and still come home?"""

from __future__ import annotations

from explore_bt.errors import ComponentFailure, PlanningFailure
from explore_bt.tree import Input, Key, Leaf, Output, Status
from explore_bt.types import Budget
from explore_bt.units import Share, Speed

__all__ = ["BudgetLeft"]

_WAY_ROUND = 3.0
_LOOK_PERIOD_S = 1.0


class BudgetLeft(Leaf):
    """FAILURE once the planned way home would take what is left of time, distance or battery.

    Nothing is planned while three times the straight way would do; then the way home is planned once a
    second. Where no way is found, the last one found and all that was driven since is what it takes.
    FAILURE writes what ran short into ``over_budget``: the mission's outcome is then ``budget``.
    """

    type_key = "budget_left"

    pace: Input[float] = Input(Speed, default=0.2, ge=0.01, doc="how fast the way home is counted")
    spare: Input[float] = Input(Share, default=0.2, ge=0.0, doc="how much more the way home may take")
    over_budget: Output[str] = Output(str, default=Key("over_budget"), doc="what ran short, and when")

    _way_m: float | None = None
    _planned_at_m = _next_look_s = 0.0

    def update(self) -> Status:
        """Compare what is left with what the way home takes."""
        budgets = self.robot.budgets()
        if self._short_of(budgets, _WAY_ROUND * self._straight_m) is None:
            return Status.SUCCESS
        way_m = self._way_home_m()
        short = self._short_of(budgets, way_m)
        if short is None:
            return Status.SUCCESS
        self.over_budget = (
            f"turned home: the way of {way_m:.1f} m takes {self._need(short, way_m):.0f} {short.unit}, "
            f"left of the {short.name} budget are {short}"
        )
        self.say(self.over_budget)
        return Status.FAILURE

    @property
    def _straight_m(self) -> float:
        return self.robot.estimate().T_map_base.distance_to(self.robot.home)

    def _short_of(self, budgets: tuple[Budget, ...], way_m: float) -> Budget | None:
        return next((budget for budget in budgets if self._need(budget, way_m) >= budget.left), None)

    def _need(self, budget: Budget, way_m: float) -> float:
        return (1.0 + self.spare) * budget.need(way_m, way_m / self.pace)

    def _way_home_m(self) -> float:
        if self.robot.now_s() >= self._next_look_s:
            self._next_look_s = self.robot.now_s() + _LOOK_PERIOD_S
            try:
                self._way_m = self.robot.plan(self.robot.home).length_m
                self._planned_at_m = self.robot.distance_m
                self.say("")
            except (PlanningFailure, ComponentFailure) as refusal:
                self.say(f"no way home found: {refusal}")
        if self._way_m is None:
            return _WAY_ROUND * self._straight_m
        return self._way_m + self.robot.distance_m - self._planned_at_m
