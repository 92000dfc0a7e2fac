//! Cures against what they promise: the finding goes, nothing else comes, and the surface stays within the
//! bound.
mod attributes;
mod hostile;
mod laws;
mod sampler;
mod sick;
mod welding;

use chordal::check::{Validity, t_junctions, validity};
use chordal::explicit::Topology;
use chordal::mend::{
    Duplicates, HoleSelection, MendedMesh, Weld, drop_degenerate, drop_duplicates, drop_unused, fill_holes,
    nesting::NestedShells, orient, resolve_t_junctions, split_non_manifold, weld,
};
use chordal::{Job, Mesh};

/// A cure that needs no number.
type Cure = fn(&Mesh) -> MendedMesh;

/// Every cure that needs no number, by its name.
pub const CURES: [(&str, Cure); 9] = [
    ("weld", |mesh| weld(mesh, Weld::Exact, &Job::default()).unwrap()),
    ("drop_duplicates", |mesh| duplicates(mesh, Duplicates::SameWay)),
    ("drop_duplicates either way", |mesh| duplicates(mesh, Duplicates::EitherWay)),
    ("drop_degenerate", |mesh| drop_degenerate(mesh, Topology::Indices, &Job::default()).unwrap()),
    ("resolve_t_junctions", |mesh| {
        resolve_t_junctions(mesh, Topology::Indices, None, &Job::default()).unwrap()
    }),
    ("split_non_manifold", |mesh| split_non_manifold(mesh, Topology::Indices, &Job::default()).unwrap()),
    ("orient", |mesh| orient(mesh, Topology::Indices, NestedShells::Cavity, &Job::default()).unwrap()),
    ("fill_holes", |mesh| fill_holes(mesh, Topology::Indices, HoleSelection::All, &Job::default()).unwrap()),
    ("drop_unused", |mesh| drop_unused(mesh, &Job::default()).unwrap()),
];

fn duplicates(mesh: &Mesh, which: Duplicates) -> MendedMesh {
    drop_duplicates(mesh, Topology::Indices, which, &Job::default()).unwrap()
}

/// The mesh after the cure of that name.
pub fn cure(name: &str, mesh: &Mesh) -> MendedMesh {
    CURES.iter().find(|cure| cure.0 == name).unwrap().1(mesh)
}

/// How often each finding was met, by the mesh's own word on positions.
pub fn findings(mesh: &Mesh) -> [(&'static str, u64); 9] {
    let Validity {
        boundary_edges,
        non_manifold_edges,
        non_manifold_vertices,
        inconsistent_edges,
        duplicate_faces,
        collapsed_faces,
        zero_area_faces,
        unused_vertices,
        ..
    } = validity(mesh, Topology::Indices);
    [
        ("boundary_edges", boundary_edges.count),
        ("non_manifold_edges", non_manifold_edges.count),
        ("non_manifold_vertices", non_manifold_vertices.count),
        ("inconsistent_edges", inconsistent_edges.count),
        ("duplicate_faces", duplicate_faces.count),
        ("collapsed_faces", collapsed_faces.count),
        ("zero_area_faces", zero_area_faces.count),
        ("unused_vertices", unused_vertices.count),
        ("t_junctions", t_junctions(mesh, Topology::Indices, None).count),
    ]
}

/// A mesh that is known to be valid.
pub fn mesh_of(positions: &[[f64; 3]], faces: &[[u32; 3]]) -> Mesh {
    Mesh::new(positions.to_vec(), faces.to_vec()).unwrap()
}

/// The unit cube, outwards.
pub fn cube() -> Mesh {
    let corners: Vec<[f64; 3]> = (0..8).map(|i| std::array::from_fn(|k| f64::from(i >> k & 1))).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    mesh_of(&corners, &faces)
}
