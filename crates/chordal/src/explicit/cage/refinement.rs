//! `Refinement`: several precomputed rounds of a cage, for moving positions.
use super::creases::{GridSharpness, StencilTable};
use super::edges::{CageEdges, VertexIncidence};
use super::grids::{QuadGridLevel, corners, n_points};
use super::quads::QuadTopology;
use super::refinement_step::as_texcoord_error;
use super::sharpness::CageSharpness;
use super::stencils::RefinementStencils;
use super::triangles::{self, TriangleTopology};
use super::values::{Real, chunks};
use super::{Cage, Chart, CornerTexcoords, FaceSizes, InvalidCage, MOST, Scheme};
use crate::budget::{Job, par_map_owned};

/// Faces per task, approximately, when corners are numbered. Chosen: enough to outweigh the start of a task.
const TASK: usize = 1 << 14;

impl Cage {
    /// The cage after some rounds; zero rounds give the cage itself.
    ///
    /// The faces and vertices are those of repeated [`Cage::refined`], except for rounding and, after the
    /// second round, the order. First come the vertices of the first round, with the same indices; then for
    /// each of its edges the points along it, from its lower vertex; then for each of its faces the points
    /// inside, row by row, with rows from its first vertex to its second. Faces follow the order of the first
    /// round, also row by row. For Loop's scheme the vertices, edges and faces of the cage itself replace
    /// those of the first round; in rows of triangles upright and inverted ones alternate.
    ///
    /// If an interior vertex has only two triangles, the two edges opposite to it stay separate here;
    /// repeated [`Cage::refined`] merges them after the first round, since they have the same ends.
    ///
    /// It runs on all threads; [`Cage::refinement`] and [`Refinement::refined`] take a job.
    ///
    /// *Cost.* As for [`Refinement::evaluate`], and 16 bytes for the indices of a face of the result.
    ///
    /// # Errors
    /// As for [`Cage::refined`].
    pub fn refined_times(&self, rounds: u32) -> Result<Self, InvalidCage> {
        self.refinement(rounds)?.refined(&self.positions, &Job::default())
    }

    /// Precomputes the data of some rounds that does not depend on positions.
    ///
    /// *Cost.* Proportional to the corners of the cage, for any number of rounds: some 0.1 µs each.
    ///
    /// # Errors
    /// [`InvalidCage::TooMany`] when the result would have too many corners.
    pub fn refinement(&self, rounds: u32) -> Result<Refinement, InvalidCage> {
        Refinement::new(self, rounds)
    }
}

/// Several precomputed rounds of a cage: for moving positions, and any other values at its vertices.
///
/// Faces, creases and the rules of all points are computed once, from the cage and its first round alone.
/// Only the sharpness along creases that end between rounds grows with the number of rounds. About 200 bytes
/// per corner of the cage.
///
/// ```
/// use chordal::budget::Job;
/// use chordal::explicit::Cage;
/// let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let cage = Cage::new(square, [[0_u32, 1, 2, 3]])?;
/// let refinement = cage.refinement(4)?;
/// let faces = refinement.corners(&Job::default()); // once
/// assert_eq!(faces.len(), 4 * refinement.n_faces());
/// let mut moving = cage.positions().to_vec();
/// for frame in 0..3 {
///     moving[2][2] = f64::from(frame);
///     let points = refinement.evaluate(&moving, &Job::default())?;
///     assert_eq!(points.len(), refinement.n_points());
/// }
/// // Colours, in single precision.
/// let colours = [[1.0_f32, 0.0, 0.0, 1.0], [0.0; 4], [0.0; 4], [0.0; 4]];
/// assert!(refinement.evaluate(&colours, &Job::default()).is_ok());
/// # Ok::<(), chordal::explicit::InvalidCage>(())
/// ```
#[derive(Clone, Debug)]
pub struct Refinement {
    rounds: RefinementRounds,
    /// The result without positions, and without faces if there are grids; after zero rounds, the cage.
    result: Cage,
    /// The chart of the cage with its own refinement, and the number of rounds.
    chart: Option<Box<(Chart, Refinement, u32)>>,
}

/// The precomputed data, by the kind of rounds.
#[derive(Clone, Debug)]
enum RefinementRounds {
    None,
    One(RefinementStencils),
    /// The first round, then grids over its quads.
    Quads(RefinementStencils, QuadTopology, Vec<StencilTable>),
    /// Loop's scheme: grids over the triangles of the cage.
    Triangles(TriangleTopology, Vec<StencilTable>),
}

impl Refinement {
    fn new(cage: &Cage, rounds: u32) -> Result<Self, InvalidCage> {
        // Without faces the vertices do not move, and finite sharpness ends after ten rounds.
        let rounds = if cage.corners.is_empty() && rounds > 12 { 12 } else { rounds };
        // Every round turns one corner into four.
        let n_corners = (0..rounds).try_fold(cage.corners.len(), |n, _| n.checked_mul(4));
        if n_corners.is_none_or(|n| n > MOST) {
            return Err(InvalidCage::TooMany { what: "corners", most: MOST });
        }
        if rounds == 0 {
            return Ok(Self { rounds: RefinementRounds::None, result: cage.clone(), chart: None });
        }
        let edges = CageEdges::new(cage);
        let around = VertexIncidence::new(cage, &edges);
        let sharp = CageSharpness::new(cage, &edges, &around);
        let chart = cage.texcoords.as_ref().map(|texcoords| {
            let chart = Chart::from_texcoords(cage, texcoords, &edges, &around, &sharp);
            let chart_refinement = Self::new(chart.cage(), rounds)?;
            Ok(Box::new((chart, chart_refinement, rounds)))
        });
        let chart = chart.transpose()?;
        let of_cage = Self::for_positions(cage, rounds, edges, around, &sharp);
        Ok(Self { chart, ..of_cage })
    }

    /// The refinement without texture coordinates.
    fn for_positions(
        cage: &Cage,
        rounds: u32,
        edges: CageEdges,
        around: VertexIncidence,
        sharp: &CageSharpness,
    ) -> Self {
        if cage.scheme == Scheme::Loop {
            return Self::for_triangles(cage, rounds, edges, around, sharp);
        }
        if rounds == 1 {
            let mut result = cage.next_topology(&edges, &around, sharp);
            result.positions = Vec::new();
            return Self {
                rounds: RefinementRounds::One(RefinementStencils::new(cage, edges, around, sharp)),
                result,
                chart: None,
            };
        }
        let quads = QuadTopology::new(cage, &edges);
        let tags = cage.next_tags(&edges, &around, sharp);
        let mut of_edges: Vec<(u32, f64)> = Vec::new();
        // The grids begin after the first round: their edges are halves of the cage's, each with
        // the sharpness that is left at its end.
        for (e, halves) in quads.halves.iter().enumerate().filter(|(e, _)| sharp.edges[*e] > 0.0) {
            let half_sharpness =
                edges.ends[e].map(|v| sharp.subdivided(cage.creasing, &around, e, v as usize));
            of_edges.extend(
                halves
                    .iter()
                    .copied()
                    .zip(half_sharpness)
                    .filter(|(_, half_sharpness)| *half_sharpness > 0.0),
            );
        }
        let listed: Vec<u32> = cage.creases.iter().filter_map(|([a, b], _)| edges.between(*a, *b)).collect();
        let first = RefinementStencils::new(cage, edges, around, sharp);
        let points_and_edges = (quads.n_vertices, &*quads.ends);
        let mut creases =
            GridSharpness::new(cage.creasing, points_and_edges, &of_edges, &tags.sharp_vertices);
        let rules = (1..rounds).map(|_| creases.next()).collect();
        let n = 1_usize << (rounds - 1);
        let halves = listed.iter().flat_map(|e| quads.halves[*e as usize]);
        let creased = part_creases(&creases, n, points_and_edges, halves);
        let holes = tags.holes.iter().flat_map(|face| parts(*face, n)).collect();
        let result = Cage { creases: creased, sharp_vertices: creases.vertices(), holes, ..tags };
        Self { rounds: RefinementRounds::Quads(first, quads, rules), result, chart: None }
    }

    fn for_triangles(
        cage: &Cage,
        rounds: u32,
        edges: CageEdges,
        around: VertexIncidence,
        sharp: &CageSharpness,
    ) -> Self {
        let tags = cage.next_tags(&edges, &around, sharp);
        let listed: Vec<u32> = cage.creases.iter().filter_map(|([a, b], _)| edges.between(*a, *b)).collect();
        let some = |sharpness: &[f64]| -> Vec<(u32, f64)> {
            let sharpness = sharpness.iter().enumerate().filter(|(_, sharp)| **sharp > 0.0);
            sharpness.map(|(k, sharp)| (k as u32, *sharp)).collect()
        };
        let triangles = TriangleTopology::new(&cage.corners, cage.positions.len(), edges, around);
        let points_and_edges = (triangles.n_vertices, &*triangles.ends);
        let mut creases =
            GridSharpness::new(cage.creasing, points_and_edges, &some(&sharp.edges), &some(&sharp.vertices));
        let rules = (0..rounds).map(|_| creases.next()).collect();
        let n = 1_usize << rounds;
        let creased = part_creases(&creases, n, points_and_edges, listed.into_iter());
        // The tags list four parts for each hole, as after one round.
        let holes = tags.holes.iter().step_by(4).flat_map(|part| parts(part / 4, n)).collect();
        let result = Cage { creases: creased, sharp_vertices: creases.vertices(), holes, ..tags };
        Self { rounds: RefinementRounds::Triangles(triangles, rules), result, chart: None }
    }

    /// The number of vertices of the cage.
    #[must_use]
    pub fn n_controls(&self) -> usize {
        match &self.rounds {
            RefinementRounds::None => self.result.positions.len(),
            RefinementRounds::One(round) | RefinementRounds::Quads(round, ..) => round.n_before(),
            RefinementRounds::Triangles(triangles, _) => triangles.n_vertices,
        }
    }

    /// The number of vertices of the result.
    #[must_use]
    pub fn n_points(&self) -> usize {
        match &self.rounds {
            RefinementRounds::None => self.result.positions.len(),
            RefinementRounds::One(round) => round.n_after(),
            RefinementRounds::Quads(_, quads, rules) => n_points(quads, 1 << rules.len()),
            RefinementRounds::Triangles(triangles, rules) => triangles.n_points(1 << rules.len()),
        }
    }

    /// The number of faces of the result, including holes.
    #[must_use]
    pub fn n_faces(&self) -> usize {
        match &self.rounds {
            RefinementRounds::None | RefinementRounds::One(_) => self.result.n_faces(),
            RefinementRounds::Quads(_, quads, rules) => quads.edges.len() << (2 * rules.len()),
            RefinementRounds::Triangles(triangles, rules) => triangles.n_faces() << (2 * rules.len()),
        }
    }

    /// The corners of all faces of the result, one after the other: four each, but three for Loop, and those
    /// of the cage itself after zero rounds. They do not depend on positions.
    #[must_use]
    pub fn corners(&self, job: &Job) -> Vec<u32> {
        let (size, n) = match &self.rounds {
            RefinementRounds::None | RefinementRounds::One(_) => return self.result.corners.clone(),
            RefinementRounds::Quads(_, _, rules) => (4, 1 << rules.len()),
            RefinementRounds::Triangles(_, rules) => (3, 1 << rules.len()),
        };
        let mut out = vec![0; size * self.n_faces()];
        let each = size * n * n;
        par_map_owned(job, chunks(&mut out, TASK.div_ceil(n * n) * each), |(first, out)| {
            match &self.rounds {
                RefinementRounds::Quads(_, quads, _) => corners(quads, n, (first / each, out)),
                RefinementRounds::Triangles(triangles, _) => triangles.faces(n, (first / each, out)),
                RefinementRounds::None | RefinementRounds::One(_) => {}
            }
        });
        out
    }

    /// Values at the vertices of the result, in their order, from values at those of the cage, with K numbers
    /// each.
    ///
    /// For the f64 positions of a cage the result equals [`Cage::refined_times`] bit for bit, on any number
    /// of threads. The job sets their number; its cancellation is ignored.
    ///
    /// *Cost.* 8 K bytes per point of the result (4 K in f32), and a third more while it runs, for the
    /// previous rounds: a level of n quads holds 24 bytes per point in f64 and 12 in f32, and there are about
    /// as many points as quads. Its indices take 16 bytes per quad.
    ///
    /// # Errors
    /// [`InvalidCage::WrongCount`], and [`InvalidCage::NotFinite`] if a number is NaN or infinite, or an
    /// intermediate one overflows.
    pub fn evaluate<T: Real, const K: usize>(
        &self,
        values: &[[T; K]],
        job: &Job,
    ) -> Result<Vec<[T; K]>, InvalidCage> {
        let mut out = vec![[T::default(); K]; self.n_points()];
        self.evaluate_into(values, &mut out, job)?;
        Ok(out)
    }

    /// [`Refinement::evaluate`] into existing memory; its content after an error is unspecified.
    ///
    /// # Errors
    /// As for [`Refinement::evaluate`], for both counts.
    pub fn evaluate_into<T: Real, const K: usize>(
        &self,
        values: &[[T; K]],
        out: &mut [[T; K]],
        job: &Job,
    ) -> Result<(), InvalidCage> {
        for (expected, found) in [(self.n_controls(), values.len()), (self.n_points(), out.len())] {
            if expected != found {
                return Err(InvalidCage::WrongCount { expected, found });
            }
        }
        let is_finite = |p: &[T; K]| p.iter().all(|x| x.is_finite());
        if let Some(row) = values.iter().position(|p| !is_finite(p)) {
            return Err(InvalidCage::NotFinite { row });
        }
        // The pool is entered once for all rounds; a single thread needs none.
        match job.threads {
            1 => self.apply_rounds(values, job, out),
            _ => job.run(|| self.apply_rounds(values, job, out)),
        }
        // Weights are from 0 to 1 and add up to 1, so that numbers far below the largest number stay so.
        if !values.iter().all(|p| p.iter().all(|x| x.is_safe_to_sum()))
            && let Some(row) = out.iter().position(|p| !is_finite(p))
        {
            return Err(InvalidCage::NotFinite { row });
        }
        Ok(())
    }

    fn apply_rounds<T: Real, const K: usize>(&self, values: &[[T; K]], job: &Job, out: &mut [[T; K]]) {
        match &self.rounds {
            RefinementRounds::None => out.copy_from_slice(values),
            RefinementRounds::One(round) => round.apply(values, job, out),
            RefinementRounds::Triangles(triangles, rules) => {
                let round = |n, values: &[[T; K]], rules: &StencilTable, out: &mut [[T; K]]| {
                    triangles::TriangleGridLevel { triangles, n, values }.divide(rules, job, out);
                };
                let size = |n| triangles.n_points(n);
                apply_grid_rounds(rules, values, out, size, round);
            }
            RefinementRounds::Quads(first, quads, rules) => {
                let mut points = vec![[T::default(); K]; first.n_after()];
                first.apply(values, job, &mut points);
                let is_bilinear = self.result.scheme == Scheme::Bilinear;
                let weights = if is_bilinear { [1.0, 0.0] } else { [0.75, 0.125] }.map(T::from_f64);
                let round = |n, values: &[[T; K]], rules: &StencilTable, out: &mut [[T; K]]| {
                    QuadGridLevel { quads, n, values }.divide(rules, weights, job, out);
                };
                apply_grid_rounds(rules, &points, out, |n| n_points(quads, n), round);
            }
        }
    }

    /// The texture coordinates of the result, if the cage has any. They do not depend on positions.
    ///
    /// *Cost.* As for [`Refinement::evaluate`] and [`Refinement::corners`].
    ///
    /// # Errors
    /// [`InvalidCage::TexcoordNotFinite`] if an intermediate one overflows.
    pub fn texcoords(&self, job: &Job) -> Result<Option<CornerTexcoords>, InvalidCage> {
        let Some(chart) = &self.chart else { return Ok(self.result.texcoords.clone()) };
        let (chart, refinement, rounds) = &**chart;
        let values = refinement.evaluate(&chart.values(), job).map_err(as_texcoord_error)?;
        Ok(Some(chart.texcoords(*rounds, values, refinement.corners(job))))
    }

    /// The refined cage for these positions, with its texture coordinates.
    ///
    /// # Errors
    /// As for [`Refinement::evaluate`].
    pub fn refined(&self, positions: &[[f64; 3]], job: &Job) -> Result<Cage, InvalidCage> {
        let positions = self.evaluate(positions, job)?;
        let texcoords = self.texcoords(job)?;
        let size = match &self.rounds {
            RefinementRounds::None | RefinementRounds::One(_) => {
                return Ok(Cage { positions, texcoords, ..self.result.clone() });
            }
            RefinementRounds::Quads(..) => 4,
            RefinementRounds::Triangles(..) => 3,
        };
        let sizes = FaceSizes::uniform(size, self.n_faces());
        Ok(Cage { positions, sizes, corners: self.corners(job), texcoords, ..self.result.clone() })
    }
}

/// Rounds over grids, the last one into `out`. `round` receives the number of parts along an edge, the values
/// before the round and the weights.
fn apply_grid_rounds<T: Real, const K: usize>(
    rules: &[StencilTable],
    values: &[[T; K]],
    out: &mut [[T; K]],
    size: impl Fn(usize) -> usize,
    round: impl Fn(usize, &[[T; K]], &StencilTable, &mut [[T; K]]),
) {
    let Some((last, before)) = rules.split_last() else { return };
    let (mut n, mut points) = (1, Vec::new());
    for rules in before {
        let mut next = vec![[T::default(); K]; size(2 * n)];
        round(n, if n == 1 { values } else { &points }, rules, &mut next);
        (n, points) = (2 * n, next);
    }
    round(n, if n == 1 { values } else { &points }, last, out);
}

/// The n² parts of a face.
fn parts(face: u32, n: usize) -> std::ops::Range<u32> {
    let n = (n * n) as u32;
    face * n..(face + 1) * n
}

/// The sharp parts of these edges, each of which has n parts.
fn part_creases(
    creases: &GridSharpness,
    n: usize,
    (n_vertices, ends): (usize, &[[u32; 2]]),
    edges: impl Iterator<Item = u32>,
) -> Vec<([u32; 2], f64)> {
    let mut creases_of_parts = Vec::new();
    for edge in edges {
        // Points along an edge follow the vertices, edge by edge.
        let index = |part: usize| match part {
            0 => ends[edge as usize][0],
            _ if part == n => ends[edge as usize][1],
            _ => (n_vertices + edge as usize * (n - 1) + part - 1) as u32,
        };
        let parts = (0..n).map(|part| (part, creases.part_sharpness(edge, part)));
        creases_of_parts.extend(parts.filter(|(_, sharp)| *sharp > 0.0).map(|(part, sharp)| {
            let (a, b) = (index(part), index(part + 1));
            (if a < b { [a, b] } else { [b, a] }, sharp)
        }));
    }
    creases_of_parts.sort_unstable_by_key(|(ends, _)| *ends);
    creases_of_parts
}
