//! Fillets, chamfers, hulls, lofts, tapers and threads: what is inside, how fast values change, and that intervals
//! contain them.
use chordal::implicit::evaluation::{Dual, Tape};
use chordal::implicit::shapes::{
    ThreadForm, cuboid, cylinder, hull, planar_hull, polygon, rectangle, regular_polygon, sphere, thread,
};
use chordal::implicit::{Expr, Field, Seam};
use chordal::math::{Box3, Interval};
use chordal_testkit::{Random, cases};

fn at(field: &Field, p: [f64; 3]) -> f64 {
    field.expr().at(p).unwrap()
}

fn moved(field: Field, x: f64, y: f64, z: f64) -> Field {
    field.moved([x, y, z]).unwrap()
}

/// Parts with flush faces, turned faces and round faces.
fn seamed() -> Vec<Field> {
    let plate = cuboid([4.0, 3.0, 0.5]).unwrap();
    let wall = moved(cuboid([0.5, 3.0, 3.0]).unwrap(), -1.75, 0.0, 1.25);
    let turned = cuboid([1.0, 1.0, 3.0]).unwrap().rotated_deg([1.0, 2.0, 3.0], 40.0).unwrap();
    let pin = cylinder(0.6, 3.0).unwrap();
    let ball = moved(sphere(0.8).unwrap(), 0.5, 0.5, 0.3);
    let mut all = Vec::new();
    for seam in [Seam::Fillet(0.4), Seam::Chamfer(0.4)] {
        for other in [&wall, &turned, &pin, &ball] {
            all.push(plate.union_with(other, seam).unwrap());
            all.push(plate.difference_with(other, seam).unwrap());
            all.push(plate.intersection_with(other, seam).unwrap());
        }
        let two = plate.union_with(&wall, seam).unwrap().union_with(&turned, seam).unwrap();
        all.push(two.difference_with(&pin, seam).unwrap());
    }
    all
}

fn others() -> Vec<Field> {
    let star = polygon(&[[1.5, 0.0], [0.4, 0.5], [0.0, 1.5], [-1.0, 0.0], [0.0, -1.0]]).unwrap();
    let square = rectangle([2.0, 1.0]).unwrap();
    let round = chordal::implicit::shapes::circle(0.7).unwrap();
    let six = regular_polygon(6, 1.2).unwrap();
    let corners = [[0.0, 0.0, 0.0], [1.5, 0.0, 0.2], [0.0, 1.2, 0.0], [0.3, 0.2, 1.4], [1.0, 1.0, 1.0]];
    vec![
        Field::lofted(&[square.clone(), round.clone()], 2.0).unwrap(),
        Field::lofted(&[six.clone(), square.clone(), star.clone()], 1.0).unwrap(),
        six.tapered(0.4, 2.0).unwrap(),
        star.tapered(2.5, 1.0).unwrap(),
        cuboid([1.0; 3]).unwrap().tapered(0.5, 0.8).unwrap(),
        hull(&corners, 0.0).unwrap(),
        hull(&corners, 0.3).unwrap(),
        hull(&corners[..2], 0.5).unwrap(),
        hull(&corners[..3], 0.4).unwrap(),
        planar_hull(&[[0.0, 0.0], [1.0, 0.2], [0.5, 0.1], [0.3, 1.0], [0.4, 0.3]]).unwrap(),
    ]
}

#[test]
fn values_change_no_faster_than_one_moves_and_have_the_sign_of_their_second_expression() {
    let mut random = Random::new(41);
    for (k, field) in seamed().iter().chain(&others()).enumerate() {
        let mut inside = 0;
        let pairs: Vec<[[f64; 3]; 2]> = (0..3000)
            .map(|_| {
                let p: [f64; 3] = random.point_within(2.5);
                let step = random.power(1e-4, 1.0);
                let way: [f64; 3] = random.direction();
                [p, std::array::from_fn(|k| p[k] + step * way[k])]
            })
            .collect();
        let (mut values, mut signs) = (vec![0.0; 2 * pairs.len()], vec![0.0; 2 * pairs.len()]);
        field.tape().at(pairs.as_flattened(), &mut values).unwrap();
        Tape::new(field.sign()).at(pairs.as_flattened(), &mut signs).unwrap();
        for ((&[p, q], values), signs) in pairs.iter().zip(values.chunks(2)).zip(signs.chunks(2)) {
            let (a, b, sign) = (values[0], values[1], signs[0]);
            let length = (0..3).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum::<f64>().sqrt();
            assert!((a - b).abs() <= length * (1.0 + 1e-9) + 1e-12, "{k} {p:?} {q:?}: {a} {b}");
            assert!((a < 0.0) == (sign < 0.0) || a.abs() < 1e-12, "{k} {p:?}: {a} {sign}");
            if a < 0.0 {
                inside += 1;
                assert!(field.bounds().contains(p), "{k} {p:?} {:?}", field.bounds());
            }
        }
        assert!(inside > 0, "{k}: {inside}");
    }
}

#[test]
fn intervals_contain_values_and_slopes_those_of_differences() {
    let mut random = Random::new(42);
    // A thread turns about the axis, so that boxes on it and at its seam are among them.
    let threads =
        ["M1x0.25", "M4", "M4x1"].map(|name| thread(ThreadForm::from_name(name).unwrap(), 4.0).unwrap());
    for (k, field) in seamed().iter().chain(&others()).chain(&threads).enumerate() {
        for expr in [field.expr(), field.sign()] {
            let tape = Tape::new(expr);
            for _ in 0..cases(60) {
                let low: [f64; 3] = random.point_within(2.5);
                let size = random.power(1e-3, 1.0);
                let bounds = Box3 { min: low, max: low.map(|x| x + size) };
                let mut range = [Interval::UNKNOWN];
                tape.over(&[bounds], &mut range).unwrap();
                let mut slope = [Dual { value: Interval::UNKNOWN, gradient: [Interval::UNKNOWN; 3] }];
                tape.gradient_over(&[bounds], &mut slope).unwrap();
                let place: [f64; 3] = std::array::from_fn(|k| low[k] + size * random.unit());
                let axis = random.below(3);
                let mut end = place;
                end[axis] = low[axis] + size * random.unit();
                let values = [place, end].map(|p| expr.at(p).unwrap());
                for value in values {
                    assert!(range[0].contains(value), "{k} {bounds:?} {range:?} {value}");
                }
                let run = end[axis] - place[axis];
                let found = slope[0].gradient[axis];
                if run.abs() > 1e-5 && found.is_defined() {
                    // The mean of slopes along the way.
                    let mean = (values[1] - values[0]) / run;
                    assert!(
                        mean >= found.lo() - 1e-8 && mean <= found.hi() + 1e-8,
                        "{k} {bounds:?} {found:?} {mean}"
                    );
                }
            }
        }
    }
}

#[test]
fn a_fillet_is_a_quarter_of_a_circle_and_flush_faces_stay() {
    let (radius, mut random) = (0.5, Random::new(43));
    let plate = cuboid([4.0, 4.0, 2.0]).unwrap();
    let wall = moved(cuboid([2.0, 4.0, 6.0]).unwrap(), -1.0, 0.0, 2.0);
    let round = plate.union_with(&wall, Seam::Fillet(radius)).unwrap();
    let flat = plate.union_with(&wall, Seam::Chamfer(radius)).unwrap();
    for _ in 0..20_000 {
        let [x, y, z] = random.point_within(2.6);
        let in_both = x.abs() < 2.0 && y.abs() < 2.0 && z.abs() < 1.0
            || x > -2.0 && x < 0.0 && y.abs() < 2.0 && z > -1.0;
        // The corner is at x = 0 and z = 1, the circle around (r, 1 + r).
        let (u, v) = (x, z - 1.0);
        let in_corner = y.abs() < 2.0 && u >= 0.0 && v >= 0.0 && u < radius && v < radius;
        let off = ((radius - u) * (radius - u) + (radius - v) * (radius - v)).sqrt();
        for (field, filled) in [(&round, off > radius), (&flat, u + v < radius)] {
            let value = at(field, [x, y, z]);
            let truth = in_both || in_corner && filled;
            assert!((value < 0.0) == truth || value.abs() < 1e-9, "{x} {y} {z}: {value} {truth}");
        }
    }
    let hole = cuboid([4.0, 4.0, 2.0])
        .unwrap()
        .difference_with(&cylinder(1.0, 4.0).unwrap(), Seam::Fillet(radius))
        .unwrap();
    for _ in 0..20_000 {
        let [x, y, z] = random.point_within(2.6);
        let r = (x * x + y * y).sqrt();
        let (u, v) = (r - 1.0, 1.0 - z.abs());
        let off = ((radius - u) * (radius - u) + (radius - v) * (radius - v)).sqrt();
        let in_plate = x.abs() < 2.0 && y.abs() < 2.0 && u > 0.0 && v > 0.0;
        let truth = in_plate && !(u < radius && v < radius && off > radius);
        let value = at(&hole, [x, y, z]);
        assert!((value < 0.0) == truth || value.abs() < 1e-9, "{x} {y} {z}: {value} {truth}");
    }
}

#[test]
fn hulls_are_as_far_away_as_boxes_and_capsules_are() {
    let mut random = Random::new(44);
    let corners: Vec<[f64; 3]> = (0..8)
        .map(|k| std::array::from_fn(|j| (j as f64 + 1.0) * if k >> j & 1 == 1 { 1.0 } else { -1.0 }))
        .collect();
    let same = [
        (hull(&corners, 0.0).unwrap(), cuboid([2.0, 4.0, 6.0]).unwrap()),
        (
            hull(&corners, 0.5).unwrap(),
            chordal::implicit::shapes::rounded_cuboid([3.0, 5.0, 7.0], 0.5).unwrap(),
        ),
        (
            hull(&[[0.0; 3], [1.0, 1.0, 0.0], [2.0, 2.0, 0.0]], 0.5).unwrap(),
            chordal::implicit::shapes::capsule([0.0; 3], [2.0, 2.0, 0.0], 0.5).unwrap(),
        ),
    ];
    for (made, known) in &same {
        for _ in 0..2000 {
            let p: [f64; 3] = random.point_within(5.0);
            assert!((at(made, p) - at(known, p)).abs() < 1e-12, "{p:?}");
        }
    }
    // Four corners of one face.
    assert!(hull(&corners[..4], 0.0).is_err());
    assert!(planar_hull(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).is_err());
}

#[test]
fn threads_have_the_profile_of_their_standard() {
    let form = ThreadForm::from_name("M6").unwrap();
    assert_eq!((form.diameter, form.pitch), (6.0, 1.0));
    assert_eq!(ThreadForm::from_name("M10x1.25").unwrap().pitch, 1.25);
    assert!(ThreadForm::from_name("6").is_err() && ThreadForm::from_name("M6.5").is_err());
    let screw = thread(form, 8.0).unwrap();
    let mut random = Random::new(45);
    let triangle = 3.0_f64.sqrt() / 2.0;
    for _ in 0..20_000 {
        let p: [f64; 3] = random.point_within(4.2);
        let (r, turn) = ((p[0] * p[0] + p[1] * p[1]).sqrt(), p[1].atan2(p[0]) / std::f64::consts::TAU);
        // How far along z the next crest is.
        let off = p[2] - turn;
        let off = (off - off.round()).abs();
        let surface = (3.0 + triangle / 8.0 - 3.0_f64.sqrt() * off).clamp(3.0 - 0.625 * triangle, 3.0);
        let truth = r < surface && p[2].abs() < 4.0;
        let value = at(&screw, p);
        assert!((value < 0.0) == truth || value.abs() < 1e-9, "{p:?}: {value} {truth} {surface}");
    }
}

#[test]
fn tapers_and_lofts_have_the_sections_that_they_are_made_of() {
    let mut random = Random::new(46);
    let square = rectangle([2.0, 1.0]).unwrap();
    let six = regular_polygon(6, 1.2).unwrap();
    let taper = six.tapered(0.25, 2.0).unwrap();
    let loft = Field::lofted(&[square.clone(), six.clone()], 2.0).unwrap();
    let z0 = |p: [f64; 2]| [p[0], p[1], 0.0];
    for _ in 0..5000 {
        let [x, y, z] = random.point_within(1.5);
        let scale = 1.0 - 0.75 * (z + 1.0) / 2.0;
        let truth = z.abs() < 1.0 && at(&six, z0([x / scale, y / scale])) < 0.0;
        let value = at(&taper, [x, y, z]);
        assert!((value < 0.0) == truth || value.abs() < 1e-9, "{x} {y} {z}: {value} {truth}");
        for (end, profile) in [(-1.0, &square), (1.0, &six)] {
            let (section, value) = (at(profile, z0([x, y])), loft.section(end * (1.0 - 1e-12)).unwrap());
            let value = at(&value, [x, y, z]);
            assert!(
                (value < 0.0) == (section < 0.0) || section.abs() < 1e-9,
                "{x} {y} {end}: {value} {section}"
            );
        }
    }
    let [a, b] = [Expr::constant(0.2), Expr::constant(0.4)];
    // On the circle around (1, 1).
    assert!(
        Expr::constant(1.0 - 0.6).round_min(&Expr::constant(1.0 - 0.8), 1.0).at([0.0; 3]).unwrap().abs()
            < 1e-15
    );
    assert!(a.round_min(&b, 0.1).at([0.0; 3]).unwrap() - 0.2 == 0.0);
}
