//! `BorderFunctions`: the functions whose zeros may be borders of materials: the primitives of a CSG tree, and for two
//! parts of a blend the difference of how far their own surfaces are.
use crate::budget::Job;
use crate::implicit::csg::{BlendPart, CsgMaterials, MaterialChoice};
use crate::implicit::{Csg, Dual, LeafError, Membership, PrimitiveEvaluator, Tape};
use crate::math::Box3;
use std::collections::BTreeMap;

/// Blends of more parts have no borders of their own: each face has the material of its middle. Chosen: pairs go with
/// the square.
const MOST_PARTS: usize = 16;

/// Two parts of a blend with different materials.
pub(super) struct PartPair<'a> {
    parts: [&'a BlendPart; 2],
}

/// The pairs of parts of the blends of a tree. The first has the number after the last primitive.
pub(super) struct PartPairs<'a> {
    n_primitives: u32,
    pairs: Vec<PartPair<'a>>,
    /// By the indices of both parts, the smaller one first.
    numbers: BTreeMap<(u32, u32), u32>,
}

impl<'a> PartPairs<'a> {
    pub fn new(csg: &Csg, materials: &'a CsgMaterials) -> Self {
        let n_primitives = csg.primitives().len() as u32;
        let mut all = Self { n_primitives, pairs: Vec::new(), numbers: BTreeMap::new() };
        for parts in materials.blends().filter(|parts| parts.len() <= MOST_PARTS) {
            for (k, a) in parts.iter().enumerate() {
                for b in parts[k + 1..].iter().filter(|b| b.material != a.material) {
                    let number = n_primitives + all.pairs.len() as u32;
                    all.numbers.insert((a.index, b.index), number);
                    all.pairs.push(PartPair { parts: [a, b] });
                }
            }
        }
        all
    }

    /// The number of all functions.
    pub fn n_functions(&self) -> usize {
        self.n_primitives as usize + self.pairs.len()
    }

    /// The material of a blend, from which parts are known to be nearer than others.
    pub fn nearest(&self, parts: &[BlendPart], side: &impl Fn(u32) -> Membership) -> MaterialChoice {
        let mut found = MaterialChoice::Never;
        for a in parts {
            let is_farther = |b: &BlendPart| match self.numbers.get(&(a.index, b.index)) {
                Some(number) => side(*number) == Membership::Outside,
                None => self
                    .numbers
                    .get(&(b.index, a.index))
                    .is_some_and(|number| side(*number) == Membership::Inside),
            };
            if !parts.iter().any(is_farther) {
                found = found.or(MaterialChoice::One(a.material));
            }
        }
        if found == MaterialChoice::Never { MaterialChoice::Several } else { found }
    }
}

/// Evaluates them for many points or boxes at once.
pub(super) struct BorderFunctions<'a> {
    evaluator: PrimitiveEvaluator<'a>,
    pairs: &'a PartPairs<'a>,
}

impl<'a> BorderFunctions<'a> {
    pub fn new(csg: &'a Csg, pairs: &'a PartPairs<'a>, (domain, job): (&Box3, &'a Job)) -> Self {
        Self { evaluator: PrimitiveEvaluator::new(csg, domain, job), pairs }
    }

    /// Intervals of values in boxes; of pairs nothing is known.
    pub fn ranges(&mut self, asks: &[(u32, Box3)]) -> Result<Vec<[f64; 2]>, LeafError> {
        let (own, _) = self.divide(asks);
        let mut all = vec![[f64::NEG_INFINITY, f64::INFINITY]; asks.len()];
        let found = self.evaluator.ranges(&own.iter().map(|at| asks[*at]).collect::<Vec<_>>())?;
        own.into_iter().zip(found).for_each(|(at, range)| all[at] = range);
        Ok(all)
    }

    /// Values at points.
    pub fn values(&mut self, asks: &[(u32, [f64; 3])]) -> Result<Vec<f64>, LeafError> {
        let join = |pair: &PartPair, [a, b]: [f64; 2]| {
            (pair.parts[0].scale * a).abs() - (pair.parts[1].scale * b).abs()
        };
        self.evaluate((asks, 0.0), |one, own| one.values(own), |tape, at, out| tape.at(at, out), join)
    }

    /// Values with gradients at points.
    pub fn duals(&mut self, asks: &[(u32, [f64; 3])]) -> Result<Vec<Dual<f64>>, LeafError> {
        let join = |pair: &PartPair, both: [Dual<f64>; 2]| {
            let size = |k: usize| {
                let Dual { value, gradient } = both[k];
                let scale = if value < 0.0 { -pair.parts[k].scale } else { pair.parts[k].scale };
                Dual { value: scale * value, gradient: gradient.map(|slope| scale * slope) }
            };
            let (a, b) = (size(0), size(1));
            let gradient = std::array::from_fn(|k| a.gradient[k] - b.gradient[k]);
            Dual { value: a.value - b.value, gradient }
        };
        let none = Dual { value: 0.0, gradient: [0.0; 3] };
        self.evaluate(
            (asks, none),
            |one, own| one.duals(own),
            |tape, at, out| tape.gradient_at(at, out),
            join,
        )
    }

    fn evaluate<T: Copy>(
        &mut self,
        (asks, none): (&[(u32, [f64; 3])], T),
        of_primitives: impl Fn(&mut PrimitiveEvaluator<'a>, &[(u32, [f64; 3])]) -> Result<Vec<T>, LeafError>,
        of_tape: impl Fn(&Tape, &[[f64; 3]], &mut [T]) -> Result<(), LeafError>,
        join: impl Fn(&PartPair<'a>, [T; 2]) -> T,
    ) -> Result<Vec<T>, LeafError> {
        let (own, pairs) = self.divide(asks);
        let mut all = vec![none; asks.len()];
        let found = of_primitives(&mut self.evaluator, &own.iter().map(|at| asks[*at]).collect::<Vec<_>>())?;
        own.into_iter().zip(found).for_each(|(at, value)| all[at] = value);
        for (number, rows) in pairs {
            let pair = &self.pairs.pairs[(number - self.pairs.n_primitives) as usize];
            let points: Vec<[f64; 3]> = rows.iter().map(|at| asks[*at].1).collect();
            let mut both = [vec![none; rows.len()], vec![none; rows.len()]];
            for (part, out) in pair.parts.iter().zip(&mut both) {
                of_tape(&part.tape, &points, out)?;
            }
            rows.into_iter().enumerate().for_each(|(k, at)| all[at] = join(pair, [both[0][k], both[1][k]]));
        }
        Ok(all)
    }

    /// The rows of primitives, and those of each pair.
    fn divide<T>(&self, asks: &[(u32, T)]) -> (Vec<usize>, BTreeMap<u32, Vec<usize>>) {
        let (mut own, mut pairs) = (Vec::new(), BTreeMap::<u32, Vec<usize>>::new());
        for (at, (number, _)) in asks.iter().enumerate() {
            if *number < self.pairs.n_primitives {
                own.push(at);
            } else {
                pairs.entry(*number).or_default().push(at);
            }
        }
        (own, pairs)
    }
}
