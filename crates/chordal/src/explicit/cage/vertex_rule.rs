//! Sharpness: the rule of a vertex, and the sharpness after a round.
//!
//! Source: T. DeRose, M. Kass, T. Truong, *Subdivision surfaces in character animation*, 1998; where it
//! leaves a choice (several sharpnesses that end in one round, Chaikin's rule) the choice is that of
//! OpenSubdiv's `sdc/crease.cpp`.
use super::{CreasingMethod, INFINITELY_SHARP};
use crate::math::{greater, lesser};

pub(super) type CagePoint = [f64; 3];

/// The subdivision rule of a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum VertexRule {
    /// The smooth rule, from all neighbours. The end of a crease follows it as well.
    Smooth,
    /// The crease rule, from the two neighbours along the crease, given by their edges.
    Crease([u32; 2]),
    /// The corner rule: the vertex is fixed.
    Corner,
}

/// The rule of a vertex with this sharpness and these sharp edges.
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
    // A single sharp edge ends here, as a dart: smooth by definition of the scheme.
    match count {
        0 | 1 => VertexRule::Smooth,
        2 => VertexRule::Crease(two),
        _ => VertexRule::Corner,
    }
}

/// The sharpness after a round, without the influence of other edges.
pub(super) fn decrement_sharpness(sharpness: f64) -> f64 {
    if sharpness >= INFINITELY_SHARP {
        sharpness
    } else if sharpness > 1.0 {
        sharpness - 1.0
    } else {
        0.0
    }
}

/// The sharpness of an edge at one of its ends after a round. `around` is the sharpness of all edges at that
/// end, including the edge itself.
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
    // Chaikin's rule: three quarters of the edge's own sharpness and a quarter of the mean of the
    // others; the sum contains the edge itself.
    let remaining = 0.75 * sharpness + 0.25 * ((sum - sharpness) / f64::from(count - 1)) - 1.0;
    greater(remaining, 0.0)
}

/// The weight of the first rule if a vertex changes from one rule to another: the mean of the sharpnesses
/// that end, at most 1.
fn fractional_weight(sharpness: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for (before, after) in sharpness {
        if before > 0.0 && after <= 0.0 {
            sum += before;
            count += 1;
        }
    }
    let share = if count == 0 { 0.0 } else { sum / f64::from(count) };
    lesser(share, 1.0)
}

/// The rule of a vertex in a round: a mix of the rule before it and the rule after it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct RuleBlend {
    pub share: f64,
    pub rules: [VertexRule; 2],
}

impl RuleBlend {
    /// For a vertex with this sharpness, and edges with theirs.
    pub fn new(
        creasing: CreasingMethod,
        sharpness: f64,
        edges: impl Iterator<Item = (u32, f64)> + Clone,
    ) -> Self {
        let remaining =
            |sharp: f64| subdivide_sharpness(creasing, sharp, edges.clone().map(|(_, sharp)| sharp));
        let before = rule(sharpness, edges.clone().filter_map(|(edge, sharp)| (sharp > 0.0).then_some(edge)));
        if before == VertexRule::Smooth {
            return Self { share: 1.0, rules: [before; 2] };
        }
        let remains = |(edge, sharp): (u32, f64)| (remaining(sharp) > 0.0).then_some(edge);
        let after = rule(decrement_sharpness(sharpness), edges.clone().filter_map(remains));
        // The same rule before and after this round leaves nothing to blend.
        if after == before {
            return Self { share: 1.0, rules: [before; 2] };
        }
        let ends = edges
            .clone()
            .map(|(_, sharp)| (sharp, remaining(sharp)))
            .chain([(sharpness, decrement_sharpness(sharpness))]);
        Self { share: fractional_weight(ends), rules: [before, after] }
    }
}

/// A vertex with its neighbourhood.
pub(super) trait SubdivisionVertex {
    /// Its position.
    fn position(&self) -> CagePoint;
    /// Its own sharpness.
    fn sharpness(&self) -> f64;
    /// The indices of its edges, with their sharpness.
    fn edges(&self) -> impl Iterator<Item = (u32, f64)> + Clone;
    /// The position of the other end of one of these edges.
    fn other_end(&self, edge: u32) -> CagePoint;
    /// Its position by the smooth rule.
    fn smooth(&self) -> CagePoint;
    /// The rule by which sharpness decreases.
    fn creasing(&self) -> CreasingMethod;

    /// The sharpness of the half of an edge at this vertex after a round.
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

    /// Its position after a round.
    fn vertex_point(&self) -> CagePoint {
        let RuleBlend { share, rules: [before, after] } =
            RuleBlend::new(self.creasing(), self.sharpness(), self.edges());
        if after == before {
            return self.by_rule(before);
        }
        blend(share, self.by_rule(before), self.by_rule(after))
    }
}

/// The weight of the midpoint in the new point of an edge with this sharpness; `halves` is the sharpness of
/// its halves after the round.
pub(super) fn crease_weight(sharpness: f64, halves: [f64; 2]) -> f64 {
    if sharpness >= 1.0 || sharpness > 0.0 && halves.iter().all(|half| *half > 0.0) { 1.0 } else { sharpness }
}

/// The new point of an edge between `a` and `b` with this sharpness; `halves` is the sharpness of its halves
/// after the round.
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

/// The weighted mean: `share` of the first point, and the remainder of the second.
fn blend(share: f64, first: CagePoint, second: CagePoint) -> CagePoint {
    [0, 1, 2].map(|k| share * first[k] + (1.0 - share) * second[k])
}
