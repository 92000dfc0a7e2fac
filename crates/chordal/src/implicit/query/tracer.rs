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
/// hit is a bracket of 2⁻⁴² of the size, with a point outside at one end and one inside at the other. The way
/// to it is free by intervals of slopes in each cell or by the field's distance quality, up to the rounding
/// of values. Where neither says so, steps of a quarter of the beam's radius are taken, and the record says
/// *uncertain*.
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

    /// The number of points that a call of the field should have, at least.
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
                let places: Vec<[f64; 3]> = part.iter().map(|(_, k)| points[*k as usize]).collect();
                for ((_, k), normal) in part.iter().zip(normals(tape, &places)?) {
                    out[*k as usize] = normal;
                }
            }
        }
        Ok(out)
    }

    fn run(&self, beams: &[Beam], asked: HitQuery) -> Result<Vec<BeamRecord>, LeafError> {
        let mut records = Vec::with_capacity(beams.len());
        for part in beams.chunks(AT_ONCE.max(self.cells.batch)) {
            records.append(&mut self.run_part(part, asked)?);
        }
        Ok(records)
    }

    fn run_part(&self, beams: &[Beam], asked: HitQuery) -> Result<Vec<BeamRecord>, LeafError> {
        let mut records = vec![BeamRecord::default(); beams.len()];
        let mut walkers: Vec<BeamMarcher> = Vec::new();
        for (k, (beam, record)) in beams.iter().zip(&mut records).enumerate() {
            let Some(mut walker) = BeamMarcher::new(self.cells, beam, asked) else { continue };
            walker.start(self.cells);
            if walker.is_done() {
                *record = walker.record();
            } else {
                walker.beam = k as u32;
                walkers.push(walker);
            }
        }
        // Active beams, sorted by their tape. The marchers are large, and stay where they are.
        let mut live: Vec<[u32; 2]> =
            walkers.iter().enumerate().map(|(k, walker)| [walker.tape, k as u32]).collect();
        let (mut points, mut values) = (Vec::new(), Vec::new());
        while !live.is_empty() {
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
