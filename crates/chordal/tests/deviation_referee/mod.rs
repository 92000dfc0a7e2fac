//! The referee of deviations: measures distances between meshes by plain loops, and shares no code with the
//! library. `CHORDAL_LONG=1` makes it measure ten times as many pairs.
mod closed;
mod families;
mod honesty;
mod same;
pub mod sampler;

use chordal::check::{Deviation, Goal, deviation};
use chordal::{Job, Mesh, budget::Evidence};
use chordal_testkit::Random;
use chordal_testkit::is_long;
use chordal_testkit::sampler::Triangles;
use families::{KINDS, pair};
use sampler::farthest;

pub fn triangles_of(mesh: &Mesh) -> Triangles {
    Triangles::new(mesh.positions(), mesh.faces())
}

fn measured(a: &Mesh, b: &Mesh, goal: &Goal) -> Deviation {
    deviation(a, b, goal, &Job::default()).expect("two surfaces")
}

/// Both meshes brought around zero with an extent near 1, so that the referee's own rounding stays small.
fn around_zero(meshes: [&Mesh; 2]) -> ([Triangles; 2], f64) {
    let all = || meshes.iter().flat_map(|mesh| mesh.positions());
    let origin = *all().next().expect("positions");
    let off = |p: &[f64; 3]| [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]];
    let size = all().flat_map(off).fold(0.0_f64, |most, x| most.max(x.abs()));
    // A power of two, so that nothing is rounded.
    let scale = if size > 0.0 { 2_f64.powi(-(size.log2().floor() as i32)) } else { 1.0 };
    let local = |mesh: &Mesh| {
        let positions: Vec<_> = mesh.positions().iter().map(|p| off(p).map(|x| x * scale)).collect();
        Triangles::new(&positions, mesh.faces())
    };
    (meshes.map(local), scale)
}

/// What the referee's arithmetic may be off by, on shapes of extent 1 to 4.
const SLACK: f64 = 1e-13;

fn check(name: &str, meshes: [&Mesh; 2], found: &Deviation, random: &mut Random) -> f64 {
    let ([a, b], scale) = around_zero(meshes);
    let (forward, backward) = (farthest(&a, &b, random), farthest(&b, &a, random));
    let [least, most] = [found.bound.at_least(), found.bound.at_most().expect("proved")].map(|x| x * scale);
    assert_eq!(*found.bound.evidence(), Evidence::Proved);
    let seen = forward.max(backward);
    assert!(seen <= most * (1.0 + SLACK) + SLACK, "{name}: a point is {seen:e} away, proved was {most:e}");
    assert!(forward <= found.forward.at_most * scale * (1.0 + SLACK) + SLACK, "{name}: forward {forward:e}");
    assert!(
        backward <= found.backward.at_most * scale * (1.0 + SLACK) + SLACK,
        "{name}: backward {backward:e}"
    );
    // The lower ends are attained where they say.
    let origin = meshes[0].positions()[0];
    let local = |p: [f64; 3]| std::array::from_fn(|k| (p[k] - origin[k]) * scale);
    for (side, [own, other]) in [(&found.forward, [&a, &b]), (&found.backward, [&b, &a])] {
        let from = local(side.from);
        // A point in the world is rounded to the world's digits.
        let digits = origin.iter().fold(1.0_f64, |most, x| most.max((x * scale).abs())) * 1e-15;
        assert!(own.distance(from) <= SLACK + 8.0 * digits, "{name}: the worst point is not on its surface");
        let attained = other.distance(from);
        assert!(
            attained >= side.at_least * scale - SLACK - 8.0 * digits,
            "{name}: {attained:e} at the worst point"
        );
    }
    assert!(found.reached, "{name}: [{least:e}, {most:e}] is not what was asked for");
    assert!(most <= 1.1 * least * (1.0 + SLACK) + 64.0 * f64::EPSILON, "{name}: [{least:e}, {most:e}]");
    if most > 0.0 { seen / most } else { 1.0 }
}

#[test]
fn no_point_is_farther_than_proved_and_the_ends_are_close() {
    let mut ratios = Vec::new();
    for (kind, of) in KINDS.iter().enumerate() {
        for seed in 0..if is_long() { 240 } else { 8 } {
            let mut random = Random::new((1000 * kind + seed) as u64);
            let [a, b] = pair(kind, &mut random);
            let name = format!("{of} {seed}");
            ratios.push(check(&name, [&a, &b], &measured(&a, &b, &Goal::default()), &mut random));
        }
    }
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    println!("{} pairs, median seen / proved {median:.4}", ratios.len());
    assert!(median > 0.9, "the bounds are loose, or the referee sees nothing");
}
