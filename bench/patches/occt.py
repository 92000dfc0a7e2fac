"""OpenCASCADE's side of the patch bench: meshes the corpora on one thread, times it, dumps the meshes.

`wide` makes the angular deflection so large that only the linear one acts, which is the job that is compared;
`default` is OpenCASCADE's own 0.5 rad.
A hard corpus is meshed patch by patch, a model (the teapot) as one compound of faces, and once more sewn.
"""

import json
import statistics
import struct
import time
from array import array
from pathlib import Path

from OCP.BRep import BRep_Builder, BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_Sewing
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.BRepTools import BRepTools
from OCP.collections import Array2_gp_Pnt
from OCP.Geom import Geom_BezierSurface
from OCP.gp import gp_Pnt
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS, TopoDS_Compound

OUT = Path(__file__).resolve().parent.parent / "out"
# Radians. From 6 on, measured, counts change no more: a thousand never splits an edge or a face.
ANGLES = {"wide": 1e3, "default": 0.5}
# The confusion tolerance of OpenCASCADE: edges shorter than this are poles.
DEGENERATE = 1e-7


def face(patch):
    """One patch as an untrimmed face."""
    poles = Array2_gp_Pnt(1, 4, 1, 4)
    for i, row in enumerate(patch):
        for j, (x, y, z) in enumerate(row):
            poles.SetValue(j + 1, i + 1, gp_Pnt(x, y, z))
    made = BRepBuilderAPI_MakeFace(Geom_BezierSurface(poles), DEGENERATE)
    return made.Face() if made.IsDone() else None


def compound(shapes):
    """Several shapes as one."""
    builder, whole = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(whole)
    for shape in shapes:
        builder.Add(whole, shape)
    return whole


def sewn(shapes):
    """Faces joined at their common edges, so that these are meshed once."""
    sewing = BRepBuilderAPI_Sewing(1e-6)
    for shape in shapes:
        sewing.Add(shape)
    sewing.Perform()
    return sewing.SewedShape()


def mesh(shape, tolerance, angle, repeats):
    """The median CPU time in seconds of meshing from scratch; the mesh stays on the shape."""
    times = []
    for _ in range(repeats):
        BRepTools.Clean_s(shape)
        start = time.process_time()
        BRepMesh_IncrementalMesh(shape, tolerance, False, angle, False)
        times.append(time.process_time() - start)
    return statistics.median(times)


def triangles(shape):
    """All vertices and triangles of a meshed shape, and the number of faces that have none."""
    vertices, faces, missing = array("d"), array("I"), 0
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        part = BRep_Tool.Triangulation_s(TopoDS.Face(explorer.Current()), TopLoc_Location())
        explorer.Next()
        if part is None or part.NbTriangles() == 0:
            missing += 1
            continue
        base = len(vertices) // 3 - 1
        for n in range(1, part.NbNodes() + 1):
            p = part.Node(n)
            vertices.extend((p.X(), p.Y(), p.Z()))
        for n in range(1, part.NbTriangles() + 1):
            faces.extend(base + k for k in part.Triangle(n).Get())
    return vertices, faces, missing


def dump(path, meshes):
    """Little-endian: per mesh its numbers of vertices and triangles as u32, f64 coordinates, u32 indices."""
    with open(path, "wb") as out:
        for vertices, faces in meshes:
            out.write(struct.pack("<II", len(vertices) // 3, len(faces) // 3))
            out.write(vertices.tobytes())
            out.write(faces.tobytes())


def run(corpus, tolerance, angle_name, repeats=3):
    """The rows for one corpus at one tolerance: engine, triangles, seconds, faces without a mesh."""
    patches = json.loads((OUT / f"{corpus}.json").read_text())["patches"]
    faces = [face(p) for p in patches]
    variants = {"": faces}
    if corpus == "teapot":
        variants = {"": [compound(faces)], "-sewn": [sewn(faces)]}
    for variant, shapes in variants.items():
        name = ("occt" if angle_name == "wide" else "occt-default-angle") + variant
        seconds, n_triangles, missing, meshes = 0.0, 0, 0, []
        for shape in shapes:
            if shape is None:
                missing += 1
                meshes.append((array("d"), array("I")))
                continue
            seconds += mesh(shape, float(tolerance), ANGLES[angle_name], repeats)
            vertices, indices, none = triangles(shape)
            missing += none
            n_triangles += len(indices) // 3
            meshes.append((vertices, indices))
        dump(OUT / f"{corpus}.{tolerance}.{name}.mesh", meshes)
        yield name, n_triangles, seconds, missing
