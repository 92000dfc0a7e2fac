"""Reports name settings as Python spells them, whatever the verb; files keep the words of the command."""

from __future__ import annotations

import json
from pathlib import Path

import chordal


def test_reports_of_all_verbs_name_keywords(tmp_path: Path) -> None:
    ball = tmp_path / "ball.vm"
    ball.write_text("x var-x\ny var-y\nz var-z\nxx square x\nyy square y\nzz square z\na add xx yy\nb add a zz\nc const 0.5\nd sub b c\n")
    shape = chordal.load(ball)
    reports = {
        "inspect": shape.inspect(),
        "mesh": shape.mesh(rel=0.02).report,
        "lod": shape.lod(rel=0.02).report,
        "bake": shape.bake(cells=8).report,
    }
    for verb, report in reports.items():
        text = json.dumps(report)
        assert "within() sets another region" in text, verb
        assert "--region" not in text, verb
