"""What other programs count in a file: reads lines `reader<tab>path` on stdin and answers each with one of JSON.

Run by corpus.py and round_trips.py as a process of its own, since some of these programs end with a signal on broken
files.
"""

import contextlib
import json
import os
import sys
import warnings
from pathlib import Path

import numpy as np

warnings.simplefilter("ignore")
VERTICES_OF_MODE = {4: lambda n: n // 3, 5: lambda n: max(n - 2, 0), 6: lambda n: max(n - 2, 0)}


def box_of(points):
    """The lowest and the highest corner of rows of three numbers."""
    points = np.asarray(points, np.float64).reshape(-1, 3)
    return None if len(points) == 0 else [points.min(axis=0).tolist(), points.max(axis=0).tolist()]


def meshlab(path):
    """MeshLab: polygons are cut into triangles."""
    import pymeshlab

    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.load_new_mesh(str(path))
    every = [meshes.mesh(i) for i in range(meshes.mesh_number())]
    points = [mesh.vertex_matrix() for mesh in every]
    return {
        "vertices": sum(mesh.vertex_number() for mesh in every), "triangles": sum(mesh.face_number() for mesh in every),
        "box": box_of(np.concatenate(points)),
    }


def trimesh(path):
    """trimesh, told to merge and to drop nothing; polygons are cut into triangles."""
    import trimesh as t

    scene = t.load_scene(str(path), process=False, maintain_order=True)
    meshes = [mesh for mesh in scene.geometry.values() if hasattr(mesh, "faces")]
    clouds = [cloud for cloud in scene.geometry.values() if isinstance(cloud, t.PointCloud)]
    return {
        "vertices": sum(len(mesh.vertices) for mesh in meshes + clouds), "triangles": sum(len(mesh.faces) for mesh in meshes),
        "box": None if scene.bounds is None else scene.bounds.tolist(), "materials": materials_of(meshes),
    }


def materials_of(meshes):
    """The names of materials that trimesh found."""
    found = (getattr(mesh.visual, "material", None) for mesh in meshes)
    return sorted({str(m.name) for m in found if m is not None and getattr(m, "name", None)})


def vtk(path):
    """VTK's reader for the extension, without merging of points: cells by their numbers of corners."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    kind = Path(path).suffix.lower()
    if kind == ".obj":
        from vtkmodules.vtkIOGeometry import vtkOBJReader as reader_class
    elif kind == ".stl":
        from vtkmodules.vtkIOGeometry import vtkSTLReader as reader_class
    elif kind == ".ply":
        from vtkmodules.vtkIOPLY import vtkPLYReader as reader_class
    elif kind == ".vtp":
        from vtkmodules.vtkIOXML import vtkXMLPolyDataReader as reader_class
    elif kind == ".vti":
        from vtkmodules.vtkIOXML import vtkXMLImageDataReader as reader_class
    elif kind == ".slc":
        from vtkmodules.vtkIOImage import vtkSLCReader as reader_class
    else:
        from vtkmodules.vtkIOImage import vtkMetaImageReader as reader_class
    reader = reader_class()
    reader.SetFileName(str(path))
    if kind == ".stl":
        reader.MergingOff()
    reader.Update()
    data = reader.GetOutput()
    if kind == ".obj" and data.GetNumberOfPoints() == 0:
        raise ValueError("it found nothing, and only its log says why")
    if kind in (".vti", ".mhd", ".slc"):
        values = vtk_to_numpy(data.GetPointData().GetScalars() or data.GetPointData().GetArray(0))
        return {"size": list(data.GetDimensions()), "low": float(values.min()), "high": float(values.max())}
    offsets = data.GetPolys().GetOffsetsArray()
    corners = np.diff(vtk_to_numpy(offsets)) if offsets is not None and offsets.GetNumberOfTuples() > 0 else np.zeros(0, int)
    points = data.GetPoints()
    return {
        "vertices": data.GetNumberOfPoints(), "polygons": len(corners), "triangles": int(np.maximum(corners - 2, 0).sum()),
        "box": None if points is None else box_of(vtk_to_numpy(points.GetData())),
    }


def lines_of_obj(path):
    """The lines v and f of an OBJ."""
    text = Path(path).read_bytes().replace(b"\r\n", b"\n").replace(b"\\\n", b" ").decode("utf-8", "replace")
    rows = [words for words in (line.split("#")[0].split() for line in text.split("\n")) if words]
    corners = np.array([len(words) - 1 for words in rows if words[0] == "f"], int)
    points = [[float(x) for x in words[1:4]] for words in rows if words[0] == "v"]
    return {
        "vertices": len(points), "polygons": int((corners >= 3).sum()),
        "triangles": int(np.maximum(corners - 2, 0).sum()), "box": box_of(points),
    }


def plyfile(path):
    """plyfile: rows of elements, and the lengths of the lists of faces."""
    import plyfile as p

    data = p.PlyData.read(str(path))
    names = {element.name: element for element in data.elements}
    vertex = names.get("vertex")
    corners = np.zeros(0, int)
    if "face" in names:
        lists = [x.name for x in names["face"].properties if x.name in ("vertex_indices", "vertex_index")]
        if lists:
            corners = np.array([len(row) for row in names["face"].data[lists[0]]], int)
    points = None
    if vertex is not None and len(vertex.data) and {"x", "y", "z"} <= {x.name for x in vertex.properties}:
        points = np.stack([np.asarray(vertex.data[axis], np.float64) for axis in "xyz"], axis=1)
    return {
        "vertices": 0 if vertex is None else vertex.count, "polygons": int((corners >= 3).sum()),
        "triangles": int(np.maximum(corners - 2, 0).sum()), "box": None if points is None else box_of(points),
    }


def gltf_json(path):
    """The JSON of a glTF: what its accessors count, for the meshes that nodes show."""
    data = Path(path).read_bytes()
    if data[:4] == b"glTF":
        data = data[20:20 + int.from_bytes(data[12:16], "little")]
    tree = json.loads(data)
    accessors, nodes, meshes = tree.get("accessors", []), tree.get("nodes", []), tree.get("meshes", [])
    scenes = tree.get("scenes", [])
    roots = range(len(nodes))
    if scenes:
        roots = scenes[tree.get("scene", 0)].get("nodes", [])
    shown, below, seen = [], list(roots), set()
    while below:
        at = below.pop()
        if at in seen:
            continue
        seen.add(at)
        below.extend(nodes[at].get("children", []))
        if "mesh" in nodes[at]:
            shown.append(nodes[at]["mesh"])
    found = {"vertices": 0, "triangles": 0, "parts": 0, "shown": 0, "other": 0}
    for mesh in sorted(set(shown)):
        points, n = set(), 0
        for primitive in meshes[mesh]["primitives"]:
            attributes, mode = primitive["attributes"], primitive.get("mode", 4)
            if "POSITION" not in attributes or mode not in VERTICES_OF_MODE:
                found["other"] += 1
                continue
            at = primitive.get("indices", attributes["POSITION"])
            n += VERTICES_OF_MODE[mode](accessors[at]["count"])
            points.add(attributes["POSITION"])
        found["vertices"] += sum(accessors[at]["count"] for at in points)
        found["triangles"] += n
        found["parts"] += 1
        found["shown"] += n * shown.count(mesh)
    found["materials"] = sorted(m.get("name", "") for m in tree.get("materials", []))
    return found


def lib3mf(path):
    """lib3mf: meshes of the model and of the parts that it names."""
    from lib3mf import get_wrapper

    model = get_wrapper().CreateModel()
    model.QueryReader("3mf").ReadFromFile(str(path))
    objects, n_vertices, n_triangles, parts = model.GetMeshObjects(), 0, 0, 0
    while objects.MoveNext():
        mesh = objects.GetCurrentMeshObject()
        n_vertices += mesh.GetVertexCount()
        n_triangles += mesh.GetTriangleCount()
        parts += 1
    return {"vertices": n_vertices, "triangles": n_triangles, "parts": parts}


def usd(path):
    """OpenUSD: its meshes, at the places of their prims, what refers to one included."""
    from pxr import Usd, UsdGeom, UsdShade

    stage = Usd.Stage.Open(str(path))
    found = {"vertices": 0, "triangles": 0, "polygons": 0, "parts": 0, "materials": []}
    points = []
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
        if prim.IsA(UsdShade.Material):
            found["materials"].append(prim.GetName())
        if not prim.IsA(UsdGeom.Mesh):
            continue
        mesh = UsdGeom.Mesh(prim)
        corners = np.asarray(mesh.GetFaceVertexCountsAttr().Get() or [], int)
        at = np.asarray(mesh.GetPointsAttr().Get() or [], np.float64).reshape(-1, 3)
        matrix = np.asarray(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(0))
        points.append(at @ matrix[:3, :3] + matrix[3, :3])
        found["vertices"] += len(at)
        found["polygons"] += len(corners)
        found["triangles"] += int(np.maximum(corners - 2, 0).sum())
        found["parts"] += 1
    found["box"] = box_of(np.concatenate(points)) if points else None
    return found


def nibabel(path):
    """nibabel: size of the lattice, and the range of its samples as the file scales them."""
    import nibabel as n

    image = n.load(str(path))
    values = np.asarray(image.dataobj)
    return {"size": list(image.shape[:3]), "low": float(values.min()), "high": float(values.max())}


def numpy(path):
    """NumPy; a[i, j, k] is at x = k, y = j, z = i."""
    values = np.load(path)
    return {"size": list(values.shape[::-1]), "low": float(values.min()), "high": float(values.max())}


def svgelements(path):
    """svgelements: shapes that are drawn, and their subpaths."""
    import svgelements as s

    shapes = [element for element in s.SVG.parse(str(path)).elements() if isinstance(element, s.Shape)]
    paths = [s.Path(shape) for shape in shapes]
    return {"elements": len(shapes), "subpaths": sum(len(list(path.as_subpaths())) for path in paths)}


def first_line(path):
    """The number that a list of patches begins with."""
    return {"patches": int(Path(path).read_text().split()[0])}


def lines_of_off(path):
    """The numbers of an OFF of text, wherever its lines end; colours after the corners of a face are not expected."""
    text = "\n".join(line.split("#")[0] for line in Path(path).read_text().split("\n"))
    words = text.replace("OFF", " ", 1).split()
    n_points, n_faces = int(words[0]), int(words[1])
    at, corners = 3 + 3 * n_points, []
    for _ in range(n_faces):
        corners.append(int(words[at]))
        at += 1 + corners[-1]
    points = np.array(words[3:3 + 3 * n_points], np.float64)
    return {
        "vertices": n_points, "polygons": n_faces, "triangles": sum(max(n - 2, 0) for n in corners), "box": box_of(points),
    }


def lines_of_vm(path):
    """The distinct steps of an op list that its last step needs."""
    numbers, names, last = {}, {}, None
    for line in Path(path).read_text().split("\n"):
        words = line.split("#")[0].split()
        if words:
            step = (words[1], *(float(x) if words[1] == "const" else names[x] for x in words[2:]))
            last = names[words[0]] = numbers.setdefault(step, len(numbers))
    steps, seen, below = list(numbers), set(), [last]
    while below:
        at = below.pop()
        if at not in seen:
            seen.add(at)
            below.extend(steps[at][1:] if steps[at][0] != "const" else ())
    return {"terms": len(seen)}


READERS = {
    "MeshLab": meshlab, "trimesh": trimesh, "VTK": vtk, "lines": lines_of_obj, "plyfile": plyfile, "JSON": gltf_json,
    "lib3mf": lib3mf, "OpenUSD": usd, "nibabel": nibabel, "NumPy": numpy, "svgelements": svgelements,
    "first line": first_line, "steps": lines_of_vm, "numbers": lines_of_off,
}


def main():
    """Answers until stdin ends. What the programs print goes to stderr."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    for line in sys.stdin:
        name, path = line.rstrip("\n").split("\t")
        try:
            with contextlib.redirect_stdout(sys.stderr):
                found = READERS[name](path)
        except BaseException as error:  # Some raise their own kind beside Exception.
            found = {"error": f"{type(error).__name__}: {error}"[:200]}
        answers.write(json.dumps(found) + "\n")
        answers.flush()


if __name__ == "__main__":
    main()
