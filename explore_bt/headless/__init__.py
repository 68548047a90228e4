"""Strategies without a robot: a map and a pose in, the next goal and path out, for foreign loops."""

from explore_bt.headless.decision import Decision
from explore_bt.headless.explorer import Explorer
from explore_bt.headless.strategies import STRATEGIES

__all__ = ["STRATEGIES", "Decision", "Explorer"]
