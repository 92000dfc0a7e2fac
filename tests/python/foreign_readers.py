"""Opens files with another program's library and prints what it found: `foreign_readers.py LIBRARY < paths`.

Each path is a line; so is each answer, a JSON object with the number of triangles and the bounds, or with what went wrong. A
library runs in a process of its own: some end it where they cannot read a file. Whoever counts the answers knows at which.
"""

from __future__ import annotations

import ctypes
import importlib.util
import json
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import numpy as np

#: What a library found: how many triangles, and the least and the greatest coordinates.
Found = tuple[int, Any, Any]
Reader = Callable[[str], Found]


def bounds_of(points: Any) -> tuple[Any, Any]:
    points = np.asarray(points, dtype=np.float64).reshape(-1, 3)
    return points.min(axis=0), points.max(axis=0)


def trimesh() -> Reader:
    import trimesh

    def read(path: str) -> Found:
        scene = trimesh.load_scene(path, process=False)
        placed = [scene.graph[name] for name in scene.graph.nodes_geometry]
        return sum(len(scene.geometry[shape].faces) for _, shape in placed), *scene.bounds

    return read


def pymeshlab() -> Reader:
    import pymeshlab

    def read(path: str) -> Found:
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(path)
        points = []
        for mesh in meshes:
            points.append(mesh.transformed_vertex_matrix())
        return sum(mesh.face_number() for mesh in meshes), *bounds_of(np.concatenate(points))

    return read


def open3d() -> Reader:
    # Its wheel expects a library of the system, of which another wheel has a copy.
    if importlib.util.find_spec("libusb_package") is not None:
        import libusb_package

        ctypes.CDLL(str(libusb_package.get_library_path()), mode=ctypes.RTLD_GLOBAL)
    # It imports what its pages are drawn with, of which none is asked for here.
    for name in ("dash", "plotly", "plotly.graph_objects"):
        sys.modules.setdefault(name, MagicMock())
    import open3d

    def read(path: str) -> Found:
        mesh = open3d.io.read_triangle_mesh(Path(path))
        if not len(mesh.triangles):
            raise ValueError("no triangles")
        return len(mesh.triangles), mesh.get_min_bound(), mesh.get_max_bound()

    return read


def assimp() -> Reader:
    import assimp_py

    def read(path: str) -> Found:
        # Its meshes are where the nodes place them, of which each may show one many times.
        steps = assimp_py.Process_Triangulate | assimp_py.Process_PreTransformVertices
        scene = assimp_py.import_file(path, steps)
        points = np.concatenate([np.asarray(mesh.vertices).reshape(-1, 3) for mesh in scene.meshes])
        return sum(mesh.num_faces for mesh in scene.meshes), *bounds_of(points)

    return read


def vtk() -> Reader:
    from vtkmodules.util import numpy_support
    from vtkmodules.vtkFiltersCore import vtkTriangleFilter
    from vtkmodules.vtkFiltersGeometry import vtkCompositeDataGeometryFilter
    from vtkmodules.vtkIOGeometry import vtkGLTFReader, vtkOBJReader, vtkSTLReader
    from vtkmodules.vtkIOPLY import vtkPLYReader
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

    to_numpy: Any = numpy_support.vtk_to_numpy

    def read(path: str) -> Found:
        extension = path.rsplit(".", 1)[-1]
        of_gltf = extension in ("glb", "gltf")
        kinds = {"obj": vtkOBJReader, "stl": vtkSTLReader, "ply": vtkPLYReader, "vtp": vtkXMLPolyDataReader}
        reader: Any = vtkGLTFReader() if of_gltf else kinds[extension]()
        reader.SetFileName(path)
        flat = reader
        if of_gltf:
            flat = vtkCompositeDataGeometryFilter()
            flat.SetInputConnection(reader.GetOutputPort())
        triangles = vtkTriangleFilter()
        triangles.SetInputConnection(flat.GetOutputPort())
        triangles.Update()
        found = triangles.GetOutput()
        if reader.GetErrorCode() or not found.GetNumberOfPolys():
            raise ValueError("no triangles")
        return found.GetNumberOfPolys(), *bounds_of(to_numpy(found.GetPoints().GetData()))

    return read


def lib3mf() -> Reader:
    from lib3mf import get_wrapper

    wrapper = get_wrapper()

    def read(path: str) -> Found:
        model = wrapper.CreateModel()
        reader = model.QueryReader("3mf")
        # It checks all that the standard asks for.
        reader.SetStrictModeActive(True)
        reader.ReadFromFile(path)
        warnings = [reader.GetWarning(i) for i in range(reader.GetWarningCount())]
        if warnings:
            raise ValueError(f"warnings: {warnings}")
        box = model.GetOutbox()
        n = 0
        merged = model.MergeToModel()
        items = merged.GetMeshObjects()
        while items.MoveNext():
            n += items.GetCurrentMeshObject().GetTriangleCount()
        return n, list(box.MinCoordinate), list(box.MaxCoordinate)

    return read


def usd() -> Reader:
    from pxr import Usd, UsdGeom

    def read(path: str) -> Found:
        stage = Usd.Stage.Open(path)
        n, points = 0, []
        for prim in stage.Traverse():
            if prim.IsA(UsdGeom.Mesh):
                mesh = UsdGeom.Mesh(prim)
                n += sum(corners - 2 for corners in mesh.GetFaceVertexCountsAttr().Get())
                own = np.asarray(mesh.GetPointsAttr().Get(), dtype=np.float64)
                placed = np.asarray(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default()))
                points.append(own @ placed[:3, :3] + placed[3, :3])
        return n, *bounds_of(np.concatenate(points))

    return read


def volume_of(values: Any) -> Found:
    """A volume as if it were a mesh: its samples, and their least and greatest value in place of bounds."""
    return values.size, [float(values.min())] * 3, [float(values.max())] * 3


def pynrrd() -> Reader:
    import nrrd

    return lambda path: volume_of(nrrd.read(path)[0])


def vtk_nrrd() -> Reader:
    from vtkmodules.util import numpy_support
    from vtkmodules.vtkIOImage import vtkNrrdReader

    to_numpy: Any = numpy_support.vtk_to_numpy

    def read(path: str) -> Found:
        reader = vtkNrrdReader()
        reader.SetFileName(path)
        reader.Update()
        if reader.GetErrorCode():
            raise ValueError("not read")
        return volume_of(to_numpy(reader.GetOutput().GetPointData().GetScalars()))

    return read


#: The libraries, by the name that is asked for.
LIBRARIES: dict[str, Callable[[], Reader]] = {
    "trimesh": trimesh,
    "pymeshlab": pymeshlab,
    "open3d": open3d,
    "assimp": assimp,
    "vtk": vtk,
    "lib3mf": lib3mf,
    "usd": usd,
    "pynrrd": pynrrd,
    "vtk_nrrd": vtk_nrrd,
}


def answers(library: str, paths: Iterable[str]) -> Iterable[dict[str, Any]]:
    try:
        read = LIBRARIES[library]()
    except ImportError as error:
        yield {"missing": str(error)}
        return
    for path in paths:
        try:
            n, least, greatest = read(path)
            yield {"n": int(n), "bounds": [[float(x) for x in corner] for corner in (least, greatest)]}
        except Exception as error:  # Whatever a library says of a file is the answer.
            yield {"error": f"{type(error).__name__}: {error}"}


if __name__ == "__main__":
    for answer in answers(sys.argv[1], sys.stdin.read().splitlines()):
        print(json.dumps(answer), flush=True)
