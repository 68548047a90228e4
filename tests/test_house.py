"""The house in order: style, types, layers, and the shape that CONTRIBUTING promises."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SOURCES = sorted(
    path for folder in ("explore_bt", "plugins", "benchmarks") for path in (ROOT / folder).rglob("*.py")
)


@pytest.mark.parametrize(
    "command",
    [
        ["ruff", "check", "."],
        ["ruff", "format", "--check", "."],
        ["lint-imports", "--no-cache"],
        ["mypy"],
    ],
    ids=lambda command: command[0] + (" format" if "format" in command else ""),
)
def test_a_tool_finds_nothing(command: list[str]) -> None:
    tool = Path(sys.executable).with_name(command[0])
    run = subprocess.run([tool, *command[1:]], cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_no_file_outgrows_its_noun(path: Path) -> None:
    assert len(path.read_text().splitlines()) <= 400


def test_the_paper_is_cited_where_its_rules_live() -> None:
    exploration = (ROOT / "explore_bt/exploration").glob("*.py")
    assert sum("paper" in path.read_text() for path in exploration) >= 4
