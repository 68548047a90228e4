"""The tables and pictures of an exploration benchmark, made of its rows."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from exploration_runs import Store
from matplotlib.lines import Line2D

mpl.use("Agg")
from matplotlib import pyplot as plt  # the backend is chosen first

__all__ = ["per_map", "per_strategy", "write_plots"]

Row = dict[str, Any]
_HEAD = (
    "| {first} | runs | done | ≥ 99 % | coverage, least | 90 %: path / tour | 95 % | 99 % "
    "| 95 %: path / set cover | whole path "
    "| mean clearance (bound) | closest | contacts | turning | goal changes | at 3 min | decision, p99 |\n"
    "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|"
)


def per_strategy(rows: Sequence[Row]) -> str:
    """One line a strategy: medians over all its runs; lengths over the tour's."""
    return _table("strategy", rows, lambda row: str(row["strategy"]))


def per_map(rows: Sequence[Row]) -> str:
    """One line a map and strategy."""
    return _table("map, strategy", rows, lambda row: f"{row['map']}, {row['strategy']}")


def _table(first: str, rows: Sequence[Row], name: Callable[[Row], str]) -> str:
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(name(row), []).append(row)
    return "\n".join([_HEAD.format(first=first), *(_line(each, groups[each]) for each in sorted(groups))])


def _line(name: str, rows: Sequence[Row]) -> str:
    whole = [row for row in rows if "coverage" in row]
    if not whole:
        return f"| {name} | {len(rows)} | {rows[0]['outcome']} |" + " |" * 14
    finished = sum(row["finished"] for row in whole)
    complete = sum(row["coverage"] >= 0.99 for row in whole)
    metres = sum(row["path_m"] for row in whole)
    cells = [
        name,
        f"{len(rows)}",
        f"{finished}",
        f"{complete}",
        f"{100 * min(row['coverage'] for row in whole):.1f} %",
        *(_ratio(whole, f"ratio_{share}") for share in (90, 95, 99)),
        _ratio(whole, "set_cover_ratio_95"),
        f"{statistics.median(row['path_m'] for row in whole):.0f} m",
        f"{_mean(whole, 'mean_clearance_m'):.2f} m ({_mean(whole, 'clearance_bound_m'):.2f})",
        f"{min(row['min_clearance_m'] for row in whole):.3f} m",
        f"{sum(row['contacts'] for row in whole)}",
        f"{sum(row['turning_rad'] for row in whole) / max(metres, 1.0):.2f} rad/m",
        f"{_mean(whole, 'goal_changes_per_100m'):.1f} / 100 m",
        f"{100 * _mean(whole, 'coverage_at_180_s'):.1f} %",
        f"{statistics.median(row['decision_ms_median'] for row in whole):.0f}, "
        f"{max(row['decision_ms_p99'] for row in whole):.0f} ms",
    ]
    return "| " + " | ".join(cells) + " |"


def _ratio(rows: Sequence[Row], key: str) -> str:
    """The median over all runs, those that never get there counting as the worst, and how many get there."""
    there = sorted(row[key] for row in rows if row.get(key) is not None)
    if not there:
        return f"–, 0/{len(rows)}"
    padded = [*there, *[float("inf")] * (len(rows) - len(there))]
    return f"{statistics.median(padded):.2f}, {len(there)}/{len(rows)}"


def _mean(rows: Sequence[Row], key: str) -> float:
    return statistics.fmean(row.get(key) or 0.0 for row in rows)


def write_plots(store: Store, stem: Path) -> list[Path]:
    """``stem_distance.png`` and ``stem_time.png``: coverage, one panel a map, one line a run."""
    rows = [row for row in store.rows if "coverage" in row]
    return [
        _plot(store, rows, column, label, stem.with_name(f"{stem.name}_{name}.png"))
        for name, column, label in (("distance", 0, "driven, m"), ("time", 1, "time, s"))
    ]


def _plot(store: Store, rows: Sequence[Row], column: int, label: str, file: Path) -> Path:
    maps = sorted({row["map"] for row in rows})
    strategies = sorted({row["strategy"] for row in rows})
    across = min(3, len(maps)) or 1
    down = -(-len(maps) // across) or 1
    size = (5.2 * across, 3.6 * down)
    figure, axes = plt.subplots(down, across, figsize=size, squeeze=False, layout="constrained")
    for panel, name in zip(axes.flat, maps, strict=False):
        for number, strategy in enumerate(strategies):
            style = {"color": f"C{number}", "lw": 1.0, "alpha": 0.8, "label": strategy}
            for row in (row for row in rows if (row["map"], row["strategy"]) == (name, strategy)):
                curve = store.curve(row)["curve"]
                panel.plot(curve[:, column], 100 * curve[:, 2], **style)
                style["label"] = "_one more run"
        tours = [row["tour_m"] for row in rows if row["map"] == name and "tour_m" in row]
        if tours and column == 0:
            lengths = np.array([[tour[share] or np.nan for share in tour] for tour in tours], dtype=float)
            shares = [100 * float(share) for share in tours[0]]
            lengths = lengths[:, ~np.isnan(lengths).all(axis=0)]
            panel.plot(np.nanmean(lengths, axis=0), shares[: lengths.shape[1]], "k.--", label="tour, mean")
        panel.set(title=name, xlabel=label, ylabel="coverage, %", ylim=(0, 101), xlim=(0, None))
        panel.grid(alpha=0.3)
    for panel in axes.flat[len(maps) :]:
        panel.set_axis_off()
    lines: dict[str, Line2D] = {}
    for panel in axes.flat:
        lines.update(zip(*panel.get_legend_handles_labels()[::-1], strict=True))
    figure.legend(lines.values(), lines, loc="outside lower center", ncols=len(lines) or 1, frameon=False)
    figure.savefig(file, dpi=110)
    plt.close(figure)
    return file
