"""The few shapes that the report's page is made of."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

__all__ = ["section", "table"]


def table(
    head: Sequence[str], rows: Iterable[Sequence[str]], classes: str = "", row_classes: Sequence[str] = ()
) -> str:
    """A table of cells that are HTML already; with a class for every row if there are any."""
    marks = [f' class="{name}"' for name in row_classes]
    body = "".join(
        f"<tr{marks[index] if marks else ''}>" + "".join(f"<td>{cell}</td>" for cell in row) + "</tr>"
        for index, row in enumerate(rows)
    )
    names = "".join(f"<th>{escape(name)}</th>" for name in head)
    whole = f'<table class="{classes}"><thead><tr>{names}</tr></thead><tbody>{body}</tbody></table>'
    return f'<div class="scroll">{whole}</div>'


def section(title: str, content: str, note: str = "") -> str:
    """A titled part of the page."""
    aside = f" <span>{escape(note)}</span>" if note else ""
    return f"<section><h2>{escape(title)}{aside}</h2>{content}</section>"
