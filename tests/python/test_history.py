"""What is moved, joined, or put in a scene keeps its bound: in memory, in its file, and through pickles; `verify` proves it."""

from __future__ import annotations

import copy
import json
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import chordal
from chordal import shapes

BALL = shapes.sphere(1)
MESH = BALL.mesh(tol=0.01)
PLAIN = chordal.Mesh([(5, 0, 0), (6, 0, 0), (5, 1, 0)], [(0, 1, 2)])
TURN = [(0, -1, 0, 3), (1, 0, 0, 0), (0, 0, 2, 0)]
PLACED = chordal.Placed([MESH, PLAIN], [(4, 0, 0), (8, 0, 0)])

#: Meshes of the ball, and those of the ball and the triangle.
OF_THE_BALL: dict[str, Callable[[], chordal.Mesh]] = {
    "moved": lambda: MESH.translate(3, 0, 0),
    "moved twice": lambda: MESH.rotate("z", 30).scale(2),
    "mirrored": lambda: MESH.transform(TURN).scale((1, -1, 1)),
    "of another unit": lambda: chordal.scene(MESH, unit="in").to_unit("mm"),
    "a list joined": lambda: chordal.concatenate([MESH.translate(k, 0, 0) for k in (0, 3, 6)]),
    "a scene, joined and moved": lambda: (chordal.scene(chordal.Placed(MESH, TURN)) + MESH).translate(0, 9, 0),
    "pickled": lambda: pickle.loads(pickle.dumps(MESH.translate(3, 0, 0))),
    "copied": lambda: copy.deepcopy(chordal.scene(chordal.Placed(MESH, TURN))),
}
OF_BOTH: dict[str, Callable[[], chordal.Mesh]] = {
    "joined": lambda: MESH + PLAIN.rotate("x", 10),
    "a scene": lambda: chordal.scene({"a": MESH, "b": PLACED}),
    "a scene of scenes": lambda: chordal.scene(chordal.Placed(chordal.scene(MESH.scale(3), PLAIN), TURN), MESH),
}


def total_of(report: Any) -> dict[str, Any]:
    found: dict[str, Any] = report["certificate"]["history"]["total"]
    return found


def open_claims(verified: Any) -> list[Any]:
    return [claim for claim in verified["claims"] if claim["verdict"] != "re-proved"]


@pytest.mark.parametrize("name", [*OF_THE_BALL, *OF_BOTH])
@pytest.mark.parametrize("format", ["ply", "glb", "3mf", "stl", "obj"])
def test_the_bound_is_in_the_file(name: str, format: str, tmp_path: Path) -> None:
    made = (OF_THE_BALL | OF_BOTH)[name]()
    assert made.bound.at_most is not None and made.bound.at_most > 0
    path = tmp_path / f"a.{format}"
    report = made.export(path)
    total = total_of(report)
    # Single precision adds its own.
    own = report["certificate"]["bound"]["at_most"]
    assert total["evidence"] == "proved"
    # Of several moves the product counts, which may lengthen less than they do one by one.
    assert 0.5 * made.bound.at_most <= total["at_most"] <= (made.bound.at_most + own) * (1 + 1e-9)
    against = [MESH, BALL] + ([PLAIN] if name in OF_BOTH else [])
    verified = chordal.verify(path, against, certificate=report)
    assert verified["verdict"] == "re-proved", open_claims(verified)


def test_what_is_made_of_a_scene_goes_on_from_it(tmp_path: Path) -> None:
    scene = OF_BOTH["a scene"]()
    coarse = scene.mesh(tol=0.05)
    total = total_of(coarse.report)
    assert scene.bound.at_most is not None and coarse.bound.at_most is not None
    assert coarse.bound.at_most <= 0.05 < total["at_most"] <= coarse.bound.at_most + scene.bound.at_most + 1e-12
    assert total["reference"] == "several shapes"
    coarse.export(tmp_path / "coarse.ply")
    assert not open_claims(chordal.verify(tmp_path / "coarse.ply", [MESH, BALL, PLAIN]))
    # Levels and grids, too.
    volume = MESH.translate(3, 0, 0).bake(cells=24, bound=True)
    volume.export(tmp_path / "grid.nrrd")
    assert total_of(volume.report)["reference"] == "field"
    assert chordal.verify(tmp_path / "grid.nrrd", [MESH, BALL])["verdict"] == "re-proved"


def test_files_are_enough(tmp_path: Path) -> None:
    (tmp_path / "ball.star").write_text("sphere(1)\n")
    mesh = chordal.load(tmp_path / "ball.star").mesh(tol=0.01)
    mesh.export(tmp_path / "ball.ply")
    moved = chordal.load(tmp_path / "ball.ply", kind=chordal.Mesh).translate(3, 0, 0)
    report = moved.export(tmp_path / "moved.stl")
    assert total_of(report)["reference"] == "field"
    files = [tmp_path / "ball.ply", tmp_path / "ball.star"]
    # The report as Python writes it: 1e-07 where others write 1e-7.
    (tmp_path / "report.json").write_text(json.dumps(report))
    for certificate in (report, tmp_path / "report.json"):
        verified = chordal.verify(tmp_path / "moved.stl", files, certificate=certificate)
        assert not open_claims(verified)
    without = chordal.verify(tmp_path / "moved.stl", files[1], certificate=report)
    assert without["verdict"] == "not re-proved"
    assert any("was not given" in claim.get("reason", "") for claim in without["claims"])


def test_another_shape_is_refuted(tmp_path: Path) -> None:
    path = tmp_path / "a.glb"
    MESH.translate(3, 0, 0).export(path)
    assert chordal.verify(path, [MESH, BALL])["verdict"] == "re-proved"
    assert chordal.verify(path, [MESH, shapes.sphere(1.001)])["verdict"] == "refuted"
    assert chordal.verify(path, [MESH.translate(3, 0, 0), BALL])["verdict"] == "refuted"
    with pytest.raises(chordal.ReadError, match="no certificate"):
        chordal.verify(PLAIN, PLAIN)


def test_a_piece_and_a_triangle_that_was_given_have_no_history_of_others() -> None:
    pieces = (MESH + PLAIN).split()
    assert pieces[1].bound.at_most == 0
    total = total_of(json.loads(json.dumps(PLAIN.translate(1, 0, 0).mesh(tol=0.1).report)))
    assert 0 < total["at_most"] < 1e-12 and total["reference"] == "input triangles"


def test_digests_are_of_what_there_is() -> None:
    digest = {name: field.mesh(tol=0.1).report["certificate"]["input"]["sha256"] for name, field in FIELDS.items()}
    assert digest["ball"] == digest["the same ball"] != digest["another"]
    assert digest["function"] is None


FIELDS = {
    "ball": shapes.sphere(1),
    "the same ball": shapes.sphere(1),
    "another": shapes.sphere(1.5),
    "function": chordal.field(lambda p: (p**2).sum(axis=1) ** 0.5 - 1, bounds=((-2, -2, -2), (2, 2, 2)), lipschitz=1),
}


@pytest.mark.parametrize("mixed", ["solid", "one-sided"])
def test_the_weakest_metric_of_all_holds(mixed: str) -> None:
    from chordal._pieces import _largest

    near = chordal.Bound(0.0, 0.1, "proved", "hausdorff", "field")
    other = chordal.Bound(0.0, 0.3, "proved", mixed, "boolean")
    found = _largest([near, other])
    assert found is not None and found.metric == mixed
    assert found.at_most == (None if mixed == "solid" else 0.3)
    assert _largest([other, other]) == chordal.Bound(0.0, 0.3, "proved", mixed, "boolean")


@pytest.mark.parametrize("format", ["3mf", "glb", "ply", "usda"])
def test_a_file_whose_writer_turns_it_is_no_lie(format: str, tmp_path: Path) -> None:
    path = tmp_path / f"a.{format}"
    for up in ("y", "z"):
        chordal.scene({"a": MESH}, up=up, unit="cm").export(path)
        assert not open_claims(chordal.verify(path, [MESH, BALL])), up
        again = chordal.load(path, kind=chordal.Mesh).translate(1, 2, 3)
        again.export(tmp_path / f"b.{format}")
        verified = chordal.verify(tmp_path / f"b.{format}", [chordal.load(path), MESH, BALL])
        assert verified["verdict"] != "refuted", open_claims(verified)


def test_the_mesh_of_a_volume_that_was_read_by_blocks_knows_it(tmp_path: Path) -> None:
    i, j, k = np.indices((16, 17, 18)).astype(float)
    samples = np.sqrt((i - 8) ** 2 + (j - 8) ** 2 + (k - 9) ** 2) - 5
    made = chordal.block_volume(samples).mesh(iso=0, inside="low", block=8)
    total = total_of(made.export(tmp_path / "a.ply"))
    assert total["reference"] == "trilinear interpolant" and total["at_most"] == made.bound.at_most
    whole = chordal.volume(samples).surface(iso=0, inside="low")
    assert not open_claims(chordal.verify(tmp_path / "a.ply", [made, whole]))
    further = total_of(made.mesh(tol=0.25).report)
    assert further["reference"] == "trilinear interpolant" and further["at_most"] > 0.25 - 0.2


def test_a_simplification_is_proved_again(tmp_path: Path) -> None:
    for tol in (0.03, 0.05, 0.1):
        MESH.mesh(tol=tol).export(tmp_path / "a.ply")
        assert not open_claims(chordal.verify(tmp_path / "a.ply", [MESH, BALL])), tol
    for count in (60, 100, 200, 400):
        MESH.mesh(triangles=count).export(tmp_path / "a.ply")
        assert not open_claims(chordal.verify(tmp_path / "a.ply", [MESH, BALL])), count


def test_one_file_more_than_is_needed_is_no_lie(tmp_path: Path) -> None:
    MESH.translate(1, 0, 0).export(tmp_path / "a.ply")
    assert not open_claims(chordal.verify(tmp_path / "a.ply", [MESH, BALL, PLAIN]))
    assert chordal.verify(tmp_path / "a.ply", [BALL, PLAIN])["verdict"] == "refuted"


def test_many_moves_and_many_places_fit_into_a_file(tmp_path: Path) -> None:
    turned = MESH
    for _ in range(100):
        turned = turned.rotate((1, 1, 1), 37).rotate((1, -1, 0), 45)
    report = turned.export(tmp_path / "turned.ply")
    # What each turn rounds adds up, and no more.
    assert total_of(report)["at_most"] < MESH.bound.at_most + 1e-9  # type: ignore[operator]
    assert total_of(report)["at_most"] < turned.bound.at_most + 1e-9  # type: ignore[operator]
    assert len(json.dumps(report["certificate"]["history"])) < 4000
    assert chordal.verify(tmp_path / "turned.ply", [MESH, BALL])["verdict"] != "refuted"
    places = np.random.default_rng(5).normal(size=(2000, 3))
    many = chordal.scene(chordal.Placed(PLAIN, places), MESH)
    for name in ("many.ply", "many.glb"):
        many.export(tmp_path / name)
        history = chordal.load(tmp_path / name).history
        assert history["begins"]["code"] == "composed"
    joined = chordal.concatenate([PLAIN.translate(k, 0, 0).scale(1 + k) for k in range(400)])
    for name in ("a.obj", "a.off", "a.vtp", "a.stl"):
        assert "history" in joined.export(tmp_path / name)["certificate"]


@pytest.mark.parametrize("format", ["ply", "obj", "off", "vtp", "stl", "3mf", "glb", "usda"])
def test_parts_that_touch_are_counted_as_their_file_has_them(format: str, tmp_path: Path) -> None:
    path = tmp_path / f"a.{format}"
    report = chordal.scene(PLAIN, PLAIN.rotate("z", 20, about=(5, 0, 0))).export(path)
    assert not open_claims(chordal.verify(path, [PLAIN], certificate=report))


def test_of_several_functions_nobody_knows_which_it_was(tmp_path: Path) -> None:
    def ball(radius: float) -> chordal.Field:
        return chordal.field(lambda p: (p**2).sum(axis=1) ** 0.5 - radius, bounds=((-3,) * 3, (3,) * 3), lipschitz=1)

    fields = ball(1), ball(2)
    meshes = [field.mesh(tol=0.1) for field in fields]
    (meshes[0].translate(0, 0, 5) + meshes[1]).export(tmp_path / "a.ply")
    verified = chordal.verify(tmp_path / "a.ply", [*meshes, *fields])
    assert verified["verdict"] == "not re-proved"
    assert any("can only be identified if just one field is given" in claim.get("reason", "") for claim in verified["claims"])


def test_what_shows_nothing_is_in_a_scene_too() -> None:
    empty = chordal.load(
        b'{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"name":"nothing"}]}',
        format="gltf",
        kind=chordal.Mesh,
    )
    both = chordal.scene(chordal.Placed(empty, (1, 0, 0)), MESH, unit="m", up="y")
    assert len(both.faces) == len(MESH.faces)


def test_solids_that_are_moved_keep_their_bound(tmp_path: Path) -> None:
    both = MESH | MESH.translate(1, 0, 0)
    moved = both.translate(0, 0, 3)
    assert moved.bound.metric == "solid" and moved.bound.at_most is not None
    total = moved.history["total"]
    assert total["metric"] == "solid" and total["at_most"] is not None and total["at_most"] < 1e-9


def test_vertices_below_nodes_are_rounded_and_it_counts(tmp_path: Path) -> None:
    turned = [[0.8, -0.6, 0.0, 0.1], [0.6, 0.8, 0.0, 0.7], [0.0, 0.0, 1.0, 0.3], [0.0, 0.0, 0.0, 1.0]]
    chordal.scene(chordal.Placed(PLAIN, turned), PLAIN).export(tmp_path / "a.usda")
    read = chordal.load(tmp_path / "a.usda", kind=chordal.Mesh)
    bound = chordal.concatenate([read]).bound
    assert bound.at_most is not None and 0 < bound.at_most < 1e-12


def test_a_small_scale_is_no_flattening() -> None:
    assert PLAIN.scale(1e-110).vertices[0, 0] == 5e-110


def test_a_bound_of_any_size_is_shown() -> None:
    assert "e+100" in repr(MESH.scale(1.2e102)) and "e-10" in repr(MESH.scale(1e-100))
    far = MESH.scale(1e200).bound
    assert far.at_most is None and far.evidence == "estimated" and "at least" in far.sentence()


def test_a_history_is_read_back(tmp_path: Path) -> None:
    moved = MESH.translate(3, 0, 0)
    report = moved.export(tmp_path / "a.glb")
    found = chordal.load(tmp_path / "a.glb").history
    assert found["total"] == total_of(report) and found["steps"] == report["certificate"]["history"]["steps"]
    assert moved.history["total"]["at_most"] <= 0.01 + 1e-12
    assert moved.history["composed"]["origins"][0]["steps"] == MESH.history["steps"]
    assert PLAIN.history["steps"] == [] and PLAIN.history["begins"]["code"] == "no-certificate"
    assert shapes.sphere(1).history["total"] is None
