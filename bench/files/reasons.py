"""The words of docs/corpus.md: its text, names for files without shapes, and reasons for other counts."""

from pathlib import Path

ABOUT = """
# Results for every file of the test data

`chordal inspect` was run on each of the {files} files in the folder of test data (`CHORDAL_DATA`, else
`../shared/data`), and other programs counted the same files. `make -C bench corpus` writes this page, and
`make -C bench corpus-check` fails if it is out of date. Files of one folder with equal results share a row.

| files | |
|---|---|
| {read} | read, {warned} of them with warnings |
| {refused} | refused with a code, a place and a reason: they are broken, or need a feature that is not supported |
| {companions} | companions: buffers, materials and samples that another file names |
| {others} | of a format that is not read, or without any shape; refused as such |
| {texts} | licences and other texts |
| {crashed} | ended by a signal, a panic, or the limit of 60 s |

Of the {read} files that are read, {asked} have a format that other programs read as well. In {agreed} of those at least
one program counts the same, and the rows of the others say why none does. The remaining {alone} are shape scripts,
which only Chordal reads. Files that take more than 64 MiB plus 16 times their size to inspect: {heavy}.

In the tables, *v* stands for vertices and *t* for triangles. A vertex of an OBJ is a line `v`, whatever normals and
texture coordinates its corners have; a vertex of an STL is a corner; in every other format it is what the file calls a
vertex. If parts are shown more than once, the number of triangles shown stands beside. The last column names the
programs that count the same.
"""

ABOUT_READERS = """
`bench/files/requirements.txt` has the versions. *lines*, *numbers*, *steps*, *JSON* and *first line* are short readers
in `bench/files/readers.py`, which share no code with the library. A program may differ in a count only for the reason
in the row; `box` is the lowest and the highest corner of the scene.
"""

OF_FILES = {
    "implicit/fidget/models/bear.vm": "657 distinct steps; each logarithm of a sum of exponentials becomes one term",
    "implicit/fidget/models/prospero.vm": "7,591 distinct steps; adding 0 and multiplying a term by itself take fewer terms",
}

# By format, reader and what it counts otherwise.
OF_KINDS = {
    ("3mf", "trimesh", "box"): "two parts of the package number their objects alike, and the first object is shown for both; lib3mf agrees with Chordal",
    ("3mf", "trimesh", "vertices,triangles,box"): "finds no mesh in the other parts of the package",
    ("dae", "trimesh", "vertices,triangles,box"): "finds no mesh",
    ("glb", "trimesh", "box"): "does not decode Draco",
    ("glb", "trimesh", "error"): "needs a buffer that exists only in compressed views (`EXT_meshopt_compression`)",
    ("gltf", "trimesh", "box"): "counts points and lines, shows nothing if the file has no scene, and ignores the values of a sparse accessor",
    ("gltf", "trimesh", "vertices"): "counts an accessor once for each primitive that shares it",
    ("gltf", "trimesh", "vertices,box"): "counts points, which Chordal leaves out with a warning",
    ("gltf", "trimesh", "vertices,triangles,box"): "drops triangle fans",
    ("obj", "MeshLab", "triangles"): "drops triangles that use a vertex twice; cuts polygons that are not flat, or have corners on straight sides, into fewer",
    ("obj", "VTK", "error"): "stops at a face of two corners, an empty material name, or `1//`",
    ("obj", "VTK", "vertices"): "splits vertices whose corners have different texture coordinates or normals",
    ("obj", "VTK", "vertices,box"): "the same, and drops vertices without faces",
    ("obj", "trimesh", "error"): "does not accept negative indices of texture coordinates",
    ("obj", "trimesh", "vertices"): "splits vertices with several texture coordinates or materials, and drops vertices without faces",
    ("obj", "trimesh", "vertices,box"): "the same; the dropped vertices reach out of the box of the others",
    ("off", "MeshLab", "error"): "does not accept comments before the counts, a keyword without a space after it, or a face over two lines",
    ("off", "numbers", "error"): "does not accept colours after the corners of a face",
    ("off", "trimesh", "triangles"): "miscounts a face that is written over two lines",
    ("ply", "MeshLab", "error"): "does not accept lines that end in `\\r` alone, integer coordinates, or a file without vertices",
    ("ply", "plyfile", "error"): "does not accept `\\r\\n` after a binary header, or `obj_info` between elements",
    ("ply", "trimesh", "error"): "does not accept lines that end in `\\r` alone",
    ("stl", "MeshLab", "error"): "does not accept a file without triangles",
    ("stl", "MeshLab", "vertices"): "merges equal corners",
    ("stl", "MeshLab", "vertices,triangles"): "merges equal corners; drops duplicate triangles, triangles without area, or one of a second solid",
    ("stl", "MeshLab", "vertices,triangles,box"): "the same",
    ("stl", "trimesh", "vertices"): "merges corners in files of several solids",
    ("vm", "steps", "terms"): "see the rows of the two files",
}

OTHERS = {
    ".mtl": ("other format", "a material library that no file names"), ".b3dm": ("other format", "3D Tiles 1.0"),
    ".subtree": ("other format", "a subtree of an implicit tileset of 3D Tiles"),
    ".ttf": ("other format", "a font"), ".dem": ("other format", "a digital elevation model (USGS)"),
    ".ctm": ("other format", "OpenCTM"), ".msh": ("other format", "Gmsh"), ".mesh": ("other format", "Medit"),
    ".zip": ("other format", "a zip archive"), ".bz2": ("other format", "compressed by bzip2"),
    ".gii.gz": ("other format", "GIFTI"), ".xml": ("other format", "Irrlicht"), ".npz": ("other format", "weights of a network: no array has three axes"),
    ".bin": ("other format", "a buffer that no file names"),
}


def other(name):
    """What a file is whose format is not known, as its fate and its words."""
    path = Path(name)
    if path.name.upper().startswith(("LICENSE", "README", "COPYRIGHT", "SUBTREEINFO")):
        return "text", ""
    if path.name == "tileset.json":
        return "other format", "a tileset of 3D Tiles, without shapes of its own"
    if name.startswith("polygon/earcut/"):
        return "other format", "polygons as bare arrays of rings, without any key"
    if path.name.startswith("empty."):
        return "other format", f"an empty file, named like a format that is not read ({path.suffix[1:]})"
    if path.name.startswith("clusterfuzz"):
        return "other format", "random bytes without an extension"
    for ending, said in OTHERS.items():
        if path.name.endswith(ending):
            return said
    return "refused", ""
