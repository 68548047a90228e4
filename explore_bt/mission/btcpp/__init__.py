"""Trees as BehaviorTree.CPP 4 XML: written, read back, and shown while they run."""

from explore_bt.mission.btcpp.live import live_attributes, live_tree_xml, uid_of
from explore_bt.mission.btcpp.read import ImportedTree, read_tree_xml
from explore_bt.mission.btcpp.write import tree_xml

__all__ = ["ImportedTree", "live_attributes", "live_tree_xml", "read_tree_xml", "tree_xml", "uid_of"]
