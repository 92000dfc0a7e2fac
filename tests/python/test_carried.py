"""Scripts that files carry: found, proved again, left out."""

from __future__ import annotations

from pathlib import Path

import pytest

import chordal

PLATE = "r = param('r', 0.4)\nbox(2, 2, 1) - cylinder(r, 2)\n"


def carried(path: Path) -> list[dict[str, object]]:
    found = chordal.load(path).inspect()["inspection"]["found"]["certificate"]
    sources: list[dict[str, object]] = found.get("sources", [])
    return sources


@pytest.mark.parametrize("extension", ["glb", "3mf"])
def test_a_file_carries_its_script_and_is_proved_from_it_alone(tmp_path: Path, extension: str) -> None:
    script, out = tmp_path / "plate.star", tmp_path / f"plate.{extension}"
    script.write_text(PLATE)
    chordal.load(script).mesh(rel=0.01).export(out)
    (source,) = carried(out)
    assert (source["name"], source["text"], source.get("parameters", {})) == ("plate.star", PLATE, {})
    script.unlink()
    assert chordal.verify(out)["verdict"] == "re-proved"


def test_no_source_leaves_it_out_of_the_file_and_of_its_report(tmp_path: Path) -> None:
    script, out = tmp_path / "plate.star", tmp_path / "plate.glb"
    script.write_text(PLATE)
    mesh = chordal.load(script).mesh(rel=0.01)
    assert "sources" not in mesh.export(out, no_source=True)["certificate"]
    assert carried(out) == []
    with pytest.raises(chordal.ReadError, match="carries no script"):
        chordal.verify(out)
    # The same mesh still has it.
    assert "sources" in mesh.export(out)["certificate"]
    assert b"cylinder" not in mesh.to_bytes("3mf", no_source=True)
    levels = tmp_path / "levels.glb"
    chordal.load(script).lod(rel=0.01, no_source=True).export(levels)
    assert carried(levels) == []


def test_lib3mf_reads_such_a_file_without_a_warning_and_keeps_the_script(tmp_path: Path) -> None:
    lib3mf = pytest.importorskip("lib3mf")
    script, out, kept = tmp_path / "plate.star", tmp_path / "plate.3mf", tmp_path / "kept.3mf"
    script.write_text(PLATE)
    chordal.load(script).mesh(rel=0.01).export(out)
    model = lib3mf.get_wrapper().CreateModel()
    reader = model.QueryReader("3mf")
    reader.ReadFromFile(str(out))
    assert reader.GetWarningCount() == 0
    model.QueryWriter("3mf").WriteToFile(str(kept))
    assert carried(kept)[0]["text"] == PLATE
