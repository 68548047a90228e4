"""Every broken mission of ``broken/*.txt`` gives exactly the message that stands below it.

One entry: ``### title``, ``- text of the good mission``, ``+ what stands there instead``, the message.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

from explore_bt.mission import MissionError


@dataclass(frozen=True)
class BrokenMission:
    """``old`` in the good mission replaced by ``new`` has to give ``message``."""

    title: str
    old: str
    new: str
    message: str


def broken_missions() -> list[BrokenMission]:
    """All of the table."""
    cases = []
    for file in sorted((Path(__file__).parent / "broken").glob("*.txt")):
        for block in file.read_text().split("### ")[1:]:
            title, old, new, message = block.split("\n", 3)
            cases.append(BrokenMission(f"{file.stem}: {title}", _text(old), _text(new), message.rstrip("\n")))
    return cases


def _text(line: str) -> str:
    return line[2:].replace("\\n", "\n").replace("\\t", "\t")


def test_the_table_is_large() -> None:
    assert len(broken_missions()) > 100


@pytest.mark.parametrize("case", broken_missions(), ids=lambda case: case.title)
def test_a_broken_mission_says_exactly_what_is_wrong(load, good, case) -> None:
    assert case.old in good
    with pytest.raises(MissionError) as caught:
        load(good.replace(case.old, case.new, 1))
    assert str(caught.value) == case.message
