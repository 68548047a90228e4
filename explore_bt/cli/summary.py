"""The last words of a run: how it ended, where the files are."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING

from explore_bt.cli.human import count, duration, percent
from explore_bt.files import RECORDING

if TYPE_CHECKING:
    from explore_bt.types import Result

__all__ = ["summary_lines"]

_MOST = 3
_FILES = (("map", "map.yaml"), ("report", "report.html"), ("recording", RECORDING), ("log", "run.log"))


def summary_lines(result: Result, folder: Path) -> list[tuple[str, str]]:
    """Label and text of each line; figures that nobody knows are left out."""
    lines = [(str(result.outcome), " · ".join(_figures(result)))]
    if result.mocked:
        lines.append(("dry run", f"leaves that a script played: {len(result.mocked)}; no figure counts"))
    lines += [("reason", result.reason)] if result.reason else []
    lines += [("left open", sentence) for sentence in _first(result.left_open)]
    lines += [("not merged", sentence) for sentence in _first(result.not_merged)]
    lines += [(label, str(path)) for label, name in _FILES for path in _files(folder, name)]
    lines += (
        [("replay", f"explore-bt replay {shlex.quote(str(folder))}")] if _files(folder, RECORDING) else []
    )
    return lines


def _first(sentences: tuple[str, ...]) -> list[str]:
    """A handful; all of them are in result.json."""
    rest = len(sentences) - _MOST
    return [*sentences[:_MOST], *([f"and {rest} more, see result.json"] if rest > 0 else [])]


def _files(folder: Path, name: str) -> list[Path]:
    """The file of a single robot, else one per robot in folders of their own."""
    return [folder / name] if (folder / name).is_file() else sorted(folder.glob(f"*/{name}"))


def _figures(result: Result) -> list[str]:
    figures = []
    if result.coverage is not None:
        figures.append(f"{percent(result.coverage)} of the reachable floor")
    figures += [f"{result.path_length_m:.1f} m", duration(result.mission_time_s)]
    if result.contacts is not None:
        figures.append(count(result.contacts, "contact"))
    if result.touched_by_people:
        figures.append(f"touched by people: {result.touched_by_people}")
    if result.min_clearance_m is not None:
        figures.append(f"closest {result.min_clearance_m:.2f} m")
    return [*figures, _home(result.distance_to_home_m)]


def _home(distance_m: float) -> str:
    if distance_m < 0.5:
        return f"home within {distance_m * 100:.0f} cm"
    return f"{distance_m:.1f} m from home"
