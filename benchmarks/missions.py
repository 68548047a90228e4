"""Runs of a mission through the command line, as a user would, and the table they make."""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

__all__ = ["HEADER", "median_row", "row", "run"]

EXPLORE_BT = Path(sys.executable).with_name("explore-bt")
HEADER = (
    "| run | outcome | coverage | contacts | error rmse | path | closest | mission time | wall time "
    "| home |\n"
    "|---|---|---|---|---|---|---|---|---|---|"
)


def run(mission: Path, out: Path, seed: int, settings: Sequence[str] = ()) -> dict[str, Any]:
    """One headless run; the content of its ``result.json``, or ``{"outcome": message}`` if it left none."""
    command = [EXPLORE_BT, "run", mission, "--headless", "--seed", str(seed), "--out", out]
    for setting in settings:
        command += ["--set", setting]
    process = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    file = out / "result.json"
    if not file.exists():
        return {"outcome": (process.stderr.strip().splitlines() or ["no result"])[-1]}
    result: dict[str, Any] = json.loads(file.read_text())
    return result


def row(name: str, result: dict[str, Any]) -> str:
    """One line of the table."""
    if "coverage" not in result:
        return f"| {name} | {result['outcome']} |" + " |" * 8
    return (
        f"| {name} | {result['outcome']} | {_percent(result['coverage'])} | {result['contacts']:.0f} "
        f"| {_centimetres(result['ate_rmse_m'])} | {result['path_length_m']:.1f} m "
        f"| {result['min_clearance_m']:.2f} m | {_clock(result['mission_time_s'])} "
        f"| {result['wall_time_s']:.0f} s | {_centimetres(result['distance_to_home_m'])} |"
    )


def median_row(results: Sequence[dict[str, Any]]) -> str:
    """The medians of all runs that left a result."""
    whole = [result for result in results if "coverage" in result]
    numbers = [key for key, value in whole[0].items() if isinstance(value, int | float)] if whole else []
    medians = {key: statistics.median(result[key] for result in whole) for key in numbers}
    explored = sum(result["outcome"] == "explored" for result in results)
    return row("**median**", {**medians, "outcome": f"{explored} of {len(results)} explored"})


def _percent(share: float) -> str:
    return f"{100.0 * share:.1f} %"


def _centimetres(metres: float) -> str:
    return f"{100.0 * metres:.1f} cm"


def _clock(seconds: float) -> str:
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"
