//! Sharpness: which rule a vertex follows, and what is left of it after a round.
//!
//! Source: T. DeRose, M. Kass, T. Truong, *Subdivision surfaces in character animation*, 1998; where that
//! leaves a choice (several sharpnesses that end in one round, Chaikin's rule) it is that of OpenSubdiv's
//! `sdc/crease.cpp`.
use super::{CreasingMethod, INFINITELY_SHARP};

pub(super) type CagePoint = [f64; 3];

/// By what a vertex is shaped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VertexRule {
    /// All around it. The end of a crease is as well.
    Smooth,
    /// The two neighbours along its crease, by their edges.
    Crease([u32; 2]),
    /// Nothing.
    Corner,
}

/// The rule of a vertex of that sharpness with these sharp edges.
fn rule(sharpness: f64, sharp_edges: impl Iterator<Item = u32>) -> VertexRule {
    if sharpness > 0.0 {
        return VertexRule::Corner;
    }
    let mut two = [0; 2];
    let mut count = 0;
    for edge in sharp_edges {
        if count < 2 {
            two[count] = edge;
        }
        count += 1;
    }
    match count {
        0 | 1 => VertexRule::Smooth,
        2 => VertexRule::Crease(two),
        _ => VertexRule::Corner,
    }
}

/// What is left of a sharpness after a round, by itself.
pub(super) fn decrement_sharpness(sharpness: f64) -> f64 {
    if sharpness >= INFINITELY_SHARP {
        sharpness
    } else if sharpness > 1.0 {
        sharpness - 1.0
    } else {
        0.0
    }
}

/// What is left of the sharpness of an edge at one of its ends, around which there are edges that are this
/// sharp, with it.
pub(super) fn subdivide_sharpness(
    creasing: CreasingMethod,
    sharpness: f64,
    around: impl Iterator<Item = f64>,
) -> f64 {
    if creasing == CreasingMethod::Uniform || sharpness <= 0.0 || sharpness >= INFINITELY_SHARP {
        return decrement_sharpness(sharpness);
    }
    let (mut sum, mut count) = (0.0, 0);
    for other in around.filter(|other| *other > 0.0 && *other < INFINITELY_SHARP) {
        sum += other;
        count += 1;
    }
    if count < 2 {
        return decrement_sharpness(sharpness);
    }
    let left = 0.75 * sharpness + 0.25 * ((sum - sharpness) / f64::from(count - 1)) - 1.0;
    if left > 0.0 { left } else { 0.0 }
}

/// The share of the rule that ends, where a vertex goes from one to another: the mean of what ends, at
/// most 1.
fn fractional_weight(of: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for (before, after) in of {
        if before > 0.0 && after <= 0.0 {
            sum += before;
            count += 1;
        }
    }
    let share = if count == 0 { 0.0 } else { sum / f64::from(count) };
    if share < 1.0 { share } else { 1.0 }
}

/// What a vertex follows in a round: a share of the rule before it and the rest of the rule after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RuleBlend {
    pub share: f64,
    pub rules: [VertexRule; 2],
}

impl RuleBlend {
    /// Of a vertex of that sharpness, whose edges are this sharp.
    pub fn new(creasing: CreasingMethod, own: f64, edges: impl Iterator<Item = (u32, f64)> + Clone) -> Self {
        let left = |sharp: f64| subdivide_sharpness(creasing, sharp, edges.clone().map(|(_, sharp)| sharp));
        let before = rule(own, edges.clone().filter_map(|(edge, sharp)| (sharp > 0.0).then_some(edge)));
        if before == VertexRule::Smooth {
            return Self { share: 1.0, rules: [before; 2] };
        }
        let remains = |(edge, sharp): (u32, f64)| (left(sharp) > 0.0).then_some(edge);
        let after = rule(decrement_sharpness(own), edges.clone().filter_map(remains));
        if after == before {
            return Self { share: 1.0, rules: [before; 2] };
        }
        let ends =
            edges.clone().map(|(_, sharp)| (sharp, left(sharp))).chain([(own, decrement_sharpness(own))]);
        Self { share: fractional_weight(ends), rules: [before, after] }
    }
}

/// A vertex with what is around it.
pub(super) trait SubdivisionVertex {
    /// Where it is.
    fn position(&self) -> CagePoint;
    /// Its own sharpness.
    fn sharpness(&self) -> f64;
    /// Its edges by numbers, with their sharpness.
    fn edges(&self) -> impl Iterator<Item = (u32, f64)> + Clone;
    /// Where one of these edges leads.
    fn other_end(&self, edge: u32) -> CagePoint;
    /// By the smooth rule.
    fn smooth(&self) -> CagePoint;
    /// How sharpness falls.
    fn creasing(&self) -> CreasingMethod;

    /// What is left of an edge's sharpness on its half here.
    fn subdivided_sharpness(&self, sharpness: f64) -> f64 {
        subdivide_sharpness(self.creasing(), sharpness, self.edges().map(|(_, sharp)| sharp))
    }

    fn by_rule(&self, rule: VertexRule) -> CagePoint {
        match rule {
            VertexRule::Corner => self.position(),
            VertexRule::Crease(two) => {
                let start = self.position().map(|x| 0.75 * x);
                two.iter().fold(start, |sum, edge| plus(sum, 0.125, self.other_end(*edge)))
            }
            VertexRule::Smooth => self.smooth(),
        }
    }

    /// Where it is after a round.
    fn vertex_point(&self) -> CagePoint {
        let RuleBlend { share, rules: [before, after] } =
            RuleBlend::new(self.creasing(), self.sharpness(), self.edges());
        if after == before {
            return self.by_rule(before);
        }
        blend(share, self.by_rule(before), self.by_rule(after))
    }
}

/// The share of the middle in what comes to lie on an edge of that sharpness, whose halves keep some of it or
/// not.
pub(super) fn crease_weight(sharpness: f64, halves: [f64; 2]) -> f64 {
    if sharpness >= 1.0 || sharpness > 0.0 && halves.iter().all(|half| *half > 0.0) { 1.0 } else { sharpness }
}

/// The middle of an edge between `a` and `b` of that sharpness, whose halves keep some of it or not.
pub(super) fn edge_point(
    [a, b]: [CagePoint; 2],
    sharpness: f64,
    halves: [f64; 2],
    smooth: impl FnOnce() -> CagePoint,
) -> CagePoint {
    let middle = [0, 1, 2].map(|k| 0.5 * a[k] + 0.5 * b[k]);
    let share = crease_weight(sharpness, halves);
    if share >= 1.0 {
        return middle;
    }
    if share > 0.0 { blend(share, middle, smooth()) } else { smooth() }
}

pub(super) fn plus(sum: CagePoint, share: f64, p: CagePoint) -> CagePoint {
    [0, 1, 2].map(|k| sum[k] + share * p[k])
}

/// `share` of the first and the rest of the second.
fn blend(share: f64, first: CagePoint, second: CagePoint) -> CagePoint {
    [0, 1, 2].map(|k| share * first[k] + (1.0 - share) * second[k])
}
