"""Operations on meshes that trimesh, PyVista and Open3D have and Chordal has not, by the methods that convert a mesh."""

from __future__ import annotations

from typing import Final

#: For each method of `Mesh`, the names without an equivalent in Chordal, as of trimesh 5.2, PyVista 0.49 and Open3D 0.20.
NAMES: Final[dict[str, str]] = {
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
