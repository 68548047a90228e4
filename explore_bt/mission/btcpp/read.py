"""BehaviorTree.CPP 4 XML as one of our trees, checked, or every reason why it cannot be."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from explore_bt.mission.btcpp.document import XmlElement, parse_xml
from explore_bt.mission.btcpp.node_reader import NodeReader
from explore_bt.mission.btcpp.vocabulary import OWN_NAME
from explore_bt.mission.btcpp.yaml_text import trees_text
from explore_bt.mission.catalog import PluginCatalog
from explore_bt.mission.document import Entry, Scalar
from explore_bt.mission.faults import Faults
from explore_bt.mission.files import read_text
from explore_bt.mission.nodes import NodeSpec
from explore_bt.mission.references import Scope
from explore_bt.mission.source import Place, Source
from explore_bt.mission.tree_reader import TreeReader
from explore_bt.mission.wiring import check_wiring
from explore_bt.mission.words import did_you_mean

__all__ = ["ImportedTree", "read_tree_xml"]


@dataclass(frozen=True, slots=True)
class ImportedTree:
    """A tree that was XML.

    Attributes:
        name: of the main tree.
        root: the tree, checked; places are those of the XML.
        text: it and its subtrees as a YAML file to include.
        remarks: what is not quite as it was, one sentence each.
    """

    name: str
    root: NodeSpec
    text: str
    remarks: tuple[str, ...]


def read_tree_xml(path: Path, catalog: PluginCatalog) -> ImportedTree:
    """Read a BehaviorTree.CPP 4 file.

    Args:
        path: the XML.
        catalog: the installed plugins; its leaves are the nodes the tree may use.

    Raises:
        MissionError: with every fault, each at its line and column of the XML.
    """
    faults = Faults()
    head = Source(str(path), "", path.parent, has_lines=False)
    text = read_text(path, head.place(), "the tree", faults)
    root = None if text is None else parse_xml(Source(str(path), text, path.parent), faults)
    if root is None:
        faults.raise_if_any()
    assert root is not None  # else a fault was noted, and that was raised
    return _Importer(root, catalog, faults).tree()


class _Importer:
    def __init__(self, root: XmlElement, catalog: PluginCatalog, faults: Faults) -> None:
        self._root = root
        self._catalog = catalog
        self._faults = faults
        self._blocks: dict[str, XmlElement] = {}
        self._names: dict[str, str] = {}
        self._gather()

    def tree(self) -> ImportedTree:
        main, place = self._main()
        reader = NodeReader(self._names, self._catalog, self._faults)
        trees: dict[str, Entry] = {}
        for block, element in self._blocks.items():
            top = reader.only_child(element)
            if top is not None:
                trees[self._names[block]] = Entry(self._names[block], element.place, top)
        self._faults.raise_if_any()
        checker, scope = TreeReader(trees, True, self._catalog, self._faults), Scope({}, os.environ, "robot")
        root = checker.root(Scalar(main, main, True, place), scope)
        checker.check_unused(scope)
        if root is not None and checker.complete:
            check_wiring(root, self._faults)
        self._faults.raise_if_any()
        assert root is not None  # else a fault was noted
        remarks = tuple(dict.fromkeys(reader.remarks))
        return ImportedTree(main, root, trees_text({n: e.value for n, e in trees.items()}, remarks), remarks)

    def _gather(self) -> None:
        """The trees by ID, and what each is to be called."""
        if self._root.tag != "root":
            self._faults.add(
                self._root.place,
                f"the outermost tag is <{self._root.tag}>",
                'expected <root BTCPP_format="4">',
            )
            return
        version = self._root.get("BTCPP_format", "4")
        if version != "4":
            place = self._root.place_of("BTCPP_format")
            self._faults.add(
                place, f"BTCPP_format {version} is not read", "convert the tree to BehaviorTree.CPP 4 first"
            )
        for element in self._root.children:
            if element.tag == "BehaviorTree":
                self._take(element)
            elif element.tag == "include":
                self._faults.add(element.place, "<include> is not followed", "convert each file by itself")
            elif element.tag != "TreeNodesModel":
                hint = "expected <BehaviorTree> or <TreeNodesModel>"
                self._faults.add(element.place, f"<{element.tag}> stands outside of every tree", hint)
        if not self._blocks:
            self._faults.add(
                self._root.place, "there is no tree", 'write <BehaviorTree ID="main"> ... </BehaviorTree>'
            )
        taken: set[str] = set()
        for block, element in self._blocks.items():
            name = element.get(OWN_NAME, block)
            self._names[block] = block if name in taken or (name != block and name in self._blocks) else name
            taken.add(self._names[block])

    def _take(self, element: XmlElement) -> None:
        block = element.get("ID")
        if not block:
            if len([each for each in self._root.children if each.tag == "BehaviorTree"]) > 1:
                self._faults.add(element.place, "the tree has no ID", 'write <BehaviorTree ID="name">')
            block = block or "main"
        if block not in self._blocks:
            self._blocks[block] = element
        elif _shape(self._blocks[block]) != _shape(element):
            first = self._blocks[block].place
            self._faults.add(
                element.place, f'another tree has the ID "{block}"', f"the first stands at {first}"
            )

    def _main(self) -> tuple[str, Place]:
        named = self._root.get("main_tree_to_execute")
        place = self._root.place_of("main_tree_to_execute")
        if named and named not in self._blocks:
            self._faults.add(place, f'there is no tree "{named}"', did_you_mean(named, self._blocks, "trees"))
        elif not named and len(self._blocks) > 1 and not self._is_dump():
            self._faults.add(
                self._root.place, "which tree is the main one is not said", 'write main_tree_to_execute="..."'
            )
        main = named if named in self._blocks else next(iter(self._blocks), "")
        return self._names.get(main, main), place

    def _is_dump(self) -> bool:
        """Whether a running tree wrote this about itself: the main tree then comes first."""
        return any("_fullpath" in block.attributes for block in self._blocks.values())


def _shape(element: XmlElement) -> object:
    """What counts when trees are compared: repeated instances of a subtree differ in ``_uid`` only."""
    kept = {name: text for name, text in element.attributes.items() if name not in ("_uid", "_fullpath")}
    return element.tag, kept, [_shape(child) for child in element.children]
