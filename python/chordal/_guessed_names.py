"""Names of other libraries, by the class or module here on which they are tried, with the equivalent call."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

_FEWER = "shape.mesh(triangles=5000), or shape.mesh(tol=0.01) for the fewest within a length"
_ELSE = "Chordal has none"
_BACK = "meshes come back by Mesh.from_"
_INSIDE_OUT = "chordal.Mesh(mesh.vertices, mesh.faces[:, ::-1])"

#: Extensions in names of methods, as in `to_stl`.
_EXTENSIONS = ("stl", "obj", "ply", "glb", "gltf", "3mf")

#: Names that apply to all shapes.
_VERBS: dict[str, str] = {
    **dict.fromkeys(
        ("simplify", "decimate", "decimate_pro", "reduce", "remesh", "tessellate", "triangulate", "to_mesh")
        + ("simplify_quadric_decimation", "simplify_quadratic_decimation", "simplify_vertex_clustering"),
        _FEWER,
    ),
    **dict.fromkeys(("save", "write", "save_mesh", "write_mesh", "dump"), 'shape.export("a.stl"), or shape.to_bytes("stl")'),
    **dict.fromkeys(("fill_holes", "close_holes"), "shape.mend(fill_holes=True)"),
    **dict.fromkeys(
        ("weld", "merge_vertices", "merge_close_vertices", "merge_points", "remove_duplicated_vertices"),
        "shape.mend(weld=True), or shape.mend(weld=1e-6) for vertices that are nearly one",
    ),
    **dict.fromkeys(("clean", "repair", "process", "fix", "make_watertight", "make_manifold"), "shape.mend(all=True)"),
    **dict.fromkeys(
        ("fix_normals", "fix_winding", "orient", "orient_triangles"), "shape.mend(orient=True)"
    ),
    **dict.fromkeys(("remove_degenerate_faces", "remove_degenerate_triangles"), "shape.mend(drop_degenerate=True)"),
    **dict.fromkeys(("remove_duplicate_faces", "remove_duplicated_triangles"), "shape.mend(drop_duplicates=True)"),
    **dict.fromkeys(("remove_unreferenced_vertices", "remove_unused_points"), "shape.mend(drop_unused=True)"),
    **dict.fromkeys(
        ("signed_distance", "implicit_distance", "compute_implicit_distance", "sdf"),
        "shape.to_field()(points), negative inside",
    ),
    **dict.fromkeys(("contains", "select_enclosed_points", "is_inside", "select_interior_points"), "shape.to_field()(points) < 0"),
    **dict.fromkeys(
        ("nearest", "proximity", "closest_point", "find_closest_cell", "find_closest_point", "nearest_point"),
        "shape.to_field()(points) for distances; nearest points are those of to_trimesh().nearest",
    ),
    **dict.fromkeys(("distance", "hausdorff", "hausdorff_distance", "compare"), "shape.deviation(other)"),
    **dict.fromkeys(
        ("voxelized", "voxelize", "voxels", "voxelize_binary_mask", "voxelize_rectilinear"),
        "shape.bake(cells=64), the distances on a lattice; samples below 0 are inside",
    ),
    "remove_non_manifold_edges": "shape.mend(split_nonmanifold=True)",
    "boolean_union": "shape.union(other), or a | b",
    "boolean_difference": "shape.difference(other), or a - b",
    "boolean_intersection": "shape.intersection(other), or a & b",
    "boolean": "shape.union, difference and intersection",
    "levels": "shape.lod(…)",
    **{f"{verb}_{ext}": f'shape.export("a.{ext}")' for verb in ("to", "save", "write") for ext in _EXTENSIONS},
    "to_file": 'shape.export("a.stl")',
    **dict.fromkeys(("screenshot", "save_image", "picture"), 'shape.render(…).export("a.png")'),
}

#: Names that apply to meshes alone.
_MESHES: dict[str, str] = {
    **dict.fromkeys(("plot", "view", "display"), 'mesh.show(), in a notebook; else mesh.render().export("a.png")'),
    **dict.fromkeys(("n_faces", "n_cells", "num_faces", "n_triangles", "num_tri", "number_of_cells"), "len(mesh.faces)"),
    **dict.fromkeys(
        ("n_points", "n_vertices", "num_vertices", "n_verts", "num_vert", "number_of_points", "vertex_count"), "len(mesh.vertices)"
    ),
    "face_count": "len(mesh.faces)",
    **dict.fromkeys(("connected_components", "cluster_connected_triangles", "pieces", "components"), "mesh.split()"),
    **dict.fromkeys(("unite", "fuse", "add"), "mesh.union(other), or a | b, for solids; mesh + other for triangles next to each other"),
    **dict.fromkeys(("subtract", "minus"), "mesh.difference(other), or a - b"),
    **dict.fromkeys(("intersect", "common"), "mesh.intersection(other), or a & b"),
    **dict.fromkeys(("cut", "slice_plane", "clip_plane", "clip_closed_surface"), "mesh.difference(other), as of a large box"),
    **dict.fromkeys(("crop", "clip_box"), "mesh.intersection(other), as of a box: chordal.shapes.box(…) with tol=0.01"),
    **dict.fromkeys(("collision", "is_intersecting"), "mesh.intersection(other), which has no triangles where they are apart"),
    **dict.fromkeys(
        ("submesh", "update_faces", "remove_cells", "extract_cells", "select_by_index", "remove_triangles_by_index")
        + ("remove_triangles_by_mask", "remove_vertices_by_index", "remove_vertices_by_mask"),
        "chordal.Mesh(mesh.vertices, mesh.faces[keep]), and .mend(drop_unused=True) where vertices are left over",
    ),
    "plot_normals": 'mesh.render(show="normals")',
    "plot_curvature": "mesh.vertex_curvature(), for the colours of any plot",
    "edge_lengths": "numpy.linalg.norm of the differences of mesh.vertices[mesh.faces]",
    **dict.fromkeys(("pointcloud", "point_cloud", "to_points"), "mesh.vertices, or mesh.to_trimesh().sample(count)"),
    "name": "mesh.parts[0].name, and that of mesh.nodes",
    **dict.fromkeys(("certificate", "proof", "provenance"), 'mesh.history, or mesh.report["certificate"]'),
    **dict.fromkeys(("isotropic_remesh", "isotropic_remeshing"), "shape.mesh(tol=0.01), whose triangles are as large as that allows"),
    "normalize": "mesh.translate(…) and mesh.scale(…), as mesh.bounds says",
    "unify": "mesh.union(other), or mesh.mend(orient=True) for faces that look the same way",
    **dict.fromkeys(
        ("is_manifold", "is_edge_manifold", "is_vertex_manifold"),
        'mesh.report["certificate"]["valid"], with "manifold"; closed is mesh.is_watertight',
    ),
    **dict.fromkeys(("adjacency", "face_adjacency_edges"), "mesh.to_trimesh().face_adjacency"),
    **dict.fromkeys(("principal_axes", "register", "align"), "those of mesh.to_trimesh()"),
    **dict.fromkeys(("is_empty", "has_triangles", "has_vertices"), "len(mesh.faces) == 0"),
    **dict.fromkeys(
        ("mass", "density", "mass_properties"), "mesh.volume and mesh.center_mass; a mass is the volume times a density"
    ),
    **dict.fromkeys(("surface_area", "get_surface_area"), "mesh.area"),
    "get_volume": "mesh.volume",
    **dict.fromkeys(
        ("triangle_normals", "compute_triangle_normals", "facets_normal", "normalize_normals"), "mesh.face_normals"
    ),
    **dict.fromkeys(("triangles_center", "cell_centers", "face_centers"), "mesh.vertices[mesh.faces].mean(axis=1)"),
    **dict.fromkeys(("corners", "triangles_points"), "mesh.vertices[mesh.faces]"),
    **dict.fromkeys(("euler_poincare_characteristic", "euler_characteristic"), "mesh.euler_number"),
    "genus": "(2 - mesh.euler_number) // 2, of one closed piece",
    **dict.fromkeys(
        ("is_edge_manifold", "is_vertex_manifold", "is_orientable", "is_valid", "get_non_manifold_edges", "n_open_edges")
        + ("get_non_manifold_vertices", "validate_mesh", "status", "broken_faces", "is_self_intersecting"),
        'mesh.report["certificate"]["valid"], which counts what is wrong',
    ),
    **dict.fromkeys(
        ("has_triangle_uvs", "has_vertex_colors", "has_vertex_normals", "has_textures", "has_triangle_normals"),
        "mesh.uv is not None, and the same of mesh.colors, mesh.normals and mesh.images",
    ),
    **dict.fromkeys(("vertex_colors", "face_colors", "colours"), "mesh.colors"),
    **dict.fromkeys(("triangle_uvs", "texture_coordinates", "active_texture_coordinates", "t_coords"), "mesh.uv"),
    **dict.fromkeys(
        (
            "metadata",
            "point_data",
            "cell_data",
            "field_data",
            "vertex_attributes",
            "face_attributes",
            "array_names",
            "user_dict",
        ),
        "mesh.attributes, and mesh.report for what is known of it",
    ),
    **dict.fromkeys(
        ("triangle_material_ids", "material_ids"),
        'mesh.parts[0].attribute("group", "material"), numbers of mesh.materials from 1',
    ),
    **dict.fromkeys(
        ("material", "paint_uniform_color", "set_color", "set_material", "strip_visuals"),
        'chordal.scene(chordal.Placed(mesh, material=chordal.Material(color="#d33")))',
    ),
    **dict.fromkeys(
        ("add_geometry", "add_mesh", "add_part", "to_scene", "subscene"), 'chordal.scene({"a": mesh, "b": other})'
    ),
    **dict.fromkeys(("to_geometry", "to_mesh64", "to_legacy"), "mesh.vertices and mesh.faces, which are of all parts"),
    **dict.fromkeys(("camera", "lights", "set_camera"), "the view= of mesh.render"),
    **dict.fromkeys(("cluster_connected_triangles", "decompose", "separate_cells", "extract_largest"), "mesh.split()"),
    **dict.fromkeys(("flip_x", "flip_y", "flip_z"), "mesh.scale((-1, 1, 1)), a new mesh"),
    **dict.fromkeys(("flip_faces", "flip_normal", "flip_normals", "flip_normal_vectors", "invert"), _INSIDE_OUT),
    "flip": f"{_INSIDE_OUT} turns it inside out, and mesh.scale((-1, 1, 1)) mirrors it",
    "hull": f"{_ELSE}: mesh.to_trimesh().convex_hull; {_BACK}",
    "project": f"{_ELSE}: mesh.to_trimesh().projected(normal)",
    "quads": "mesh.faces, which are triangles",
    **dict.fromkeys(("recenter", "center_mesh"), "mesh.translate(-mesh.bounds.mean(axis=0))"),
    "get_bounds": "mesh.bounds",
    **dict.fromkeys(("to_numpy", "to_arrays"), "mesh.vertices and mesh.faces, arrays of numpy"),
    "to_sdf": "mesh.to_field(), a function of points, or mesh.bake(cells=64), its values on a lattice",
    "to_volume": "mesh.bake(cells=64), the distances on a lattice",
    "chamfer": "mesh.vertex_deviation(other).mean() and the same the other way; the largest is mesh.deviation(other)",
    "marching_cubes": "mesh.bake(cells=64).mesh(iso=0), of the distances on a lattice",
    **dict.fromkeys(("remove_infinite_values", "remove_nan_cells"), "chordal.load(path, drop_nonfinite=True)"),
    **dict.fromkeys(
        ("referenced_vertices", "rezero", "remove_points"), "mesh.mend(drop_unused=True), or mesh.translate((x, y, z))"
    ),
    **dict.fromkeys(("nondegenerate_faces", "unique_faces"), "mesh.mend(drop_degenerate=True, drop_duplicates=True)"),
    **dict.fromkeys(
        ("minkowski_sum", "offset", "inflate", "dilate"), "mesh.to_field().offset(0.1).mesh(tol=0.01)"
    ),
    **dict.fromkeys(("shell", "thicken", "hollow"), "mesh.to_field().shell(thickness).mesh(tol=0.01)"),
    **dict.fromkeys(("to_dict", "to_pandas", "to_arrow"), "mesh.vertices and mesh.faces, arrays of numpy"),
    **dict.fromkeys(("identifier", "identifier_hash", "md5", "crc"), 'hashlib.sha256(mesh.to_bytes("ply")).hexdigest()'),
    **dict.fromkeys(("points", "verts", "positions", "v"), "mesh.vertices"),
    **dict.fromkeys(("triangles", "cells", "f", "indices", "regular_faces"), "mesh.faces"),
    **dict.fromkeys(("watertight", "is_closed", "is_manifold", "is_volume", "is_solid"), "mesh.is_watertight"),
    **dict.fromkeys(
        (
            "bounding_box",
            "bbox",
            "aabb",
            "get_axis_aligned_bounding_box",
            "get_max_bound",
            "get_min_bound",
            "bounds_corners",
        ),
        "mesh.bounds and mesh.extents",
    ),
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
    **dict.fromkeys(("concatenate", "append", "append_polydata", "merge"), "chordal.concatenate([a, b])"),
    **dict.fromkeys(("to_3dtiles", "tiles", "tileset", "to_tileset"), "mesh.lod(…).export(folder)"),
    **dict.fromkeys(
        ("to_neuroglancer", "neuroglancer", "precomputed", "to_precomputed"),
        'chordal.block_volume(labels, unit="nm").precomputed_levels(folder), of samples',
    ),
    **dict.fromkeys(("area_faces", "face_areas"), "mesh.area is that of all; of each: mesh.to_trimesh()"),
    **dict.fromkeys(("components", "connectivity", "split_bodies"), "mesh.split()"),
    **dict.fromkeys(("body_count", "n_components"), "len(mesh.split())"),
    **dict.fromkeys(("centroid", "center_of_mass", "center", "get_center"), "mesh.center_mass"),
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
    **dict.fromkeys(("clone", "deep_copy", "shallow_copy"), "copy.copy(mesh), which is the mesh itself: it does not change"),
    "copy": "copy.copy(mesh), which is the mesh itself: it does not change",
    **dict.fromkeys(
        ("contour", "isosurface"),
        "mesh.to_field().offset(distance).mesh(tol=0.01) at a distance; lines on it are those of mesh.to_pyvista().contour()",
    ),
}

#: Operations that only meshes of other libraries have: the conversion to them.
_ELSEWHERE: dict[str, str] = {
    **{
        name: f"{_ELSE}: mesh.to_trimesh().{name}, or the like of mesh.to_pyvista(); {_BACK}"
        for name in ("convex_hull", "subdivide", "subdivide_loop", "smoothed", "unwrap", "moment_inertia", "ray", "sample")
        + ("edges", "edges_unique", "face_adjacency", "bounding_sphere", "bounding_box_oriented", "section")
        + ("principal_inertia_transform",)
    },
    **{
        name: f"{_ELSE}: mesh.to_pyvista().{name}(…), or the like of mesh.to_trimesh(); {_BACK}"
        for name in ("smooth", "smooth_taubin", "clip", "slice", "geodesic", "ray_trace", "delaunay_3d")
        + ("extract_surface", "compute_cell_sizes")
    },
    "sample_points_uniformly": f"{_ELSE}: mesh.to_trimesh().sample(count)",
}

#: Operations on meshes that other libraries have and Chordal has not, as of trimesh 5.2, PyVista 0.49 and Open3D 0.20: by the
#: method of `Mesh` that converts to the library.
_ONLY_THERE: Final[dict[str, str]] = {
    "to_trimesh": """
        apply_obb bounding_cylinder bounding_primitive compute_stable_poses convex_decomposition edges_face edges_sorted
        edges_sorted_tree edges_sparse edges_unique_inverse edges_unique_length extend_faces face_adjacency_angles
        face_adjacency_convex face_adjacency_edges face_adjacency_edges_tree face_adjacency_projections
        face_adjacency_radius face_adjacency_span face_adjacency_tree face_adjacency_unshared face_angles
        face_angles_sparse face_neighborhood faces_sparse faces_unique_edges facets facets_area facets_boundary
        facets_on_hull facets_origin integral_mean_curvature is_convex kdtree moment_inertia_frame outline
        principal_inertia_components principal_inertia_vectors projected section_multiplane smooth_shaded
        subdivide_to_size symmetry symmetry_axis symmetry_section triangles_cross triangles_tree unmerge_vertices
        update_vertices vertex_adjacency_graph vertex_defects vertex_degree vertex_faces vertex_neighbors
    """,
    "to_pyvista": """
        align align_xyz cell_data_to_point_data cell_neighbors cell_quality cell_validator clip_scalar clip_slab
        clip_surface color_labels compute_arc_length compute_boundary_mesh_quality compute_derivative contour_banded ctp
        decimate_boundary decimate_polyline delaunay_2d edge_mask elevation explode extract_all_edges
        extract_cells_by_type extract_feature_edges extract_geometry extract_points extract_values extrude
        extrude_rotate extrude_trim gaussian_splatting geodesic_distance glyph integrate_data interpolate
        is_all_triangles length lines multi_ray_trace n_lines oriented_bounding_box outline_corners pack_labels
        partition plot_boundaries plot_over_circular_arc plot_over_circular_arc_normal plot_over_line
        point_data_to_cell_data point_neighbors project_points_to_plane protein_ribbon ptc reconstruct_surface resize
        ribbon ruled_surface sample_over_circular_arc sample_over_circular_arc_normal sample_over_line
        sample_over_multiple_lines shrink slice_along_axis slice_along_line slice_implicit slice_orthogonal sort_labels
        split_values streamlines streamlines_from_source strip subdivide_adaptive surface_indices texture_map_to_plane
        texture_map_to_sphere threshold threshold_percent triangulate_contours tube warp_by_scalar warp_by_vector
    """,
    "to_open3d": """
        adjacency_list compute_adjacency_list compute_convex_hull create_arrow create_coordinate_frame
        create_from_oriented_bounding_box create_from_oriented_bounding_ellipsoid create_from_point_cloud_alpha_shape
        create_from_point_cloud_ball_pivoting create_from_point_cloud_poisson create_mobius deform_as_rigid_as_possible
        dimension filter_sharpen filter_smooth_laplacian filter_smooth_simple filter_smooth_taubin get_geometry_type
        get_minimal_oriented_bounding_box get_oriented_bounding_box get_oriented_bounding_ellipsoid
        get_rotation_matrix_from_axis_angle get_rotation_matrix_from_quaternion get_rotation_matrix_from_xyz
        get_rotation_matrix_from_xzy get_rotation_matrix_from_yxz get_rotation_matrix_from_yzx
        get_rotation_matrix_from_zxy get_rotation_matrix_from_zyx get_self_intersecting_triangles has_adjacency_list
        has_triangle_material_ids sample_points_poisson_disk subdivide_midpoint
    """,
}

#: Further operations of these libraries.
_OF_LIBRARIES: dict[str, str] = {
    name: f"{_ELSE}: mesh.{library}().{name}; {_BACK}"
    for library, names in _ONLY_THERE.items()
    for name in names.split()
}

_VOLUMES: dict[str, str] = {
    **dict.fromkeys(
        ("marching_cubes", "contour", "isosurface", "extract_surface", "flying_edges", "threshold"), "volume.mesh(iso=0.5)"
    ),
    **dict.fromkeys(("voxel_size", "pitch", "voxelsize"), "volume.spacing"),
    **dict.fromkeys(("plot", "show", "display", "view"), "volume.mesh(iso=0.5).show(), in a notebook"),
    "points": "volume.bounds and volume.spacing say where the samples stand",
    "contour_labels": 'volume.mesh(labels="all")',
    **dict.fromkeys(("values", "data", "samples", "voxels", "to_numpy", "numpy"), "volume.array"),
    **dict.fromkeys(("min", "max", "mean", "std"), "the same of volume.array"),
    **dict.fromkeys(("dimensions", "dims", "size", "extent", "n_points", "n_cells"), "volume.shape"),
    **dict.fromkeys(("point_data", "cell_data", "scalars", "active_scalars", "GetScalars", "get_fdata"), "volume.array"),
    **dict.fromkeys(("get_data_range", "scalar_range"), "volume.array.min() and volume.array.max()"),
    **dict.fromkeys(("center", "extents", "bounding_box"), "volume.bounds"),
    **dict.fromkeys(
        ("clip", "extract_subset", "pad_image", "resize", "median_smooth", "dilate", "erode", "image_threshold")
        + ("rotate", "flip", "slice", "sample", "interpolate", "to_unit", "gradient", "mask", "astype", "slices"),
        "chordal.volume of an array that numpy or scipy.ndimage makes",
    ),
    **dict.fromkeys(("resample", "crop", "gaussian_smooth"), "chordal.volume of an array that scipy.ndimage makes"),
    **dict.fromkeys(("transform", "matrix", "orientation", "direction"), "volume.affine"),
    **dict.fromkeys(("smooth", "smoothed"), 'volume.surface(smooth="1vox")'),
    **dict.fromkeys(("header", "zooms", "coords"), "volume.spacing, volume.origin and volume.affine"),
    "ndim": "volume.array.ndim",
    **dict.fromkeys(("to_dask", "to_zarr", "to_numpy_array"), "volume.array, which those libraries take"),
    "labels": 'volume.mesh(labels="all"), or chordal.labels(array)',
    **dict.fromkeys(("to_trimesh", "to_pyvista", "to_open3d"), "volume.mesh(iso=0.5).to_trimesh()"),
    **dict.fromkeys(("tileset", "precomputed", "to_3dtiles"), "that of chordal.block_volume(array)"),
}

_FIELDS: dict[str, str] = {
    **dict.fromkeys(("signed_distance", "sdf", "evaluate", "eval", "values", "f"), "field(points), n × 3"),
    "contains": "field(points) < 0",
    **dict.fromkeys(("subtract", "cut"), "field - other"),
    "elongate": "chordal.shapes.stretch(shape, …)",
    **dict.fromkeys(
        ("plot", "show", "display", "view"), 'field.mesh(tol=0.01).show(), in a notebook; else field.render().export("a.png")'
    ),
    **dict.fromkeys(("contour", "isosurface"), "field.mesh(tol=0.01), after field.offset(distance) for another distance"),
    **dict.fromkeys(("translate", "translated", "moved", "at"), "field.move(x, y, z)"),
    **dict.fromkeys(("scaled", "rotated"), "field.scale(k) and field.rotate(axis, degrees)"),
    **dict.fromkeys(("round", "dilate", "grow", "erode"), "field.offset(distance)"),
    **dict.fromkeys(("hollow", "thicken", "onion"), "field.shell(thickness)"),
    **dict.fromkeys(("normal", "normals"), "field.gradient(points)"),
    **dict.fromkeys(("blend", "smooth_union"), "chordal.shapes.smooth_union(a, b, radius)"),
    **dict.fromkeys(("orient", "transform"), "field.rotate(axis, degrees)"),
    **dict.fromkeys(("negate", "complement", "invert"), "chordal.shapes.box(…) - field, within a box"),
    **dict.fromkeys(("smooth_out", "k", "fillet"), "chordal.shapes.smooth_union(a, b, radius)"),
    **dict.fromkeys(("repeat", "circular_array", "array"), "chordal.shapes.linear and chordal.shapes.polar"),
    **dict.fromkeys(("bounding_box", "bbox", "box"), "field.bounds"),
    **dict.fromkeys(
        ("vertices", "faces", "num_tri", "center_mass", "centroid", "surface_area", "genus"),
        "that of its mesh: field.mesh(tol=0.01)",
    ),
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

#: Methods of shapes that curves and cages only have after `shape()`.
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
    **dict.fromkeys(("to_trimesh", "to_pyvista"), "cage.shape().mesh(tol=0.01).to_trimesh()"),
    "uv": "cage.shape().mesh(tol=0.01).uv",
    **dict.fromkeys(("subdivide", "subdivided", "refine", "catmull_clark", "loop"), "cage.refined(levels)"),
    **dict.fromkeys(("limit", "limit_surface", "tessellate", "triangulate"), "cage.shape().mesh(tol=0.01)"),
}

_BLOCKS: dict[str, str] = {
    **dict.fromkeys(("array", "values", "data", "to_numpy"), "chordal.volume(…) holds samples in memory"),
    **dict.fromkeys(("lod", "levels", "to_3dtiles", "tiles"), "volume.tileset(folder, iso=…)"),
    **dict.fromkeys(("chunks", "chunk_shape", "block_shape"), "block= of volume.mesh and the others"),
    **dict.fromkeys(("marching_cubes", "contour", "isosurface"), "volume.mesh(iso=0.5)"),
    **dict.fromkeys(("to_trimesh", "export", "deviation", "bake", "render", "show"), "the same of volume.mesh(iso=0.5)"),
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
    **{
        f"create_{name}": "a word of chordal.shapes, as in chordal.shapes.box(1, 2, 3).mesh(tol=0.01)"
        for name in (
            "box",
            "sphere",
            "cylinder",
            "cone",
            "torus",
            "ellipsoid",
            "icosahedron",
            "tetrahedron",
            "octahedron",
            "text",
        )
    },
    **dict.fromkeys(
        ("from_array", "from_numpy", "from_arrays", "from_regular_faces", "from_irregular_faces"),
        "chordal.Mesh(vertices, faces), or chordal.volume(array)",
    ),
}

_MODULE: dict[str, str] = {
    **_CLASSES,
    **_VERBS,
    **dict.fromkeys(
        ("save", "write", "save_mesh", "write_mesh", "export"), 'shape.export("a.stl"), or chordal.convert(shape, path)'
    ),
    **dict.fromkeys(("read_mesh", "read_image", "imread", "read_volume"), 'chordal.load("a.nrrd")'),
    **dict.fromkeys(("load_volume", "nifti", "array"), 'chordal.volume(array), or chordal.volume("scan.nii")'),
    **dict.fromkeys(("zarr", "dask", "tileset"), 'chordal.block_volume("a.zarr"), or of an array of Dask'),
    "image": "chordal.volume(image)",
    **dict.fromkeys(("join", "combine"), "chordal.concatenate([a, b]) next to each other, chordal.union(a, b) as one solid"),
    **dict.fromkeys(("view", "camera"), "chordal.View"),
    **dict.fromkeys(("cage", "catmull_clark", "loop"), 'chordal.Cage, or chordal.load("a.obj", surface="catmull-clark")'),
    **dict.fromkeys(("validate", "check"), "chordal.inspect(shape), and chordal.verify(path, against) for a certificate"),
    **dict.fromkeys(("set_num_threads", "config"), "none: work takes all processors, and a job of a batch its own"),
    **dict.fromkeys(("marching_cubes", "isosurface", "contour"), "chordal.volume(array).mesh(iso=0.5)"),
    **dict.fromkeys(("Scene", "MultiBlock", "load_scene", "TriangleMeshModel"), 'chordal.scene({"a": mesh, "b": other})'),
    **dict.fromkeys(("visual", "PBRMaterial", "Texture", "TextureVisuals", "SimpleMaterial"), "chordal.Material"),
    **dict.fromkeys(
        ("creation", "primitives", "Cube", "Box", "Sphere", "Cylinder", "Cone", "Torus", "Capsule", "Icosphere", "Polygon")
        + (
            "icosphere",
            "uv_sphere",
            "cube",
            "Plane",
            "Tetrahedron",
            "ParametricTorus",
            "ParametricEllipsoid",
            "SolidSphere",
        ),
        "the words of chordal.shapes, as in chordal.shapes.box(1, 2, 3)",
    ),
    **dict.fromkeys(
        ("transformations", "transform", "translate", "rotate", "scale"), "mesh.transform, translate, rotate and scale"
    ),
    **dict.fromkeys(("units", "unitize"), 'mesh.unit and mesh.to_unit("mm")'),
    **dict.fromkeys(("load_path", "load_remote", "read_triangle_mesh", "read_triangle_model"), 'chordal.load("a.stl")'),
    **dict.fromkeys(("write_triangle_mesh", "save_meshio", "write_points_cells"), 'mesh.export("a.stl")'),
    **dict.fromkeys(("available_formats", "extension_to_filetypes"), "the page docs/formats.md"),
    **dict.fromkeys(
        ("PointCloud", "PointSet", "LineSet", "points"), "Chordal has no clouds of points; arrays of numpy are points"
    ),
    **dict.fromkeys(("Manifold", "Mesh64"), "chordal.Mesh(vertices, faces), with a | b, a - b and a & b"),
    **dict.fromkeys(("CrossSection", "Path2D", "path"), "chordal.shapes.polygon(points), or chordal.load of a drawing"),
    **dict.fromkeys(("Plotter", "plotting", "viewer", "Visualizer", "draw_geometries"), "mesh.show(), in a notebook"),
    **dict.fromkeys(("sdf", "SDF3", "mesh_to_sdf"), "mesh.to_field()(points), or mesh.bake(cells=64)"),
    **dict.fromkeys(
        ("label", "regionprops", "regionprops_table"), "chordal.labels(array), of what scipy.ndimage.label makes"
    ),
    "mesh_surface_area": "mesh.area",
    "smooth": f"{_ELSE}: mesh.to_pyvista().smooth(…); of samples, chordal.volume(array).mesh(iso=0.5, smooth=1)",
    "measure": "mesh.area, mesh.volume and chordal.deviation(a, b)",
    **dict.fromkeys(("info", "describe", "stats"), "chordal.inspect(shape)"),
    "subdivide": "chordal.Cage(positions, faces).refined(levels), or mesh.to_trimesh().subdivide()",
    **dict.fromkeys(("Bezier", "BezierCurve"), "chordal.shapes.bezier(control)"),
    **dict.fromkeys(("NURBS", "Nurbs", "BSpline"), "chordal.shapes.nurbs(…)"),
    **dict.fromkeys(
        ("euler_number", "centroid", "inertia", "curvature"),
        "mesh.euler_number, mesh.center_mass and mesh.vertex_curvature()",
    ),
    "find_contours": "chordal.volume(array).mesh(iso=0.5), of three axes",
    **dict.fromkeys(("voxel", "VoxelGrid", "voxelize_volume"), "mesh.bake(cells=64)"),
    **dict.fromkeys(
        ("ray", "collision", "registration", "smoothing", "convex", "intersections", "graph", "comparison"),
        f"{_ELSE}: mesh.to_trimesh() has it",
    ),
    **dict.fromkeys(("version", "VERSION"), "chordal.__version__"),
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
    "sample": f"{_ELSE}: mesh.to_trimesh().sample(count)",
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

_PARTS: dict[str, str] = {
    **dict.fromkeys(("mesh", "export", "to_trimesh", "area", "volume", "split"), "chordal.Mesh(part.vertices, part.faces)"),
    **dict.fromkeys(("points", "verts", "positions"), "part.vertices"),
    **dict.fromkeys(("triangles", "cells", "indices"), "part.faces"),
    **dict.fromkeys(("material", "materials"), 'part.attribute("group", "material"), numbers of mesh.materials from 1'),
    **dict.fromkeys(("matrix", "transform", "nodes"), "mesh.nodes, of which one or more show this part"),
    **dict.fromkeys(("colours", "vertex_colors"), "part.colors"),
}

_BOUNDS: dict[str, str] = {
    **dict.fromkeys(("max", "error", "max_error", "distance", "value", "hausdorff", "upper", "tolerance"), "bound.at_most"),
    **dict.fromkeys(("min", "lower"), "bound.at_least"),
    **dict.fromkeys(("proved", "is_proved", "kind", "proof"), "bound.evidence"),
    **dict.fromkeys(("holds", "within", "meets", "ok"), "bound.is_within(length)"),
}

#: The tables of hints, by classes and modules here.
NOUNS: dict[str, tuple[Mapping[str, str], ...]] = {
    "Field": (_FIELDS, _VERBS, _CLASSES),
    "Volume": (_VOLUMES, _VERBS, _CLASSES),
    "Mesh": (_MESHES, _VERBS, _ELSEWHERE, _CLASSES, _OF_LIBRARIES),
    "Shape": (_VERBS, _CLASSES),
    "Curve": (_CURVES,),
    "Cage": (_CAGES,),
    "BlockVolume": (_BLOCKS,),
    "Polylines": (_LINES,),
    "Picture": (_PICTURES,),
    "Levels": (_LEVELS,),
    "Deviation": (_DEVIATIONS,),
    "Part": (_PARTS,),
    "Bound": (_BOUNDS,),
    "chordal": (_MODULE,),
    "chordal.shapes": (_SHAPES,),
}
