"""Control nodes with the semantics of BehaviorTree.CPP 4, as py_trees behaviours."""

from explore_bt.tree.control.base import ControlNode, halt
from explore_bt.tree.control.fallback import Fallback, ReactiveFallback
from explore_bt.tree.control.guard import EntryCondition, Guard, OnFailure
from explore_bt.tree.control.outcome import ForceFailure, ForceSuccess, Invert, Subtree
from explore_bt.tree.control.parallel import Parallel
from explore_bt.tree.control.rounds import Repeat, Retry
from explore_bt.tree.control.sequence import ReactiveSequence, Sequence
from explore_bt.tree.control.timeout import Timeout

__all__ = [
    "ControlNode",
    "EntryCondition",
    "Fallback",
    "ForceFailure",
    "ForceSuccess",
    "Guard",
    "Invert",
    "OnFailure",
    "Parallel",
    "ReactiveFallback",
    "ReactiveSequence",
    "Repeat",
    "Retry",
    "Sequence",
    "Subtree",
    "Timeout",
    "halt",
]
