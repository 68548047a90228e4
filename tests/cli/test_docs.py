"""The docs hold true: commands, options, missions and plugin kinds in them exist, code blocks run."""

from __future__ import annotations

import inspect
import re
import shlex
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from explore_bt import testing
from explore_bt.cli import app
from explore_bt.cli.places import shipped_missions
from explore_bt.cli.skeleton import write_skeleton
from explore_bt.plugin import INLINE_FILE, KINDS, Registry
from explore_bt.plugin.checks import CONTRACTS
from explore_bt.plugin.inline import load_inline
from explore_bt.tree import Leaf

ROOT = Path(__file__).parents[2]
DOCS = [*sorted((ROOT / "docs").glob("*.md")), ROOT / "README.md", ROOT / "examples/hello_plugin/README.md"]
DOCS = [path for path in DOCS if path.is_file()]
PLUGINS = (ROOT / "docs" / "plugins.md").read_text()
CLI = (ROOT / "docs" / "cli.md").read_text()

COMMAND = re.compile(r"explore-bt ([a-z][a-z0-9-]*)((?: [^`\n|]*)?)")


def commands_in(path: Path) -> list[tuple[str, list[str]]]:
    """Each ``explore-bt command words...`` in code: indented, or in backticks."""
    text = path.read_text()
    code = re.findall(r"^ {4,}(.*)$", text, re.MULTILINE) + re.findall(r"`([^`\n]+)`", text)
    found = [
        match for line in code for match in COMMAND.findall(line) if line.lstrip().startswith("explore-bt ")
    ]
    return [(command, words.split("#")[0].split()) for command, words in found]


def help_of(command: str) -> str:
    return CliRunner().invoke(app, [command, "--help"]).stdout


@pytest.mark.parametrize("path", DOCS, ids=lambda path: path.name)
def test_commands_and_options_in_the_docs_exist(path):
    known = {command: help_of(command) for command, _ in commands_in(path)}
    for command, words in commands_in(path):
        assert "Usage: explore-bt" in known[command], f"{path.name}: there is no command {command}"
        for option in (word.split("=")[0] for word in words if re.fullmatch(r"--?[a-z][\w=-]*", word)):
            assert re.search(rf"(^|\s){option}\b", known[command]), f"{path.name}: {command} has no {option}"


@pytest.mark.parametrize("path", DOCS, ids=lambda path: path.name)
def test_missions_in_the_docs_are_shipped(path):
    named = {
        words[0] for command, words in commands_in(path) if command in ("run", "check", "show") and words
    }
    numbered = {name for name in named if re.fullmatch(r"\d\d_\w+", name)}
    assert numbered <= set(shipped_missions())


def test_the_docs_of_the_command_line_name_every_command_and_every_option_of_run():
    listed = CliRunner().invoke(app, ["--help"]).stdout.split("Commands:\n")[1].split("\n\n")[0]
    for command in (line.split()[0] for line in listed.splitlines()):
        assert f"`explore-bt {command}" in CLI
    for option in re.findall(r"--[a-z]+", help_of("run").split("Options:")[1].split("Example")[0]):
        assert f"`{option}" in CLI.replace(", `--help`", ", `--help") or option == "--help", option


@pytest.mark.parametrize("kind", KINDS)
def test_the_docs_of_plugins_name_every_method_of_every_kind(kind):
    section = re.split(r"^##+ ", PLUGINS.split(f"### {kind}:")[1], flags=re.MULTILINE)[0]
    contract = CONTRACTS[kind]
    methods = [
        name for name, member in vars(contract).items() if inspect.isfunction(member) and name[0] != "_"
    ]
    lifecycle = ["initialise", "update", "terminate"]
    missing = [name for name in (lifecycle if contract is Leaf else methods) if f"`{name}" not in section]
    assert missing == []


def test_the_five_lines_of_toml_are_those_of_the_skeleton(tmp_path):
    write_skeleton("slam", "my_slam", tmp_path / "my_slam")
    written = tomllib.loads((tmp_path / "my_slam" / "pyproject.toml").read_text())["project"]
    (shown,) = re.findall(r"```toml\n(.*?)```", PLUGINS, re.DOTALL)
    assert len([line for line in shown.splitlines() if line]) == 5
    assert {**written, **tomllib.loads(shown)["project"]} == written


def test_the_inline_plugin_of_the_docs_is_one(tmp_path):
    inline = next(code for code in python_blocks() if "FarFromHome" in code)
    (tmp_path / INLINE_FILE).write_text(inline)
    registry = Registry()
    load_inline(registry, tmp_path / INLINE_FILE)
    assert registry.names("behaviour") == ("far_from_home",)


def test_the_code_blocks_run():
    for code in python_blocks():
        exec(compile(code, "docs/plugins.md", "exec"), {"__name__": "docs"})


def test_the_contract_suites_named_in_the_docs_exist():
    for name in re.findall(r"`(\w+Contract)`", PLUGINS):
        assert hasattr(testing, name)


def python_blocks() -> list[str]:
    return re.findall(r"```python\n(.*?)```", PLUGINS, re.DOTALL)


def test_example_lines_can_be_typed_into_a_shell():
    for path in DOCS:
        for line in re.findall(r"^ {4}(explore-bt .*)$", path.read_text(), re.MULTILINE):
            assert shlex.split(line)[0] == "explore-bt"
