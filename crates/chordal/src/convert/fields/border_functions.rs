//! `BorderFunctions`: the functions whose zeros may be borders of materials: the primitives of a CSG tree, and for each
//! two parts of a blend the difference of the distances to their own surfaces.
use crate::budget::Job;
use crate::implicit::csg::{BlendPart, CsgMaterials, MaterialChoice};
use crate::implicit::{Csg, Dual, LeafError, Membership, PrimitiveEvaluator, Tape};
use crate::math::Box3;
use std::collections::BTreeMap;

/// Blends of more parts are not cut along borders: each face has the material at its middle. Chosen: the number of pairs
/// grows with the square.
const MOST_PARTS: usize = 16;

/// Two parts of a blend with different materials.
pub(super) struct PartPair<'a> {
    parts: [&'a BlendPart; 2],
}

/// The pairs of parts of the blends of a tree, numbered after the primitives.
pub(super) struct PartPairs<'a> {
    n_primitives: u32,
    pairs: Vec<PartPair<'a>>,
    /// By the indices of both parts, the smaller one first.
    numbers: BTreeMap<(u32, u32), u32>,
}

impl<'a> PartPairs<'a> {
    pub fn new(csg: &Csg, materials: &'a CsgMaterials) -> Self {
        let n_primitives = csg.primitives().len() as u32;
        let mut pairs = Self { n_primitives, pairs: Vec::new(), numbers: BTreeMap::new() };
        for parts in materials.blends().filter(|parts| parts.len() <= MOST_PARTS) {
            for (k, a) in parts.iter().enumerate() {
                for b in parts[k + 1..].iter().filter(|b| b.material != a.material) {
                    let number = n_primitives + pairs.pairs.len() as u32;
                    pairs.numbers.insert((a.index, b.index), number);
                    pairs.pairs.push(PartPair { parts: [a, b] });
                }
            }
        }
        pairs
    }

    /// The number of primitives and pairs.
    pub fn n_functions(&self) -> usize {
        self.n_primitives as usize + self.pairs.len()
    }

    /// The material of a blend, as far as the sides of the pairs decide which part is nearest.
    pub fn nearest(&self, parts: &[BlendPart], side: &impl Fn(u32) -> Membership) -> MaterialChoice {
        let mut choice = MaterialChoice::Never;
        for a in parts {
            let is_farther = |b: &BlendPart| match self.numbers.get(&(a.index, b.index)) {
                Some(number) => side(*number) == Membership::Outside,
                None => self
                    .numbers
                    .get(&(b.index, a.index))
                    .is_some_and(|number| side(*number) == Membership::Inside),
            };
            if !parts.iter().any(is_farther) {
                choice = choice.or(MaterialChoice::One(a.material));
            }
        }
        // If the sides contradict each other, no part is nearest.
        if choice == MaterialChoice::Never { MaterialChoice::Several } else { choice }
    }
}

/// Evaluates the functions for many points or boxes at once.
pub(super) struct BorderFunctions<'a> {
    evaluator: PrimitiveEvaluator<'a>,
    pairs: &'a PartPairs<'a>,
}

impl<'a> BorderFunctions<'a> {
    pub fn new(csg: &'a Csg, pairs: &'a PartPairs<'a>, (domain, job): (&Box3, &'a Job)) -> Self {
        Self { evaluator: PrimitiveEvaluator::new(csg, domain, job), pairs }
    }

    /// Intervals of values in boxes; those of pairs are unbounded.
    pub fn ranges(&mut self, queries: &[(u32, Box3)]) -> Result<Vec<[f64; 2]>, LeafError> {
        let (primitive_rows, _) = self.divide(queries);
        let mut ranges = vec![[f64::NEG_INFINITY, f64::INFINITY]; queries.len()];
        let primitive_queries: Vec<_> = primitive_rows.iter().map(|row| queries[*row]).collect();
        let primitive_ranges = self.evaluator.ranges(&primitive_queries)?;
        primitive_rows.into_iter().zip(primitive_ranges).for_each(|(row, range)| ranges[row] = range);
        Ok(ranges)
    }

    /// Values at points.
    pub fn values(&mut self, queries: &[(u32, [f64; 3])]) -> Result<Vec<f64>, LeafError> {
        let join = |pair: &PartPair, [a, b]: [f64; 2]| {
            (pair.parts[0].scale * a).abs() - (pair.parts[1].scale * b).abs()
        };
        self.evaluate(
            (queries, 0.0),
            |evaluator, queries| evaluator.values(queries),
            |tape, at, out| tape.at(at, out),
            join,
        )
    }

    /// Values with gradients at points.
    pub fn duals(&mut self, queries: &[(u32, [f64; 3])]) -> Result<Vec<Dual<f64>>, LeafError> {
        let join = |pair: &PartPair, both: [Dual<f64>; 2]| {
            let size = |k: usize| {
                let Dual { value, gradient } = both[k];
                // The derivative of the absolute value.
                let scale = if value < 0.0 { -pair.parts[k].scale } else { pair.parts[k].scale };
                Dual { value: scale * value, gradient: gradient.map(|slope| scale * slope) }
            };
            let (a, b) = (size(0), size(1));
            let gradient = std::array::from_fn(|k| a.gradient[k] - b.gradient[k]);
            Dual { value: a.value - b.value, gradient }
        };
        let none = Dual { value: 0.0, gradient: [0.0; 3] };
        self.evaluate(
            (queries, none),
            |evaluator, queries| evaluator.duals(queries),
            |tape, at, out| tape.gradient_at(at, out),
            join,
        )
    }

    fn evaluate<T: Copy>(
        &mut self,
        (queries, none): (&[(u32, [f64; 3])], T),
        of_primitives: impl Fn(&mut PrimitiveEvaluator<'a>, &[(u32, [f64; 3])]) -> Result<Vec<T>, LeafError>,
        of_tape: impl Fn(&Tape, &[[f64; 3]], &mut [T]) -> Result<(), LeafError>,
        join: impl Fn(&PartPair<'a>, [T; 2]) -> T,
    ) -> Result<Vec<T>, LeafError> {
        let (primitive_rows, pairs) = self.divide(queries);
        let mut results = vec![none; queries.len()];
        let primitive_queries: Vec<_> = primitive_rows.iter().map(|row| queries[*row]).collect();
        let primitive_results = of_primitives(&mut self.evaluator, &primitive_queries)?;
        primitive_rows.into_iter().zip(primitive_results).for_each(|(row, value)| results[row] = value);
        for (number, rows) in pairs {
            let pair = &self.pairs.pairs[(number - self.pairs.n_primitives) as usize];
            let points: Vec<[f64; 3]> = rows.iter().map(|row| queries[*row].1).collect();
            let mut both = [vec![none; rows.len()], vec![none; rows.len()]];
            for (part, out) in pair.parts.iter().zip(&mut both) {
                of_tape(&part.tape, &points, out)?;
            }
            rows.into_iter()
                .enumerate()
                .for_each(|(k, row)| results[row] = join(pair, [both[0][k], both[1][k]]));
        }
        Ok(results)
    }

    /// The rows of primitives, and those of each pair.
    fn divide<T>(&self, queries: &[(u32, T)]) -> (Vec<usize>, BTreeMap<u32, Vec<usize>>) {
        let (mut primitive_rows, mut pairs) = (Vec::new(), BTreeMap::<u32, Vec<usize>>::new());
        for (row, (number, _)) in queries.iter().enumerate() {
            if *number < self.pairs.n_primitives {
                primitive_rows.push(row);
            } else {
                pairs.entry(*number).or_default().push(row);
            }
        }
        (primitive_rows, pairs)
    }
}
