"""Rewrites the generated part of docs/missions.md: ``python docs/generate.py``."""

from __future__ import annotations

import inspect
import re
from pathlib import Path

from explore_bt.behaviours import LEAVES
from explore_bt.cli.options import Option, options_of
from explore_bt.files import write_whole
from explore_bt.mission.bounds import asked_by_port
from explore_bt.tree import Leaf

__all__ = ["PAGE", "leaves_section", "main", "rewritten"]

PAGE = Path(__file__).with_name("missions.md")
_SECTION = re.compile(r"(?<=<!-- leaves -->\n).*?(?=<!-- /leaves -->)", re.DOTALL)


def leaves_section() -> str:
    """Every leaf with its ports, made from the classes."""
    return "\n" + "\n".join(_leaf(leaf) for leaf in LEAVES) + "\n"


def rewritten(page: str) -> str:
    """The page with its section of leaves up to date.

    Raises:
        ValueError: the page has lost its markers.
    """
    new, count = _SECTION.subn(lambda _: leaves_section(), page)
    if count != 1:
        raise ValueError(f"{PAGE.name} has {count} sections of leaves; expected <!-- leaves --> once")
    return new


def main() -> None:
    """Rewrite the page in place."""
    write_whole(PAGE, rewritten(PAGE.read_text(encoding="utf-8")))


def _leaf(leaf: type[Leaf]) -> str:
    told = inspect.cleandoc(leaf.__doc__ or "").replace("``", "`")
    head = f"#### `{leaf.type_key}`\n\n{told}\n"
    rows = [_row(leaf, option) for option in options_of(leaf)]
    if not rows:
        return head
    return "\n".join([head, "| port | type | default | meaning |", "|---|---|---|---|", *rows, ""])


def _row(leaf: type[Leaf], option: Option) -> str:
    port = leaf.inputs.get(option.name)
    bounds = asked_by_port(port).range if port else ""
    words = f"{option.type}, {bounds}" if bounds else option.type
    return f"| `{option.name}` | {_cell(words)} | `{option.default}` | {_cell(option.doc)} |"


def _cell(text: str) -> str:
    return text.replace("|", "or")


if __name__ == "__main__":
    main()
