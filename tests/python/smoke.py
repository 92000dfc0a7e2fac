"""What a wheel must do on every system before it is given away; it needs numpy alone."""

import importlib.resources
import pickle
import subprocess
import sys

import numpy as np

import chordal

block = chordal.shapes.box(2, 2, 1) - chordal.shapes.cylinder(0.4, 2)
mesh = block.mesh(tol=0.05)
assert mesh.bound.evidence == "proved" and mesh.is_watertight
assert np.array_equal(pickle.loads(pickle.dumps(mesh)).vertices, mesh.vertices)
assert mesh.to_bytes("glb")[:4] == b"glTF"
assert len(mesh.lod(pixels=1)) >= 1
# What Node has built is in it: the viewer of notebooks, and the page of the studio.
assert importlib.resources.files("chordal").joinpath("viewer.js").is_file()
with subprocess.Popen([sys.executable, "-m", "chordal", "studio"], stdout=subprocess.PIPE, encoding="utf-8") as studio:
    assert studio.stdout is not None
    assert studio.stdout.readline().startswith("Chordal studio: http"), "the page is not built in"
    studio.kill()
print(chordal.__version__, repr(mesh))
