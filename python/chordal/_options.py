"""Keyword arguments as options of the command, which is how the compiled part takes them."""

from __future__ import annotations

from collections.abc import Mapping

from chordal._arguments import number, text, whole

#: An option, the keyword that it came from, and the text of its value.
Option = tuple[str, str, str]


def options(table: Mapping[str, tuple[str, str]], **given: object) -> list[Option]:
    """The options for the keywords that were given: flags that are true, and other values that are not None."""
    return [
        (table[keyword][0], keyword, _text_of(keyword, table[keyword][1], value))
        for keyword, value in given.items()
        if (bool(value) if table[keyword][1] == "flag" else value is not None)
    ]


def _text_of(keyword: str, form: str, value: object) -> str:
    """The value as the command reads it. The compiled part judges it."""
    if form == "flag":
        return ""
    if form == "count":
        return str(whole(keyword, value, least=0))
    if form == "number":
        return repr(number(keyword, value))
    if form in ("length", "time") and not isinstance(value, str):
        return repr(number(keyword, value)) + ("s" if form == "time" else "")
    return text(keyword, value) or ""  # type: ignore[arg-type]
