//! Clusters of neighbouring triangles with normal cones, and the parts of a mesh that face away from a
//! viewer.
use super::{Mesh, Triangle};
use crate::math::{Orientation, difference, distance, dot, greater, length, lesser, orient3d};
use std::ops::Range;

/// The numbers of triangles that a viewer sees from the front, from the back, and edge-on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FacingCounts {
    /// Triangles whose front faces the eye, occluded or not.
    pub front: usize,
    /// Triangles whose back faces the eye.
    pub back: usize,
    /// Triangles whose plane contains the eye, and those without area.
    pub on_edge: usize,
}

impl FacingCounts {
    /// The fraction of triangles that back-face culling removes; 0 without triangles.
    #[must_use]
    pub fn back_share(&self) -> f64 {
        let total = self.front + self.back + self.on_edge;
        if total == 0 { 0.0 } else { self.back as f64 / total as f64 }
    }
}

/// Classifies each triangle by the side on which the eye lies, exactly. Time O(n).
///
/// ```
/// use chordal::Mesh;
/// use chordal::explicit::query::facing;
/// let mesh = Mesh::new(vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]], vec![[0, 1, 2], [0, 2, 1]]).unwrap();
/// let seen = facing(&mesh, [0.0, 0.0, 5.0]);
/// assert_eq!((seen.front, seen.back, seen.back_share()), (1, 1, 0.5));
/// ```
#[must_use]
pub fn facing(mesh: &Mesh, eye: [f64; 3]) -> FacingCounts {
    let mut counts = FacingCounts::default();
    for face in 0..mesh.faces().len() {
        let [a, b, c] = mesh.corners(face);
        *match orient3d(a, b, c, eye) {
            Orientation::Front => &mut counts.front,
            Orientation::Back => &mut counts.back,
            Orientation::Flat => &mut counts.on_edge,
        } += 1;
    }
    counts
}

/// Consecutive triangles with a bounding sphere and a cone of their normals.
#[derive(Clone, Debug, PartialEq)]
pub struct Cluster {
    /// The faces.
    pub faces: Range<usize>,
    /// The centre of the sphere.
    pub centre: [f64; 3],
    /// The radius of the sphere: no corner is farther from the centre.
    pub radius: f64,
    /// The axis of the cone, of length 1; `None` if no cone contains all normals.
    pub axis: Option<[f64; 3]>,
    /// A lower bound for the cosine of the angle between the axis and any normal.
    pub cos_angle: f64,
}

/// Margin for the roundings of lengths and products in the cone and its test, each of half a unit: a dozen
/// for a normal, and as many for the test. Derived.
const MARGIN: f64 = 64.0 * f64::EPSILON;

impl Cluster {
    /// Whether every triangle faces away from an eye or is edge-on, so that back-face culling can skip the
    /// entire cluster. Never true if a front is visible; false if sphere and cone cannot decide.
    ///
    /// Take a point of the sphere and a normal of the cone: with `x` and `y` the components of `centre − eye`
    /// along the axis and across it, and `α` the cone's angle, the normal points away from the eye by at
    /// least `x·cos α − y·sin α − radius`.
    #[must_use]
    pub fn is_backward(&self, eye: [f64; 3]) -> bool {
        let Some(axis) = self.axis else { return false };
        let away = difference(self.centre, eye);
        let distance = length(away);
        let along = dot(away, axis);
        let square = distance * distance - along * along;
        let across = if square > 0.0 { square.sqrt() } else { 0.0 };
        let cos = self.cos_angle;
        let sine_sq = 1.0 - cos * cos;
        let sine = if sine_sq > 0.0 { sine_sq.sqrt() } else { 0.0 };
        // The root of a rounded difference is off by at most the root of the rounding.
        let slack = (distance + self.radius) * MARGIN + distance * MARGIN.sqrt();
        cos > 0.0 && along * cos - across * sine - self.radius > slack
    }
}

/// Splits triangles, in their order, into clusters of at most `triangles` triangles and `vertices` vertices.
/// After [`super::cache_order`] neighbours are consecutive. A cluster has at least one triangle. Time O(n).
///
/// Source of the sizes that suit current processors (124 and 64): A. Kapoulkine, *meshoptimizer*.
#[must_use]
pub fn clusters(mesh: &Mesh, triangles: usize, vertices: usize) -> Vec<Cluster> {
    // A vertex is marked by the first triangle of the cluster that has it, so the marks are never
    // cleared.
    let mut seen_in = vec![usize::MAX; mesh.positions().len()];
    let (mut clusters, mut from, mut n_vertices) = (Vec::new(), 0, 0);
    for (face, corners) in mesh.faces().iter().enumerate() {
        let is_new = |v: &&u32| seen_in[**v as usize] != from;
        let fresh = corners.iter().filter(is_new).count();
        if face > from && (face - from >= triangles || n_vertices + fresh > vertices) {
            clusters.push(cluster(mesh, from..face));
            (from, n_vertices) = (face, 0);
        }
        for v in corners {
            if std::mem::replace(&mut seen_in[*v as usize], from) != from {
                n_vertices += 1;
            }
        }
    }
    if from < mesh.faces().len() {
        clusters.push(cluster(mesh, from..mesh.faces().len()));
    }
    clusters
}

fn cluster(mesh: &Mesh, faces: Range<usize>) -> Cluster {
    let corners = || faces.clone().flat_map(|face| mesh.corners(face));
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in corners() {
        for k in 0..3 {
            low[k] = lesser(p[k], low[k]);
            high[k] = greater(p[k], high[k]);
        }
    }
    let centre = std::array::from_fn(|k| 0.5 * low[k] + 0.5 * high[k]);
    let radius = corners().map(|p| distance(p, centre)).fold(0.0, |m, d| greater(d, m));
    // Triangles without area have no front.
    let normals: Vec<[f64; 3]> =
        faces.clone().filter_map(|face| Triangle::from_face(mesh, face).normal()).collect();
    let sum = normals.iter().fold([0.0; 3], |sum: [f64; 3], n| std::array::from_fn(|k| sum[k] + n[k]));
    let long = length(sum);
    let axis = (long > 0.0).then(|| sum.map(|x| x / long));
    // The normal that is farthest from the axis.
    let cos = axis
        .map_or(-1.0, |axis| normals.iter().map(|n| dot(*n, axis)).fold(1.0, |lowest, c| lesser(c, lowest)));
    let cos_angle = cos - MARGIN;
    Cluster {
        faces,
        centre,
        radius: radius * (1.0 + MARGIN),
        axis: axis.filter(|_| cos_angle > 0.0),
        cos_angle,
    }
}
