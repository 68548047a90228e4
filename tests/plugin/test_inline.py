from __future__ import annotations

import sys
import textwrap

import pytest

from explore_bt.errors import PluginError
from explore_bt.plugin import INLINE_FILE, Registry
from explore_bt.plugin.inline import load_inline

SOUND = """\
from __future__ import annotations

from explore_bt import hookimpl
from explore_bt.interfaces import API_VERSION, PluginOptions, Sink
from explore_bt.units import Duration


class Quiet(Sink):
    '''Says nothing.'''

    name = "quiet"
    api_version = API_VERSION

    class Options(PluginOptions):
        pause: Duration = 2.0

    def open(self, run): ...
    def on_tick(self, tick): ...
    def close(self, result): ...


@hookimpl
def explore_bt_register():
    return [Quiet]
"""


def load(folder, code: str) -> Registry:
    path = folder / INLINE_FILE
    path.write_text(textwrap.dedent(code))
    registry = Registry()
    load_inline(registry, path)
    return registry


def refusal(folder, code: str) -> str:
    with pytest.raises(PluginError) as refused:
        load(folder, code)
    return str(refused.value)


def test_the_file_beside_the_mission_is_a_plugin_and_its_path_the_origin(tmp_path):
    (entry,) = load(tmp_path, SOUND).entries()
    assert (entry.kind, entry.name, entry.origin) == ("sink", "quiet", str(tmp_path / INLINE_FILE))


def test_options_with_units_work_in_an_inline_plugin(tmp_path):
    quiet = load(tmp_path, SOUND).get("sink", "quiet")
    assert quiet.Options(pause="500 ms").pause == 0.5


def test_two_inline_plugins_in_one_process_do_not_meet(tmp_path):
    folders = [tmp_path / "a", tmp_path / "b"]
    for folder in folders:
        folder.mkdir()
    first, second = (load(folder, SOUND).get("sink", "quiet") for folder in folders)
    assert first is not second
    assert first.__module__ != second.__module__


def test_nothing_is_left_in_the_missions_folder(tmp_path):
    load(tmp_path, SOUND)
    assert [path.name for path in tmp_path.iterdir()] == [INLINE_FILE]


def test_a_syntax_error_is_told_with_file_and_line(tmp_path):
    assert refusal(tmp_path, "x = 1\ndef f(:\n") == f"{tmp_path / INLINE_FILE}:2: SyntaxError: invalid syntax"


def test_an_exception_is_told_with_the_line_in_the_file_where_it_passed(tmp_path):
    assert refusal(tmp_path, "import json\n\njson.loads('{')\n").startswith(
        f"{tmp_path / INLINE_FILE}:3: JSONDecodeError: Expecting property name"
    )


def test_a_raising_hook_is_told_with_file_and_line(tmp_path):
    code = """\
        from explore_bt import hookimpl

        @hookimpl
        def explore_bt_register():
            raise ValueError("not today")
    """
    assert refusal(tmp_path, code) == f"{tmp_path / INLINE_FILE}:5: ValueError: not today"


def test_a_missing_hook_is_told_with_the_file(tmp_path):
    assert refusal(tmp_path, "x = 1\n") == (
        f"{tmp_path / INLINE_FILE}: registers nothing: define explore_bt_register() and mark it with "
        "@explore_bt.hookimpl"
    )


def test_a_refused_class_is_told_with_the_file_once(tmp_path):
    code = """
        from explore_bt import hookimpl

        @hookimpl
        def explore_bt_register():
            return [int]
    """
    assert refusal(tmp_path, code).startswith(f"{tmp_path / INLINE_FILE}: int has no kind; derive it from")


def test_a_broken_file_leaves_no_module_behind(tmp_path):
    before = set(sys.modules)
    refusal(tmp_path, "1 / 0\n")
    assert set(sys.modules) == before
