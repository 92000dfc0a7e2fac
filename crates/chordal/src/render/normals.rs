//! `ShadingNormals`: the normals by which a mesh is shaded.
use crate::budget::{Job, par_map};
use crate::explicit::{Attribute, Domain, Mesh, Semantic, face_normal};
use glam::DVec3;
use std::collections::BTreeMap;

/// Edges sharper than this (its cosine) are creases in a mesh without normals of its own: cos 30°.
pub(super) const CREASE_COS: f64 = 0.866_025_403_784_438_6;

/// The source of the normals at a face's corners.
pub(super) enum ShadingNormals<'a> {
    /// The mesh's own.
    Given(&'a Attribute),
    /// One per corner, smooth across edges that are not sharp.
    Smooth(Vec<[f32; 3]>),
    /// The face's own.
    Flat,
}

impl<'a> ShadingNormals<'a> {
    /// The mesh's own normals, or smooth ones.
    pub fn from_mesh(mesh: &'a Mesh, job: &Job) -> Self {
        match mesh.attribute(&Semantic::Normal) {
            Some(own) if own.width == 3 => Self::Given(own),
            _ => Self::Smooth(smooth(mesh, job)),
        }
    }

    /// The normals at the corners of a face; they need not have length 1.
    pub fn corners(&self, mesh: &Mesh, face: usize) -> Option<[DVec3; 3]> {
        match self {
            Self::Flat => None,
            Self::Smooth(rows) => Some([0, 1, 2].map(|k| DVec3::from(rows[3 * face + k].map(f64::from)))),
            Self::Given(own) => Some([0, 1, 2].map(|k| {
                let row = match own.domain {
                    Domain::Vertex => mesh.faces()[face][k] as usize,
                    Domain::Corner => 3 * face + k,
                    Domain::Face => face,
                };
                DVec3::from_slice(own.row(row))
            })),
        }
    }
}

/// For each corner, the angle-weighted sum of the normals of those faces around its position that are within
/// the crease angle of its own.
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
    let run = |place: usize| &around[starts[place] as usize..starts[place + 1] as usize];
    let sum_of = |corners: &[u32], own: Option<DVec3>| {
        corners.iter().fold(DVec3::ZERO, |sum, corner| {
            let (face, k) = (*corner as usize / 3, *corner as usize % 3);
            let smooth = own.is_none_or(|own| normals[face].dot(own) >= CREASE_COS);
            if smooth { sum + normals[face] * angles[face][k] } else { sum }
        })
    };
    let fans: BTreeMap<usize, DVec3> = (0..mesh.positions().len())
        .filter(|place| run(*place).len() > MOST_COMPARED)
        .map(|place| (place, sum_of(run(place), None).normalize_or_zero()))
        .collect();
    let rows = for_faces(n_faces, job, |face| {
        let own = normals[face];
        [0, 1, 2].map(|k| {
            let place = position(3 * face + k);
            let sum = match fans.get(&place) {
                None => sum_of(run(place), Some(own)),
                Some(all) if all.dot(own) >= CREASE_COS => *all,
                Some(_) => own,
            };
            let normal = sum.normalize_or(own);
            [normal.x as f32, normal.y as f32, normal.z as f32]
        })
    });
    rows.into_flattened()
}

/// Faces of one task.
const TASK: usize = 1 << 14;

fn for_faces<T: Send + Clone>(n: usize, job: &Job, one: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let chunks: Vec<usize> = (0..n).step_by(TASK).collect();
    par_map(job, &chunks, |_, from| (*from..n.min(from + TASK)).map(&one).collect::<Vec<T>>()).concat()
}

/// Up to this many faces around a position, each is compared with each, which costs their square. In larger
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
