//! Random trees of shapes obey the laws too.
use super::law::obey;
use chordal::implicit::shapes::{
    InvalidShape, capped_cone, capsule, cuboid, cylinder, ellipsoid, sphere, torus,
};
use chordal::implicit::{DistanceQuality, Field};
use chordal_testkit::Random;

fn leaf(random: &mut Random) -> Result<Field, InvalidShape> {
    let size = 0.4 + 0.8 * random.unit();
    match random.bits() % 7 {
        0 => sphere(size),
        1 => cuboid([size, 1.0, 0.6]),
        2 => cylinder(0.5 * size, 1.0),
        3 => torus(size, 0.2),
        4 => capped_cone(size, 0.2, 1.0),
        5 => capsule([0.0; 3], random.point_within(1.0), 0.4 * size),
        _ => ellipsoid([size, 0.5, 0.8]),
    }
}

fn tree(random: &mut Random, depth: u32) -> Result<Field, InvalidShape> {
    if depth == 0 {
        return leaf(random)?
            .rotated_deg([1.0, 0.5, 0.2], 360.0 * random.unit())?
            .moved(random.point_within(0.8));
    }
    let (a, b) = (tree(random, depth - 1)?, tree(random, depth - 1)?);
    Ok(match random.bits() % 8 {
        0 | 1 => a.union(&b),
        2 => a.intersection(&b),
        3 => a.difference(&b),
        4 => a.xor(&b),
        5 => a.smooth_union(&b, 0.2)?,
        6 if a.distance().inside >= DistanceQuality::Bound => a.smooth_difference(&b, 0.2)?,
        _ => a.offset(0.1)?.union(&b.scaled([0.7; 3])?),
    })
}

#[test]
fn random_trees() {
    for seed in 0..24 {
        let field = tree(&mut Random::new(seed), 1 + seed as u32 % 4).expect("every part is a bound");
        obey(&format!("tree {seed}"), &field);
    }
}
