//! Newton steps of points onto the surfaces, creases and corners of their primitives.
use super::{BlockedPlace, FaceLabel, ImproveError, SurfaceImprover, VertexConstraint, sample};
use crate::implicit::{LeafError, PrimitiveEvaluator};
use crate::math::greater;
use glam::DVec3;

/// The most steps: each doubles the digits.
const MOST_STEPS: usize = 5;
/// Steps more where functions of the user are saturated, and the first ones have to be taken back. Chosen: each way back
/// halves the distance.
const MOST_BACK: usize = 5;
/// The iteration ends at a step of this fraction of the tolerance. Chosen: far below any measured length, and
/// above the rounding of coordinates.
const AT_REST: f64 = 1e-9;
/// Added to the squares of unit normals, so that parallel ones give a step: far below the square of the sine
/// of a degree, 3e-4.
const DAMPING: f64 = 1e-9;

/// Points with the primitives onto which they are projected.
#[derive(Debug, Default)]
pub(super) struct ProjectionBatch {
    pub at: Vec<DVec3>,
    /// By point: the start and the number of its constraints.
    pub place: Vec<(u32, u32)>,
    pub on: Vec<VertexConstraint>,
}

impl ProjectionBatch {
    pub fn push(&mut self, at: DVec3, labels: impl Iterator<Item = FaceLabel>) {
        let first = self.on.len() as u32;
        let none = |label| VertexConstraint { label, distance: f64::NAN, normal: DVec3::ZERO };
        self.on.extend(labels.map(none));
        self.at.push(at);
        self.place.push((first, self.on.len() as u32 - first));
    }

    pub fn constraints_of(&self, k: usize) -> &[VertexConstraint] {
        let (first, n) = self.place[k];
        &self.on[first as usize..(first + n) as usize]
    }

    /// Moves each point by the shortest steps onto all of its primitives at once. Distances and normals are
    /// those at the end.
    pub fn project(&mut self, evaluator: &mut PrimitiveEvaluator, tol: f64) -> Result<(), LeafError> {
        let mut open: Vec<u32> = (0..self.at.len() as u32).collect();
        let guarded = self.guarded(evaluator);
        // Of those that are guarded: where the last step began, and how far that was from the surface.
        let mut before: Vec<(DVec3, f64)> =
            self.at.iter().map(|at| (*at, f64::INFINITY)).filter(|_| !guarded.is_empty()).collect();
        let most_steps = if guarded.is_empty() { MOST_STEPS } else { MOST_STEPS + MOST_BACK };
        for step in 0..=most_steps {
            self.measure(evaluator, &open)?;
            if step == most_steps {
                break;
            }
            open.retain(|k| {
                if guarded.get(*k as usize) == Some(&true) {
                    let off = self.constraints_of(*k as usize)[0].distance.abs();
                    // Nearer than that, last digits of single precision go up and down.
                    let is_far = !(off <= SETTLED * tol);
                    let (from, was) = &mut before[*k as usize];
                    let at = self.at[*k as usize];
                    if is_far && !(off < *was) && at != *from {
                        self.at[*k as usize] = 0.5 * (*from + at);
                        return true;
                    }
                    if !is_far && step >= MOST_STEPS {
                        return false;
                    }
                    (*from, *was) = (at, off);
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
            if open.is_empty() {
                break;
            }
        }
        Ok(())
    }

    /// By point: whether its steps are taken back halfway where they lead away, as those of functions that are saturated do:
    /// an occupancy is flat beside its surface, and a plane through its values there ends far beyond. That is for points on
    /// one function of the user; without any the list is empty.
    fn guarded(&self, evaluator: &PrimitiveEvaluator) -> Vec<bool> {
        let primitives = evaluator.csg().primitives();
        let has_leaves = |on: &VertexConstraint| primitives[on.label as usize / 2].tape().has_leaves();
        let is_guarded = |k: usize| matches!(self.constraints_of(k), [one] if has_leaves(one));
        let guarded: Vec<bool> = (0..self.at.len()).map(is_guarded).collect();
        if guarded.contains(&true) { guarded } else { Vec::new() }
    }

    fn measure(&mut self, evaluator: &mut PrimitiveEvaluator, open: &[u32]) -> Result<(), LeafError> {
        let mut asks = Vec::with_capacity(open.len());
        for k in open {
            asks.extend(self.constraints_of(*k as usize).iter().map(|on| (on.label, self.at[*k as usize])));
        }
        let mut samples = sample::sample(evaluator, &asks)?.into_iter();
        for k in open {
            let (first, n) = self.place[*k as usize];
            for (on, sample) in self.on[first as usize..(first + n) as usize].iter_mut().zip(&mut samples) {
                (on.distance, on.normal) = (sample.distance, sample.normal);
            }
        }
        Ok(())
    }
}

/// The shortest vector that takes a point onto all tangent planes: `−Nᵀ (N Nᵀ)⁻¹ r`.
pub(super) fn shortest_step(on: &[VertexConstraint]) -> DVec3 {
    match on {
        [] => DVec3::ZERO,
        [one] => -one.distance * one.normal,
        [a, b] => {
            let cos = a.normal.dot(b.normal);
            let square = 1.0 + DAMPING;
            let det = square * square - cos * cos;
            let u = (-a.distance * square + b.distance * cos) / det;
            let v = (-b.distance * square + a.distance * cos) / det;
            u * a.normal + v * b.normal
        }
        _ => {
            // (NᵀN + damping)⁻¹ Nᵀ r, which is the same.
            let (mut rows, mut right) = ([DVec3::ZERO; 3], DVec3::ZERO);
            for one in on {
                for k in 0..3 {
                    rows[k] += one.normal[k] * one.normal;
                }
                right -= one.distance * one.normal;
            }
            (0..3).for_each(|k| rows[k][k] += DAMPING);
            let inverse = [rows[1].cross(rows[2]), rows[2].cross(rows[0]), rows[0].cross(rows[1])];
            let det = rows[0].dot(inverse[0]);
            (inverse[0] * right.x + inverse[1] * right.y + inverse[2] * right.z) / det
        }
    }
}

impl SurfaceImprover<'_> {
    /// Moves all vertices to their targets: first together; those in crossings go back, and then one by one
    /// as far as they can.
    pub(super) fn place_vertices(&mut self) -> Result<(), ImproveError> {
        let mut targets = ProjectionBatch {
            at: self.position.clone(),
            place: self.place.clone(),
            on: std::mem::take(&mut self.constraints),
        };
        let before = targets.on.clone();
        targets.project(&mut self.evaluator, self.tol)?;
        let mut is_away = vec![false; self.position.len()];
        let raw = self.position.clone();
        self.constraints = before;
        for v in 0..raw.len() as u32 {
            let (from, to) = (raw[v as usize], targets.at[v as usize]);
            let reach = self.size_around(v, &raw);
            let reach = greater(reach, 4.0 * self.tol);
            if (to - from).length() <= reach {
                self.position[v as usize] = to;
            } else {
                is_away[v as usize] = true;
            }
        }
        self.constraints = targets.on;
        let away: Vec<u32> = (0..raw.len() as u32).filter(|v| is_away[*v as usize]).collect();
        self.measure_vertices(&away)?;
        self.rebuild_tree();
        self.untangle(&raw, &mut is_away)?;
        let held = (0..raw.len() as u32).filter(|v| is_away[*v as usize]);
        self.blocked = held
            .map(|v| BlockedPlace { at: raw[v as usize].to_array(), extent: self.extent_around(v, &raw) })
            .collect();
        Ok(())
    }

    /// The longest edge at a vertex.
    pub(super) fn size_around(&self, v: u32, at: &[DVec3]) -> f64 {
        let length = |h: u32| (at[self.surface.end(h) as usize] - at[v as usize]).length();
        self.surface.one_ring(v).map(length).fold(0.0, |m, x| greater(x, m))
    }

    /// How far the edges at a vertex reach along each axis.
    pub(super) fn extent_around(&self, v: u32, at: &[DVec3]) -> [f64; 3] {
        let reach = |h: u32| (at[self.surface.end(h) as usize] - at[v as usize]).abs();
        self.surface.one_ring(v).map(reach).fold(DVec3::ZERO, DVec3::max).to_array()
    }

    /// Samples vertices at their positions.
    pub(super) fn measure_vertices(&mut self, vertices: &[u32]) -> Result<(), LeafError> {
        let mut asks = Vec::new();
        for v in vertices {
            asks.extend(self.constraints_of(*v).iter().map(|on| (on.label, self.at(*v))));
        }
        let mut samples = self.sample(&asks)?.into_iter();
        for v in vertices {
            for (on, sample) in self.constraints_of_mut(*v).iter_mut().zip(&mut samples) {
                (on.distance, on.normal) = (sample.distance, sample.normal);
            }
        }
        Ok(())
    }

    /// Moves vertices in crossings back until there are none, then forward as far as they can go.
    fn untangle(&mut self, raw: &[DVec3], is_away: &mut [bool]) -> Result<(), ImproveError> {
        let mut suspects: Vec<u32> = (0..self.surface.face_slots() as u32).collect();
        let mut back: Vec<u32> = Vec::new();
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
            back.extend(moved);
        }
        back.sort_unstable();
        back.dedup();
        self.measure_vertices(&back)?;
        self.settle(&back)?;
        for v in back {
            let off = self.constraints_of(v).iter().any(|on| !(on.distance.abs() <= SETTLED * self.aim));
            is_away[v as usize] = off;
        }
        Ok(())
    }

    /// Moves vertices to their targets one by one, all the way or in part, as long as no sheet blocks them.
    pub(super) fn settle(&mut self, vertices: &[u32]) -> Result<(), ImproveError> {
        let mut left = vertices.to_vec();
        for _ in 0..3 {
            if left.is_empty() {
                break;
            }
            let mut targets = ProjectionBatch::default();
            left.iter()
                .for_each(|v| targets.push(self.at(*v), self.constraints_of(*v).iter().map(|on| on.label)));
            targets.project(&mut self.evaluator, self.tol)?;
            let mut moved = Vec::new();
            let mut next = Vec::new();
            for (k, v) in left.iter().enumerate() {
                let (from, to) = (self.at(*v), targets.at[k]);
                let reach = self.size_around(*v, &self.position);
                let reach = greater(reach, 4.0 * self.tol);
                if !((to - from).length() <= reach) {
                    continue;
                }
                for part in [1.0, 0.5, 0.25] {
                    if self.may_move(*v, from + part * (to - from)) {
                        self.move_vertex(*v, from + part * (to - from));
                        moved.push(*v);
                        break;
                    }
                }
                if self.at(*v) != to {
                    next.push(*v);
                }
            }
            self.measure_vertices(&moved)?;
            left = next;
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
        let gone: Vec<u32> = self.surface.one_ring(v).map(|h| h / 3).collect();
        !self.crosses(&new, &gone)
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

/// A vertex is at its target if its error is below this fraction of the aim.
pub(super) const SETTLED: f64 = 0.02;
