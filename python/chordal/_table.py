"""Results as HTML tables for notebooks, without colours, so that they are readable in light and dark themes."""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence


def table(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """A table of titled texts, under a common title."""
    head = f'<caption style="caption-side:top;text-align:left;font-weight:bold;color:inherit">{html.escape(title)}</caption>'
    cells = "".join(f"<tr>{_heading(name, 'row')}{_cell(text)}</tr>" for name, text in rows)
    return f"<table>{head}<tbody>{cells}</tbody></table>"


def columns(title: str, names: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of rows, under the names of the columns."""
    head = f'<caption style="caption-side:top;text-align:left;font-weight:bold;color:inherit">{html.escape(title)}</caption>'
    first = "".join(_heading(name, "col") for name in names)
    cells = "".join("<tr>" + "".join(_cell(text) for text in row) + "</tr>" for row in rows)
    return f"<table>{head}<thead><tr>{first}</tr></thead><tbody>{cells}</tbody></table>"


def _heading(text: str, scope: str) -> str:
    return f'<th scope="{scope}" style="text-align:left">{html.escape(text)}</th>'


def _cell(text: str) -> str:
    return f'<td style="text-align:left">{html.escape(text)}</td>'
