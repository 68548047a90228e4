from __future__ import annotations

import importlib
import sys
from importlib.metadata import entry_points

import pytest
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.interfaces import Sink
from explore_bt.plugin import load_plugins


@pytest.mark.parametrize("name", ["foxglove", "rerun"])
def test_without_its_library_a_sink_is_left_out_with_the_line_to_type(name, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda module: None if module == name else module)
    monkeypatch.delitem(sys.modules, f"explore_bt_sinks.{name}", raising=False)
    if not any(each.name == name for each in entry_points(group="explore_bt")):
        pytest.fail("the entry point is missing: install the project anew")
    told = CliRunner().invoke(app, ["plugins", "--kind", "sink"]).stdout
    assert f'type pip install "explore-bt[{name}]"' in told
    assert "mcap" in told
    refused = CliRunner().invoke(app, ["run", "00_room", "--sink", name])
    assert refused.exit_code == 2


@pytest.mark.parametrize(("name", "key", "value"), [("foxglove", "port", "0"), ("rerun", "to", "file")])
def test_options_of_a_sink_are_given_behind_its_name(name, key, value):
    from explore_bt.cli.sinks import make_sinks

    *_, sink = make_sinks(load_plugins().registry, [f"{name},{key}={value}"])
    assert isinstance(sink, Sink)
    assert str(getattr(sink.options, key)) == value


def test_a_wrong_option_of_a_sink_is_told():
    refused = CliRunner().invoke(app, ["run", "00_room", "--sink", "rerun,to=fiel"])
    assert refused.exit_code == 2
    assert 'did you mean "file"?' in refused.stderr


def test_loading_the_plugins_does_not_import_what_takes_seconds():
    for name in ("foxglove", "rerun"):
        module = importlib.import_module(f"explore_bt_sinks.{name}")
        assert not hasattr(module, name)
