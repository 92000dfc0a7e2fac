//! `LineDepths`: the outlines and creases of a mesh in the picture, so that no part is too thin to be found.
use super::camera::RayGenerator;
use super::normals::CREASE_COS;
use crate::budget::{Job, Screen, par_map};
use crate::explicit::adjacency::{Twin, Twins};
use crate::explicit::{Mesh, Topology, face_normal};
use crate::math::{greater, lesser};
use glam::DVec3;
use std::sync::atomic::{AtomicU32, Ordering};

/// For each pixel the least depth of a line in it: of a boundary edge, an edge between front and back, or a
/// crease.
pub(super) struct LineDepths {
    screen: Screen,
    /// The upper halves of the bits of f64: for positive numbers these sort alike, in steps of 2⁻²⁰ of the
    /// number.
    bits: Vec<AtomicU32>,
}

/// The faces in one task.
const TASK: usize = 1 << 14;

impl LineDepths {
    pub fn new(mesh: &Mesh, eye: &RayGenerator, screen: Screen, job: &Job) -> Self {
        let n = screen.width_px as usize * screen.height_px as usize;
        let far = upper(f64::INFINITY);
        let depths = Self { screen, bits: (0..n).map(|_| AtomicU32::new(far)).collect() };
        let twins = Twins::new(mesh, Topology::Indices);
        let chunks: Vec<usize> = (0..mesh.faces().len()).step_by(TASK).collect();
        let _: Vec<()> = par_map(job, &chunks, |_, from| {
            for face in *from..mesh.faces().len().min(from + TASK) {
                depths.add_face(mesh, &twins, eye, face);
            }
        });
        depths
    }

    /// The least depth in a pixel; +∞ without a line, and outside the picture.
    pub fn at(&self, [x, y]: [i64; 2]) -> f64 {
        let (w, h) = (i64::from(self.screen.width_px), i64::from(self.screen.height_px));
        if x < 0 || y < 0 || x >= w || y >= h {
            return f64::INFINITY;
        }
        f64::from_bits(u64::from(self.bits[(y * w + x) as usize].load(Ordering::Relaxed)) << 32)
    }

    fn add_face(&self, mesh: &Mesh, twins: &Twins, eye: &RayGenerator, face: usize) {
        let corners = mesh.corners(face);
        for k in 0..3 {
            let half_edge = (3 * face + k) as u32;
            let is_line = match twins.get(half_edge) {
                Twin::Collapsed => false,
                Twin::Boundary | Twin::NonManifold | Twin::Flipped(_) => true,
                // Each edge is drawn once.
                Twin::Pair(other) => other < half_edge && is_line(mesh, eye, [face, other as usize / 3]),
            };
            if is_line {
                self.draw(eye, [corners[k], corners[(k + 1) % 3]]);
            }
        }
    }

    /// Marks the pixels along an edge. An edge behind the eye, or passing it, is left out: it is no thin
    /// line.
    fn draw(&self, eye: &RayGenerator, ends: [[f64; 3]; 2]) {
        let [a, b] = ends.map(|p| eye.project(p));
        if !(a[2] > 0.0 && b[2] > 0.0) {
            return;
        }
        let size = [f64::from(self.screen.width_px), f64::from(self.screen.height_px)];
        // The part of the edge inside the picture, since an edge may be millions of pixels long.
        let (mut from, mut to) = (0.0, 1.0);
        for k in 0..2 {
            let by = b[k] - a[k];
            if by == 0.0 {
                if !(a[k] >= 0.0 && a[k] < size[k]) {
                    return;
                }
                continue;
            }
            let [s, t] = [-a[k] / by, (size[k] - a[k]) / by];
            from = greater(lesser(s, t), from);
            to = lesser(greater(s, t), to);
        }
        let longest = greater((b[0] - a[0]).abs(), (b[1] - a[1]).abs());
        let steps = (longest * (to - from)).ceil();
        // NaN and infinities end here too, since no edge inside the picture is longer than it.
        if !(from <= to && steps <= 2.0 * (size[0] + size[1])) {
            return;
        }
        let steps = steps as u32;
        for step in 0..=steps {
            let t = from + (to - from) * f64::from(step) / f64::from(steps.max(1));
            let [x, y] = [0, 1].map(|k| a[k] + t * (b[k] - a[k]));
            // Inverse depth is linear in the picture if the rays come from one eye; if they are parallel, the
            // nearer end is near enough.
            let depth = 1.0 / ((1.0 - t) / a[2] + t / b[2]);
            let [x, y] = [x as usize, y as usize];
            let [w, h] = [self.screen.width_px, self.screen.height_px].map(|n| n as usize);
            if x < w && y < h {
                // The least of all depths, whichever thread comes first. Positive numbers are in the order of
                // their bits, and so are the upper halves of these.
                self.bits[y * w + x].fetch_min(upper(depth), Ordering::Relaxed);
            }
        }
    }
}

fn upper(depth: f64) -> u32 {
    (depth.to_bits() >> 32) as u32
}

fn is_line(mesh: &Mesh, eye: &RayGenerator, faces: [usize; 2]) -> bool {
    let normals = faces.map(|face| face_normal(mesh.corners(face)).map(DVec3::from));
    let [Some(a), Some(b)] = normals else { return true };
    let towards = |face: usize, normal: DVec3| {
        let corner = mesh.corners(face)[0];
        eye.look(corner).dot(normal) < 0.0
    };
    a.dot(b) < CREASE_COS || towards(faces[0], a) != towards(faces[1], b)
}
