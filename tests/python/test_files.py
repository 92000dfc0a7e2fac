"""Files: what is no file, what is wrong in one, and one that is replaced as a whole or not at all."""

from __future__ import annotations

import json
import os
import pickle
import stat
from pathlib import Path

import pytest
from conftest import SQUARE, TEAPOT

import chordal


def test_a_wrong_file_names_itself_and_the_place(tmp_path: Path) -> None:
    path = tmp_path / "wrong.obj"
    path.write_bytes(b"v 0 0 0\nf 1 2 3\n")
    with pytest.raises(chordal.ReadError) as caught:
        chordal.load(path)
    error = caught.value
    assert (error.place, error.source) == ("line 2", str(path))
    assert str(error).startswith(f"{path}: line 2: ") and error.code.replace("-", "").isalpha()
    with pytest.raises(chordal.ReadError) as caught:
        chordal.load(b"\x00\x01")
    assert caught.value.place is None and caught.value.source is None
    assert "format=" in str(caught.value) and "--" not in str(caught.value)


def test_exceptions_cross_processes() -> None:
    for error in (
        chordal.ReadError("code", "line 1", "message", "file"),
        chordal.Refused("code", "message"),
        chordal.BudgetError("message"),
        chordal.InternalError("message"),
    ):
        copy = pickle.loads(pickle.dumps(error))
        assert type(copy) is type(error) and copy.args == error.args and vars(copy) == vars(error)


def test_what_is_no_file_is_refused_before_it_is_opened(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        chordal.load(tmp_path / "missing.obj")
    with pytest.raises(IsADirectoryError):
        chordal.load(tmp_path)
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.obj")
        with pytest.raises(chordal.ReadError, match="pipe") as caught:
            chordal.load(tmp_path / "pipe.obj")
        assert caught.value.code == "not-a-file"


def test_names_that_are_no_text_will_do(tmp_path: Path) -> None:
    path = os.path.join(os.fsencode(tmp_path), b"\xff.obj")
    try:
        with open(path, "wb") as file:
            file.write(SQUARE)
    except OSError:
        pytest.skip("this file system wants names that are text")
    assert chordal.load(os.fsdecode(path)).format == "obj"


def test_export_replaces_a_file_as_a_whole_and_keeps_its_mode(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text("old")
    path.chmod(0o640)
    mesh = chordal.load(SQUARE, format="obj").mesh(tol=0.1)
    mesh.export(path)
    assert path.read_bytes() == mesh.to_bytes("obj")
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert [file.name for file in tmp_path.iterdir()] == ["a.obj"]


def test_an_obj_has_its_materials_beside_it(tmp_path: Path) -> None:
    painted = Path(__file__).parents[1] / "web" / "painted.gltf"
    mesh = chordal.load(painted).mesh(tol="2%")
    mesh.export(tmp_path / "a.obj")
    names = sorted(file.name for file in tmp_path.iterdir())
    assert names[:2] == ["a.mtl", "a.obj"] and len(names) == 3 and names[2].startswith("a_")
    assert b"mtllib a.mtl" in (tmp_path / "a.obj").read_bytes()
    assert (tmp_path / names[2]).read_bytes().startswith(b"\x89PNG")
    assert names[2] in (tmp_path / "a.mtl").read_text()
    with pytest.warns(UserWarning, match="materials stand in files beside it"):
        assert b"mtllib" not in mesh.to_bytes("obj")


def test_export_that_fails_leaves_everything_as_it_was(tmp_path: Path) -> None:
    mesh = chordal.load(TEAPOT).mesh(tol=0.1)
    old = tmp_path / "a.glb"
    old.write_text("old")
    with pytest.raises(ValueError, match="format"):
        mesh.export(tmp_path / "a.unheardof")
    with pytest.raises(ValueError, match="does not say the format"):
        mesh.export(tmp_path / "a")
    with pytest.raises(FileNotFoundError):
        mesh.export(tmp_path / "missing" / "a.glb")
    (tmp_path / "folder.glb").mkdir()
    with pytest.raises(IsADirectoryError):
        mesh.export(tmp_path / "folder.glb")
    assert old.read_text() == "old"
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.glb", "folder.glb"]


def test_a_write_that_fails_half_way_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.ply"
    path.write_text("old")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        chordal.load(SQUARE, format="obj").mesh(tol=0.1).export(path)
    assert path.read_text() == "old" and len(list(tmp_path.iterdir())) == 1


def test_materials_of_fields_are_those_of_the_file() -> None:
    from chordal.shapes import color, material, move, sphere

    both = material(sphere(2), "sea", "#08f", metallic=0.25) | color(move(sphere(1), 2, 0), (1, 0, 0))
    data = both.mesh(tol=0.1).to_bytes("glb")
    told = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
    assert [look["name"] for look in told["materials"]] == ["sea", "color-ff0000"]
    assert told["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] == [1, 0, 0, 1]
    assert sorted(one["material"] for one in told["meshes"][0]["primitives"]) == [0, 1]
    with pytest.raises(ValueError, match="needs a colour like"):
        color(sphere(1), "reddish")


def test_a_file_of_points_alone_is_warned_of(tmp_path: Path) -> None:
    points = tmp_path / "points.ply"
    header = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    points.write_text(header + "0 0 0\n1 2 3\n")
    with pytest.warns(UserWarning, match="2 points and no triangles"):
        found = chordal.load(points, kind=chordal.Mesh)
    assert len(found.faces) == 0 and found.parts[0].vertices.tolist() == [[0, 0, 0], [1, 2, 3]]
