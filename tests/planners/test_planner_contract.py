from explore_bt_planners import GridAstar, Skeleton

from explore_bt.interfaces import Planner
from explore_bt.testing.planner_contract import PlannerContract


class TestSkeletonContract(PlannerContract):
    def make(self) -> Planner:
        return Skeleton(Skeleton.Options())


class TestGridAstarContract(PlannerContract):
    def make(self) -> Planner:
        return GridAstar(GridAstar.Options())
