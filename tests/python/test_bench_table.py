"""The tables of the quick bench say what its numbers say."""

from __future__ import annotations

import importlib.util
import json
from types import ModuleType

from conftest import ROOT


def front_table() -> ModuleType:
    spec = importlib.util.spec_from_file_location("front_table", ROOT / "bench" / "front_table.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_readme_and_results_hold_the_table_of_the_last_quick_bench() -> None:
    assert front_table().stale() == []


def test_a_changed_number_makes_the_tables_stale() -> None:
    table = front_table()
    result = json.loads(table.RESULT.read_text(encoding="utf-8"))
    line = next(line for line in result["lines"] if not line["skipped"])
    before = table.long(result)
    line["ours"], line["passed"] = 1e9, not line["passed"]
    assert table.long(result) != before


def test_what_is_skipped_is_not_kept() -> None:
    result = json.loads(front_table().RESULT.read_text(encoding="utf-8"))
    for line in result["lines"]:
        assert not (line["skipped"] and line["passed"])
        if not line["skipped"]:
            assert line["passed"] == (line["ratio"] <= line["limit"])


def test_lines_behind_their_peers_are_counted() -> None:
    table = front_table()
    line = {"what": "a", "peer": "P", "ours": 3.0, "theirs": 2.0, "skipped": None}
    others = [{**line, "what": "b", "ours": 8.0}, {**line, "what": "c", "ours": 1.0}, {**line, "what": "d", "theirs": None}]
    skipped = {**line, "what": "e", "skipped": "not there"}
    assert table.behind({"lines": [line, *others, skipped]}) == "In 2 of 3 lines the peer has less."
    assert table.behind({"lines": others[1:]}) == "In 0 of 1 lines the peer has less."
