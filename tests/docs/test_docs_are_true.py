"""What the documentation says holds: missions and worlds load, links lead somewhere, tables are complete."""

from __future__ import annotations

import importlib.util
import re
import shutil
from dataclasses import fields
from pathlib import Path
from types import ModuleType

import pytest
from explore_bt_drivers.world.shapes import SHAPES
from explore_bt_drivers.world.world_file import _KEYS as WORLD_KEYS
from explore_bt_drivers.world.world_file import read_world_file
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.interfaces import PluginOptions
from explore_bt.mission import CONTROL_NODES, MODIFIERS, load_mission
from explore_bt.mission.files import MISSION_KEYS
from explore_bt.mission.limits import LimitsModel, TickModel
from explore_bt.mission.params import PARAM_KEYS, PARAM_TYPES, PLUGIN_KINDS
from explore_bt.mission.robots import ROBOT_KEYS
from explore_bt.plugin import load_plugins
from explore_bt.types import Outcome, Result
from explore_bt.units import Dimension

ROOT = Path(__file__).parents[2]
MISSIONS = ROOT / "missions"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
MISSION_PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
PAGE = (ROOT / "docs" / "missions.md").read_text(encoding="utf-8")
DECISIONS = ROOT / "docs" / "decisions"


def blocks(path: Path, begin: str) -> list[str]:
    """The YAML blocks of a page that begin with a line."""
    found = re.findall(r"^```yaml\n(.*?)^```", path.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    return [block for block in found if block.startswith((f"{begin}\n", f"{begin} "))]


def cases(begin: str) -> list[object]:
    return [
        pytest.param(block, id=f"{path.name}-{number}")
        for path in MISSION_PAGES
        for number, block in enumerate(blocks(path, begin), start=1)
    ]


def section(title: str) -> str:
    """The text under one heading of missions.md, up to the next heading."""
    return re.split(r"^#+ ", PAGE.split(f"# {title}\n", maxsplit=1)[1], flags=re.MULTILINE)[0]


def first_cells(text: str) -> set[str]:
    """Every word in backticks in the first column of the tables of a text."""
    rows = re.findall(r"^\| (`[^|]+) \|", text, re.MULTILINE)
    return {word for row in rows for word in re.findall(r"`([^`]+)`", row)}


def anchors(path: Path) -> set[str]:
    headings = re.findall(r"^#+ (.+)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.fixture
def missions(tmp_path: Path) -> Path:
    """A copy of the folder of missions, to write into."""
    return Path(shutil.copytree(MISSIONS, tmp_path / "missions"))


@pytest.fixture(scope="module")
def generate() -> ModuleType:
    spec = importlib.util.spec_from_file_location("generate", ROOT / "docs" / "generate.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("text", cases("format: explore-bt/1"))
def test_a_mission_in_the_docs_is_without_a_fault(text: str, missions: Path) -> None:
    path = missions / "from_the_docs.yaml"
    path.write_text(text, encoding="utf-8")
    assert load_mission(path, load_plugins().registry).robots


@pytest.mark.parametrize("text", cases("format: explore-bt-world/1"))
def test_a_world_in_the_docs_is_without_a_fault(text: str, tmp_path: Path) -> None:
    path = tmp_path / "world.yaml"
    path.write_text(text, encoding="utf-8")
    assert read_world_file(path).solids


def test_the_page_of_missions_has_a_mission_and_a_world() -> None:
    page = ROOT / "docs" / "missions.md"
    assert blocks(page, "format: explore-bt/1")
    assert blocks(page, "format: explore-bt-world/1")


def test_the_fault_on_the_page_is_what_check_says(missions: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (snippet,) = blocks(ROOT / "docs" / "missions.md", "# missions/mine.yaml")
    (shown,) = re.findall(r"^```text\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
    (missions / "mine.yaml").write_text(snippet, encoding="utf-8")
    monkeypatch.chdir(missions.parent)
    run = CliRunner().invoke(app, ["check", "missions/mine.yaml"])
    assert run.exit_code == 2
    assert run.stderr == shown


@pytest.mark.parametrize("path", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_every_link_leads_to_a_file(path: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", path.read_text(encoding="utf-8")):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        file = (path.parent / name).resolve() if name else path
        assert file.exists(), f"{path.name} links to {target}, which is not there"
        if anchor and file.suffix == ".md":
            assert anchor in anchors(file), f"{path.name} links to {target}; {file.name} has no such heading"


def test_the_section_of_leaves_is_made_from_the_leaves(generate: ModuleType) -> None:
    assert generate.rewritten(PAGE) == PAGE, "docs/missions.md is behind its leaves: python docs/generate.py"


def test_every_decision_is_listed() -> None:
    listed = re.findall(r"\]\(([^)]+\.md)\)", (DECISIONS / "README.md").read_text(encoding="utf-8"))
    assert sorted(listed) == sorted(path.name for path in DECISIONS.glob("*.md") if path.name != "README.md")


@pytest.mark.parametrize(
    ("title", "known"),
    [
        ("Top-level keys", {*MISSION_KEYS}),
        ("Parameters", {*PARAM_KEYS, *PARAM_TYPES}),
        ("Robots", {*ROBOT_KEYS}),
        ("Limits and ticks", {*LimitsModel.model_fields, *TickModel.model_fields}),
        ("Control nodes", {*CONTROL_NODES}),
        ("Modifiers", {*MODIFIERS}),
        ("Worlds", {"format", *WORLD_KEYS}),
        ("What a run leaves", {field.name for field in fields(Result)}),
    ],
)
def test_a_table_names_every_key_and_no_other(title: str, known: set[str]) -> None:
    told = {word for word in first_cells(section(title)) if not re.search(r"(\.\w{2,4}|/)$", word)}
    assert told - {"result.json"} == known


def test_the_units_on_the_page_are_those_that_are_understood() -> None:
    for name, type_ in PARAM_TYPES.items():
        dimension = next((x for x in getattr(type_, "__metadata__", ()) if isinstance(x, Dimension)), None)
        if dimension is not None:
            (told,) = re.findall(rf"^\| `{name}` \| [^|]+ \| ([^|]+) \|$", PAGE, re.MULTILINE)
            assert told.split(", ") == [unit for unit, _ in dimension.factors]


def test_the_page_names_every_kind_shape_and_outcome() -> None:
    for word in (*PLUGIN_KINDS, *SHAPES, *map(str, Outcome)):
        assert re.search(rf"`{word}\b", PAGE), word


def test_the_rates_on_the_page_are_the_defaults() -> None:
    defaults: type[PluginOptions] = TickModel
    for name, field in defaults.model_fields.items():
        assert f"| `{name}` | {field.default:g} Hz |" in section("Limits and ticks")
