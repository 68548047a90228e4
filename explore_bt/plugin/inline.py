"""A plugin in one file beside the mission, for trying something out."""

from __future__ import annotations

import sys
import zlib
from pathlib import Path
from types import ModuleType

from explore_bt.errors import PluginError
from explore_bt.plugin.hooks import classes_of
from explore_bt.plugin.reasons import line_in
from explore_bt.plugin.registry import Registry

__all__ = ["INLINE_FILE", "load_inline"]

INLINE_FILE = "explore_bt_inline.py"
"""The fixed name; a mission cannot name another, so that no mission file decides which code runs."""


def load_inline(registry: Registry, path: Path) -> None:
    """Run the file and register what its ``explore_bt_register`` returns.

    Raises:
        PluginError: whatever is wrong with it, with file and line.
    """
    file = path.resolve()
    # two missions in one process may each have such a file, and the modules must not meet
    name = f"{path.stem}_{zlib.crc32(str(file).encode()):08x}"
    module = ModuleType(name)
    module.__file__ = str(file)
    # pydantic looks up a class's annotations through its module
    sys.modules[name] = module
    try:
        # compiled here, not imported: nothing is cached in the mission's folder
        exec(compile(file.read_bytes(), str(file), "exec"), module.__dict__)
        registry.add_all(classes_of(module, str(path)), str(path))
    except PluginError as refused:
        del sys.modules[name]
        raise PluginError(f"{path}: {str(refused).removeprefix(f'{path}: ')}") from None
    except (Exception, SystemExit) as raised:  # the author's own file: any fault in it is theirs to see
        del sys.modules[name]
        raise PluginError(_fault(path, file, raised)) from None


def _fault(path: Path, file: Path, raised: BaseException) -> str:
    line = line_in(raised, str(file))
    place = f"{path}:{line}" if line else str(path)
    text = raised.msg if isinstance(raised, SyntaxError) else " ".join(str(raised).split())
    return f"{place}: {type(raised).__name__}: {text}"
