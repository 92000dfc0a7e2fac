//! `Operand`: one mesh of a boolean, ready for the engines and for the check of the result.
use crate::budget::{Job, JobError};
use crate::check::findings::MeshConnectivity;
use crate::check::{Component, Facing, has_zero_area, self_intersections};
use crate::explicit::{Mesh, Topology, is_closed, position_id_by_bits};
use std::fmt;

/// The reason why there is no boolean.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BooleanError {
    /// An operand, counted from 0, bounds no solid.
    NotClosed {
        /// The operand: 0 is the first mesh, 1 that of the first step.
        operand: usize,
        /// Edges with one triangle.
        boundary_edges: u64,
    },
    /// The work was refused or cancelled.
    Stopped(JobError),
}

impl From<JobError> for BooleanError {
    fn from(stopped: JobError) -> Self {
        Self::Stopped(stopped)
    }
}

impl fmt::Display for BooleanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotClosed { operand, boundary_edges: 0 } => {
                write!(
                    f,
                    "operand {operand} bounds no solid: some edge has unequal numbers of faces in its two directions"
                )
            }
            Self::NotClosed { operand, boundary_edges } => {
                write!(f, "operand {operand} bounds no solid: {boundary_edges} edges have one triangle only")
            }
            Self::Stopped(stopped) => stopped.fmt(f),
        }
    }
}

impl std::error::Error for BooleanError {}

/// A face of an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BooleanSource {
    /// 0 for the first mesh, then 1 more for each step.
    pub operand: u32,
    /// The number of the face in that operand.
    pub face: u32,
}

/// One operand.
pub(super) struct Operand<'a> {
    pub mesh: &'a Mesh,
    /// The distinct positions that faces use.
    pub points: Vec<[f64; 3]>,
    /// The faces with three distinct positions, as rows of `points`.
    pub faces: Vec<[u32; 3]>,
    /// For each of `faces`, its number in the mesh.
    pub face_of: Vec<u32>,
    /// Whether every edge has two triangles, which run along it in both directions, none crosses another, and
    /// shells are wound as their nesting demands: then all winding numbers are 0 or 1.
    pub is_simple: bool,
}

impl<'a> Operand<'a> {
    pub fn new(number: usize, mesh: &'a Mesh, job: &Job) -> Result<Self, BooleanError> {
        // 1. Rows by position.
        let ids = position_id_by_bits(mesh.positions());
        let mut row_of = vec![u32::MAX; ids.len()];
        let (mut points, mut faces, mut face_of) = (Vec::new(), Vec::new(), Vec::new());
        for (face, corners) in (0..).zip(mesh.faces()) {
            let [a, b, c] = corners.map(|row| ids[row as usize]);
            // If two corners of a face are one, its other two sides are one edge in both directions, so that the
            // mesh is as closed without it.
            if a == b || b == c || c == a {
                continue;
            }
            faces.push([a, b, c].map(|id| {
                let row = &mut row_of[id as usize];
                if *row == u32::MAX {
                    *row = points.len() as u32;
                    // Adding zero turns −0.0 into 0.0.
                    points.push(mesh.positions()[id as usize].map(|x| x + 0.0));
                }
                *row
            }));
            face_of.push(face);
        }
        // 2. The mesh must be closed, so that there is an inside.
        let solid = Mesh::by_construction(points, faces);
        let surface = MeshConnectivity::new(&solid, Topology::Indices);
        let components = surface.components_under(job)?;
        let is_sound = |component: &Component| component.closed && component.manifold() && component.oriented;
        let is_sound = components.iter().all(is_sound);
        // Components may touch along an edge, which is not manifold, and still bound a solid.
        if !is_sound && !is_closed(&solid) {
            let boundary_edges = surface.validity().boundary_edges.count;
            return Err(BooleanError::NotClosed { operand: number, boundary_edges });
        }
        // 3. The conditions of the fast engine.
        let is_simple = is_sound
            && components.iter().all(|component| component.facing == Facing::Outward)
            && has_no_crossing(&solid, job)?;
        drop(surface);
        let (points, faces) = solid.into_parts();
        Ok(Self { mesh, points, faces, face_of, is_simple })
    }

    /// The corners of a row of `faces`.
    pub fn corners(&self, face: usize) -> [[f64; 3]; 3] {
        self.faces[face].map(|row| self.points[row as usize])
    }
}

/// Whether all triangles have area, and none crosses or touches another.
fn has_no_crossing(mesh: &Mesh, job: &Job) -> Result<bool, JobError> {
    let has_area = |face: usize| !has_zero_area(mesh.corners(face));
    Ok((0..mesh.faces().len()).all(has_area) && self_intersections(mesh, job)?.count == 0)
}
