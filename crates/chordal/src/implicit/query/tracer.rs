//! `FieldTracer`: many beams at once, each advanced by one value per round, until all are done.
use super::super::LeafError;
use super::beam::{Beam, BeamRecord};
use super::octree::FieldOctree;
use super::point_queries::normals;
use super::ray_march::{BeamMarcher, HitQuery};

/// The most beams that advance together: their marchers, of half a kilobyte each, stay in the second cache.
const AT_ONCE: usize = 2048;

/// Intersects beams with the surface of a field.
///
/// All active beams are evaluated together, so that a leaf gets as many points per call as there are beams. A
/// hit is a bracket of 2⁻⁴² of the size, with a point outside at one end and one inside at the other. The
/// beam before it is free, as proved by intervals of slopes in each cell or by the field's distance quality,
/// up to the rounding of values. Where neither proves it, steps of a quarter of the beam's radius are taken,
/// and the record says *uncertain*.
///
/// ```
/// use chordal::implicit::{Expr, Field, query::{Beam, FieldOctree, FieldTracer}};
/// use chordal::{Job, math::Box3};
/// let [x, y, z] = Expr::axes();
/// let ball = Field::new(x.square() + y.square() + z.square() - 1.0)
///     .with_bounds(Box3 { min: [-1.0; 3], max: [1.0; 3] });
/// let cells = FieldOctree::build(&ball, &Job::default())?;
/// let beam = Beam { origin: [3.0, 0.0, 0.0], direction: [-1.0, 0.0, 0.0], from: 0.0, to: 9.0, cone: [0.001, 0.0] };
/// let record = FieldTracer::new(&cells).intersect(&[beam])?[0];
/// assert!((record.hit.unwrap().t - 2.0).abs() < 1e-11 && !record.uncertain);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct FieldTracer<'a> {
    cells: &'a FieldOctree,
}

impl<'a> FieldTracer<'a> {
    /// A tracer for these cells.
    #[must_use]
    pub fn new(cells: &'a FieldOctree) -> Self {
        Self { cells }
    }

    /// The first intersection of each beam with the surface, from whichever side it starts.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn intersect(&self, beams: &[Beam]) -> Result<Vec<BeamRecord>, LeafError> {
        self.run(beams, HitQuery::First)
    }

    /// Whether each beam meets anything; a beam that starts inside does.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn occluded(&self, beams: &[Beam]) -> Result<Vec<bool>, LeafError> {
        Ok(self.run(beams, HitQuery::Any)?.iter().map(|record| record.hit.is_some()).collect())
    }

    /// The smallest number of points that a call of the field should have.
    #[must_use]
    pub fn batch(&self) -> usize {
        self.cells.batch
    }

    /// The unit gradient at each point, outward on the surface; `None` where it vanishes or is not finite.
    ///
    /// # Errors
    /// When a leaf fails.
    pub fn normals(&self, points: &[[f64; 3]]) -> Result<Vec<Option<[f64; 3]>>, LeafError> {
        let mut order: Vec<(u32, u32)> =
            (points.iter().enumerate()).map(|(k, point)| (self.cells.tape_at(*point), k as u32)).collect();
        order.sort_unstable();
        let mut out = vec![None; points.len()];
        for group in order.chunk_by(|a, b| a.0 == b.0) {
            let tape = &self.cells.tapes[group[0].0 as usize];
            for part in group.chunks(self.cells.batch) {
                let part_points: Vec<[f64; 3]> = part.iter().map(|(_, k)| points[*k as usize]).collect();
                for ((_, k), normal) in part.iter().zip(normals(tape, &part_points)?) {
                    out[*k as usize] = normal;
                }
            }
        }
        Ok(out)
    }

    fn run(&self, beams: &[Beam], hit_query: HitQuery) -> Result<Vec<BeamRecord>, LeafError> {
        let mut records = Vec::with_capacity(beams.len());
        for part in beams.chunks(AT_ONCE.max(self.cells.batch)) {
            records.append(&mut self.run_part(part, hit_query)?);
        }
        Ok(records)
    }

    fn run_part(&self, beams: &[Beam], hit_query: HitQuery) -> Result<Vec<BeamRecord>, LeafError> {
        let mut records = vec![BeamRecord::default(); beams.len()];
        let mut walkers: Vec<BeamMarcher> = Vec::new();
        for (k, (beam, record)) in beams.iter().zip(&mut records).enumerate() {
            let Some(mut walker) = BeamMarcher::new(self.cells, beam, hit_query) else { continue };
            walker.start(self.cells);
            if walker.is_done() {
                *record = walker.record();
            } else {
                walker.beam = k as u32;
                walkers.push(walker);
            }
        }
        // Active beams, sorted by their tape. The marchers are large, so indices are sorted instead.
        let mut live: Vec<[u32; 2]> =
            walkers.iter().enumerate().map(|(k, walker)| [walker.tape, k as u32]).collect();
        let (mut points, mut values) = (Vec::new(), Vec::new());
        while !live.is_empty() {
            // With one tape there is nothing to group.
            if self.cells.tapes.len() > 1 {
                live.sort_unstable();
            }
            for group in live.chunk_by(|a, b| a[0] == b[0]) {
                let tape = &self.cells.tapes[group[0][0] as usize];
                for part in group.chunks(self.cells.batch) {
                    points.clear();
                    points.extend(part.iter().map(|[_, k]| walkers[*k as usize].point()));
                    values.clear();
                    values.resize(points.len(), f64::NAN);
                    tape.at(&points, &mut values)?;
                    for ([_, k], value) in part.iter().zip(&values) {
                        walkers[*k as usize].advance(self.cells, *value);
                    }
                }
            }
            live.retain_mut(|[tape, k]| {
                let walker = &walkers[*k as usize];
                *tape = walker.tape;
                if walker.is_done() {
                    records[walker.beam as usize] = walker.record();
                }
                !walker.is_done()
            });
        }
        Ok(records)
    }
}

#[cfg(test)]
mod tests {
    use super::super::BeamHit;
    use super::*;
    use crate::budget::Job;
    use crate::implicit::shapes::{capped_cone, sphere};

    /// A cone that ends in a ball is convex near the ball, except for a groove in which no part of the shape
    /// stands above a point: its normals are free.
    #[test]
    fn light_along_normals_is_not_blocked_where_a_cone_ends_in_a_ball() {
        let cone = capped_cone(6.0, 2.0, 26.0).unwrap();
        let solid = cone.union(&sphere(2.0).unwrap().moved([0.0, 0.0, 13.0]).unwrap());
        let solid = solid.rotated_deg([0.0, 1.0, 0.0], 90.0).unwrap();
        let mut cells = FieldOctree::build(&solid, &Job::default()).unwrap();
        cells.sample_gradients(&Job::default()).unwrap();
        let tracer = FieldTracer::new(&cells);
        let toward_axis = |k: usize| {
            let (x, turn) = (9.0 + 6.0 * (k % 200) as f64 / 200.0, (k / 200) as f64 * 0.11);
            let out = [0.0, libm::cos(turn), libm::sin(turn)];
            let origin = [x, 20.0 * out[1], 20.0 * out[2]];
            Beam { origin, direction: out.map(|x| -x), from: 0.0, to: 40.0, cone: [1e-3, 0.0] }
        };
        let beams: Vec<Beam> = (0..8000).map(toward_axis).collect();
        let hits: Vec<BeamHit> =
            tracer.intersect(&beams).unwrap().into_iter().filter_map(|record| record.hit).collect();
        assert!(hits.len() > 7000); // those beyond the tip pass by
        let points: Vec<[f64; 3]> = hits.iter().map(|hit| hit.point).collect();
        let lifted = |(at, normal): (&[f64; 3], Option<[f64; 3]>)| {
            let direction = normal.expect("it has a gradient");
            let origin = [0, 1, 2].map(|k| at[k] + 3e-5 * direction[k]);
            Beam { origin, direction, from: 0.0, to: f64::INFINITY, cone: [0.06, 0.01] }
        };
        let lights: Vec<Beam> = points.iter().zip(tracer.normals(&points).unwrap()).map(lifted).collect();
        let blocked = tracer.occluded(&lights).unwrap().into_iter().filter(|is_blocked| *is_blocked).count();
        assert_eq!(blocked, 0);
    }
}
