"""What things are called elsewhere, and the call that does them here: for names and keywords that somebody guesses."""

from __future__ import annotations

import difflib
import functools
import inspect
import types
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")

_FEWER = "shape.mesh(triangles=5000), or shape.mesh(tol=0.01) for the fewest within a length"
_BOUNDED = "Chordal has none, for nothing would bound what it does"

#: What all shapes do.
_VERBS: dict[str, str] = {
    **dict.fromkeys(
        ("simplify", "decimate", "decimate_pro", "reduce", "remesh", "tessellate", "triangulate", "to_mesh")
        + ("simplify_quadric_decimation", "simplify_quadratic_decimation", "simplify_vertex_clustering"),
        _FEWER,
    ),
    **dict.fromkeys(("save", "write", "save_mesh", "write_mesh", "dump"), 'shape.export("a.stl"), or shape.to_bytes("stl")'),
    **dict.fromkeys(("fill_holes", "close_holes"), "shape.mend(fill_holes=True)"),
    **dict.fromkeys(
        ("weld", "merge_vertices", "merge_close_vertices", "remove_duplicated_vertices"),
        "shape.mend(weld=True), or shape.mend(weld=1e-6) for vertices that are nearly one",
    ),
    **dict.fromkeys(("clean", "repair", "process", "fix", "make_watertight", "make_manifold"), "shape.mend(all=True)"),
    **dict.fromkeys(
        ("fix_normals", "fix_winding", "flip_normals", "orient", "orient_triangles", "invert"), "shape.mend(orient=True)"
    ),
    **dict.fromkeys(("remove_degenerate_faces", "remove_degenerate_triangles"), "shape.mend(drop_degenerate=True)"),
    **dict.fromkeys(("remove_duplicate_faces", "remove_duplicated_triangles"), "shape.mend(drop_duplicates=True)"),
    **dict.fromkeys(("remove_unreferenced_vertices", "remove_unused_points"), "shape.mend(drop_unused=True)"),
    **dict.fromkeys(
        ("signed_distance", "implicit_distance", "compute_implicit_distance", "sdf"),
        "shape.to_field()(points), negative inside",
    ),
    **dict.fromkeys(("contains", "select_enclosed_points", "is_inside"), "shape.to_field()(points) < 0"),
    **dict.fromkeys(
        ("nearest", "proximity", "closest_point", "find_closest_cell", "nearest_point"),
        "shape.to_field()(points) for distances; nearest points are those of to_trimesh().nearest",
    ),
    **dict.fromkeys(("distance", "hausdorff", "hausdorff_distance", "compare"), "shape.deviation(other)"),
    **dict.fromkeys(
        ("voxelized", "voxelize", "voxels"), "shape.bake(cells=64), the distances on a lattice; samples below 0 are inside"
    ),
    "boolean_union": "shape.union(other), or a | b",
    "boolean_difference": "shape.difference(other), or a - b",
    "boolean_intersection": "shape.intersection(other), or a & b",
    "boolean": "shape.union, difference and intersection",
    "levels": "shape.lod(…)",
    **dict.fromkeys(("to_file", "to_stl", "to_gltf"), 'shape.export("a.glb")'),
    **dict.fromkeys(("screenshot", "save_image", "picture"), 'shape.render(…).export("a.png")'),
}

#: What only a mesh does or has.
_MESHES: dict[str, str] = {
    **dict.fromkeys(("plot", "view", "display"), 'mesh.show(), in a notebook; else mesh.render().export("a.png")'),
    **dict.fromkeys(("n_faces", "n_cells", "num_faces", "n_triangles"), "len(mesh.faces)"),
    **dict.fromkeys(("n_points", "n_vertices", "num_vertices"), "len(mesh.vertices)"),
    **dict.fromkeys(("points", "verts", "positions", "v"), "mesh.vertices"),
    **dict.fromkeys(("triangles", "cells", "f", "indices", "regular_faces"), "mesh.faces"),
    **dict.fromkeys(("watertight", "is_closed", "is_manifold", "is_volume", "is_solid"), "mesh.is_watertight"),
    **dict.fromkeys(("bounding_box", "bbox", "aabb"), "mesh.bounds and mesh.extents"),
    **dict.fromkeys(("error", "max_error", "tolerance", "quality"), "mesh.bound"),
    **dict.fromkeys(("units", "length_unit"), "mesh.unit"),
    **dict.fromkeys(("convert_units", "to_units"), 'mesh.to_unit("mm")'),
    **dict.fromkeys(("apply_transform", "transformed"), "mesh.transform(matrix), a new mesh"),
    **dict.fromkeys(("apply_translation", "translated", "move", "moved"), "mesh.translate((x, y, z)), a new mesh"),
    **dict.fromkeys(("apply_scale", "scaled"), "mesh.scale(2), a new mesh"),
    **dict.fromkeys(
        ("rotated", "rotate_x", "rotate_y", "rotate_z", "rotate_vector"), 'mesh.rotate("z", 90), in degrees: a new mesh'
    ),
    **dict.fromkeys(("mirror", "reflect"), "mesh.scale((-1, 1, 1)), a new mesh"),
    **dict.fromkeys(("concatenate", "append", "merge"), "chordal.concatenate([a, b])"),
    **dict.fromkeys(("to_3dtiles", "tiles", "tileset", "to_tileset"), "mesh.lod(…).export(folder)"),
    **dict.fromkeys(
        ("to_neuroglancer", "neuroglancer", "precomputed", "to_precomputed"),
        'chordal.block_volume(labels, unit="nm").precomputed_levels(folder), of samples',
    ),
    **dict.fromkeys(("area_faces", "face_areas"), "mesh.area is that of all; of each: mesh.to_trimesh()"),
    **dict.fromkeys(("components", "connectivity", "split_bodies"), "mesh.split()"),
    **dict.fromkeys(("body_count", "n_components"), "len(mesh.split())"),
    **dict.fromkeys(("centroid", "center_of_mass", "center"), "mesh.center_mass"),
    **dict.fromkeys(("geometry", "meshes", "blocks"), "mesh.parts"),
    **dict.fromkeys(("graph", "scene"), "mesh.nodes and mesh.roots"),
    **dict.fromkeys(("visual", "texture"), "mesh.uv, mesh.colors, mesh.materials, mesh.textures and mesh.images"),
    **dict.fromkeys(("point_normals", "normal"), "mesh.vertex_normals"),
    **dict.fromkeys(("compute_normals", "compute_vertex_normals"), "mesh.vertex_normals and mesh.face_normals"),
    "cell_normals": "mesh.face_normals",
    **dict.fromkeys(("curvature", "curvatures", "mean_curvature"), "mesh.vertex_curvature()"),
    "gaussian_curvature": 'mesh.vertex_curvature("gaussian")',
    **dict.fromkeys(("as_trimesh", "trimesh"), "mesh.to_trimesh()"),
    **dict.fromkeys(("as_pyvista", "to_polydata"), "mesh.to_pyvista()"),
    "copy": "copy.copy(mesh), which is the mesh itself: it does not change",
    **dict.fromkeys(("contour", "isosurface"), "mesh.to_field().offset(distance).mesh(tol=0.01)"),
}

#: What a mesh of other libraries does and ours does not: the way there.
_ELSEWHERE: dict[str, str] = {
    **{
        name: f"{_BOUNDED}: mesh.to_trimesh().{name}, or mesh.to_pyvista(), and back by Mesh.from_"
        for name in ("convex_hull", "subdivide", "subdivide_loop", "smoothed", "unwrap", "moment_inertia", "ray", "sample")
        + ("edges", "edges_unique", "face_adjacency", "bounding_sphere", "bounding_box_oriented", "section", "submesh")
        + ("slice_plane", "update_faces", "principal_inertia_transform")
    },
    **{
        name: f"{_BOUNDED}: mesh.to_pyvista().{name}(…), or mesh.to_trimesh(), and back by Mesh.from_"
        for name in ("smooth", "smooth_taubin", "clip", "slice", "geodesic", "ray_trace", "delaunay_3d")
        + ("extract_surface", "compute_cell_sizes")
    },
    "sample_points_uniformly": f"{_BOUNDED}: mesh.to_trimesh().sample(count)",
}

_VOLUMES: dict[str, str] = {
    **dict.fromkeys(
        ("marching_cubes", "contour", "isosurface", "extract_surface", "flying_edges", "threshold"), "volume.mesh(iso=0.5)"
    ),
    "contour_labels": 'volume.mesh(labels="all")',
    **dict.fromkeys(("values", "data", "samples", "voxels", "to_numpy", "numpy"), "volume.array"),
    **dict.fromkeys(("min", "max", "mean", "std"), "the same of volume.array"),
    **dict.fromkeys(("dimensions", "dims", "size"), "volume.shape"),
    **dict.fromkeys(("resample", "crop", "gaussian_smooth"), "chordal.volume of an array that scipy.ndimage makes"),
    **dict.fromkeys(("transform", "matrix", "orientation", "direction"), "volume.affine"),
    "labels": 'volume.mesh(labels="all"), or chordal.labels(array)',
    **dict.fromkeys(("to_trimesh", "to_pyvista", "to_open3d"), "volume.mesh(iso=0.5).to_trimesh()"),
    **dict.fromkeys(("tileset", "precomputed", "to_3dtiles"), "that of chordal.block_volume(array)"),
}

_FIELDS: dict[str, str] = {
    **dict.fromkeys(("signed_distance", "sdf", "evaluate", "eval", "values", "f"), "field(points), n × 3"),
    "contains": "field(points) < 0",
    **dict.fromkeys(("translate", "moved", "at"), "field.move(x, y, z)"),
    **dict.fromkeys(("scaled", "rotated"), "field.scale(k) and field.rotate(axis, degrees)"),
    **dict.fromkeys(("round", "dilate", "grow", "erode"), "field.offset(distance)"),
    **dict.fromkeys(("hollow", "thicken"), "field.shell(thickness)"),
    **dict.fromkeys(("normal", "normals"), "field.gradient(points)"),
    **dict.fromkeys(("blend", "smooth_union"), "chordal.shapes.smooth_union(a, b, radius)"),
    **dict.fromkeys(("volume", "area", "is_watertight"), "that of its mesh: field.mesh(tol=0.01)"),
    **dict.fromkeys(("marching_cubes", "to_mesh", "generate"), "field.mesh(tol=0.01)"),
    **dict.fromkeys(
        ("sample", "grid", "to_grid", "sample_grid", "to_volume", "voxels", "rasterize"),
        "field.bake(cells=64), or field(points) of an array whose last axis is 3 long",
    ),
    **dict.fromkeys(("to_trimesh", "to_pyvista", "to_open3d"), "field.mesh(tol=0.01).to_trimesh()"),
}

_PICTURES: dict[str, str] = {
    **dict.fromkeys(("save", "write", "to_file"), 'picture.export("a.png")'),
    **dict.fromkeys(("to_pil", "image"), "PIL.Image.fromarray(picture.array)"),
    **dict.fromkeys(("data", "numpy", "to_numpy", "pixels"), "picture.array"),
    **dict.fromkeys(("show", "plot", "display"), "the picture itself, as the last line of a cell"),
    **dict.fromkeys(("size", "width", "height", "shape"), "picture.array.shape: height, width, 4"),
}

_LEVELS: dict[str, str] = {
    **dict.fromkeys(("save", "write"), 'levels.export("a.glb")'),
    **dict.fromkeys(("meshes", "levels"), "[level.mesh for level in levels]"),
}

_DEVIATIONS: dict[str, str] = {
    **dict.fromkeys(("max", "hausdorff", "distance", "value"), "deviation.at_most"),
    **dict.fromkeys(("mean", "rms"), "mesh.vertex_deviation(other).mean(), of vertices alone"),
}

#: What shapes do and what has a `shape()` does not.
_OF_SHAPES = ("mesh", "lod", "inspect", "deviation", "bake", "render", "show", "export", "to_bytes", "to_field", "union")

_CURVES: dict[str, str] = {
    **{name: f"curve.shape().{name}(…)" for name in _OF_SHAPES},
    "mesh": "curve.shape().mesh(tol=0.01) fills a closed one; curve.flatten(tol=0.01) makes lines",
    **dict.fromkeys(
        ("discretize", "tessellate", "to_polyline", "polyline", "sample", "points", "interpolate", "subdivide"),
        "curve.flatten(tol=0.01).points, or curve.points_at(t) for parameters",
    ),
    **dict.fromkeys(("evaluate", "eval", "point", "point_at", "at", "value"), "curve.points_at(t)"),
    **dict.fromkeys(("derivative", "tangent", "tangents", "velocity"), "curve.derivatives(t)"),
    **dict.fromkeys(("is_closed",), "curve.closed"),
    **dict.fromkeys(("extruded", "sweep", "linear_extrude"), "curve.extrude(…)"),
    **dict.fromkeys(("revolved", "rotate_extrude", "lathe"), "curve.revolve(…)"),
}

_CAGES: dict[str, str] = {
    **{name: f"cage.shape().{name}(…)" for name in _OF_SHAPES},
    **dict.fromkeys(("vertices", "points", "verts"), "cage.positions"),
    **dict.fromkeys(("subdivide", "subdivided", "refine", "catmull_clark", "loop"), "cage.refined(levels)"),
    **dict.fromkeys(("limit", "limit_surface", "tessellate", "triangulate"), "cage.shape().mesh(tol=0.01)"),
}

_BLOCKS: dict[str, str] = {
    **dict.fromkeys(("array", "values", "data", "to_numpy"), "chordal.volume(…) holds samples in memory"),
    **dict.fromkeys(("lod", "levels", "to_3dtiles", "tiles"), "volume.tileset(folder, iso=…)"),
    **dict.fromkeys(("chunks", "chunk_shape", "block_shape"), "block= of volume.mesh and the others"),
    **dict.fromkeys(("marching_cubes", "contour", "isosurface"), "volume.mesh(iso=0.5)"),
    **dict.fromkeys(
        ("neuroglancer", "to_neuroglancer", "to_precomputed", "fragments", "multiresolution"),
        "volume.precomputed_levels(folder), or volume.precomputed(folder)",
    ),
}

_LINES: dict[str, str] = {
    **dict.fromkeys(("save", "write"), 'lines.export("a.svg")'),
    **dict.fromkeys(("vertices", "coords", "xy"), "lines.points"),
    **dict.fromkeys(("error", "max_error"), "lines.bound"),
}

_FROM = "chordal.Mesh.from_(thing)"
_CLASSES: dict[str, str] = {
    **dict.fromkeys(("bezier", "spline", "nurbs", "arc"), "the functions of chordal.shapes"),
    **dict.fromkeys(("from_trimesh", "from_pyvista", "from_open3d", "from_meshio", "from_manifold3d", "wrap"), _FROM),
    **dict.fromkeys(("load", "read", "from_file", "open", "load_mesh", "from_bytes"), 'chordal.load("a.stl")'),
    **dict.fromkeys(("from_array", "from_numpy", "from_arrays"), "chordal.Mesh(vertices, faces), or chordal.volume(array)"),
}

_MODULE: dict[str, str] = {
    **_CLASSES,
    **_VERBS,
    **dict.fromkeys(
        ("save", "write", "save_mesh", "write_mesh", "export"), 'shape.export("a.stl"), or chordal.convert(shape, path)'
    ),
    **dict.fromkeys(("read_mesh", "read_image", "imread", "read_volume"), 'chordal.load("a.nrrd")'),
    **dict.fromkeys(("marching_cubes", "isosurface", "contour"), "chordal.volume(array).mesh(iso=0.5)"),
    **dict.fromkeys(("Trimesh", "PolyData", "TriangleMesh"), "chordal.Mesh(vertices, faces)"),
    **dict.fromkeys(("ImageData", "UniformGrid", "Image", "Grid"), "chordal.volume(array, spacing=…)"),
    **dict.fromkeys(("SDF", "sdf3"), "chordal.field(function, bounds=…)"),
    "boolean": "chordal.union, chordal.difference and chordal.intersection",
    "boolean_union": "chordal.union(a, b)",
    "boolean_difference": "chordal.difference(a, b)",
    "boolean_intersection": "chordal.intersection(a, b)",
    "merge": "chordal.concatenate([a, b]), or chordal.union(a, b) for one closed mesh",
    **dict.fromkeys(("plot", "show"), 'mesh.show(), in a notebook; else shape.render().export("a.png")'),
    "to_trimesh": "mesh.to_trimesh()",
    "sample": f"{_BOUNDED}: mesh.to_trimesh().sample(count)",
    **dict.fromkeys(("patches", "bezier", "spline", "nurbs", "arc"), "the functions of chordal.shapes"),
}

_SHAPES: dict[str, str] = {
    **dict.fromkeys(("cube", "Box", "Cube"), "box(x, y, z)"),
    **dict.fromkeys(("Sphere", "ball", "icosphere", "uv_sphere"), "sphere(radius)"),
    **dict.fromkeys(("Cylinder",), "cylinder(radius, height)"),
    **dict.fromkeys(("Torus", "donut"), "torus(major, minor)"),
    **dict.fromkeys(("translate", "translated"), "move(shape, x, y, z)"),
    **dict.fromkeys(("subtract", "cut"), "difference(a, b), or a - b"),
    "intersect": "intersection(a, b), or a & b",
    "blend": "smooth_union(a, b, radius)",
    "round": "offset(shape, distance)",
    "bezier_curve": "bezier(control)",
    "slice": "section(shape, z)",
}

_NOUNS: dict[str, tuple[Mapping[str, str], ...]] = {
    "Field": (_FIELDS, _VERBS, _CLASSES),
    "Volume": (_VOLUMES, _VERBS, _CLASSES),
    "Mesh": (_MESHES, _VERBS, _ELSEWHERE, _CLASSES),
    "Shape": (_VERBS, _CLASSES),
    "Curve": (_CURVES,),
    "Cage": (_CAGES,),
    "BlockVolume": (_BLOCKS,),
    "Polylines": (_LINES,),
    "Picture": (_PICTURES,),
    "Levels": (_LEVELS,),
    "Deviation": (_DEVIATIONS,),
    "chordal": (_MODULE,),
    "chordal.shapes": (_SHAPES,),
}

#: Keywords of other libraries, by what stands for them here.
_KEYWORDS: dict[str, tuple[str, ...]] = {
    "triangles=": ("faces", "n_faces", "face_count", "target_count", "target_number_of_triangles", "max_triangles")
    + ("max_faces", "count", "n_triangles", "num_faces"),
    "tol=": ("tolerance", "error", "max_error", "target_error", "deflection", "linear_deflection", "epsilon", "eps")
    + ("precision", "absolute", "max_deviation"),
    "rel=": ("relative", "relative_error"),
    "angle=": ("angular_deflection", "angular_tolerance", "feature_angle"),
    "iso=": ("level", "isovalue", "threshold", "isosurface", "isosurfaces", "value", "iso_value", "isolevel"),
    "cells=": ("resolution", "grid", "n_cells", "divisions"),
    "spacing=": ("voxel_size", "voxelsize", "pitch", "resolution", "voxel_spacing", "scale"),
    "format=": ("file_type", "filetype", "ext", "extension", "file_format"),
    "unit=": ("units",),
    "radius": ("r",),
    "height": ("h", "length"),
    "size=": ("width", "window_size", "image_size", "resolution"),
    "view=": ("camera", "camera_position", "cpos"),
    "weld=": ("merge", "merge_vertices", "process"),
    "fill_holes=": ("fillholes", "holes", "hole_size"),
    "drop_duplicates=": ("remove_duplicates",),
    "drop_unused=": ("remove_unreferenced",),
    "labels=": ("label", "segments"),
    "smooth=": ("smooth_sigma", "sigma", "smoothing"),
    "bounds=": ("bbox", "box", "extent", "region", "domain"),
    "gradient=": ("grad", "derivative"),
    "colors=": ("color", "vertex_colors", "rgb"),
    "normals=": ("vertex_normals", "normal"),
    "distances=": ("lod_distances", "switch_distances"),
}


#: Keywords of other libraries for which no single one stands here: the way there, where a function has one of these.
_ANSWERS: tuple[tuple[tuple[str, ...], str, str], ...] = (
    (
        ("ratio", "percent", "fraction", "target_reduction", "keep", "reduction"),
        "triangles",
        "say how many, as in triangles=len(mesh.faces) // 10",
    ),
    (
        ("levels", "ratios", "lods", "n_levels", "count", "triangles", "faces"),
        "tile_triangles",
        "levels are those that a screen can tell apart; for your own, [shape.mesh(triangles=n) for n in counts]",
    ),
    (("labels",), "executor", "volume.labels() has a mesh for each"),
    (("angle", "theta"), "degrees", "here it is degrees="),
)


def found_hint(owner: str, name: str) -> str | None:
    """The call that does here what a name does elsewhere; None where nothing is known of it."""
    tables = _NOUNS.get(owner, ())
    return next((table[name] for table in tables if name in table), None)


def no_attribute(owner: str, title: str, name: str, thing: object) -> AttributeError:
    """What is raised for a name that is not there."""
    sentence = f"{title} has no attribute {name!r}"
    if not name.startswith("_"):
        hint = found_hint(owner, name)
        if hint is None:
            # Those that begin alike: who asks `hasattr` does not read it, and is not to wait for it.
            owned = thing if isinstance(thing, (type, types.ModuleType)) else type(thing)
            near = difflib.get_close_matches(name, [known for known in _names_in(owned) if known[:3] == name[:3]], 1)
            hint = f"is {near[0]} meant?" if near else None
        sentence += "" if hint is None else f": {hint}"
    return AttributeError(sentence)


#: The names of classes and modules, once they were asked for.
_OWN_NAMES: dict[int, list[str]] = {}


def _names_in(owner: object) -> list[str]:
    # Classes and modules stay, so that their numbers do.
    if id(owner) not in _OWN_NAMES:
        _OWN_NAMES[id(owner)] = dir(owner)
    return _OWN_NAMES[id(owner)]


def owner_of(kind: type) -> str:
    """The name of a class, or of the first of those that it is made of, that the table knows."""
    return next((base.__name__ for base in kind.__mro__ if base.__name__ in _NOUNS), "")


class Guessed:
    """What says of a name that it has not what is meant. Type checkers see nothing of that, so that they refuse such names."""

    __slots__ = ()

    if not TYPE_CHECKING:

        def __getattr__(self, name):
            kind = type(self)
            if any(name in base.__dict__ for base in kind.__mro__):
                # It is there, and what it raised is an AttributeError: that one.
                return object.__getattribute__(self, name)
            raise no_attribute(owner_of(kind), kind.__name__, name, self)


class GuessedType(type):
    """The same for names of the class itself, as in `Mesh.from_trimesh`."""

    if not TYPE_CHECKING:

        def __getattr__(cls, name):
            raise no_attribute(owner_of(cls), f"type object {cls.__name__}", name, cls)


def keywords_hinted(function: Callable[P, R]) -> Callable[P, R]:
    """A function that says of a keyword that it has not what is meant."""
    all_of_them = inspect.signature(function).parameters.values()
    by_kind = {kind: [one.name for one in all_of_them if one.kind is kind] for kind in inspect._ParameterKind}
    one_kind = inspect.Parameter
    if by_kind[one_kind.VAR_KEYWORD]:
        return function
    placed, named_only = by_kind[one_kind.POSITIONAL_OR_KEYWORD], by_kind[one_kind.KEYWORD_ONLY]
    known = frozenset(placed + named_only) - {"self"}
    most = len(placed) + len(by_kind[one_kind.POSITIONAL_ONLY])
    needed = [one.name for one in all_of_them if one.name in placed and one.default is one.empty]
    is_counted = bool(named_only) and not by_kind[one_kind.VAR_POSITIONAL]

    @functools.wraps(function)
    def hinted(*args: P.args, **named: P.kwargs) -> R:
        if not named.keys() <= known:
            wrong = next(name for name in named if name not in known)
            raise TypeError(f"{_title(function)}() has no argument {wrong!r}: {meant_keyword(wrong, known)}")
        if is_counted and len(args) > most:
            raise TypeError(f"{_title(function)}() takes these by name: " + ", ".join(f"{name}=" for name in named_only))
        title = _title(function)
        if len(args) < len(needed) and title in _MAKERS and not named.keys() >= set(needed[len(args) :]):
            raise TypeError(f"{title}() needs {' and '.join(needed[1:])}: {_MAKERS[title]}")
        return function(*args, **named)

    return hinted


def _title(function: Callable[..., Any]) -> str:
    return function.__qualname__.removesuffix(".__init__").rpartition(".")[2]


#: Who makes what of what, for those who call a class.
_MAKERS: dict[str, str] = {
    "Mesh": "Mesh(vertices, faces) takes arrays; chordal.load reads files, chordal.Mesh.from_ takes meshes of other libraries",
    "Volume": "chordal.volume(array, spacing=…) makes it, chordal.load of a file, and .bake of another shape",
    "Field": "chordal.field(function, bounds=…) makes it, chordal.script of a text, and the words of chordal.shapes",
    "Curve": "the functions of chordal.shapes make it: bezier, spline, nurbs, arc, fit",
    "Formula": "chordal.shapes.x, y and z are formulas, and what is computed of them",
    "Shape": "chordal.load(path) makes it",
}


def refuse_own(made: object, given: object, wanted: type) -> None:
    """Raises `TypeError` where a class is called whose things functions make, and says which."""
    if not isinstance(given, wanted):
        title = type(made).__name__
        raise TypeError(f"{title} is not made of {type(given).__name__}: {_MAKERS.get(title, _MAKERS['Shape'])}")


def meant_keyword(wrong: str, known: Iterable[str]) -> str:
    """What stands for a keyword of another library, among those that a function has."""
    names = sorted(known)
    for words, needed, answer in _ANSWERS:
        if wrong in words and needed in known:
            return answer
    for own, others in _KEYWORDS.items():
        if wrong in others and own.rstrip("=") in names:
            return f"here it is {own}"
    near = difflib.get_close_matches(wrong, names, 1)
    return f"is {near[0]}= meant?" if near else "it has " + ", ".join(f"{name}=" for name in names)


def module_hint(module: str, name: str, thing: object) -> AttributeError:
    """What is raised for a name that a module has not."""
    from chordal import shapes

    if module == "chordal" and name in shapes.__all__:
        return AttributeError(f"{module} has no attribute {name!r}: chordal.shapes.{name}")
    return no_attribute(module, module, name, thing)
