"""Meshes and images of other libraries, taken and given: of those that are installed."""

from __future__ import annotations

import types
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SQUARE

import chordal

POINTS = np.array([(0.1, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
FACES = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
NORMALS = POINTS / np.linalg.norm(POINTS, axis=1, keepdims=True)
UV = np.array([(0, 0), (1, 0), (0, 1), (0.25, 0.5)])
COLORS = np.array([(255, 0, 0, 255), (0, 255, 0, 255), (0, 0, 255, 255), (9, 8, 7, 128)], np.uint8)


def library(name: str) -> Any:
    return pytest.importorskip(name, reason=f"{name} is not installed: what is taken from and given to it is not tried")


def test_whatever_has_vertices_and_faces_is_a_mesh() -> None:
    other = types.SimpleNamespace(vertices=POINTS, faces=FACES)
    assert np.array_equal(chordal.Mesh.from_(other).vertices, POINTS)
    assert chordal.mesh(other, tol=0.1).is_watertight
    with pytest.raises(TypeError, match="a mesh of another library, not int"):
        chordal.Mesh.from_(3)


def test_trimesh_comes_and_goes() -> None:
    trimesh = library("trimesh")
    ours = chordal.Mesh(POINTS, FACES, normals=NORMALS, uv=UV)
    theirs = ours.to_trimesh()
    assert isinstance(theirs, trimesh.Trimesh) and theirs.is_watertight
    assert np.array_equal(theirs.vertices, POINTS) and np.array_equal(theirs.faces, FACES)
    assert np.array_equal(theirs.visual.uv, UV) and np.allclose(theirs.vertex_normals, NORMALS)
    assert theirs.metadata["chordal"] == {"at_least": 0.0, "at_most": 0.0, "evidence": "proved"}
    back = chordal.Mesh.from_(theirs)
    assert np.array_equal(back.vertices, POINTS) and np.array_equal(back.uv, UV)  # type: ignore[arg-type]
    painted = chordal.Mesh(POINTS, FACES, colors=COLORS).to_trimesh()
    assert np.array_equal(painted.visual.vertex_colors, COLORS)
    again = chordal.Mesh.from_(painted).colors
    assert again is not None and np.array_equal(np.rint(again * 255), COLORS)
    assert abs(ours.volume - theirs.volume) < 1e-15 and abs(ours.area - theirs.area) < 1e-15


def test_normals_that_trimesh_computed_are_not_taken() -> None:
    trimesh = library("trimesh")
    triangle: dict[str, Any] = {"vertices": [(0, 0, 0), (1, 0, 0), (0, 1, 0)], "faces": [(0, 1, 2)], "process": False}
    upwards = np.tile([0.0, 0, 1], (3, 1))
    plain = trimesh.Trimesh(**triangle)
    assert np.array_equal(plain.vertex_normals, upwards)
    assert chordal.Mesh.from_(plain).normals is None
    # Those that were assigned are taken even if they are the ones that trimesh would compute.
    assigned = trimesh.Trimesh(**triangle, vertex_normals=upwards)
    assert np.array_equal(chordal.Mesh.from_(assigned).normals, upwards)  # type: ignore[arg-type]
    assert assigned.face_angles.shape == (1, 3)
    assert np.array_equal(chordal.Mesh.from_(assigned).normals, upwards)  # type: ignore[arg-type]
    tilted = np.tile([0.0, 0.6, 0.8], (3, 1))
    plain.vertex_normals = tilted
    assert np.array_equal(chordal.Mesh.from_(plain).normals, tilted)  # type: ignore[arg-type]
    # Normals of vertices that have moved are gone, in trimesh as here.
    assigned.vertices = assigned.vertices + 1
    assert chordal.Mesh.from_(assigned).normals is None


def test_numbers_of_a_mesh_are_those_of_trimesh() -> None:
    library("trimesh")
    ring = chordal.shapes.arc(0.5, center=(2, 0)).revolve().mesh(tol=0.01)
    theirs = ring.to_trimesh()
    assert np.allclose(ring.bounds, theirs.bounds) and np.allclose(ring.extents, theirs.extents)
    assert np.isclose(ring.volume, theirs.volume) and np.isclose(ring.area, theirs.area)
    assert np.allclose(ring.face_normals, theirs.face_normals, atol=1e-9)
    assert ring.is_watertight and theirs.is_watertight


def test_pyvista_comes_and_goes() -> None:
    pyvista = library("pyvista")
    theirs = chordal.Mesh(POINTS, FACES, normals=NORMALS, uv=UV).to_pyvista()
    assert isinstance(theirs, pyvista.PolyData) and theirs.n_open_edges == 0
    back = chordal.Mesh.from_(theirs)
    assert np.array_equal(back.vertices, POINTS) and np.array_equal(back.faces, FACES)
    assert np.array_equal(back.uv, UV) and np.allclose(back.normals, NORMALS)  # type: ignore[arg-type]


def test_manifold3d_comes_and_goes() -> None:
    library("manifold3d")
    theirs = chordal.Mesh(POINTS, FACES).to_manifold3d()
    assert theirs.num_tri() == 4 and abs(theirs.volume() - chordal.Mesh(POINTS, FACES).volume) < 1e-12
    back = chordal.Mesh.from_(theirs)
    assert sorted(map(tuple, back.vertices)) == sorted(map(tuple, POINTS))
    with pytest.raises(ValueError, match="no solid"):
        chordal.Mesh(POINTS, FACES[:3]).to_manifold3d()


def test_meshio_comes_and_goes() -> None:
    meshio = library("meshio")
    theirs = chordal.Mesh(POINTS, FACES, uv=UV).to_meshio()
    assert np.array_equal(theirs.point_data["uv"], UV)
    assert np.array_equal(chordal.Mesh.from_(theirs).faces, FACES)
    quads = meshio.Mesh([(0, 0), (1, 0), (1, 1), (0, 1)], [("quad", np.array([(0, 1, 2, 3)]))])
    assert chordal.Mesh.from_(quads).area == 1
    with pytest.raises(ValueError, match="not of tetra"):
        chordal.Mesh.from_(meshio.Mesh(POINTS, [("tetra", np.array([(0, 1, 2, 3)]))]))


def test_open3d_comes_and_goes() -> None:
    library("open3d")
    theirs = chordal.Mesh(POINTS, FACES, normals=NORMALS).to_open3d()
    back = chordal.Mesh.from_(theirs)
    assert np.array_equal(back.vertices, POINTS) and np.array_equal(back.faces, FACES)
    assert np.allclose(back.normals, NORMALS)  # type: ignore[arg-type]


SAMPLES = np.arange(3 * 4 * 5, dtype=np.int16).reshape(3, 4, 5)
TURNED = np.array([(0, -0.5, 0, 10), (2, 0, 0, 20), (0, 0, 3, 30), (0, 0, 0, 1)], float)


def test_nibabel_comes_and_goes(tmp_path: Path) -> None:
    nibabel = library("nibabel")
    image = nibabel.Nifti1Image(SAMPLES, TURNED)
    image.header.set_xyzt_units("mm")
    ours = chordal.volume(image)
    assert np.array_equal(ours.array, SAMPLES) and ours.dtype == np.int16
    assert np.array_equal(ours.affine, TURNED) and ours.spacing == (2, 0.5, 3)
    back = ours.to_nibabel()
    assert np.array_equal(back.dataobj, SAMPLES) and np.array_equal(back.affine, TURNED)
    pieces = chordal.block_volume(image)
    assert pieces.shape == (3, 4, 5) and np.array_equal(pieces.affine, TURNED)
    with pytest.raises(TypeError, match="this image says them already"):
        chordal.block_volume(image, spacing=2)
    of_array = chordal.block_volume(SAMPLES, affine=TURNED)
    assert np.array_equal(pieces.mesh(iso=20.5, block=2).vertices, of_array.mesh(iso=20.5, block=2).vertices)
    several = nibabel.Nifti1Image(np.stack([SAMPLES, SAMPLES[::-1]], axis=3), TURNED).to_bytes()
    with pytest.raises(chordal.ReadError, match="index= names one, from 0 to 1"):
        chordal.load(several, format="nii")
    assert np.array_equal(chordal.load(several, format="nii", index=1).array, SAMPLES[::-1])
    (tmp_path / "several.nii").write_bytes(several)
    second = chordal.block_volume(tmp_path / "several.nii", channel=1).mesh(iso=20.5, block=2)
    turned = chordal.block_volume(np.ascontiguousarray(SAMPLES[::-1]), affine=TURNED).mesh(iso=20.5, block=2)
    assert np.array_equal(second.vertices, turned.vertices)
    with pytest.raises(ValueError, match="the file has 2, so from 0 on"):
        chordal.block_volume(tmp_path / "several.nii", channel=2)
    with pytest.raises(ValueError, match="level: a NIfTI file has one alone"):
        chordal.block_volume(tmp_path / "several.nii", level=1)
    with pytest.raises(ValueError, match="channel: what is no path"):
        chordal.block_volume(SAMPLES, channel=1)
    with pytest.raises(ValueError, match=r"image\.slicer"):
        chordal.volume(nibabel.Nifti1Image.from_bytes(several))
    with pytest.raises(ValueError, match="index: a whole number of at least 0"):
        chordal.load(several, format="nii", index=-1)
    scaled = nibabel.Nifti1Image(SAMPLES, TURNED)
    scaled.header.set_slope_inter(2, 1)
    assert chordal.volume(nibabel.Nifti1Image.from_bytes(scaled.to_bytes())).array[2, 3, 4] == 2 * 59 + 1


def test_simpleitk_comes_and_goes() -> None:
    library("SimpleITK")
    ours = chordal.volume(SAMPLES, affine=TURNED)
    image = ours.to_simpleitk()
    assert image.GetSize() == (3, 4, 5) and image[2, 3, 4] == SAMPLES[2, 3, 4]
    assert image.TransformIndexToPhysicalPoint((1, 2, 3)) == tuple((TURNED @ (1, 2, 3, 1))[:3])
    back = chordal.volume(image)
    assert np.array_equal(back.array, SAMPLES) and np.allclose(back.affine, TURNED, atol=1e-12)
    with pytest.raises(ValueError, match="right angles"):
        chordal.volume(SAMPLES, affine=[(1, 1, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0)]).to_simpleitk()


def test_xarray_comes_and_goes() -> None:
    xarray = library("xarray")
    coords = {"z": np.array([1.0, 1.5, 2.0]), "y": np.arange(4) * 2.0, "x": np.arange(5) - 7.0}
    data = xarray.DataArray(SAMPLES, dims=("z", "y", "x"), coords=coords)
    ours = chordal.volume(data)
    assert ours.shape == (5, 4, 3) and ours.spacing == (1, 2, 0.5) and ours.origin == (-7, 0, 1)
    assert ours.array[4, 3, 2] == SAMPLES[2, 3, 4]
    back = ours.to_xarray()
    assert np.array_equal(back.transpose("z", "y", "x").values, SAMPLES)
    assert all(np.array_equal(back.coords[name], data.coords[name]) for name in "xyz")
    coords["x"][1] = 0
    with pytest.raises(ValueError, match="not evenly spaced"):
        chordal.volume(xarray.DataArray(SAMPLES, dims=("z", "y", "x"), coords=coords))


def test_an_image_says_where_it_is() -> None:
    image = types.SimpleNamespace(dims=("x", "y", "z"), coords={}, values=SAMPLES)
    image.transpose = lambda *_: image
    assert chordal.volume(image).shape == (3, 4, 5)
    with pytest.raises(TypeError, match="says them already"):
        chordal.volume(image, spacing=2)


def test_a_square_of_a_file_is_given_with_what_it_has() -> None:
    library("trimesh")
    assert len(chordal.load(SQUARE, format="obj").mesh(tol=0.1).to_trimesh().faces) == 2


def test_what_a_mesh_of_another_library_would_compute_is_not_asked_for() -> None:
    class Lazy:
        vertices = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
        faces = np.array([[0, 1, 2]])

        @property
        def triangles(self) -> None:
            raise AssertionError("this takes as long as the copy")

    assert len(chordal.Mesh.from_(Lazy()).faces) == 1


def test_a_part_that_is_shown_twice_has_its_attributes_twice() -> None:
    mesh = chordal.load(Path(__file__).parents[1] / "web" / "painted.gltf")
    assert isinstance(mesh, chordal.Mesh) and len(mesh.parts) == 1
    n_shown = sum(node.part is not None for node in mesh.nodes)
    rows = len(mesh.parts[0].vertices)
    assert n_shown == 2 and len(mesh.vertices) == n_shown * rows
    assert mesh.uv is not None and np.array_equal(mesh.uv[:rows], mesh.uv[rows:]) and len(mesh.uv) == len(mesh.vertices)
    # Normals are turned with their instance: they fit the faces that are shown.
    assert mesh.normals is not None and len(mesh.normals) == len(mesh.vertices)
    flat = mesh.face_normals
    assert np.all(np.einsum("fk,fk->f", flat, mesh.normals[mesh.faces[:, 0]]) > 0)


@pytest.mark.parametrize("name", ["trimesh", "pyvista", "meshio", "open3d"])
def test_what_goes_to_another_library_comes_back(name: str) -> None:
    library(name)
    normals = np.tile([0.0, 0, 1], (3, 1))
    uv, colors = np.array([[0, 0], [1, 0], [0, 0.5]]), np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    given: dict[str, Any] = {"normals": normals, "uv": uv, "colors": colors}
    for kind in (["normals", "uv"], ["normals", "colors"]):
        mesh = chordal.Mesh(POINTS[:3], [(0, 1, 2)], **{one: given[one] for one in kind})
        back = chordal.Mesh.from_(getattr(mesh, f"to_{name}")())
        for one in kind:
            found = getattr(back, one)
            assert found is not None and np.allclose(found[:, : given[one].shape[1]], given[one], atol=0.003), (one, found)


def test_trimesh_gets_the_unit_and_what_it_does_not_get_is_told() -> None:
    trimesh = library("trimesh")
    uv = np.zeros((3, 2))
    both = chordal.Mesh(POINTS[:3], [(0, 1, 2)], uv=uv, colors=np.ones((3, 3)), unit="mm")
    with pytest.warns(UserWarning, match="colours beside texture coordinates"):
        there = both.to_trimesh()
    assert there.units == "millimeters" and chordal.Mesh.from_(there).unit == "mm"
    painted = trimesh.Trimesh(POINTS[:3], [(0, 1, 2)], process=False, face_colors=[[255, 0, 0, 255]])
    with pytest.warns(UserWarning, match="colours of faces"):
        chordal.Mesh.from_(painted)


def test_a_scene_of_trimesh_comes_with_places_and_materials() -> None:
    trimesh = library("trimesh")
    box = trimesh.creation.box()
    red = trimesh.visual.material.PBRMaterial(name="red", baseColorFactor=[255, 0, 0, 255], metallicFactor=0.25, roughnessFactor=0.5)
    ball = trimesh.creation.icosphere(subdivisions=1)
    ball.visual = trimesh.visual.TextureVisuals(uv=ball.vertices[:, :2], material=red)
    moved = trimesh.transformations.translation_matrix((3, 0, 0))
    theirs = trimesh.Scene({"box": box, "ball": ball})
    theirs.add_geometry(trimesh.load_path([[0, 0], [1, 1]]), geom_name="line")
    theirs.graph.update("far", geometry="ball", matrix=moved)
    with pytest.warns(UserWarning, match="Path2D: these stay behind"):
        ours = chordal.Mesh.from_(theirs)
    assert len(ours.parts) == 2 and {node.name for node in ours.nodes} == {"box", "ball", "far"}
    assert ours.materials == [
        {
            "name": "red",
            "pbrMetallicRoughness": {"metallicFactor": 0.25, "roughnessFactor": 0.5, "baseColorFactor": [1, 0, 0, 1]},
        }
    ]
    assert np.allclose(ours.bounds, [(-1, -1, -1), (4, 1, 1)])
    assert np.isclose(ours.volume, box.volume + 2 * ball.volume)
    assert chordal.mesh(chordal.scene(trimesh.Scene(box)), tol=0.1).is_watertight
    with pytest.raises(ValueError, match="no mesh in this scene"):
        chordal.Mesh.from_(trimesh.Scene())


def test_what_has_no_triangles_is_said() -> None:
    pyvista = library("pyvista")
    solid = pyvista.UnstructuredGrid({10: np.array([[0, 1, 2, 3]])}, POINTS)
    with pytest.raises(TypeError, match=r"UnstructuredGrid has cells: chordal.Mesh.from_\(thing.extract_surface\(\)\)"):
        chordal.Mesh.from_(solid)
    assert chordal.Mesh.from_(solid.extract_surface(algorithm=None)).is_watertight
    with pytest.raises(TypeError, match=r"MultiBlock has cells: .*thing.combine\(\)"):
        chordal.Mesh.from_(pyvista.MultiBlock([solid]))
    with pytest.raises(ValueError, match="lines and no faces in it; thing.tube"):
        chordal.Mesh.from_(pyvista.Line())
    with pytest.raises(ValueError, match="points and no faces"):
        chordal.Mesh.from_(pyvista.PolyData(POINTS))


def test_data_that_stays_behind_is_told() -> None:
    trimesh = library("trimesh")
    tagged = trimesh.Trimesh(POINTS, FACES, process=False, vertex_attributes={"heat": np.zeros(4)})
    with pytest.warns(UserWarning, match="heat of vertices: these stay behind"):
        chordal.Mesh.from_(tagged)


def test_lines_and_data_of_meshio_that_stay_behind_are_told() -> None:
    meshio = library("meshio")
    theirs = meshio.Mesh(POINTS, [("triangle", FACES), ("line", FACES[:, :2])], point_data={"heat": np.zeros(4)})
    with pytest.warns(UserWarning) as told:
        chordal.Mesh.from_(theirs)
    assert {str(one.message).partition(":")[0] for one in told} == {"heat of points", "lines"}


def picture() -> Any:
    image = library("PIL.Image").new("RGB", (4, 4), (255, 0, 0))
    image.putpixel((1, 2), (0, 255, 0))
    return image


def test_a_textured_mesh_of_trimesh_comes_and_goes() -> None:
    trimesh = library("trimesh")
    material = trimesh.visual.material.PBRMaterial(
        name="bark", baseColorFactor=[1.0, 0.5, 0.25, 1.0], metallicFactor=0.25, roughnessFactor=0.5, baseColorTexture=picture()
    )
    uv = np.random.default_rng(1).random((4, 2))
    visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    theirs = trimesh.Trimesh(POINTS, FACES, visual=visual, process=False)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ours = chordal.Mesh.from_(theirs)
        back = ours.to_trimesh()
    assert [one["name"] for one in ours.materials] == ["bark"] and len(ours.images) == 1
    assert ours.uv is not None and np.array_equal(ours.uv, uv) and ours.bound.at_most == 0
    again = back.visual.material
    assert (again.name, again.metallicFactor, again.roughnessFactor) == ("bark", 0.25, 0.5)
    assert np.array_equal(again.baseColorFactor, material.baseColorFactor)
    assert np.array_equal(np.asarray(again.baseColorTexture), np.asarray(picture())) and np.array_equal(back.visual.uv, uv)


def test_a_material_that_says_nothing_is_none() -> None:
    trimesh = library("trimesh")
    visual = trimesh.visual.TextureVisuals(uv=np.zeros((4, 2)))
    assert chordal.Mesh.from_(trimesh.Trimesh(POINTS, FACES, visual=visual, process=False)).materials == []


def test_what_others_do_not_get_of_materials_is_told() -> None:
    for name in ("trimesh", "pyvista", "open3d", "meshio"):
        library(name)
    red = chordal.scene(chordal.Placed(chordal.Mesh(POINTS, FACES), material=chordal.Material("red", color="#f00")))
    for export in (red.to_pyvista, red.to_open3d, red.to_meshio):
        with pytest.warns(UserWarning, match="materials: these stay behind"):
            export()
    assert red.to_trimesh().visual.material.name == "red"
    with pytest.warns(UserWarning, match="materials: these stay behind, .*scene"):
        both = red + chordal.Mesh(POINTS, FACES).translate(5, 0, 0)
    assert both.materials == []


def test_data_of_cells_is_told() -> None:
    meshio = library("meshio")
    theirs = meshio.Mesh(POINTS, [("triangle", FACES)], cell_data={"pressure": [np.arange(4.0)]})
    with pytest.warns(UserWarning, match="pressure of cells"):
        chordal.Mesh.from_(theirs)


def test_texture_coordinates_of_open3d_tensors_come_along() -> None:
    open3d = library("open3d")
    uv = np.random.default_rng(2).random((4, 2))
    made = chordal.Mesh(POINTS, FACES, uv=uv).to_open3d()
    tensor = open3d.t.geometry.TriangleMesh.from_legacy(made)
    found = chordal.Mesh.from_(tensor)
    assert found.uv is not None and np.allclose(found.uv, uv)


def test_texture_coordinates_have_v_up_whatever_the_file_says(tmp_path: Path) -> None:
    trimesh = library("trimesh")
    ours = chordal.Mesh(POINTS, FACES, uv=UV)
    ours.export(tmp_path / "a.glb")
    read = chordal.load(tmp_path / "a.glb", kind=chordal.Mesh)
    assert read.uv is not None and np.allclose(read.uv, UV) and np.allclose(read.parts[0].uv, UV)  # type: ignore[arg-type]
    theirs = trimesh.load(tmp_path / "a.glb", force="mesh", process=False)
    assert np.allclose(read.to_trimesh().visual.uv, theirs.visual.uv)
    for again in (chordal.Mesh(read.vertices, read.faces, uv=read.uv), read + read, read.translate(1, 0, 0), chordal.scene(read)):
        again.export(tmp_path / "b.glb")
        found = chordal.load(tmp_path / "b.glb", kind=chordal.Mesh).uv
        assert found is not None and np.allclose(found[:4], UV)


def test_attributes_of_ones_own_are_told(tmp_path: Path) -> None:
    meshio, pyvista = library("meshio"), library("pyvista")
    meshio.Mesh(POINTS, [("triangle", FACES)], point_data={"heat": np.arange(4.0)}).write(tmp_path / "a.ply")
    read = chordal.load(tmp_path / "a.ply", kind=chordal.Mesh)
    with pytest.warns(UserWarning, match="heat: these stay behind"):
        assert isinstance(read.to_pyvista(), pyvista.PolyData)


def test_the_unit_of_a_volume_goes_along() -> None:
    nibabel, _ = library("nibabel"), library("xarray")
    ours = chordal.volume(np.zeros((3, 4, 5)), spacing=2, unit="mm")
    assert ours.unit == "mm" and chordal.volume(np.zeros((3, 4, 5))).unit is None
    assert ours.to_nibabel().header.get_xyzt_units()[0] == "mm"
    assert chordal.volume(ours.to_nibabel()).unit == chordal.volume(ours.to_xarray()).unit == "mm"
    with pytest.warns(UserWarning, match="NIfTI has mm, m and um, and not in"):
        assert isinstance(chordal.volume(np.zeros((3, 4, 5)), unit="in").to_nibabel(), nibabel.Nifti1Image)
