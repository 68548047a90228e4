"""The files of a new plugin, made from the templates."""

from __future__ import annotations

import difflib
import importlib.util
import keyword
import re
import shutil
from importlib.resources import files
from pathlib import Path

from explore_bt.errors import UserError

__all__ = ["KINDS", "check_kind", "check_name", "write_skeleton"]

KINDS = ("driver", "slam", "planner", "controller", "team", "allocator", "behaviour", "sink", "exporter")
"""Kinds with a template: all of them (a test compares), without importing the contracts."""

_USAGE = {
    "driver": "A mission uses it with `driver: {use: my_plugin}`.",
    "slam": "A mission uses it with `slam: {use: my_plugin}`.",
    "planner": "A mission uses it with `planner: {use: my_plugin}`.",
    "controller": "A mission uses it with `controller: {use: my_plugin}`.",
    "team": "A mission of several robots uses it with `team: {use: my_plugin}`.",
    "allocator": "A mission of several robots uses it with `allocator: {use: my_plugin}`.",
    "behaviour": "A mission's tree uses it with `my_plugin: {distance: 2 m}`.",
    "sink": "A run uses it with `explore-bt run MISSION --sink my_plugin`.",
    "exporter": "Every run uses it: its file lies beside the map.",
}

# for our linter, not for the reader's
_LINT_REASON = re.compile(r"  # noqa: \w+  # .*")


def check_kind(kind: str) -> None:
    """Refuse a kind there is no contract for.

    Raises:
        UserError: with the kinds there are.
    """
    if kind not in KINDS:
        close = difflib.get_close_matches(kind, KINDS, n=1)
        hint = f'did you mean "{close[0]}"? ' if close else ""
        raise UserError(f'there is no plugin kind "{kind}"; {hint}Kinds: {", ".join(KINDS)}')


def check_name(kind: str, name: str) -> None:
    """Refuse a name that Python, a mission or another plugin has no room for.

    Raises:
        UserError: with what is wrong and an example.
    """
    example = f"for example my_{kind}"
    if keyword.iskeyword(name) or keyword.issoftkeyword(name):
        raise UserError(f'"{name}" is a word of Python itself; choose another name, {example}')
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
        raise UserError(
            f'"{name}" cannot be a plugin\'s name; '
            f"write small letters, digits and underscores, a letter first, {example}"
        )
    if importlib.util.find_spec(name) is not None:
        raise UserError(f'a Python module "{name}" is installed already; choose another name, {example}')


def write_skeleton(kind: str, name: str, folder: Path) -> list[Path]:
    """Make ``folder`` with module, test, pyproject and README.

    Returns:
        The files, in the order in which to read them.

    Raises:
        UserError: the folder exists, or the one it should lie in does not. Nothing is written then.
    """
    if folder.exists():
        raise UserError(f"{folder} exists already; choose another folder with --out")
    if not folder.parent.is_dir():
        raise UserError(f"there is no folder {folder.parent} to put {folder.name} into; make it first")
    contents = {
        f"{name}.py": _template(f"{kind}.py"),
        "pyproject.toml": _template("texts/pyproject.toml.txt"),
        f"test_{name}.py": _template(f"texts/test_{kind}.txt"),
        "README.md": _template("texts/README.md.txt").replace("my_usage", _USAGE[kind]),
    }
    folder.mkdir()
    try:
        for file, text in contents.items():
            (folder / file).write_text(_renamed(text, kind, name))
    except BaseException:
        shutil.rmtree(folder)
        raise
    return [folder / file for file in contents]


def _template(name: str) -> str:
    return files("explore_bt.cli.templates").joinpath(name).read_text()


def _renamed(text: str, kind: str, name: str) -> str:
    class_name = "".join(part.capitalize() for part in name.split("_"))
    text = _LINT_REASON.sub("", text)
    return text.replace("my_plugin", name).replace("MyPlugin", class_name).replace("my_kind", kind)
