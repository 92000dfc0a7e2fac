"""One peer on a volume: `peers.py WHO THREADS PATH N` prints a line of JSON with the median seconds and the triangles."""

import json
import resource
import sys
import time

import numpy as np

who, threads, path, n = sys.argv[1], int(sys.argv[2]), sys.argv[3], int(sys.argv[4])
values = np.fromfile(path, np.float32).reshape(n, n, n)


def open_edges(faces):
    """How many edges have one face: each is between two vertices."""
    faces = np.asarray(faces, np.int64).reshape(-1, 3)
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    _, counts = np.unique(edges[:, 0] << 32 | edges[:, 1], return_counts=True)
    return int((counts == 1).sum())


def skimage(volume):
    """Lewiner's marching cubes."""
    from skimage.measure import marching_cubes

    return marching_cubes(volume, 0.0)[1]


def mcubes(volume):
    """PyMCubes' marching cubes."""
    import mcubes as m

    return m.marching_cubes(volume, 0.0)[1]


def vtk():
    """A function that runs Flying Edges, with everything that is not the triangles switched off."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonCore import vtkSMPTools
    from vtkmodules.vtkCommonDataModel import vtkImageData
    from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D

    vtkSMPTools.SetBackend("STDThread")
    vtkSMPTools.Initialize(threads)
    assert vtkSMPTools.GetBackend() == "STDThread"
    image = vtkImageData()
    image.SetDimensions(n, n, n)
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel()))

    def work():
        edges = vtkFlyingEdges3D()
        edges.SetInputData(image)
        edges.SetValue(0, 0.0)
        edges.ComputeNormalsOff()
        edges.ComputeGradientsOff()
        edges.ComputeScalarsOff()
        edges.Update()
        return edges.GetOutput().GetNumberOfPolys()

    return work


if who.startswith("ties-"):
    # The samples rounded to tenths in a shell of outside ones, so that every edge should have two faces.
    rounded = np.pad(np.round(values * 10) / np.float32(10), 1, constant_values=9.0)
    faces = {"ties-skimage": skimage, "ties-mcubes": mcubes}[who](rounded)
    print(json.dumps({"seconds": None, "triangles": len(faces), "open": open_edges(faces)}))
else:
    work = {"vtk": vtk, "skimage": lambda: lambda: len(skimage(values)), "mcubes": lambda: lambda: len(mcubes(values))}[who]()
    seconds = []
    for _ in range(9 if who == "vtk" else 3):
        start = time.perf_counter()
        triangles = work()
        seconds.append(time.perf_counter() - start)
    peak = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(json.dumps({"seconds": sorted(seconds)[len(seconds) // 2], "triangles": triangles, "open": None, "peak": peak}))
