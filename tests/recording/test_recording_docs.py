from __future__ import annotations

import re
from pathlib import Path

import pytest

from explore_bt.recording import TOPICS, McapRecorder, read_recording

PAGE = (Path(__file__).parents[2] / "docs" / "recording.md").read_text()


def test_the_table_of_topics_is_the_recorders_own():
    rows = re.findall(r"^\| `([^`]+)` \| `([^`]+)` \| (.+) \|$", PAGE, re.MULTILINE)
    assert rows == [(topic.pattern, topic.schema, topic.rate) for topic in TOPICS]


def test_every_topic_of_the_table_is_really_written_and_no_other(recorded_drive):
    recording = read_recording(recorded_drive.run.folder / "recording.mcap")
    written = {message.topic for message in recording.messages()}
    assert written == {topic.of("robot") for topic in TOPICS}


def test_the_options_on_the_page_have_their_true_defaults():
    assert "`clouds` (off)" in PAGE
    assert McapRecorder.Options.model_fields["clouds"].default is False
    for name, field in McapRecorder.Options.model_fields.items():
        if name == "clouds":
            continue
        told = re.search(rf"`{name}` \(([\d.]+) s\)", PAGE)
        assert told, name
        assert float(told[1]) == field.default


@pytest.mark.parametrize("example", re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL))
def test_the_python_example_runs(example, recorded_drive, monkeypatch, capsys):
    monkeypatch.chdir(recorded_drive.run.folder)
    exec("\n".join(line.removeprefix("  ") for line in example.splitlines()), {})
    assert "01_apartment ('robot',)" in capsys.readouterr().out
