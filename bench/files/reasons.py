"""The words of docs/corpus.md: what files that are no models are, and why other programs count otherwise."""

from pathlib import Path

ABOUT = """
# What happens to each file of the test data

`chordal inspect` on each of the {files} files of the folder of test data (`CHORDAL_DATA`, else `../shared/data`),
beside what other programs count in the same file. `make -C bench corpus` writes this page, and
`make -C bench corpus-check` fails where it is no longer true. Files of one folder that say the same are one row.

| files | |
|---|---|
| {read} | read, {warned} of them with warnings |
| {refused} | refused with a code, its place and the reason: they are broken, or ask for what is not read |
| {companions} | companions: buffers, materials and samples that are named by another file |
| {others} | of a format that is not read, or one that holds no shape; refused as such |
| {texts} | licences and texts |
| {crashed} | ended otherwise: a signal, a panic, or 60 s |

Of the {read} files that are read, other programs read the formats of {asked}; for {agreed} of them at least one
counts the same, and the rest is explained in their rows. The other {alone} are shape scripts, which only Chordal
reads. Files that take more than 64 MiB and 16 times their size to inspect: {heavy}.

In the tables, *v* are vertices and *t* triangles. For an OBJ, a vertex is a line `v`, whatever normals and texture
coordinates its corners have; for an STL it is a corner; else it is what the file calls so. Where parts are shown more
than once, the triangles that are shown stand beside. The last column names the programs that count the same.
"""

ABOUT_READERS = """
Versions are those of `bench/files/requirements.txt`. *lines*, *numbers*, *steps*, *JSON* and *first line* are
readers of a few lines in `bench/files/readers.py`, which share no code with the library. A program may differ in a
kind of count for one of these reasons only; `box` is the lowest and highest corner of the scene.
"""

OF_FILES = {
    "implicit/fidget/models/bear.vm": "657 distinct steps; the logarithms of sums of exponentials become one term each",
    "implicit/fidget/models/prospero.vm": "7,591 distinct steps; sums with 0 and products of a term with itself become fewer terms",
}

# By format, reader and what it counts otherwise.
OF_KINDS = {
    ("3mf", "trimesh", "box"): "objects of two parts of the package have one number, and the first is shown for both; lib3mf has our box",
    ("3mf", "trimesh", "vertices,triangles,box"): "finds no mesh in the package's other parts",
    ("dae", "trimesh", "vertices,triangles,box"): "finds no mesh",
    ("glb", "trimesh", "box"): "does not decode Draco",
    ("glb", "trimesh", "error"): "a buffer that only compressed views (`EXT_meshopt_compression`) have",
    ("gltf", "trimesh", "box"): "counts points and lines, shows nothing without a scene, and leaves out the values of a sparse accessor",
    ("gltf", "trimesh", "vertices"): "an accessor that several primitives share counts for each",
    ("gltf", "trimesh", "vertices,box"): "points, which Chordal leaves out with a warning",
    ("gltf", "trimesh", "vertices,triangles,box"): "triangle fans become nothing",
    ("obj", "MeshLab", "triangles"): "drops triangles with a corner twice; cuts polygons that bend, or have corners on straight sides, into fewer",
    ("obj", "VTK", "error"): "stops at a face of two corners, an empty name of a material, or `1//`",
    ("obj", "VTK", "vertices"): "a vertex for each corner whose texture coordinate or normal is another",
    ("obj", "VTK", "vertices,box"): "the same, without the vertices that no face has",
    ("obj", "trimesh", "error"): "negative indices to texture coordinates",
    ("obj", "trimesh", "vertices"): "a vertex for each texture coordinate or material, and none without a face",
    ("obj", "trimesh", "vertices,box"): "the same: the vertices without a face reach out of the box of the others",
    ("off", "MeshLab", "error"): "comments before the counts, no space after the keyword, or a face over two lines",
    ("off", "numbers", "error"): "colours after the faces' corners",
    ("off", "trimesh", "triangles"): "a face stands over two lines",
    ("ply", "MeshLab", "error"): "`\\r` alone as the end of a line, coordinates that are whole numbers, or no vertices",
    ("ply", "plyfile", "error"): "`\\r\\n` after a binary header, and `obj_info` between elements",
    ("ply", "trimesh", "error"): "`\\r` alone as the end of a line",
    ("stl", "MeshLab", "error"): "no triangles",
    ("stl", "MeshLab", "vertices"): "merges equal corners",
    ("stl", "MeshLab", "vertices,triangles"): "merges equal corners; drops triangles that are there twice, without area, or one of a second solid",
    ("stl", "MeshLab", "vertices,triangles,box"): "the same",
    ("stl", "trimesh", "vertices"): "merges the corners of files of several solids",
    ("vm", "steps", "terms"): "in the rows of the two files",
}

OTHERS = {
    ".mtl": ("other format", "a material library that no file names"), ".b3dm": ("other format", "3D Tiles 1.0"),
    ".subtree": ("other format", "3D Tiles, a subtree of an implicit tileset"),
    ".ttf": ("other format", "a typeface"), ".dem": ("other format", "a digital elevation model (USGS)"),
    ".ctm": ("other format", "OpenCTM"), ".msh": ("other format", "Gmsh"), ".mesh": ("other format", "Medit"),
    ".zip": ("other format", "a zip archive"), ".bz2": ("other format", "packed by bzip2"),
    ".gii.gz": ("other format", "GIfTI"), ".xml": ("other format", "Irrlicht"), ".npz": ("other format", "weights of a network: no array has three axes"),
    ".bin": ("other format", "a buffer that no file names"),
}


def other(name):
    """What a file is whose format is not known, as its fate and its words."""
    path = Path(name)
    if path.name.upper().startswith(("LICENSE", "README", "COPYRIGHT", "SUBTREEINFO")):
        return "text", ""
    if path.name == "tileset.json":
        return "other format", "3D Tiles, a tileset: no shapes in it"
    if name.startswith("polygon/earcut/"):
        return "other format", "polygons as bare arrays of rings, without a name for what they are"
    if path.name.startswith("empty."):
        return "other format", f"empty, with the name of a format that is not read ({path.suffix[1:]})"
    if path.name.startswith("clusterfuzz"):
        return "other format", "random bytes without an extension"
    for ending, said in OTHERS.items():
        if path.name.endswith(ending):
            return said
    return "refused", ""
