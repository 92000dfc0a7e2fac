//! Solids of revolution: a profile with a side on the axis costs ranges no more than one beside it.
use chordal::implicit::Field;
use chordal::implicit::evaluation::Tape;
use chordal::implicit::shapes::{capped_cone, polygon, rectangle, rounded_rectangle};
use chordal::math::{Box3, Interval};

/// Levels of the octree.
const LEVELS: u32 = 7;

fn cube_around(bounds: &Box3) -> Box3 {
    let c = bounds.centre();
    // Odd, so that no cut is where something else is.
    let half = 0.5
        * (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, |a, b| if b > a { b } else { a })
        * 1.037;
    Box3 { min: c.map(|x| x - half * 1.01), max: c.map(|x| x + half) }
}

/// How many boxes of the last level may hold the surface, and how many of them the axis.
fn undecided(field: &Field) -> [usize; 2] {
    let tape = Tape::new(field.sign());
    let mut boxes = vec![cube_around(&field.bounds())];
    for _ in 0..LEVELS {
        boxes = boxes.iter().flat_map(eighths).collect();
        let mut ranges = vec![Interval::UNKNOWN; boxes.len()];
        tape.over(&boxes, &mut ranges).expect("no leaf fails");
        let open = |range: &Interval| !(range.is_defined() && (range.lo() > 0.0 || range.hi() < 0.0));
        boxes = boxes.iter().zip(&ranges).filter(|(_, range)| open(range)).map(|(b, _)| *b).collect();
    }
    let on_axis = |b: &&Box3| (0..2).all(|k| b.min[k] <= 0.0 && b.max[k] >= 0.0);
    [boxes.len(), boxes.iter().filter(on_axis).count()]
}

fn eighths(bounds: &Box3) -> impl Iterator<Item = Box3> + use<> {
    let (bounds, c) = (*bounds, bounds.centre());
    (0..8_usize).map(move |n| {
        let upper = [0, 1, 2].map(|k| n >> k & 1 == 1);
        Box3 {
            min: std::array::from_fn(|k| if upper[k] { c[k] } else { bounds.min[k] }),
            max: std::array::from_fn(|k| if upper[k] { bounds.max[k] } else { c[k] }),
        }
    })
}

/// A vase: outside, lip, and the inside down to the axis.
const VASE: [[f64; 2]; 8] =
    [[0.0, 0.0], [0.75, 0.0], [1.0, 1.0], [0.5, 2.0], [0.75, 2.5], [0.625, 2.5], [0.375, 2.0], [0.0, 0.25]];
const SPINDLE: [[f64; 2]; 4] = [[0.0, -1.0], [1.0, -0.5], [1.0, 0.5], [0.0, 1.0]];

fn profiles() -> Vec<(&'static str, Field)> {
    let moved = |shape: Field| shape.moved([1.0, 0.0, 0.0]).expect("a shape");
    let bar = moved(rectangle([2.0, 1.0]).expect("a shape"));
    let spindle = polygon(&SPINDLE).expect("a shape");
    vec![
        ("vase", polygon(&VASE).expect("a shape")),
        ("spindle", spindle.clone()),
        ("bar", bar.clone()),
        ("both", spindle.union(&bar)),
        ("less", spindle.difference(&rounded_rectangle([0.5, 0.25], 0.05).expect("a shape"))),
        ("scaled", spindle.scaled([0.5, 0.5, 1.0]).expect("a shape")),
    ]
}

#[test]
fn a_profile_on_the_axis_is_as_cheap_as_one_beside_it() {
    for (name, profile) in profiles() {
        let [on, along] = undecided(&profile.revolved());
        let [beside, _] = undecided(&profile.moved([1.0, 0.0, 0.0]).expect("a shape").revolved());
        // Both have about as much surface as their cubes.
        assert!(on < 2 * beside, "{name}: {on} boxes on the axis, {beside} beside it");
        // The surface goes through the axis in two places, or four, with some three boxes each; the axis has
        // 128 of them.
        assert!(along <= 16, "{name}: {along} boxes along the axis");
    }
}

#[test]
fn the_axis_is_inside_of_what_is_around_it() {
    for (name, profile) in profiles() {
        let solid = profile.revolved();
        let at = |p| solid.sign().at(p).expect("a value");
        let (x, z) = if name == "less" { (0.0, 0.6) } else { (0.0, 0.125) };
        let scale = if name == "scaled" { 0.5 } else { 1.0 };
        assert!(at([x, 0.0, z * scale]) < 0.0, "{name}");
        assert!(at([1e-12, 0.0, z * scale]) < 0.0, "{name}");
        assert!(at([0.0, 0.0, 9.0]) > 0.0, "{name}");
    }
    // A wall of a profile stands on the axis too, where one was asked for.
    let tube = polygon(&SPINDLE).expect("a shape").shell(0.25).expect("a shape").revolved();
    assert!(tube.sign().at([0.0; 3]).expect("a value") < 0.0);
    assert!(tube.sign().at([0.5, 0.0, 0.0]).expect("a value") > 0.0);
    let cored = polygon(&SPINDLE).expect("a shape").offset(-0.125).expect("a shape").revolved();
    assert!(cored.sign().at([0.0; 3]).expect("a value") > 0.0);
}

#[test]
fn tips_of_cones_have_a_direction_for_ranges() {
    for (bottom, top) in [(1.0, 0.0), (0.0, 1.0), (1.0, 0.5)] {
        let cone = capped_cone(bottom, top, 2.0).expect("a shape");
        let tape = Tape::new(cone.sign());
        let end = if top < bottom { 1.0 } else { -1.0 };
        let radius = if end > 0.0 { top } else { bottom };
        let room = 1.0 / 64.0;
        let at = [radius, 0.0, end];
        let tip = Box3 { min: at.map(|x| x - room), max: at.map(|x| x + room) };
        let mut slope = [chordal::implicit::evaluation::Dual {
            value: Interval::UNKNOWN,
            gradient: [Interval::UNKNOWN; 3],
        }];
        tape.gradient_over(&[tip], &mut slope).expect("no leaf fails");
        let along = slope[0].gradient[2];
        assert!(along.is_defined(), "{bottom} {top}");
        assert!(if end > 0.0 { along.lo() > 0.0 } else { along.hi() < 0.0 }, "{bottom} {top}: {along:?}");
        // The sign is that of the exact distance.
        for k in 0..1000_u32 {
            let p = [k % 10, k / 10 % 10, k / 100].map(|i| -1.4 + 0.31 * f64::from(i));
            let [value, sign] = [cone.expr(), cone.sign()].map(|expr| expr.at(p).expect("a value"));
            assert_eq!(value < 0.0, sign < 0.0, "{p:?}: {value} {sign}");
        }
    }
}
