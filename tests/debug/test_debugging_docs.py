"""docs/debugging.md holds: every command, every name, every example in it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from explore_bt.debug import NAMES, Expression
from explore_bt.debug.terminal.parsing import breakpoint_of, force_of
from explore_bt.debug.terminal.verbs import VERBS, find_verb

PAGE = (Path(__file__).parents[2] / "docs" / "debugging.md").read_text(encoding="utf-8")
INDENTED = re.findall(r"^ {4}(\w+ .*)$", PAGE, re.MULTILINE)
TYPED = re.findall(r"^debug> (.*)$", PAGE, re.MULTILINE)


def test_the_page_lists_every_command_with_its_letter():
    rows = "\n".join(re.findall(r"^\| `.*$", PAGE.split("### Expressions")[0], re.MULTILINE))
    for verb in VERBS:
        assert re.search(rf"`{verb.name}\b", rows), verb.name
        assert not verb.short or f"`{verb.short}`" in rows, verb.short


def test_the_page_lists_every_name_that_expressions_know():
    rows = "\n".join(re.findall(r"^\| `.*$", PAGE.split("### Expressions")[1], re.MULTILINE))
    assert set(NAMES) == {
        name for row in rows.splitlines() for name in re.findall(r"`(\w+)`", row.split("|")[1])
    }


@pytest.mark.parametrize("line", [line for line in [*INDENTED, *TYPED] if not line.startswith("explore-bt")])
def test_every_command_in_the_page_can_be_typed(line):
    word, _, rest = line.partition(" ")
    verb = find_verb(word)
    if verb.name == "break":
        condition = breakpoint_of(rest).condition
        assert not condition or Expression(condition)
    elif verb.name == "force":
        force_of(rest)
    elif verb.name == "print":
        Expression(rest)


def test_the_code_of_the_page_runs():
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(code, "docs/debugging.md", "exec"), {"__name__": "docs"})
