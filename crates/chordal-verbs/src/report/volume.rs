//! Volumes in the report; only from `inspect`.
use crate::input::volume::{ValueRange, VolumeShape, type_name};
use chordal::convert::Inside;
use chordal::implicit::Affine3;
use serde::Serialize;

/// The description of a volume.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VolumeFacts {
    /// Its name in the file, or empty.
    pub name: String,
    /// Samples along each index, the first of which runs fastest.
    pub size: [u64; 3],
    /// The type of a sample, as in "u8" or "f32".
    pub samples: &'static str,
    /// The names of the axes of space, as in "RAS"; `None` if the file has none.
    pub space: Option<String>,
    /// The patient side to which each index runs, as in "LAS"; `None` if the file does not state it.
    pub axes: Option<String>,
    /// The position of the first sample.
    pub origin: [f64; 3],
    /// The displacement when one index grows by 1, by index.
    pub steps: [[f64; 3]; 3],
    /// The lengths of those steps.
    pub spacing: [f64; 3],
    /// Whether the indices run left-handed.
    pub mirrored: bool,
    /// Whether the steps are not at right angles.
    pub sheared: bool,
    /// The lowest finite sample; `None` if there is none.
    pub low: Option<f64>,
    /// The highest finite sample; `None` if there is none.
    pub high: Option<f64>,
    /// Samples that are NaN.
    pub nan: u64,
    /// Samples that are infinite.
    pub infinite: u64,
    /// The number of distinct values, if all samples are whole numbers and there are at most 65,536 values.
    pub labels: Option<u64>,
    /// The values with the most samples, at most [`MOST_LABELS`], in their order.
    pub label_list: Vec<LabelFacts>,
    /// A suggested level; `None` if all samples are equal.
    pub suggested: Option<SuggestedLevelFacts>,
}

/// The most values that are listed. Chosen: a report stays readable.
pub const MOST_LABELS: usize = 64;

/// One value of the samples.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct LabelFacts {
    /// The value.
    pub label: i64,
    /// The number of its samples.
    pub samples: u64,
    /// The name in the file; absent if there is none.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub name: String,
}

/// A suggested level.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SuggestedLevelFacts {
    /// The level.
    pub level: f64,
    /// "high" if samples above the level are inside, "low" if samples below it are.
    pub inside: &'static str,
    /// The interpretation of the samples: "mask", "occupancy", "signed distance" or "intensity".
    pub kind: &'static str,
    /// Whether `mesh` uses it by default; otherwise it is a guess.
    pub follows: bool,
}

impl VolumeFacts {
    /// Describes a volume, in two passes over its samples.
    #[must_use]
    pub fn new(sampled: &VolumeShape) -> Self {
        let volume = &sampled.volume;
        let (samples, affine) = (volume.grid.samples(), volume.grid.affine());
        let range = ValueRange::from_samples(samples);
        let steps = affine.steps();
        let mut label_list: Vec<LabelFacts> = range
            .labels
            .iter()
            .flatten()
            .map(|(label, samples)| LabelFacts {
                label: *label,
                samples: *samples,
                name: volume.labels.get(label).map_or_else(String::new, |look| look.name.clone()),
            })
            .collect();
        // The most frequent ones are kept, and then listed by their numbers.
        label_list.sort_by_key(|facts| (std::cmp::Reverse(facts.samples), facts.label));
        label_list.truncate(MOST_LABELS);
        label_list.sort_by_key(|facts| facts.label);
        Self {
            name: volume.name.clone(),
            size: volume.grid.size().map(|n| n as u64),
            samples: type_name(samples),
            space: volume.space.clone(),
            axes: volume.space.as_deref().and_then(|space| axes(affine, space)),
            origin: affine.at([0.0; 3]),
            steps,
            spacing: steps.map(length),
            mirrored: affine.orientation() < 0,
            sheared: is_sheared(steps),
            low: range.ends.map(|ends| ends[0]),
            high: range.ends.map(|ends| ends[1]),
            nan: range.nan,
            infinite: range.infinite,
            labels: range.labels.as_ref().map(|labels| labels.len() as u64),
            label_list,
            suggested: range.suggest(volume).map(|suggestion| SuggestedLevelFacts {
                level: suggestion.level,
                inside: if suggestion.inside == Inside::Low { "low" } else { "high" },
                kind: suggestion.kind,
                follows: suggestion.follows(),
            }),
        }
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// Whether steps are not at right angles, beyond the rounding of single precision.
fn is_sheared([a, b, c]: [[f64; 3]; 3]) -> bool {
    // Cosines of angles below this are rounding: 2⁻²⁰, eight steps of single precision.
    const ROUNDING: f64 = 1.0 / 1_048_576.0;
    [(a, b), (b, c), (c, a)].into_iter().any(|(p, q)| dot(p, q).abs() > ROUNDING * length(p) * length(q))
}

/// The side to which each index mostly runs: each side once, the clearest index first.
fn axes(affine: &Affine3, space: &str) -> Option<String> {
    let letters: [char; 3] = space.chars().collect::<Vec<_>>().try_into().ok()?;
    let steps = affine.steps();
    let mut sides = [None; 3];
    // The largest part of all is settled first: each index gets the axis that it is nearest to, and no axis twice.
    let mut used = [false; 3];
    for _ in 0..3 {
        let mut best = (-1.0, 0, 0);
        for index in (0..3).filter(|index| sides[*index].is_none()) {
            let size = length(steps[index]);
            for axis in (0..3).filter(|axis| !used[*axis]) {
                let part = (steps[index][axis] / size).abs();
                if part > best.0 {
                    best = (part, index, axis);
                }
            }
        }
        let (_, index, axis) = best;
        used[axis] = true;
        let letter = letters[axis];
        sides[index] = if steps[index][axis] < 0.0 { opposite_direction(letter) } else { Some(letter) };
    }
    sides.into_iter().collect()
}

fn opposite_direction(letter: char) -> Option<char> {
    let pairs = [('R', 'L'), ('A', 'P'), ('S', 'I')];
    pairs.iter().find_map(|(a, b)| match letter {
        _ if letter == *a => Some(*b),
        _ if letter == *b => Some(*a),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_are_named_after_the_side_that_they_run_to() {
        let affine = |rows| Affine3::new(rows).unwrap();
        let plain = affine([[-3.0, 0.0, 0.0, 78.0], [0.0, 3.0, 0.0, -112.0], [0.0, 0.0, 3.0, -50.0]]);
        assert_eq!(axes(&plain, "RAS").as_deref(), Some("LAS"));
        assert_eq!(axes(&plain, "LPS").as_deref(), Some("RPS"));
        let turned = affine([[0.1, 0.2, 1.0, 0.0], [2.0, 0.3, 0.0, 0.0], [0.0, -1.0, 0.4, 0.0]]);
        assert_eq!(axes(&turned, "RAS").as_deref(), Some("AIR"));
        assert_eq!(axes(&turned, "scanner-xyz"), None);
        assert!(is_sheared(turned.steps()) && !is_sheared(plain.steps()));
    }
}
