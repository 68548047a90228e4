"""What trees are made of: ports, blackboard, the base of leaves, and the control nodes."""

from explore_bt.tree.blackboard import Blackboard
from explore_bt.tree.leaf import Leaf, Status
from explore_bt.tree.ports import REQUIRED, Input, Key, Output, PortUnsetError

__all__ = ["REQUIRED", "Blackboard", "Input", "Key", "Leaf", "Output", "PortUnsetError", "Status"]
