"""A server that speaks the Groot2 protocol of BehaviorTree.CPP 4; needs the extra ``groot``."""

from explore_bt.groot.server import GrootServer
from explore_bt.groot.sink import GrootSink

__all__ = ["GrootServer", "GrootSink"]
