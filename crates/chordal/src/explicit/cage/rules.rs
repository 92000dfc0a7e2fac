//! Sharpness: which rule a vertex follows, and what is left of it after a round.
//!
//! Source: T. DeRose, M. Kass, T. Truong, *Subdivision surfaces in character animation*, 1998; where that leaves a choice (several
//! sharpnesses that end in one round, Chaikin's rule) it is that of OpenSubdiv's `sdc/crease.cpp`.
use super::{Creasing, INFINITELY_SHARP};

/// By what a vertex is shaped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    /// All around it. The end of a crease is as well.
    Smooth,
    /// The two neighbours along its crease, by their edges.
    Crease([u32; 2]),
    /// Nothing.
    Corner,
}

/// The rule of a vertex of that sharpness with these sharp edges.
pub(super) fn rule(sharpness: f64, sharp_edges: impl Iterator<Item = u32>) -> Rule {
    if sharpness > 0.0 {
        return Rule::Corner;
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
        0 | 1 => Rule::Smooth,
        2 => Rule::Crease(two),
        _ => Rule::Corner,
    }
}

/// What is left of a sharpness after a round, by itself.
pub(super) fn less(sharpness: f64) -> f64 {
    if sharpness >= INFINITELY_SHARP {
        sharpness
    } else if sharpness > 1.0 {
        sharpness - 1.0
    } else {
        0.0
    }
}

/// What is left of the sharpness of an edge at one of its ends, around which there are edges that are this sharp, with it.
pub(super) fn less_at(creasing: Creasing, sharpness: f64, around: impl Iterator<Item = f64>) -> f64 {
    if creasing == Creasing::Uniform || sharpness <= 0.0 || sharpness >= INFINITELY_SHARP {
        return less(sharpness);
    }
    let (mut sum, mut count) = (0.0, 0);
    for other in around.filter(|other| *other > 0.0 && *other < INFINITELY_SHARP) {
        sum += other;
        count += 1;
    }
    if count < 2 {
        return less(sharpness);
    }
    let left = 0.75 * sharpness + 0.25 * ((sum - sharpness) / f64::from(count - 1)) - 1.0;
    if left > 0.0 { left } else { 0.0 }
}

/// The share of the rule that ends, where a vertex goes from one to another: the mean of what ends, at most 1.
pub(super) fn ending(of: impl Iterator<Item = (f64, f64)>) -> f64 {
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
