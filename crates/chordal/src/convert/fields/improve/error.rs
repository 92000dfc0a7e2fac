//! The errors of edges and faces against their primitives: by samples if there are any, otherwise estimated from the
//! normals at their ends.
use super::{FaceLabel, SurfaceImprover, VertexConstraint, area_normal, sides};
use crate::math::{greater, lesser};
use glam::DVec3;

/// The allowed error of a crease: this fraction of a face's aim, times the sine of half its angle. Measured in
/// proofs.
const CREASE: f64 = 0.8;
/// The least sine that is used. Chosen: with smaller ones, edges would be split without end.
const SHARPEST: f64 = 0.05;

/// Estimates are used if the normals at both ends are within 30°. Chosen: beyond, the terms that they neglect are as
/// large as the result.
const ALIKE: f64 = 0.866;
/// The barycentric coordinates of further samples of a face, beside its corners, its centroid and the middles of its
/// edges: halfway from the centroid to the corners, and the quarter points of the edges.
const INSIDE: [[f64; 3]; 9] = {
    const A: f64 = 2.0 / 3.0;
    const B: f64 = 1.0 / 6.0;
    [
        [A, B, B],
        [B, A, B],
        [B, B, A],
        [0.75, 0.25, 0.0],
        [0.25, 0.75, 0.0],
        [0.0, 0.75, 0.25],
        [0.0, 0.25, 0.75],
        [0.25, 0.0, 0.75],
        [0.75, 0.0, 0.25],
    ]
};

/// Faces whose samples are in memory at once. Chosen: some megabytes.
const CHECKED_TOGETHER: usize = 1 << 14;

/// The range of signed distances over an edge or a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct SignedDistanceRange {
    pub low: f64,
    pub high: f64,
}

impl SignedDistanceRange {
    pub const NONE: Self = Self { low: 0.0, high: 0.0 };

    /// The range extended by one more distance; NaN counts as infinitely far.
    #[inline]
    pub fn including(self, distance: f64) -> Self {
        if distance.is_nan() {
            return Self { low: f64::NEG_INFINITY, high: f64::INFINITY };
        }
        Self { low: lesser(distance, self.low), high: greater(distance, self.high) }
    }

    #[inline]
    pub fn largest(self) -> f64 {
        greater(-self.low, self.high)
    }
}

impl SurfaceImprover<'_> {
    /// The constraint of a vertex for one of its primitives.
    #[inline]
    pub(super) fn constraint(&self, v: u32, label: FaceLabel) -> Option<&VertexConstraint> {
        self.constraints_of(v).iter().find(|on| on.label == label)
    }

    /// The estimated distance between a primitive and the middle of two vertices, by the distances and normals at these;
    /// the error is of fourth order.
    #[inline]
    pub(super) fn estimate(&self, a: u32, b: u32, label: FaceLabel) -> f64 {
        let (Some(p), Some(q)) = (self.constraint(a, label), self.constraint(b, label)) else {
            return f64::NAN;
        };
        // The middle of the cubic Hermite interpolant: slopes along the edge are the components of the
        // normals.
        0.5 * (p.distance + q.distance) + 0.125 * (p.normal - q.normal).dot(self.at(b) - self.at(a))
    }

    /// The distance of the middle of a half-edge from the primitive of its face.
    #[inline]
    pub(super) fn middle_of(&self, h: u32) -> f64 {
        let sampled = self.middle[h as usize];
        if !sampled.is_nan() {
            return sampled;
        }
        let (a, b, label) = (self.surface.start(h), self.surface.end(h), self.label_of(h));
        match (self.constraint(a, label), self.constraint(b, label)) {
            (Some(p), Some(q)) if p.normal.dot(q.normal) > ALIKE => self.estimate(a, b, label),
            _ => f64::NAN,
        }
    }

    /// The error allowed between these vertices.
    #[inline]
    pub(super) fn aim_of<const N: usize>(&self, vertices: [u32; N]) -> f64 {
        let aims = vertices.map(|v| self.aim_at[v as usize]);
        aims[1..].iter().fold(aims[0], |least, aim| lesser(*aim, least))
    }

    /// The error of an edge, relative to the aim.
    pub(super) fn edge_excess(&self, h: u32) -> f64 {
        let t = self.surface.twin(h);
        let distances = [self.middle_of(h), self.middle_of(t)];
        if self.is_crease(h) {
            let labels = [self.label_of(h), self.label_of(t)];
            self.crease_excess([self.surface.start(h), self.surface.end(h)], labels, distances)
        } else {
            let excess = distances[0].abs() / self.aim_of([self.surface.start(h), self.surface.end(h)]);
            if excess.is_nan() { f64::INFINITY } else { excess }
        }
    }

    /// The error of a crease edge, relative to the aim, by the distances of its middle from both primitives.
    pub(super) fn crease_excess(&self, [a, b]: [u32; 2], labels: [FaceLabel; 2], distances: [f64; 2]) -> f64 {
        let normal = |label: FaceLabel| {
            let at = |v: u32| self.constraint(v, label).map_or(DVec3::ZERO, |constraint| constraint.normal);
            (at(a) + at(b)).normalize_or_zero()
        };
        let constraints: [VertexConstraint; 2] = std::array::from_fn(|k| VertexConstraint {
            label: labels[k],
            distance: distances[k],
            normal: normal(labels[k]),
        });
        let distance = super::newton::shortest_step(&constraints).length();
        // Half the sum of unit normals is the sine of half the angle between the faces.
        let sine = 0.5 * (constraints[0].normal + constraints[1].normal).length();
        let sine = greater(SHARPEST, sine);
        let excess = distance / (CREASE * self.aim_of([a, b]) * sine);
        if excess.is_nan() { f64::INFINITY } else { excess }
    }

    /// The range of distances over a face, by those at its corners, middles and centroid.
    pub(super) fn face_distances(&self, face: u32) -> SignedDistanceRange {
        let [u, v, w] = sides(3 * face);
        let middles = [self.middle_of(u), self.middle_of(v), self.middle_of(w)];
        self.distances(
            self.surface.corners(face),
            self.label[face as usize],
            middles,
            self.centre[face as usize],
        )
    }

    /// The error of a face, relative to the aim.
    pub(super) fn face_excess(&self, face: u32) -> f64 {
        self.face_distances(face).largest() / self.aim_of(self.surface.corners(face))
    }

    /// The range of distances over a possible new face. `middles` are by edge from the first corner on; a `centre` of NaN
    /// is estimated.
    pub(super) fn distances(
        &self,
        corners: [u32; 3],
        label: FaceLabel,
        middles: [f64; 3],
        centre: f64,
    ) -> SignedDistanceRange {
        let corner = corners.map(|v| self.constraint(v, label).map_or(f64::NAN, |on| on.distance));
        let centre = if centre.is_nan() {
            // The quadratic through corners and middles.
            (4.0 * (middles[0] + middles[1] + middles[2]) - (corner[0] + corner[1] + corner[2])) / 9.0
        } else {
            centre
        };
        corner
            .into_iter()
            .chain(middles)
            .fold(SignedDistanceRange::NONE.including(centre), SignedDistanceRange::including)
    }

    /// Whether a triangle has an area, and its normal is within 60° of a normal.
    #[inline]
    pub(super) fn faces_along(&self, points: [DVec3; 3], normal: DVec3) -> bool {
        let area = area_normal(points);
        let size = area.length();
        let [a, b, c] = points;
        let longest_sq =
            [b - a, c - b, a - c].map(DVec3::length_squared).into_iter().fold(0.0, |m, x| greater(x, m));
        // The normals of thinner triangles may be lost in rounding.
        const THINNEST: f64 = 1e-6; // Chosen: a tenth of a millimetre on a hundred metres.
        size > THINNEST * longest_sq && area.dot(normal) > 0.5 * size
    }

    /// Discards the samples of a face and of its edges, on both sides of these.
    pub(super) fn forget(&mut self, face: u32) {
        self.centre[face as usize] = f64::NAN;
        for h in sides(3 * face) {
            self.middle[h as usize] = f64::NAN;
            self.middle[self.surface.twin(h) as usize] = f64::NAN;
        }
    }

    /// The middle of an edge.
    #[inline]
    pub(super) fn middle_point(&self, a: u32, b: u32) -> DVec3 {
        0.5 * (self.at(a) + self.at(b))
    }

    /// The approximate number of faces that the aim requires. Errors fall with the square of edge lengths, so a face is cut
    /// into as many parts as its error exceeds the aim by, and a crease edge into the root of that.
    pub fn estimated_faces(&mut self) -> Result<f64, super::ImproveError> {
        let edges: Vec<u32> = self.edges().collect();
        self.sample_middles(&edges)?;
        let mut parts = vec![1.0_f64; self.surface.face_slots()];
        let mut along_creases = 0.0;
        for h in edges {
            let excess = self.edge_excess(h);
            if !excess.is_finite() {
                continue;
            }
            if self.is_crease(h) {
                // Each part of a crease edge has a face on both sides.
                along_creases += 2.0 * excess.sqrt();
                continue;
            }
            for face in [h / 3, self.surface.twin(h) / 3] {
                let parts = &mut parts[face as usize];
                *parts = greater(excess, *parts);
            }
        }
        let faces = (0..parts.len()).filter(|face| self.surface.has_face(*face as u32));
        Ok(along_creases + faces.map(|face| parts[face]).sum::<f64>())
    }

    /// Samples the unknown middles of edges.
    pub(super) fn sample_middles(&mut self, edges: &[u32]) -> Result<(), super::ImproveError> {
        let (mut queries, mut half_edges) = (Vec::new(), Vec::new());
        for h in edges {
            if !self.middle[*h as usize].is_nan() {
                continue;
            }
            let t = self.surface.twin(*h);
            let at = self.middle_point(self.surface.start(*h), self.surface.end(*h));
            queries.push((self.label_of(*h), at));
            half_edges.push(*h);
            // At a crease, both sides have a primitive of their own.
            if self.is_crease(*h) {
                queries.push((self.label_of(t), at));
                half_edges.push(t);
            }
        }
        let samples = self.sample(&queries)?;
        for (h, sample) in half_edges.into_iter().zip(samples) {
            self.middle[h as usize] = sample.distance;
            if !self.is_crease(h) {
                let t = self.surface.twin(h);
                self.middle[t as usize] = sample.distance;
            }
        }
        Ok(())
    }

    /// Samples the unknown centroids of faces.
    pub(super) fn sample_centres(&mut self, faces: &[u32]) -> Result<(), super::ImproveError> {
        let unknown: Vec<u32> = faces.iter().copied().filter(|f| self.centre[*f as usize].is_nan()).collect();
        let query = |f: &u32| {
            let [a, b, c] = self.points(*f);
            (self.label[*f as usize], (a + b + c) / 3.0)
        };
        let queries: Vec<_> = unknown.iter().map(query).collect();
        let samples = self.sample(&queries)?;
        unknown.iter().zip(samples).for_each(|(f, sample)| self.centre[*f as usize] = sample.distance);
        Ok(())
    }

    /// The faces of a list with an error above the aim at some sample; the others are marked as verified.
    pub(super) fn find_refuted(&mut self, faces: &[u32]) -> Result<Vec<u32>, super::ImproveError> {
        let edges: Vec<u32> = faces.iter().flat_map(|f| sides(3 * *f)).collect();
        self.sample_middles(&edges)?;
        self.sample_centres(faces)?;
        let mut refuted = Vec::new();
        for part in faces.chunks(CHECKED_TOGETHER) {
            let mut queries = Vec::with_capacity(INSIDE.len() * part.len());
            for f in part {
                let [a, b, c] = self.points(*f);
                queries.extend(INSIDE.map(|[u, v, w]| (self.label[*f as usize], u * a + v * b + w * c)));
            }
            let samples = self.sample(&queries)?;
            for (f, samples) in part.iter().zip(samples.chunks(INSIDE.len())) {
                let range = samples
                    .iter()
                    .fold(self.face_distances(*f), |range, sample| range.including(sample.distance));
                let is_near = range.largest() <= self.aim_of(self.surface.corners(*f));
                self.is_verified[*f as usize] = is_near;
                if !is_near {
                    refuted.push(*f);
                }
            }
        }
        Ok(refuted)
    }
}

#[cfg(test)]
impl SurfaceImprover<'_> {
    /// Counts stored samples that differ from the primitives, and errors above the aim.
    pub(super) fn count_wrong_samples(&mut self) -> usize {
        let edges: Vec<u32> = self.edges().collect();
        let stored = std::mem::replace(&mut self.middle, vec![f64::NAN; 3 * self.surface.face_slots()]);
        self.sample_middles(&edges).unwrap();
        let is_wrong = |h: u32| (stored[h as usize] - self.middle[h as usize]).abs() > 1e-6 * self.aim;
        let wrong = |h: &&u32| {
            is_wrong(**h) || is_wrong(self.surface.twin(**h)) || !(self.edge_excess(**h) <= 1.0 + 1e-9)
        };
        edges.iter().filter(wrong).count()
    }
}
