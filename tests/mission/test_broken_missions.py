"""Every broken mission of ``broken/*.txt`` gives exactly the message that stands below it.

One entry: ``### title``, ``- text of the good mission``, ``+ what stands there instead``, the message.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from explore_bt.mission import MissionError


def _cases() -> list[object]:
    cases = []
    for file in sorted((Path(__file__).parent / "broken").glob("*.txt")):
        for block in file.read_text().split("### ")[1:]:
            title, old, new, message = block.split("\n", 3)
            texts = (_text(old), _text(new), message.rstrip("\n"))
            cases.append(pytest.param(*texts, id=f"{file.stem}: {title}"))
    return cases


def _text(line: str) -> str:
    return line[2:].replace("\\n", "\n").replace("\\t", "\t")


def test_the_table_is_large() -> None:
    assert len(_cases()) > 100


@pytest.mark.parametrize(("old", "new", "message"), _cases())
def test_a_broken_mission_says_exactly_what_is_wrong(load, good, old, new, message) -> None:
    assert old in good
    with pytest.raises(MissionError) as caught:
        load(good.replace(old, new, 1))
    assert str(caught.value) == message
