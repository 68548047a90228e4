"""Distributions made on the spot: a folder with dist-info, as pip leaves it."""

from __future__ import annotations

import textwrap
from importlib.metadata import EntryPoint, distributions
from pathlib import Path

import pytest

LEAF = """
    from explore_bt import hookimpl
    from explore_bt.tree import Leaf, Status


    class {cls}(Leaf):
        '''Waits no longer.'''

        type_key = "{key}"

        def update(self):
            return Status.SUCCESS


    @hookimpl
    def explore_bt_register():
        return [{cls}]
"""


class Site:
    """A folder on ``sys.path`` with distributions in it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def install(self, name: str, module: str, code: str, requires: str = "") -> None:
        info = self.folder / f"{name}-1.2.dist-info"
        info.mkdir()
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.2\n{requires}")
        (info / "entry_points.txt").write_text(f"[explore_bt]\n{name}-entry = {module}\n")
        (self.folder / f"{module}.py").write_text(textwrap.dedent(code))

    def install_leaf(self, name: str, module: str, key: str) -> None:
        self.install(name, module, textwrap.dedent(LEAF).format(cls="Ready", key=key))

    @property
    def entry_points(self) -> list[EntryPoint]:
        return [each for found in distributions(path=[str(self.folder)]) for each in found.entry_points]


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Site:
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(folder)
    return Site(folder)
