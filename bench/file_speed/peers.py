"""Another program that reads or writes a file: `peers.py PROGRAM read|write THREADS FILE` prints a line of JSON with the
least of five times, or of those that ten seconds allow, the bytes and the triangles. What is timed ends with arrays of
positions and triangles in memory, or with a file on the disk of memory."""

import json
import os
import sys
import tempfile
import time
from pathlib import Path


def timed(work):
    times, last = [], None
    while len(times) < 5 and sum(times) < 10:
        last = None
        start = time.perf_counter()
        last = work()
        times.append(time.perf_counter() - start)
    return min(times), last


def size(path):
    beside = path.with_suffix(".bin")
    return path.stat().st_size + (beside.stat().st_size if path.suffix == ".gltf" and beside.exists() else 0)


class Trimesh:
    def __init__(self):
        import trimesh
        self.trimesh = trimesh

    def read(self, path):
        # Nothing is merged, checked or left out.
        return self.trimesh.load(path, process=False, force="mesh")

    def triangles(self, mesh):
        return len(mesh.faces)

    def write(self, mesh, path, ascii):
        kind = path.suffix[1:]
        options = {"encoding": "ascii"} if ascii and kind == "ply" else {}
        mesh.export(path, file_type="stl_ascii" if ascii and kind == "stl" else kind, **options)


class Meshio:
    def __init__(self):
        import meshio
        self.meshio = meshio

    def read(self, path):
        return self.meshio.read(path)

    def triangles(self, mesh):
        return sum(len(block.data) for block in mesh.cells if block.type == "triangle")

    def write(self, mesh, path, ascii):
        options = {"binary": not ascii} if path.suffix in (".ply", ".stl") else {}
        self.meshio.write(path, mesh, **options)


class Open3D:
    def __init__(self):
        import open3d
        self.io = open3d.io

    def read(self, path):
        return self.io.read_triangle_mesh(str(path))

    def triangles(self, mesh):
        return len(mesh.triangles)

    def write(self, mesh, path, ascii):
        if path.suffix == ".stl":
            # It is the only format that it refuses without normals of triangles.
            mesh.compute_triangle_normals()
        assert self.io.write_triangle_mesh(str(path), mesh, write_ascii=ascii)


class TinyObjLoader:
    def __init__(self):
        import tinyobjloader
        self.tinyobjloader = tinyobjloader

    def read(self, path):
        reader = self.tinyobjloader.ObjReader()
        assert reader.ParseFromFile(str(path))
        return reader

    def triangles(self, reader):
        return sum(len(shape.mesh.num_face_vertices) for shape in reader.GetShapes())


class Vtk:
    def __init__(self):
        import vtk
        self.vtk = vtk

    def read(self, path):
        kinds = {".obj": "vtkOBJReader", ".ply": "vtkPLYReader", ".stl": "vtkSTLReader", ".vtp": "vtkXMLPolyDataReader"}
        reader = getattr(self.vtk, kinds[path.suffix])()
        reader.SetFileName(str(path))
        reader.Update()
        return reader.GetOutput()

    def triangles(self, mesh):
        return mesh.GetNumberOfPolys()

    def write(self, mesh, path, ascii):
        kinds = {".obj": "vtkOBJWriter", ".ply": "vtkPLYWriter", ".stl": "vtkSTLWriter", ".vtp": "vtkXMLPolyDataWriter"}
        writer = getattr(self.vtk, kinds[path.suffix])()
        writer.SetFileName(str(path))
        writer.SetInputData(mesh)
        if path.suffix in (".ply", ".stl"):
            writer.SetFileTypeToASCII() if ascii else writer.SetFileTypeToBinary()
        writer.Write()


PROGRAMS = {"trimesh": Trimesh, "meshio": Meshio, "open3d": Open3D, "tinyobjloader": TinyObjLoader, "vtk": Vtk}


def main():
    name, verb, _threads, path = sys.argv[1:]
    program, path = PROGRAMS[name](), Path(path)
    is_text = path.stem == "text"
    if verb == "read":
        seconds, mesh = timed(lambda: program.read(path))
        n_bytes = size(path)
    else:
        mesh = program.read(path)
        # A disk of memory: the speed of a disk is not what is asked.
        with tempfile.TemporaryDirectory(dir="/dev/shm" if os.path.isdir("/dev/shm") else None) as folder:
            out = Path(folder) / f"out{path.suffix}"
            seconds, _ = timed(lambda: program.write(mesh, out, is_text))
            n_bytes = sum(file.stat().st_size for file in Path(folder).iterdir())
    print(json.dumps({"seconds": seconds, "bytes": n_bytes, "triangles": program.triangles(mesh)}))


main()
