//! `ShadingNormals`: the normals by which a mesh is shaded.
use crate::budget::{Job, par_map};
use crate::explicit::{Attribute, Domain, Mesh, Semantic, face_normal};
use glam::DVec3;
use std::collections::BTreeMap;

/// Edges sharper than this (its cosine) are creases in a mesh without normals: cos 30°.
pub(super) const CREASE_COS: f64 = 0.866_025_403_784_438_6;

/// The source of the normals at a face's corners.
pub(super) enum ShadingNormals<'a> {
    /// The normals of the mesh.
    Given(&'a Attribute),
    /// One normal per corner, smooth across edges that are not sharp.
    Smooth(Vec<[f32; 3]>),
    /// The normal of the face.
    Flat,
}

impl<'a> ShadingNormals<'a> {
    /// The normals of the mesh, or smooth ones if it has none.
    pub fn from_mesh(mesh: &'a Mesh, job: &Job) -> Self {
        match mesh.attribute(&Semantic::Normal) {
            Some(given) if given.width == 3 => Self::Given(given),
            _ => Self::Smooth(smooth(mesh, job)),
        }
    }

    /// The normals at the corners of a face; they need not have length 1.
    pub fn corners(&self, mesh: &Mesh, face: usize) -> Option<[DVec3; 3]> {
        match self {
            Self::Flat => None,
            Self::Smooth(rows) => Some([0, 1, 2].map(|k| DVec3::from(rows[3 * face + k].map(f64::from)))),
            Self::Given(given) => Some([0, 1, 2].map(|k| {
                let row = match given.domain {
                    Domain::Vertex => mesh.faces()[face][k] as usize,
                    Domain::Corner => 3 * face + k,
                    Domain::Face => face,
                };
                DVec3::from_slice(given.row(row))
            })),
        }
    }
}

/// For each corner, the angle-weighted sum of the normals of those faces around its position whose normals
/// are within the crease angle of that of its face.
fn smooth(mesh: &Mesh, job: &Job) -> Vec<[f32; 3]> {
    let n_faces = mesh.faces().len();
    let normals = for_faces(n_faces, job, |f| face_normal(mesh.corners(f)).map_or(DVec3::ZERO, DVec3::from));
    let angles = for_faces(n_faces, job, |f| corner_angles(mesh.corners(f)));
    // The corners around each position, one run after the other.
    let mut starts = vec![0_u32; mesh.positions().len() + 1];
    let position = |corner: usize| mesh.position_of(mesh.faces()[corner / 3][corner % 3]) as usize;
    (0..3 * n_faces).for_each(|corner| starts[position(corner) + 1] += 1);
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let mut around = vec![0_u32; 3 * n_faces];
    for corner in 0..3 * n_faces {
        let at = &mut next[position(corner)];
        around[*at as usize] = corner as u32;
        *at += 1;
    }
    let run = |position_id: usize| &around[starts[position_id] as usize..starts[position_id + 1] as usize];
    let sum_of = |corners: &[u32], face_normal: Option<DVec3>| {
        corners.iter().fold(DVec3::ZERO, |sum, corner| {
            let (face, k) = (*corner as usize / 3, *corner as usize % 3);
            let smooth = face_normal.is_none_or(|face_normal| normals[face].dot(face_normal) >= CREASE_COS);
            if smooth { sum + normals[face] * angles[face][k] } else { sum }
        })
    };
    let fans: BTreeMap<usize, DVec3> = (0..mesh.positions().len())
        .filter(|position_id| run(*position_id).len() > MOST_COMPARED)
        .map(|position_id| (position_id, sum_of(run(position_id), None).normalize_or_zero()))
        .collect();
    let rows = for_faces(n_faces, job, |face| {
        let face_normal = normals[face];
        [0, 1, 2].map(|k| {
            let position_id = position(3 * face + k);
            let sum = match fans.get(&position_id) {
                None => sum_of(run(position_id), Some(face_normal)),
                Some(mean) if mean.dot(face_normal) >= CREASE_COS => *mean,
                Some(_) => face_normal,
            };
            let normal = sum.normalize_or(face_normal);
            [normal.x as f32, normal.y as f32, normal.z as f32]
        })
    });
    rows.into_flattened()
}

/// The faces in one task.
const TASK: usize = 1 << 14;

fn for_faces<T: Send + Clone>(n: usize, job: &Job, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let chunks: Vec<usize> = (0..n).step_by(TASK).collect();
    par_map(job, &chunks, |_, from| (*from..n.min(from + TASK)).map(&work).collect::<Vec<T>>()).concat()
}

/// Up to this many faces around a position, each is compared with each, which takes their square. In larger
/// fans (the poles of spheres) each is compared with the mean.
const MOST_COMPARED: usize = 256;

fn corner_angles(corners: [[f64; 3]; 3]) -> [f64; 3] {
    let p = corners.map(DVec3::from);
    std::array::from_fn(|k| {
        let (a, b) =
            ((p[(k + 1) % 3] - p[k]).normalize_or_zero(), (p[(k + 2) % 3] - p[k]).normalize_or_zero());
        libm::atan2(a.cross(b).length(), a.dot(b))
    })
}
