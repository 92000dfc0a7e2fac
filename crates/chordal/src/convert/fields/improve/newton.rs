//! Newton steps of points onto the surfaces, creases and corners of their primitives.
use super::{BlockedPlace, FaceLabel, ImproveError, SurfaceImprover, VertexConstraint, sample};
use crate::implicit::{LeafError, PrimitiveEvaluator};
use crate::math::greater;
use glam::DVec3;

/// The most steps. Chosen: each step doubles the digits.
const MOST_STEPS: usize = 5;
/// Additional steps for leaves that are saturated, so that the first steps have to be taken back. Chosen: each step back
/// halves the distance.
const MOST_BACK: usize = 5;
/// The iteration ends at a step of this fraction of the tolerance. Chosen: far below any measured length, and
/// above the rounding of coordinates.
const AT_REST: f64 = 1e-9;
/// Added to the squares of unit normals, so that parallel normals give a step. Chosen: far below the square of the sine
/// of a degree, 3e-4.
const DAMPING: f64 = 1e-9;

/// Points with the primitives onto which they are projected.
#[derive(Debug, Default)]
pub(super) struct ProjectionBatch {
    pub at: Vec<DVec3>,
    /// By point: the start and the number of its constraints.
    pub run: Vec<(u32, u32)>,
    pub constraints: Vec<VertexConstraint>,
}

impl ProjectionBatch {
    pub fn push(&mut self, at: DVec3, labels: impl Iterator<Item = FaceLabel>) {
        let first = self.constraints.len() as u32;
        let none = |label| VertexConstraint { label, distance: f64::NAN, normal: DVec3::ZERO };
        self.constraints.extend(labels.map(none));
        self.at.push(at);
        self.run.push((first, self.constraints.len() as u32 - first));
    }

    pub fn constraints_of(&self, k: usize) -> &[VertexConstraint] {
        let (first, n) = self.run[k];
        &self.constraints[first as usize..(first + n) as usize]
    }

    /// Moves each point by shortest steps onto all of its primitives at once. Afterwards its constraints have the distances
    /// and normals at its final position.
    pub fn project(&mut self, evaluator: &mut PrimitiveEvaluator, tol: f64) -> Result<(), LeafError> {
        let mut active: Vec<u32> = (0..self.at.len() as u32).collect();
        let guarded = self.guarded(evaluator);
        // For guarded points: the start of the last step, and its distance from the surface.
        let mut before: Vec<(DVec3, f64)> =
            self.at.iter().map(|at| (*at, f64::INFINITY)).filter(|_| !guarded.is_empty()).collect();
        let most_steps = if guarded.is_empty() { MOST_STEPS } else { MOST_STEPS + MOST_BACK };
        for step in 0..=most_steps {
            self.measure(evaluator, &active)?;
            // The last measurement only brings the constraints up to date with the final positions.
            if step == most_steps {
                break;
            }
            active.retain(|k| {
                if guarded.get(*k as usize) == Some(&true) {
                    let distance = self.constraints_of(*k as usize)[0].distance.abs();
                    // Nearer than that, distances fluctuate by the last digits of single precision.
                    let is_far = !(distance <= SETTLED * tol);
                    let (from, last_distance) = &mut before[*k as usize];
                    let at = self.at[*k as usize];
                    // The last step led no nearer: half of it is taken back.
                    if is_far && !(distance < *last_distance) && at != *from {
                        self.at[*k as usize] = 0.5 * (*from + at);
                        return true;
                    }
                    if !is_far && step >= MOST_STEPS {
                        return false;
                    }
                    (*from, *last_distance) = (at, distance);
                } else if step >= MOST_STEPS {
                    return false;
                }
                let move_by = shortest_step(self.constraints_of(*k as usize));
                let at = self.at[*k as usize] + move_by;
                let moves = move_by.length_squared() > (AT_REST * tol) * (AT_REST * tol) && at.is_finite();
                if moves {
                    self.at[*k as usize] = at;
                }
                moves
            });
            if active.is_empty() {
                break;
            }
        }
        Ok(())
    }

    /// By point: whether a step that leads away from the surface is taken back halfway. Saturated functions have such steps: an
    /// occupancy is flat beside its surface, so that a Newton step from there leads far beyond it. Points with a single
    /// primitive that has leaves are guarded; if there are none, the list is empty.
    fn guarded(&self, evaluator: &PrimitiveEvaluator) -> Vec<bool> {
        let primitives = evaluator.csg().primitives();
        let has_leaves = |on: &VertexConstraint| primitives[on.label as usize / 2].tape().has_leaves();
        let is_guarded = |k: usize| matches!(self.constraints_of(k), [only] if has_leaves(only));
        let guarded: Vec<bool> = (0..self.at.len()).map(is_guarded).collect();
        if guarded.contains(&true) { guarded } else { Vec::new() }
    }

    fn measure(&mut self, evaluator: &mut PrimitiveEvaluator, points: &[u32]) -> Result<(), LeafError> {
        let mut queries = Vec::with_capacity(points.len());
        for k in points {
            queries.extend(
                self.constraints_of(*k as usize)
                    .iter()
                    .map(|constraints| (constraints.label, self.at[*k as usize])),
            );
        }
        let mut samples = sample::sample(evaluator, &queries)?.into_iter();
        for k in points {
            let (first, n) = self.run[*k as usize];
            for (constraints, sample) in
                self.constraints[first as usize..(first + n) as usize].iter_mut().zip(&mut samples)
            {
                (constraints.distance, constraints.normal) = (sample.distance, sample.normal);
            }
        }
        Ok(())
    }
}

/// The shortest vector that moves a point onto all tangent planes: `−Nᵀ (N Nᵀ)⁻¹ r`.
pub(super) fn shortest_step(constraints: &[VertexConstraint]) -> DVec3 {
    match constraints {
        [] => DVec3::ZERO,
        [only] => -only.distance * only.normal,
        [a, b] => {
            let cos = a.normal.dot(b.normal);
            let square = 1.0 + DAMPING;
            let det = square * square - cos * cos;
            let u = (-a.distance * square + b.distance * cos) / det;
            let v = (-b.distance * square + a.distance * cos) / det;
            u * a.normal + v * b.normal
        }
        _ => {
            // (NᵀN + damping)⁻¹ Nᵀ r, which is equal to it and has rank 3 for any number of planes.
            let (mut rows, mut right) = ([DVec3::ZERO; 3], DVec3::ZERO);
            for constraint in constraints {
                for k in 0..3 {
                    rows[k] += constraint.normal[k] * constraint.normal;
                }
                right -= constraint.distance * constraint.normal;
            }
            (0..3).for_each(|k| rows[k][k] += DAMPING);
            let inverse = [rows[1].cross(rows[2]), rows[2].cross(rows[0]), rows[0].cross(rows[1])];
            let det = rows[0].dot(inverse[0]);
            (inverse[0] * right.x + inverse[1] * right.y + inverse[2] * right.z) / det
        }
    }
}

impl SurfaceImprover<'_> {
    /// Moves all vertices to their targets: first all at once; vertices of crossing faces are moved back, and then forward one
    /// by one as far as possible.
    pub(super) fn place_vertices(&mut self) -> Result<(), ImproveError> {
        let mut targets = ProjectionBatch {
            at: self.position.clone(),
            run: self.run.clone(),
            constraints: std::mem::take(&mut self.constraints),
        };
        let before = targets.constraints.clone();
        targets.project(&mut self.evaluator, self.tol)?;
        let mut is_away = vec![false; self.position.len()];
        let raw = self.position.clone();
        self.constraints = before;
        // All at once: sheets that are near to each other move together. One by one, each would block the
        // next.
        for v in 0..raw.len() as u32 {
            let (from, to) = (raw[v as usize], targets.at[v as usize]);
            let reach = self.size_around(v, &raw);
            let reach = greater(reach, 4.0 * self.tol);
            // A target farther away is on another part of the surface, or the steps diverge.
            if (to - from).length() <= reach {
                self.position[v as usize] = to;
            } else {
                is_away[v as usize] = true;
            }
        }
        self.constraints = targets.constraints;
        let away: Vec<u32> = (0..raw.len() as u32).filter(|v| is_away[*v as usize]).collect();
        self.measure_vertices(&away)?;
        self.rebuild_tree();
        self.untangle(&raw, &mut is_away)?;
        let blocked = (0..raw.len() as u32).filter(|v| is_away[*v as usize]);
        self.blocked = blocked
            .map(|v| BlockedPlace { at: raw[v as usize].to_array(), extent: self.extent_around(v, &raw) })
            .collect();
        Ok(())
    }

    /// The longest edge at a vertex.
    pub(super) fn size_around(&self, v: u32, at: &[DVec3]) -> f64 {
        let length = |h: u32| (at[self.surface.end(h) as usize] - at[v as usize]).length();
        self.surface.one_ring(v).map(length).fold(0.0, |m, x| greater(x, m))
    }

    /// The extent of the edges at a vertex along each axis.
    pub(super) fn extent_around(&self, v: u32, at: &[DVec3]) -> [f64; 3] {
        let reach = |h: u32| (at[self.surface.end(h) as usize] - at[v as usize]).abs();
        self.surface.one_ring(v).map(reach).fold(DVec3::ZERO, DVec3::max).to_array()
    }

    /// Samples vertices at their positions.
    pub(super) fn measure_vertices(&mut self, vertices: &[u32]) -> Result<(), LeafError> {
        let mut queries = Vec::new();
        for v in vertices {
            queries.extend(self.constraints_of(*v).iter().map(|on| (on.label, self.at(*v))));
        }
        let mut samples = self.sample(&queries)?.into_iter();
        for v in vertices {
            for (on, sample) in self.constraints_of_mut(*v).iter_mut().zip(&mut samples) {
                (on.distance, on.normal) = (sample.distance, sample.normal);
            }
        }
        Ok(())
    }

    /// Moves vertices of crossing faces back until no faces cross, then forward as far as possible.
    fn untangle(&mut self, raw: &[DVec3], is_away: &mut [bool]) -> Result<(), ImproveError> {
        let mut suspects: Vec<u32> = (0..self.surface.face_slots() as u32).collect();
        let mut moved_back: Vec<u32> = Vec::new();
        // This ends, since the raw surface has no crossing faces, and every pass sends some vertex back to
        // it.
        while !suspects.is_empty() {
            self.next_round()?;
            let crossing = self.find_crossing(&suspects);
            let mut moved: Vec<u32> = crossing.iter().flat_map(|f| self.surface.corners(*f)).collect();
            moved.sort_unstable();
            moved.dedup();
            moved.retain(|v| self.position[*v as usize] != raw[*v as usize]);
            suspects.clear();
            for v in &moved {
                self.position[*v as usize] = raw[*v as usize];
                is_away[*v as usize] = true;
            }
            for v in &moved {
                suspects.extend(self.surface.one_ring(*v).map(|h| h / 3));
            }
            suspects.sort_unstable();
            suspects.dedup();
            suspects.iter().for_each(|f| self.grow_tree(*f));
            moved_back.extend(moved);
        }
        moved_back.sort_unstable();
        moved_back.dedup();
        self.measure_vertices(&moved_back)?;
        self.settle(&moved_back)?;
        for v in moved_back {
            let is_off = self.constraints_of(v).iter().any(|on| !(on.distance.abs() <= SETTLED * self.aim));
            is_away[v as usize] = is_off;
        }
        Ok(())
    }

    /// Moves vertices to their targets one by one, all the way or in part, unless another sheet blocks them.
    pub(super) fn settle(&mut self, vertices: &[u32]) -> Result<(), ImproveError> {
        let mut remaining = vertices.to_vec();
        // A vertex that was blocked may get farther once its neighbours have moved.
        for _ in 0..3 {
            if remaining.is_empty() {
                break;
            }
            let mut targets = ProjectionBatch::default();
            remaining
                .iter()
                .for_each(|v| targets.push(self.at(*v), self.constraints_of(*v).iter().map(|on| on.label)));
            targets.project(&mut self.evaluator, self.tol)?;
            let mut moved = Vec::new();
            let mut next = Vec::new();
            for (k, v) in remaining.iter().enumerate() {
                let (from, to) = (self.at(*v), targets.at[k]);
                let reach = self.size_around(*v, &self.position);
                let reach = greater(reach, 4.0 * self.tol);
                // Written so that a target that is no number is left out, too.
                if !((to - from).length() <= reach) {
                    continue;
                }
                for share in [1.0, 0.5, 0.25] {
                    if self.may_move(*v, from + share * (to - from)) {
                        self.move_vertex(*v, from + share * (to - from));
                        moved.push(*v);
                        break;
                    }
                }
                if self.at(*v) != to {
                    next.push(*v);
                }
            }
            self.measure_vertices(&moved)?;
            remaining = next;
            if moved.is_empty() {
                break;
            }
        }
        Ok(())
    }

    /// Vertices that are not at their targets.
    pub(super) fn unsettled(&self) -> Vec<u32> {
        let is_off =
            |v: &u32| self.constraints_of(*v).iter().any(|on| !(on.distance.abs() <= SETTLED * self.aim));
        (0..self.surface.vertex_slots() as u32).filter(|v| self.surface.has_vertex(*v) && is_off(v)).collect()
    }

    fn may_move(&mut self, v: u32, to: DVec3) -> bool {
        let mut new = Vec::new();
        for h in self.surface.one_ring(v) {
            let corners = self.surface.corners(h / 3);
            let points = corners.map(|w| if w == v { to } else { self.at(w) });
            new.push((corners, points));
        }
        let removed: Vec<u32> = self.surface.one_ring(v).map(|h| h / 3).collect();
        !self.crosses(&new, &removed)
    }

    /// Moves a vertex; the samples of its faces are discarded.
    pub(super) fn move_vertex(&mut self, v: u32, to: DVec3) {
        self.position[v as usize] = to;
        let faces: Vec<u32> = self.surface.one_ring(v).map(|h| h / 3).collect();
        for face in faces {
            self.forget(face);
            self.grow_tree(face);
        }
    }
}

/// A vertex is at its target if its error is below this fraction of the aim. Chosen: so small an error does not count
/// beside the aim.
pub(super) const SETTLED: f64 = 0.02;
