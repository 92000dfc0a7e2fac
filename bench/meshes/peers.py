"""One job of one peer, timed: `peers.py PEER JOB THREADS MESH [MESH]` prints a line of JSON as the `meshes` program does."""

import json
import statistics
import sys
import time

import numpy as np


def read(path):
    """The arrays that the `meshes` program wrote."""
    raw = open(path, "rb").read()
    n, m = np.frombuffer(raw, "<u8", 2)
    points = np.frombuffer(raw, "<f8", 3 * int(n), 16).reshape(-1, 3)
    faces = np.frombuffer(raw, "<u4", 3 * int(m), 16 + 24 * int(n)).reshape(-1, 3)
    return points.copy(), faces.astype(np.int32)


def timed(work, repeats=3, prepare=lambda: None):
    """The median of the times of `work(prepare())`, without those of `prepare`, and the last result."""
    times = []
    for _ in range(repeats):
        given = prepare()
        start = time.perf_counter()
        found = work() if given is None else work(given)
        times.append(time.perf_counter() - start)
    return statistics.median(times), found


def units(n):
    """The random numbers of the `meshes` program, from -1 to 1."""
    state, numbers = 1, []
    for _ in range(n):
        state = (state * 6364136223846793005 + 1) % (1 << 64)
        numbers.append((state >> 11) / (1 << 53))
    return 2 * np.array(numbers) - 1


def points_for(n=200_000):
    """The points of the `closest` job."""
    return units(3 * n).reshape(-1, 3) * [1.4, 1.4, 0.4]


def rays_for(job):
    """Origins and directions of the jobs about rays."""
    if job == "rays-random":
        rays = units(6 << 19).reshape(-1, 6)
        return 1.5 * rays[:, :3], rays[:, 3:]
    x, y = np.meshgrid(np.arange(1024) / 512 - 1, np.arange(1024) / 512 - 1)
    directions = np.stack([0.45 * x, 0.87 - 0.2 * y, -0.5 + 0.35 * y], axis=-1).reshape(-1, 3)
    return np.broadcast_to([0.3, -4.2, 2.4], directions.shape), directions


def trimesh_(job, threads, meshes):
    import trimesh

    points, faces = meshes[0]
    if job == "whole":
        def work():
            mesh = trimesh.Trimesh(points, faces, process=False)
            mesh.merge_vertices()
            return len(mesh.vertex_normals), mesh.is_watertight, mesh.is_winding_consistent, mesh.euler_number
        return timed(work)
    if job == "closest":
        asked = points_for(2_000)
        mesh = trimesh.Trimesh(points, faces, process=False)
        _ = mesh.triangles_tree
        seconds, found = timed(lambda: len(trimesh.proximity.closest_point(mesh, asked)[0]), 1)
        return seconds * 100, found
    return None


def vtk_(job, threads, meshes):
    import vtk
    from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

    def data(mesh):
        points, faces = mesh
        poly = vtk.vtkPolyData()
        vtk_points = vtk.vtkPoints()
        vtk_points.SetDataTypeToDouble()
        vtk_points.SetData(numpy_to_vtk(points, deep=True))
        cells = vtk.vtkCellArray()
        rows = np.hstack([np.full((len(faces), 1), 3), faces]).astype(np.int64).ravel()
        cells.ImportLegacyFormat(numpy_to_vtkIdTypeArray(rows, deep=True))
        poly.SetPoints(vtk_points)
        poly.SetPolys(cells)
        return poly

    if job == "whole":
        def work(poly):
            clean = vtk.vtkStaticCleanPolyData()
            clean.SetInputData(poly)
            normals = vtk.vtkPolyDataNormals()
            normals.SetInputConnection(clean.GetOutputPort())
            normals.SplittingOff()
            normals.ConsistencyOff()
            normals.ComputePointNormalsOn()
            normals.Update()
            edges = vtk.vtkFeatureEdges()
            edges.SetInputConnection(clean.GetOutputPort())
            edges.BoundaryEdgesOn()
            edges.NonManifoldEdgesOn()
            edges.FeatureEdgesOff()
            edges.ManifoldEdgesOff()
            edges.Update()
            return normals.GetOutput().GetNumberOfPoints(), edges.GetOutput().GetNumberOfCells()
        return timed(work, prepare=lambda: data(meshes[0]))
    if job == "weld":
        def weld(poly):
            clean = vtk.vtkStaticCleanPolyData()
            clean.SetInputData(poly)
            clean.Update()
            return clean.GetOutput().GetNumberOfPoints()
        return timed(weld, prepare=lambda: data(meshes[0]))
    if job == "closest":
        asked = points_for(20_000)
        locator = vtk.vtkStaticCellLocator()
        locator.SetDataSet(data(meshes[0]))
        locator.BuildLocator()
        cell, at, which, square, kind = vtk.vtkGenericCell(), [0.0] * 3, vtk.mutable(0), vtk.mutable(0.0), vtk.mutable(0)

        def ask():
            for point in asked:
                locator.FindClosestPoint(point, at, cell, which, kind, square)
            return len(asked)
        seconds, found = timed(ask, 1)
        return seconds * 10, found
    return None


def open3d_(job, threads, meshes):
    import open3d

    def legacy(mesh):
        vector = open3d.utility
        return open3d.geometry.TriangleMesh(vector.Vector3dVector(mesh[0]), vector.Vector3iVector(mesh[1]))

    if job == "whole":
        def work(mesh):
            mesh.remove_duplicated_vertices()
            mesh.compute_vertex_normals()
            found = mesh.is_edge_manifold(), mesh.is_vertex_manifold(), mesh.is_orientable()
            return len(mesh.vertex_normals), *found
        return timed(work, prepare=lambda: legacy(meshes[0]))
    if job == "closest":
        tensor = open3d.t.geometry.TriangleMesh.from_legacy(legacy(meshes[0]))
        scene = open3d.t.geometry.RaycastingScene(nthreads=threads)
        scene.add_triangles(tensor)
        asked = open3d.core.Tensor(points_for().astype(np.float32))
        scene.compute_closest_points(asked[:10], nthreads=threads)
        return timed(lambda: len(scene.compute_closest_points(asked, nthreads=threads)["points"]))
    if job.startswith("rays"):
        scene = open3d.t.geometry.RaycastingScene(nthreads=threads)
        scene.add_triangles(open3d.t.geometry.TriangleMesh.from_legacy(legacy(meshes[0])))
        rays = open3d.core.Tensor(np.hstack(rays_for(job)).astype(np.float32))
        scene.cast_rays(rays[:10], nthreads=threads)

        def cast():
            return int(np.isfinite(scene.cast_rays(rays, nthreads=threads)["t_hit"].numpy()).sum())
        return timed(cast)
    return None


def embree_(job, threads, meshes):
    from embreex import mesh_construction, rtcore_scene

    if threads != 1:
        return None
    scene = rtcore_scene.EmbreeScene()
    points, faces = meshes[0]
    mesh_construction.TriangleMesh(scene, points[faces].astype(np.float32))
    origins, directions = (array.astype(np.float32).copy() for array in rays_for(job))
    scene.run(origins[:10], directions[:10])
    return timed(lambda: int((scene.run(origins, directions) >= 0).sum()))


def pymeshlab_(job, threads, meshes):
    import pymeshlab

    if job == "deviation":
        both = pymeshlab.MeshSet()
        for points, faces in meshes:
            both.add_mesh(pymeshlab.Mesh(points, faces))

        def work():
            found = [
                both.get_hausdorff_distance(
                    sampledmesh=a, targetmesh=1 - a, samplevert=True, sampleedge=False, sampleface=True, samplenum=2_000_000,
                    maxdist=pymeshlab.PercentageValue(100),
                )["max"]
                for a in (0, 1)
            ]
            return max(found)
        return timed(work, 1)
    if job == "self":
        def select(given):
            given.compute_selection_by_self_intersections_per_face()
            return given.current_mesh().selected_face_number()

        def prepare():
            one = pymeshlab.MeshSet()
            one.add_mesh(pymeshlab.Mesh(*meshes[0]))
            return one
        return timed(select, 1, prepare)
    return None


def meshlib_(job, threads, meshes):
    from meshlib import mrmeshnumpy, mrmeshpy

    made = [mrmeshnumpy.meshFromFacesVerts(faces, points) for points, faces in meshes]
    if job == "self":
        # The tree is part of the work, as it is on the other sides; a mesh keeps it until its caches are invalid.
        def collide(mesh):
            return mrmeshpy.findSelfCollidingTriangles(mesh).size()

        def prepare():
            made[0].invalidateCaches()
            return made[0]
        return timed(collide, prepare=prepare)
    if job == "deviation":
        return timed(lambda: mrmeshpy.findMaxDistanceSq(mrmeshpy.MeshPart(made[0]), mrmeshpy.MeshPart(made[1])) ** 0.5)
    if job == "closest":
        asked = [mrmeshpy.Vector3f(*point) for point in points_for(20_000)]
        made[0].getAABBTree()

        def ask():
            for point in asked:
                mrmeshpy.findProjection(point, made[0])
            return len(asked)
        seconds, found = timed(ask, 1)
        return seconds * 10, found
    return None


def igl_(job, threads, meshes):
    import igl

    points, faces = meshes[0]
    if job == "closest":
        tree = igl.AABB()
        tree.init(points, faces.astype(np.int64))
        asked = points_for()
        return timed(lambda: len(tree.squared_distance(points, faces.astype(np.int64), asked)[0]), 1)
    if job == "deviation":
        return timed(lambda: float(igl.hausdorff(*meshes[0], *meshes[1])), 1)
    return None


def main():
    peer, job, threads, *paths = sys.argv[1:]
    found = globals()[peer + "_"](job, int(threads), [read(path) for path in paths])
    seconds, value = found if found else (None, None)
    print(json.dumps({"job": job, "seconds": seconds, "found": value}, default=str))


main()
