//! The referee sees what it is there for: bounds that are cut are caught.
use super::families::{KINDS, pair};
use super::sampler::farthest;
use super::{measured, triangles_of};
use chordal::check::Goal;
use chordal_testkit::Random;

#[test]
fn bounds_cut_by_a_fifth_are_caught() {
    let (mut caught, mut all) = (0, 0);
    for kind in (0..KINDS.len()).filter(|kind| !matches!(KINDS[*kind], "far away" | "tiny" | "huge")) {
        for seed in 0..4 {
            let mut random = Random::new((77_000 + 100 * kind + seed) as u64);
            let [a, b] = pair(kind, &mut random);
            let most = measured(&a, &b, &Goal::default()).bound.at_most().unwrap();
            if most < 1e-12 {
                continue;
            }
            let [a, b] = [triangles_of(&a), triangles_of(&b)];
            all += 1;
            caught +=
                usize::from(farthest(&a, &b, &mut random).max(farthest(&b, &a, &mut random)) > 0.8 * most);
        }
    }
    assert!(10 * caught > 9 * all, "{caught} of {all}");
}
