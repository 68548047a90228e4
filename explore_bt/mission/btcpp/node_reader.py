"""One element of BehaviorTree.CPP XML as a node of ours."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from explore_bt.mission.btcpp.attributes import entry_name, port_value
from explore_bt.mission.btcpp.document import XmlElement
from explore_bt.mission.btcpp.draft import Draft, constant
from explore_bt.mission.btcpp.element_checks import (
    check_attributes,
    check_reference,
    node_tag,
    passed_over,
    whole_number,
)
from explore_bt.mission.btcpp.vocabulary import (
    BUILTIN_TAGS,
    CONTROL_TAGS,
    DECORATOR_TAGS,
    ENTRY_HOLDS,
    MODIFIER,
    OWN_NAME,
)
from explore_bt.mission.catalog import PluginCatalog
from explore_bt.mission.document import Entries, Entry, Items, Scalar, Value
from explore_bt.mission.faults import Faults
from explore_bt.mission.references import NAME
from explore_bt.mission.words import did_you_mean
from explore_bt.tree import Input, Leaf, Output

__all__ = ["NodeReader"]

_LISTS = {tag: key for key, tag in CONTROL_TAGS.items()}
_ONES = {tag: key for key, tag in DECORATOR_TAGS.items()}
_INSTEAD = {
    "AsyncSequence": "use Sequence",
    "AsyncFallback": "use Fallback",
    "SequenceWithMemory": "use Sequence; RetryUntilSuccessful begins it anew",
    "ParallelAll": "use Parallel with success_count and failure_count",
    "IfThenElse": "use a Fallback of two Sequences",
    "WhileDoElse": "use a ReactiveFallback of two ReactiveSequences",
}


class NodeReader:
    """Turns elements into the values a mission would hold; notes every fault.

    Args:
        trees: ID in the XML -> name in the mission.
        catalog: the installed plugins.
        faults: where to note what is wrong.

    Attributes:
        remarks: what was passed over or is not quite the same, one sentence each.
    """

    def __init__(self, trees: Mapping[str, str], catalog: PluginCatalog, faults: Faults) -> None:
        self._trees = trees
        self._catalog = catalog
        self._faults = faults
        self.remarks: list[str] = []
        self._special: Mapping[str, Callable[[XmlElement], Draft | None]] = {
            "Timeout": self._timeout,
            "RetryUntilSuccessful": self._retry,
            "Repeat": self._repeat,
            "KeepRunningUntilFailure": self._forever,
            "Parallel": self._parallel,
            "SubTree": self._subtree,
            ENTRY_HOLDS: self._misplaced_entry,
        }

    def only_child(self, element: XmlElement) -> Value | None:
        """What stands in an element that holds exactly one node."""
        node = self._only(element)
        return None if node is None else node.value()

    def _only(self, element: XmlElement) -> Draft | None:
        if len(element.children) != 1:
            found = len(element.children) or "none"
            self._faults.add(element.place, f"<{element.tag}> holds exactly one node; this has {found}")
        nodes = [self._node(child) for child in element.children]
        return nodes[0] if len(nodes) == 1 else None

    def _node(self, element: XmlElement) -> Draft | None:
        self.remarks += passed_over(element)
        tag = node_tag(element, self._faults)
        if tag in self._special:
            return self._special[tag](element)
        if tag in _LISTS:
            check_attributes(element, (), self._faults)
            return self._composed(element, _LISTS[tag]) or self._list(element, _LISTS[tag])
        if tag in _ONES:
            return self._one(element, _ONES[tag])
        if tag in self._catalog.names("behaviour"):
            return self._leaf(element, tag)
        self._refuse(element, tag)
        return None

    def _refuse(self, element: XmlElement, tag: str) -> None:
        if tag in BUILTIN_TAGS:
            hint = _INSTEAD.get(tag, "write a leaf that does it, or leave it out")
            self._faults.add(element.place, f"{tag} has no twin here", hint)
        elif tag:
            known = [*self._catalog.names("behaviour"), *_LISTS, *_ONES, *self._special]
            self._faults.add(element.place, f"there is no node {tag}", did_you_mean(tag, known, "nodes"))
        for child in element.children:  # their faults count too
            self._node(child)

    def _named(self, node: Draft, element: XmlElement, attribute: str = "name") -> Draft:
        """``node`` with the name and the comment its element gives."""
        name, comment = element.get(attribute), element.get("_description")
        is_default = name == node_tag(element, self._faults) and "_uid" in element.attributes
        if name and not is_default:
            node = node.with_text("name", name, element.place_of(attribute))
        return node.with_text("doc", comment, element.place_of("_description")) if comment else node

    def _leaf(self, element: XmlElement, tag: str) -> Draft:
        cls = self._catalog.get("behaviour", tag)
        assert issubclass(cls, Leaf)  # the catalog's contract for this kind
        ports: dict[str, Input[Any] | Output[Any]] = {**cls.inputs, **cls.outputs}
        check_attributes(element, tuple(ports), self._faults)
        if element.children:
            place = element.children[0].place
            self._faults.add(place, f"{tag} is a leaf; nothing can stand in it", "move it behind")
        entries = []
        for name, given in element.attributes.items():
            if name in ports:
                place = element.place_of(name)
                text = f"{{{name}}}" if given == "{=}" else given
                check_reference(text, place, self._faults)
                entries.append(Entry(name, place, port_value(text, ports[name], place)))
        value = Entries(tuple(entries), element.place) if entries else constant(None, element.place)
        return self._named(Draft(Entry(tag, element.place, value)), element)

    def _one(self, element: XmlElement, key: str) -> Draft | None:
        check_attributes(element, (), self._faults)
        inside = self.only_child(element)
        return None if inside is None else self._named(Draft(Entry(key, element.place, inside)), element)

    def _list(self, element: XmlElement, key: str) -> Draft | None:
        children = self._children(element)
        return None if children is None else self._named(Draft(Entry(key, element.place, children)), element)

    def _children(self, element: XmlElement) -> Items | None:
        if not element.children:
            self._faults.add(element.place, f"<{element.tag}> has no children")
        nodes = [self._node(child) for child in element.children]
        values = tuple(node.value() for node in nodes if node is not None)
        return Items(values, element.place) if values else None

    def _composed(self, element: XmlElement, key: str) -> Draft | None:
        """The modifier that an element stands for; None if it is just what it seems."""
        if len(element.children) != 2:
            return None
        first, second = element.children
        mark, asked = element.get(MODIFIER), _asked_entry(first)
        if key == "sequence" and (mark == "if" or asked is not None):
            node, condition = self._node(second), asked or self._value(first)
            return self._modified(node, "if", condition, element)
        if key == "fallback" and mark == "on_failure" and second.tag == "ForceFailure":
            return self._modified(self._node(first), "on_failure", self.only_child(second), element)
        return None

    def _value(self, element: XmlElement) -> Value | None:
        node = self._node(element)
        return None if node is None else node.value()

    def _modified(
        self, node: Draft | None, modifier: str, value: Value | None, element: XmlElement
    ) -> Draft | None:
        if node is None or value is None:
            return None
        has_name = "name" in element.attributes and "_uid" not in element.attributes
        if "_description" in element.attributes or (has_name and MODIFIER not in element.attributes):
            self.remarks.append(f"{element.place}: {modifier} cannot have a name or comment; it was left out")
        return node.modified(modifier, value, element.place)

    def _misplaced_entry(self, element: XmlElement) -> None:
        hint = "make it the first of the two children of a Sequence"
        self._faults.add(element.place, f"{ENTRY_HOLDS} can only stand before the one node it guards", hint)

    def _timeout(self, element: XmlElement) -> Draft | None:
        check_attributes(element, ("msec",), self._faults)
        place = element.place_of("msec")
        milliseconds = whole_number(element, "msec", self._faults)
        child = self._only(element)
        if milliseconds is None:
            return None
        if milliseconds < 1:
            self._faults.add(place, f'msec="{milliseconds}" is no time limit', "1 or more, or no Timeout")
            return None
        seconds = repr(milliseconds / 1000).removesuffix(".0")
        return self._modified(child, "timeout", constant(f"{seconds} s", place), element)

    def _retry(self, element: XmlElement) -> Draft | None:
        check_attributes(element, ("num_attempts",), self._faults)
        place = element.place_of("num_attempts")
        attempts = whole_number(element, "num_attempts", self._faults)
        child = self._only(element)
        if attempts is None:
            return None
        if attempts < 1:
            self._faults.add(place, f'num_attempts="{attempts}" has no twin here', "say how many, 1 or more")
            return None
        return (
            child if attempts == 1 else self._modified(child, "retry", constant(attempts - 1, place), element)
        )

    def _repeat(self, element: XmlElement) -> Draft | None:
        check_attributes(element, ("num_cycles",), self._faults)
        cycles = whole_number(element, "num_cycles", self._faults)
        if cycles is not None and (cycles == 0 or cycles < -1):
            self._faults.add(element.place_of("num_cycles"), f'num_cycles="{cycles}" is no number of rounds')
        if cycles == -1:
            self.remarks.append(f"{element.place}: repeats for ever, with one round a tick at most")
        return self._repeated(element, "forever" if cycles == -1 else cycles)

    def _forever(self, element: XmlElement) -> Draft | None:
        check_attributes(element, (), self._faults)
        return self._repeated(element, "forever")

    def _repeated(self, element: XmlElement, times: int | str | None) -> Draft | None:
        child, place = self.only_child(element), element.place
        if child is None or times is None:
            return None
        inside = (Entry("times", place, constant(times, place)), Entry("child", place, child))
        return self._named(Draft(Entry("repeat", place, Entries(inside, place))), element)

    def _parallel(self, element: XmlElement) -> Draft | None:
        check_attributes(element, ("success_count", "failure_count"), self._faults)
        children, place = self._children(element), element.place
        success = whole_number(element, "success_count", self._faults, default=-1)
        failure = whole_number(element, "failure_count", self._faults, default=1)
        if children is None or success is None or failure is None:
            return None
        entries = [Entry("children", place, children)]
        for key, number, default in (("failure", failure, 1), ("success", success, -1)):
            if number != default:
                counted = number if number >= 0 else len(element.children) + number + 1
                at = element.place_of(f"{key}_count")
                entries.insert(0, Entry(key, at, constant(counted, at)))
        value = Entries(tuple(entries), place) if len(entries) > 1 else children
        return self._named(Draft(Entry("parallel", place, value)), element)

    def _subtree(self, element: XmlElement) -> Draft | None:
        block, place = element.get("ID"), element.place_of("ID")
        if block not in self._trees:
            message = f'there is no tree "{block}"' if block else "<SubTree> has no ID"
            self._faults.add(place, message, did_you_mean(block, self._trees, "trees"))
            return None
        if element.children:
            self._faults.add(element.children[0].place, "nothing can stand in a <SubTree>", "move it behind")
        if element.get("_autoremap") != "true" and "_fullpath" not in element.attributes:
            message = f"{block} would have a blackboard of its own; subtrees here share one"
            self._faults.add(element.place, message, 'write _autoremap="true"')
        for name in element.attributes:
            if name not in ("ID", "name") and not name.startswith("_"):
                message = f"{name} is renamed for {block}; subtrees here share one blackboard"
                hint = "give both sides the same entry, and take it out"
                self._faults.add(element.place_of(name), message, hint)
        node = Draft(Entry("subtree", element.place, constant(self._trees[block], place)))
        return self._named(node, element, "name" if "name" in element.attributes else OWN_NAME)


def _asked_entry(element: XmlElement) -> Scalar | None:
    """``$key`` or ``not $key`` for the condition on an entry."""
    inverted = element.tag == "Inverter" and len(element.children) == 1 and "name" not in element.attributes
    asked = element.children[0] if inverted else element
    key = entry_name(asked.get("entry"))
    if asked.tag != ENTRY_HOLDS or not NAME.fullmatch(key) or asked.children:
        return None
    return constant(f"not ${key}" if inverted else f"${key}", asked.place_of("entry"))
