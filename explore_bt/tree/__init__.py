"""What trees are made of: ports, blackboard, the base of leaves, and the control nodes."""

from explore_bt.tree.blackboard import Blackboard
from explore_bt.tree.control import (
    ControlNode,
    EntryCondition,
    Fallback,
    ForceFailure,
    ForceSuccess,
    Guard,
    Invert,
    OnFailure,
    Parallel,
    ReactiveFallback,
    ReactiveSequence,
    Repeat,
    Retry,
    Sequence,
    Subtree,
    Timeout,
    halt,
)
from explore_bt.tree.leaf import Leaf, Status
from explore_bt.tree.memory import TreeMemory, restore_tree, tree_memory
from explore_bt.tree.mocked import MockedLeaf, Round, Script, mocked
from explore_bt.tree.ports import REQUIRED, Input, Key, Output, PortUnsetError
from explore_bt.tree.probe import Probe, attach, detach, tick
from explore_bt.tree.status_word import status_word

__all__ = [
    "REQUIRED",
    "Blackboard",
    "ControlNode",
    "EntryCondition",
    "Fallback",
    "ForceFailure",
    "ForceSuccess",
    "Guard",
    "Input",
    "Invert",
    "Key",
    "Leaf",
    "MockedLeaf",
    "OnFailure",
    "Output",
    "Parallel",
    "PortUnsetError",
    "Probe",
    "ReactiveFallback",
    "ReactiveSequence",
    "Repeat",
    "Retry",
    "Round",
    "Script",
    "Sequence",
    "Status",
    "Subtree",
    "Timeout",
    "TreeMemory",
    "attach",
    "detach",
    "halt",
    "mocked",
    "restore_tree",
    "status_word",
    "tick",
    "tree_memory",
]
