//! `Refinement`: some rounds of a cage made ready, for positions that move.
use super::creases::{Creases, Rules};
use super::edges::{Around, Edges};
use super::grids::{Level, corners, n_points};
use super::quads::Quads;
use super::refine::Sharp;
use super::round::Round;
use super::values::{Real, chunks};
use super::{Cage, InvalidCage, MOST, Scheme, Sizes};
use crate::budget::{Job, par_map_owned};

/// Faces of the result that one task of a thread numbers, about. Chosen.
const TASK: usize = 1 << 14;

impl Cage {
    /// The cage after some rounds; none gives the cage itself.
    ///
    /// The faces are the same as by [`Cage::refined`] so many times, and so are the vertices, but for rounding and the order after
    /// the second round: first the vertices of the first round, under their numbers; then for each of its edges the points along it, from its
    /// lower vertex; then for each of its faces the points inside, row by row, rows running from its first vertex to its
    /// second. Faces follow those of the first round, row by row as well. Loop's scheme has them as [`Cage::refined`].
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

    /// Some rounds made ready: all that does not depend on positions.
    ///
    /// # Errors
    /// [`InvalidCage::TooMany`] when the result could not be counted.
    pub fn refinement(&self, rounds: u32) -> Result<Refinement, InvalidCage> {
        Refinement::of(self, rounds)
    }
}

/// Some rounds of a cage made ready: for positions that move, and whatever else stands at its vertices.
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
pub struct Refinement {
    rounds: Vec<Round>,
    /// What comes after the first round, where it is quads.
    grids: Option<(Quads, Vec<Rules>)>,
    /// The result, without positions, and without faces where there are grids.
    result: Cage,
}

impl Refinement {
    fn of(cage: &Cage, rounds: u32) -> Result<Self, InvalidCage> {
        // Every round makes four corners of one.
        let n_corners = (0..rounds).try_fold(cage.corners.len(), |n, _| n.checked_mul(4));
        if n_corners.is_none_or(|n| n > MOST) {
            return Err(InvalidCage::TooMany { what: "corners", most: MOST });
        }
        if rounds < 2 || cage.scheme == Scheme::Loop {
            let mut refinement = Self { rounds: Vec::new(), grids: None, result: cage.clone() };
            for _ in 0..rounds {
                let cage = &refinement.result;
                let edges = Edges::of(cage);
                let around = Around::of(cage, &edges);
                let sharp = Sharp::of(cage, &edges, &around);
                let next = cage.next_topology(&edges, &around, &sharp);
                let round = Round::of(cage, edges, around, &sharp);
                refinement.rounds.push(round);
                refinement.result = next;
            }
            if rounds > 0 {
                refinement.result.positions = Vec::new();
            }
            return Ok(refinement);
        }
        let edges = Edges::of(cage);
        let around = Around::of(cage, &edges);
        let sharp = Sharp::of(cage, &edges, &around);
        let quads = Quads::of(cage, &edges);
        let tags = cage.next_tags(&edges, &around, &sharp);
        let mut of_edges: Vec<(u32, f64)> = Vec::new();
        for (e, halves) in quads.halves.iter().enumerate().filter(|(e, _)| sharp.edges[*e] > 0.0) {
            let left = edges.ends[e].map(|v| sharp.left(cage.creasing, &around, (e, v as usize)));
            of_edges.extend(halves.iter().copied().zip(left).filter(|(_, left)| *left > 0.0));
        }
        let listed: Vec<u32> = cage.creases.iter().filter_map(|([a, b], _)| edges.between(*a, *b)).collect();
        let first = Round::of(cage, edges, around, &sharp);
        let mut creases = Creases::new(&quads, cage.creasing, &of_edges, &tags.sharp_vertices);
        let rules = (1..rounds).map(|_| creases.next()).collect();
        let n = 1_usize << (rounds - 1);
        let mut all = Vec::new();
        for half in listed.iter().flat_map(|e| quads.halves[*e as usize]) {
            let ends = quads.ends[half as usize];
            let index = |place: usize| match place {
                0 => ends[0],
                _ if place == n => ends[1],
                _ => (quads.n_vertices + half as usize * (n - 1) + place - 1) as u32,
            };
            let parts = (0..n).map(|part| (part, creases.of_part(half, part)));
            all.extend(parts.filter(|(_, sharp)| *sharp > 0.0).map(|(part, sharp)| {
                let (a, b) = (index(part), index(part + 1));
                (if a < b { [a, b] } else { [b, a] }, sharp)
            }));
        }
        all.sort_unstable_by_key(|(ends, _)| *ends);
        let part = (n * n) as u32;
        let holes = tags.holes.iter().flat_map(|face| face * part..(face + 1) * part).collect();
        let result = Cage { creases: all, sharp_vertices: creases.vertices(), holes, ..tags };
        Ok(Self { rounds: vec![first], grids: Some((quads, rules)), result })
    }

    /// Parts of an edge of the first round.
    fn n_parts(&self) -> usize {
        self.grids.as_ref().map_or(1, |(_, rules)| 1 << rules.len())
    }

    /// How many vertices the cage has.
    #[must_use]
    pub fn n_controls(&self) -> usize {
        self.rounds.first().map_or(self.result.positions.len(), Round::n_before)
    }

    /// How many vertices the result has.
    #[must_use]
    pub fn n_points(&self) -> usize {
        match &self.grids {
            Some((quads, _)) => n_points(quads, self.n_parts()),
            None => self.rounds.last().map_or(self.result.positions.len(), Round::n_after),
        }
    }

    /// How many faces the result has, with holes.
    #[must_use]
    pub fn n_faces(&self) -> usize {
        match &self.grids {
            Some((quads, _)) => quads.edges.len() * self.n_parts() * self.n_parts(),
            None => self.result.n_faces(),
        }
    }

    /// The corners of all faces of the result, one after the other: four each, but three for Loop, and those of the cage itself
    /// after no round. They do not change as the cage moves.
    #[must_use]
    pub fn corners(&self, job: &Job) -> Vec<u32> {
        let Some((quads, _)) = &self.grids else { return self.result.corners.clone() };
        let n = self.n_parts();
        let mut out = vec![0; 4 * self.n_faces()];
        let few = TASK.div_ceil(n * n);
        par_map_owned(job, chunks(&mut out, 4 * few * n * n), |(first, out)| {
            corners(quads, n, (first / (4 * n * n), out));
        });
        out
    }

    /// What stands at the vertices of the result, in their order, from what stands at those of the cage: K numbers each.
    ///
    /// Of the positions of a cage in f64 it makes, bit for bit, those of its [`Cage::refined_times`], on any number of threads. The
    /// job says how many; it is not asked whether it is cancelled.
    ///
    /// *Cost.* 8 K bytes a point of the result (4 K in f32), and a third as much again while it runs, for the rounds before.
    ///
    /// # Errors
    /// [`InvalidCage::WrongCount`], and [`InvalidCage::NotFinite`] where a number is NaN or infinite, or grows so on the way.
    pub fn evaluate<T: Real, const K: usize>(
        &self,
        values: &[[T; K]],
        job: &Job,
    ) -> Result<Vec<[T; K]>, InvalidCage> {
        let mut out = vec![[T::default(); K]; self.n_points()];
        self.evaluate_into(values, &mut out, job)?;
        Ok(out)
    }

    /// [`Refinement::evaluate`] into memory that is there; what it holds after an error is not said.
    ///
    /// # Errors
    /// As for [`Refinement::evaluate`], of both counts.
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
        job.run(|| self.rounds_of(values, job, out));
        // Shares are from 0 to 1 and add up to 1, so that what is far from the largest number stays so.
        if !values.iter().all(|p| p.iter().all(|x| x.is_calm()))
            && let Some(row) = out.iter().position(|p| !is_finite(p))
        {
            return Err(InvalidCage::NotFinite { row });
        }
        Ok(())
    }

    fn rounds_of<T: Real, const K: usize>(&self, values: &[[T; K]], job: &Job, out: &mut [[T; K]]) {
        let Some((first, rest)) = self.rounds.split_first() else { return out.copy_from_slice(values) };
        if rest.is_empty() && self.grids.is_none() {
            return first.apply(values, job, out);
        }
        let apply = |round: &Round, values: &[[T; K]]| {
            let mut out = vec![[T::default(); K]; round.n_after()];
            round.apply(values, job, &mut out);
            out
        };
        let mut points = apply(first, values);
        if let Some((last, between)) = rest.split_last() {
            for round in between {
                points = apply(round, &points);
            }
            return last.apply(&points, job, out);
        }
        let Some((quads, rules)) = &self.grids else { return };
        let weights = if self.result.scheme == Scheme::Bilinear { [1.0, 0.0] } else { [0.75, 0.125] };
        let weights = weights.map(T::of);
        let Some((last, between)) = rules.split_last() else { return };
        let mut n = 1;
        for rules in between {
            let mut next = vec![[T::default(); K]; n_points(quads, 2 * n)];
            Level { quads, n, values: &points }.divide(rules, weights, job, &mut next);
            (points, n) = (next, 2 * n);
        }
        Level { quads, n, values: &points }.divide(last, weights, job, out);
    }

    /// The cage after the rounds, where its vertices are here.
    ///
    /// # Errors
    /// As for [`Refinement::evaluate`].
    pub fn refined(&self, positions: &[[f64; 3]], job: &Job) -> Result<Cage, InvalidCage> {
        let positions = self.evaluate(positions, job)?;
        if self.grids.is_none() {
            return Ok(Cage { positions, ..self.result.clone() });
        }
        let corners = self.corners(job);
        Ok(Cage { positions, sizes: Sizes::even(4, self.n_faces()), corners, ..self.result.clone() })
    }
}
