"""The rows of a comparison."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from explore_bt.comparison.run_facts import RunFacts
from explore_bt.report import words
from explore_bt.types import Outcome

__all__ = ["Figure", "figures_of"]

_Say = Callable[[float], str]


@dataclass(frozen=True, slots=True)
class Figure:
    """One row.

    Attributes:
        key: its name in ``result.json``; before SLAM's own stands ``slam.``.
        label: what it is about, for people.
        values: one a run, as they stand there; None where a run does not know.
        texts: the same with units.
        differences: against the first run, with sign and unit; empty where there is none to tell.
        differs: whether not all are the same.
    """

    key: str
    label: str
    values: tuple[Any, ...]
    texts: tuple[str, ...]
    differences: tuple[str, ...]
    differs: bool


def _metres(value: float) -> str:
    return words.length(abs(value))


def _share(value: float) -> str:
    """100 % only where nothing at all is missing."""
    return "100 %" if value >= 1.0 else f"{min(abs(value) * 100.0, 99.9):.1f} %"


def _seconds(value: float) -> str:
    return words.duration(abs(value))


def _count(value: float) -> str:
    return words.figure(abs(value))


_ROWS: Sequence[tuple[str, str, _Say]] = (
    ("coverage", "mapped", _share),
    ("path_length_m", "driven", _metres),
    ("mission_time_s", "mission time", _seconds),
    ("contacts", "contacts", _count),
    ("touched_by_people", "touched by people", _count),
    ("min_clearance_m", "closest", _metres),
    ("mean_clearance_m", "mean clearance", _metres),
    ("ate_rmse_m", "pose error, rmse", _metres),
    ("distance_to_home_m", "from home", _metres),
    ("wall_time_s", "computing time", _seconds),
)


def figures_of(runs: Sequence[RunFacts]) -> list[Figure]:
    """Every figure that at least one run knows."""
    results = [_known(run.result) for run in runs]
    rows = [_outcomes(results)]
    rows += [_row(key, label, say, [result.get(key) for result in results]) for key, label, say in _ROWS]
    rows.append(
        _row("left_open", "left open", _count, [len(result.get("left_open") or ()) for result in results])
    )
    slam = [result.get("slam") or {} for result in results]
    for name in dict.fromkeys(name for each in slam for name in each):
        label = f"SLAM: {name.replace('_', ' ')}"
        rows.append(_row(f"slam.{name}", label, _count, [each.get(name) for each in slam]))
    return [row for row in rows if any(value is not None for value in row.values)]


def _known(result: Mapping[str, Any]) -> Mapping[str, Any]:
    """Without the computing time of a cut run, which nobody has recorded."""
    return {**result, "wall_time_s": None} if result.get("outcome") == Outcome.CUT else result


def _outcomes(results: Sequence[Mapping[str, Any]]) -> Figure:
    outcomes = tuple(str(result.get("outcome", "")) for result in results)
    return Figure("outcome", "outcome", outcomes, outcomes, ("",) * len(outcomes), len(set(outcomes)) > 1)


def _row(key: str, label: str, say: _Say, values: Sequence[Any]) -> Figure:
    numbers = [float(value) if isinstance(value, int | float) else None for value in values]
    texts = tuple(words.NOBODY_KNOWS if number is None else say(number) for number in numbers)
    differences = tuple(
        "" if text == texts[0] else _difference(say, numbers[0], number)
        for text, number in zip(texts, numbers, strict=True)
    )
    return Figure(key, label, tuple(values), texts, differences, len(set(texts)) > 1)


def _difference(say: _Say, first: float | None, number: float | None) -> str:
    if first is None or number is None:
        return ""
    sign = "+" if number > first else "−"
    return f"{sign}{say(number - first)}"
