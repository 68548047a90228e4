"""Runs side by side on one page that opens in any browser, without a network."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from importlib.resources import files

from explore_bt.comparison.figures import Figure, figures_of
from explore_bt.comparison.notes import notes_on
from explore_bt.comparison.pictures import Extent, difference_svg, extent_of, map_svg
from explore_bt.comparison.run_facts import RunFacts
from explore_bt.report import words
from explore_bt.types import Outcome

__all__ = ["comparison_page"]


def comparison_page(runs: Sequence[RunFacts]) -> str:
    """The whole page as HTML text: notes, figures, maps in one scale and one frame."""
    values = {
        "title": escape(" · ".join(run.name for run in runs)),
        "style": _asset("report.css") + _asset("compare.css"),
        "count": str(len(runs)),
        "notes": "".join(f"<li>{escape(note)}</li>" for note in notes_on(runs)),
        "table": _table(runs, figures_of(runs)),
        "maps": _maps(runs),
    }
    head, *rest = _asset("compare.html").split("{{")
    filled = [head]
    for part in rest:  # one pass, so that nothing inside a value is taken for a place to fill
        name, _, text = part.partition("}}")
        filled += [values[name], text]
    return "".join(filled)


def _asset(name: str) -> str:
    return (files("explore_bt.report") / "assets" / name).read_text(encoding="utf-8")


def _table(runs: Sequence[RunFacts], figures: Sequence[Figure]) -> str:
    names = "".join(f"<th>{escape(run.name)}</th>" for run in runs)
    rows = []
    for figure in figures:
        cells = "".join(
            f"<td>{escape(text)}{f'<span>{escape(difference)}</span>' if difference else ''}</td>"
            for text, difference in zip(figure.texts, figure.differences, strict=True)
        )
        rows.append(f'<tr class="{"differs" if figure.differs else ""}"><th>{figure.label}</th>{cells}</tr>')
    return f"<table><thead><tr><th></th>{names}</tr></thead><tbody>{''.join(rows)}</tbody></table>"


def _maps(runs: Sequence[RunFacts]) -> str:
    grids = [run.grid for run in runs if run.grid is not None]
    if not grids:
        return "<p>None of these runs has left a map.</p>"
    extent = extent_of(grids)
    panes = [_pane(run, extent) for run in runs]
    if len(grids) == 2 and len(runs) == 2:
        names = (escape(run.name) for run in runs)
        keys = "".join(
            f'<li><i class="{mark}"></i>only {name} knows</li>'
            for mark, name in zip("ab", names, strict=True)
        )
        keys += '<li><i class="c"></i>they disagree</li>'
        panes.append(
            f"<figure><figcaption>Where they differ</figcaption>{difference_svg(grids[0], grids[1], extent)}"
            f'<ul class="key">{keys}</ul></figure>'
        )
    return "".join(panes)


def _pane(run: RunFacts, extent: Extent) -> str:
    outcome = str(run.result.get("outcome", ""))
    known = words.outcome_words(Outcome(outcome)) if outcome in set(Outcome) else outcome
    picture = map_svg(run.grid, run.ways, extent) if run.grid is not None else "<p>no map</p>"
    badge = f'<span class="outcome {escape(outcome)}">{escape(known)}</span>'
    return f"<figure><figcaption>{escape(run.name)} {badge}</figcaption>{picture}</figure>"
