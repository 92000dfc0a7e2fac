//! Attributes that deform a mesh: the joint weights of its vertices, and their displacements by morph
//! targets.
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use std::cmp::Reverse;

/// The joints of one set; defined by glTF.
pub(super) const IN_A_SET: usize = 4;

/// The morph targets of a mesh to be written: for each its attributes with their names in glTF.
pub(crate) fn targets_of(mesh: &Mesh) -> Vec<Vec<(&str, &Attribute)>> {
    let mut targets: Vec<Vec<(&str, &Attribute)>> = Vec::new();
    for attribute in mesh.attributes().iter().filter(|attribute| attribute.domain == Domain::Vertex) {
        let Semantic::Blended(name) = &attribute.semantic else { continue };
        let parsed = name.strip_prefix("morph target ").and_then(|rest| rest.split_once(' '));
        if let Some((Ok(target), name)) = parsed.map(|(target, name)| (target.parse::<usize>(), name)) {
            targets.resize_with(targets.len().max(target + 1), Vec::new);
            targets[target].push((name, attribute));
        }
    }
    targets
}

/// The joint weights of a mesh: for each attribute its first joint, and the number of joints per vertex.
pub(crate) fn weights_of(mesh: &Mesh) -> Vec<(usize, usize, &Attribute)> {
    let parse = |attribute: &'_ Attribute| {
        let Semantic::Blended(name) = &attribute.semantic else { return None };
        let (joints, influences) = name.strip_prefix("weights of joints ")?.split_once(", ")?;
        let first = joints.split_once(" to ")?.0.parse().ok()?;
        Some((first, influences.strip_suffix(" a vertex")?.parse().ok()?))
    };
    let vertices = mesh.attributes().iter().filter(|attribute| attribute.domain == Domain::Vertex);
    vertices.filter_map(|attribute| parse(attribute).map(|(first, n)| (first, n, attribute))).collect()
}

/// Whether a mesh has joint weights or morph targets.
pub(crate) fn is_deformed(mesh: &Mesh) -> bool {
    mesh.attributes().iter().any(|attribute| matches!(attribute.semantic, Semantic::Blended(_)))
}

/// Whether a mesh has joint weights.
pub(super) fn has_skin(mesh: &Mesh) -> bool {
    !weights_of(mesh).is_empty()
}

/// A set of four joints per vertex with their weights, as glTF stores it.
pub(super) struct SkinSet {
    pub joints: Vec<u16>,
    pub weights: Vec<f32>,
}

/// The joints of a mesh to be written: as many per vertex as in the source file, the heaviest first, with
/// weights that sum to 1.
pub(super) fn skin_sets(mesh: &Mesh) -> Vec<SkinSet> {
    let attributes = weights_of(mesh);
    let Some(n_influences) = attributes.iter().map(|(_, n, _)| *n).max() else { return Vec::new() };
    let n_sets = n_influences.div_ceil(IN_A_SET).max(1);
    let n = mesh.positions().len() * IN_A_SET;
    let mut sets: Vec<SkinSet> = (0..n_sets)
        .map(|_| SkinSet { joints: Vec::with_capacity(n), weights: Vec::with_capacity(n) })
        .collect();
    for vertex in 0..mesh.positions().len() {
        let mut influences: Vec<(u16, f64)> = Vec::new();
        for (first, _, attribute) in &attributes {
            let row = attribute.row(vertex).iter().enumerate().filter(|(_, weight)| **weight > 0.0);
            influences.extend(row.map(|(k, weight)| ((first + k) as u16, *weight)));
        }
        // Weights are positive, so the order of their bits is the order of their values.
        influences.sort_by_key(|(joint, weight)| (Reverse(weight.to_bits()), *joint));
        influences.truncate(n_sets * IN_A_SET);
        let sum: f64 = influences.iter().map(|(_, weight)| weight).sum();
        // A vertex without joints gets the first joint.
        let influences = if sum > 0.0 && sum.is_finite() { influences } else { vec![(0, 1.0)] };
        let sum = if sum > 0.0 && sum.is_finite() { sum } else { 1.0 };
        let mut stored: Vec<f32> = influences.iter().map(|(_, weight)| (weight / sum) as f32).collect();
        // Each weight was rounded for itself, so their sum is not 1. The heaviest joint takes the
        // difference: it is the smallest there in proportion.
        let rest: f64 = stored[1..].iter().map(|weight| f64::from(*weight)).sum();
        stored[0] = (1.0 - rest) as f32;
        for (s, set) in sets.iter_mut().enumerate() {
            let mut rows = influences.iter().zip(&stored).skip(s * IN_A_SET);
            for _ in 0..IN_A_SET {
                // A joint without weight is written as joint 0, as the validator demands.
                let row = rows.next().filter(|(_, weight)| **weight > 0.0);
                let (joint, weight) = row.map_or((0, 0.0), |((joint, _), weight)| (*joint, *weight));
                set.joints.push(joint);
                set.weights.push(weight);
            }
        }
    }
    sets
}

/// The weights of sets as integer shares of 65,535 with exactly this sum at each vertex, as glTF demands. The
/// remainder goes to the shares that rounding down reduced most. A joint whose weight becomes 0 is written as
/// joint 0.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub(super) fn short_weights(sets: &mut [SkinSet]) -> Vec<Vec<u16>> {
    let n = sets.first().map_or(0, |set| set.weights.len() / IN_A_SET);
    let mut integers: Vec<Vec<u16>> = sets.iter().map(|set| vec![0; set.weights.len()]).collect();
    for vertex in 0..n {
        let places = (0..sets.len()).flat_map(|s| (0..IN_A_SET).map(move |k| (s, IN_A_SET * vertex + k)));
        let mut shares: Vec<((usize, usize), f64)> =
            places.map(|(s, at)| ((s, at), f64::from(sets[s].weights[at]) * f64::from(u16::MAX))).collect();
        let floor = |share: f64| share.clamp(0.0, f64::from(u16::MAX)) as u16;
        shares.iter().for_each(|((s, at), share)| integers[*s][*at] = floor(*share));
        let sum: u32 = shares.iter().map(|(_, share)| u32::from(floor(*share))).sum();
        // The numbers are positive, so the order of their bits is total; the sort keeps equal ones in order.
        shares.sort_by_key(|(place, share)| (Reverse((share - share.floor()).to_bits()), *place));
        let remainder = u32::from(u16::MAX).saturating_sub(sum) as usize;
        for ((s, at), _) in shares.iter().cycle().take(remainder) {
            integers[*s][*at] += 1;
        }
        for (set, weights) in sets.iter_mut().zip(&integers) {
            let corners = IN_A_SET * vertex..IN_A_SET * (vertex + 1);
            for (joint, weight) in set.joints[corners.clone()].iter_mut().zip(&weights[corners]) {
                *joint = if *weight == 0 { 0 } else { *joint };
            }
        }
    }
    integers
}
