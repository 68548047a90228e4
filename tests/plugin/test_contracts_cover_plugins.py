"""Every registered driver, SLAM, planner and controller has a test class of its contract somewhere."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from pathlib import Path

import pytest

from explore_bt.testing import registered

TESTS = Path(__file__).parents[1]
SUITES = {
    "driver": "DriverContract",
    "slam": "SlamContract",
    "planner": "PlannerContract",
    "controller": "ControllerContract",
    "team": "TeamContract",
    "allocator": "AllocatorContract",
}


NEIGHBOURS = {"Nav2"}
"""It passes on what another process decides, in that one's time and by a way of its own: no path drives it.

``tests/ros2`` drives it against such a process.
"""


def classes_under(suite: str, files: Iterable[Path]) -> Iterator[ast.ClassDef]:
    """Test classes that derive from a suite, directly or through a class of the same file."""
    for file in files:
        family = {suite}
        for node in ast.parse(file.read_text()).body:
            if isinstance(node, ast.ClassDef) and family & {
                ast.unparse(base).split(".")[-1] for base in node.bases
            }:
                family.add(node.name)
                yield node


def words_of(node: ast.ClassDef) -> set[str]:
    """Names that a class mentions."""
    names = (getattr(each, "id", None) or getattr(each, "attr", None) for each in ast.walk(node))
    return {name for name in names if name}


def untested(classes: Iterable[type], suite: str, files: Iterable[Path]) -> list[str]:
    """Names of the classes that no test class of the suite mentions."""
    mentioned = [words_of(node) for node in classes_under(suite, files) if node.name.startswith("Test")]
    return [cls.__name__ for cls in classes if not any(cls.__name__ in words for words in mentioned)]


@pytest.mark.parametrize(("kind", "suite"), SUITES.items())
def test_every_registered_class_is_put_to_the_contract_of_its_kind(kind, suite):
    asked = [cls for cls in registered(kind) if cls.__name__ not in NEIGHBOURS]
    missing = untested(asked, suite, sorted(TESTS.rglob("test_*.py")))
    assert missing == [], f"write class Test{missing[0]}({suite}) in tests/ with a make() that returns one"


def test_a_class_without_a_contract_test_is_found(tmp_path):
    file = tmp_path / "test_planners.py"
    file.write_text(
        "class Common(PlannerContract):\n"
        "    pass\n\n"
        "class TestTried(Common):\n"
        "    def make(self):\n"
        "        return Tried(Tried.Options())\n\n"
        "class TestOther:\n"
        "    plugin = Forgotten\n"
    )
    tried, forgotten = type("Tried", (), {}), type("Forgotten", (), {})
    assert untested([tried, forgotten], "PlannerContract", [file]) == ["Forgotten"]
