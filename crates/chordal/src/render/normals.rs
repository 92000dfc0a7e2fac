//! `ShadingNormals`: the normals by which a mesh is shaded.
use crate::explicit::{Attribute, Domain, Mesh, Semantic, face_normal};
use glam::DVec3;

/// Edges sharper than this (its cosine) are creases in a mesh without normals of its own: cos 30°.
const CREASE_COS: f64 = 0.866_025_403_784_438_6;

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
    pub fn from_mesh(mesh: &'a Mesh) -> Self {
        match mesh.attribute(&Semantic::Normal) {
            Some(own) if own.width == 3 => Self::Given(own),
            _ => Self::Smooth(smooth(mesh)),
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
fn smooth(mesh: &Mesh) -> Vec<[f32; 3]> {
    let n_faces = mesh.faces().len();
    let normals: Vec<DVec3> =
        (0..n_faces).map(|f| face_normal(mesh.corners(f)).map_or(DVec3::ZERO, DVec3::from)).collect();
    let angles: Vec<[f64; 3]> = (0..n_faces).map(|f| corner_angles(mesh.corners(f))).collect();
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
    let sum_of = |corners: &[u32], own: Option<DVec3>| {
        corners.iter().fold(DVec3::ZERO, |sum, corner| {
            let (face, k) = (*corner as usize / 3, *corner as usize % 3);
            let smooth = own.is_none_or(|own| normals[face].dot(own) >= CREASE_COS);
            if smooth { sum + normals[face] * angles[face][k] } else { sum }
        })
    };
    let mut rows = vec![[0.0_f32; 3]; 3 * n_faces];
    for run in starts.windows(2).map(|ends| &around[ends[0] as usize..ends[1] as usize]) {
        let all = if run.len() > MOST_COMPARED { sum_of(run, None).normalize_or_zero() } else { DVec3::ZERO };
        for corner in run {
            let own = normals[*corner as usize / 3];
            let sum = if run.len() <= MOST_COMPARED {
                sum_of(run, Some(own))
            } else if all.dot(own) >= CREASE_COS {
                all
            } else {
                own
            };
            let normal = sum.normalize_or(own);
            rows[*corner as usize] = [normal.x as f32, normal.y as f32, normal.z as f32];
        }
    }
    rows
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
