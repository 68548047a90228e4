"""What makes runs hard to compare, said before anybody reads a figure."""

from __future__ import annotations

from collections.abc import Sequence

from explore_bt.comparison.run_facts import RunFacts

__all__ = ["notes_on"]


def notes_on(runs: Sequence[RunFacts]) -> list[str]:
    """One sentence for every way in which these are not runs of the same thing."""
    notes = []
    if different := _different(runs, "mission"):
        notes.append(f"different missions: {different}")
    elif len({run.result.get("mission_sha256") for run in runs}) > 1:
        notes.append("the same mission, but its text or parameters differ")
    if different := _different(runs, "seed"):
        notes.append(f"different seeds: {different}")
    if different := _different(runs, "version"):
        notes.append(f"different versions of explore-bt: {different}")
    notes += [f"{run.name}: {run.damage}; its figures count up to there" for run in runs if _is_cut(run)]
    return notes


def _is_cut(run: RunFacts) -> bool:
    return bool(run.damage) and run.result.get("outcome") == "cut"


def _different(runs: Sequence[RunFacts], key: str) -> str:
    values = [str(run.result.get(key)) for run in runs]
    return ", ".join(values) if len(set(values)) > 1 else ""
