"""What every element of a tree in XML has to heed."""

from __future__ import annotations

import re

from explore_bt.mission.btcpp.attributes import entry_name
from explore_bt.mission.btcpp.document import XmlElement
from explore_bt.mission.btcpp.vocabulary import EXPLICIT_TAGS, MODIFIER, OWN_NAME
from explore_bt.mission.faults import Faults
from explore_bt.mission.references import NAME
from explore_bt.mission.source import Place
from explore_bt.mission.words import did_you_mean

__all__ = ["check_attributes", "check_reference", "node_tag", "passed_over", "whole_number"]

_SCRIPTS = ("_skipIf", "_failureIf", "_successIf", "_while", "_onSuccess", "_onFailure", "_onHalted", "_post")
_KNOWN = ("_uid", "_fullpath", "_description", "_autoremap", MODIFIER, OWN_NAME)
_WHOLE = re.compile("-?[0-9]{1,9}")


def node_tag(element: XmlElement, faults: Faults) -> str:
    """Which node it is: the tag, or the ID of the long form; empty where that is not said."""
    if element.tag not in EXPLICIT_TAGS:
        return element.tag
    if not element.get("ID"):
        faults.add(element.place, f"<{element.tag}> has no ID", f'write <{element.tag} ID="drive_to">')
    return element.get("ID")


def check_attributes(element: XmlElement, known: tuple[str, ...], faults: Faults) -> None:
    """Note every attribute that the node does not have, and every script."""
    usual = ("name", "ID") if element.tag in EXPLICIT_TAGS else ("name",)
    for name in element.attributes:
        place = element.place_of(name)
        if name in _SCRIPTS:
            message = f"{name} holds a script; scripts have no twin here"
            faults.add(place, message, "make it a condition of its own in the tree")
        elif not name.startswith("_") and name not in (*known, *usual):
            hint = did_you_mean(name, (*known, *usual), "attributes")
            faults.add(place, f'<{element.tag}> has no attribute "{name}"', hint)


def passed_over(element: XmlElement) -> list[str]:
    """Attributes that mean nothing here, one sentence each."""
    odd = [name for name in element.attributes if name.startswith("_") and name not in (*_KNOWN, *_SCRIPTS)]
    return [f"{element.place_of(name)}: {name} was passed over" for name in odd]


def check_reference(text: str, place: Place, faults: Faults) -> None:
    """Note a ``{key}`` that no entry can be called, and a ``$key``, which is plain text in XML."""
    key = entry_name(text)
    if key and not NAME.fullmatch(key):
        faults.add(place, f"{{{key}}} is not the name of an entry", "letters, digits and _ only")
    if text.startswith("$"):
        faults.add(place, f"{text} is plain text in BehaviorTree.CPP", f"write {{{text[1:]}}}")


def whole_number(element: XmlElement, name: str, faults: Faults, default: int | None = None) -> int | None:
    """The number in an attribute; None where there is none (the fault is noted)."""
    if name not in element.attributes:
        if default is None:
            faults.add(element.place, f'<{element.tag}> needs the attribute "{name}"', f'write {name}="3"')
        return default
    text = element.get(name)
    if _WHOLE.fullmatch(text):
        return int(text)
    hint = "a constant; no blackboard entry" if entry_name(text) else f'write {name}="3"'
    faults.add(element.place_of(name), f'{name}="{text}" is not a whole number', hint)
    return None
