//! Level curves of fields of the plane: closed, with inside on the left, and within a bound that an
//! independent count agrees with.
use chordal::budget::RefusalCode;
use chordal::convert::field_to_polyline;
use chordal::explicit::Polyline;
use chordal::implicit::evaluation::{Binary, Unary};
use chordal::implicit::{Expr, Field, shapes};
use chordal::math::Box3;
use chordal::{Budget, Failure, Job, Tolerance};
use chordal_testkit::is_long;

fn within(expr: Expr, size: f64) -> Field {
    Field::new(expr).with_bounds(Box3 { min: [-size; 3], max: [size; 3] })
}

fn area(lines: &[Polyline<2>]) -> f64 {
    0.5 * lines.iter().flat_map(Polyline::segments).map(|[a, b]| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
}

/// Dense points of the lines.
fn points(lines: &[Polyline<2>]) -> Vec<[f64; 2]> {
    let between = |[a, b]: [[f64; 2]; 2]| {
        (0..4).map(move |k| [0, 1].map(|i| a[i] + 0.25 * f64::from(k) * (b[i] - a[i])))
    };
    lines.iter().flat_map(Polyline::segments).flat_map(between).collect()
}

fn made(field: &Field, length: f64) -> (Vec<Polyline<2>>, f64) {
    let budget = Budget::length(Tolerance::new(length).unwrap());
    let made = field_to_polyline(field, &budget, &Job::default()).unwrap();
    // The box is this test's word.
    assert!(made.bound.evidence().bounds_above());
    let most = made.bound.at_most().unwrap();
    assert!(most <= length && made.bound.at_least() <= most, "{:?}", made.bound);
    assert!(made.shape.iter().all(|line| line.closed && line.points.len() > 2));
    (made.shape, most)
}

#[test]
fn a_circle_is_within_the_bound_by_its_closed_form() {
    let [x, y, _] = Expr::axes();
    let circle = within((x.square() + y.square()).sqrt() - 0.7, 0.8);
    for length in [0.1, 0.01, 1e-4] {
        let (lines, most) = made(&circle, length);
        assert_eq!(lines.len(), 1);
        let far = points(&lines).iter().map(|p| (p[0].hypot(p[1]) - 0.7).abs()).fold(0.0, f64::max);
        assert!(far <= most, "{far} {most}");
        let missing = std::f64::consts::PI * 0.49 - area(&lines);
        assert!(missing > 0.0 && missing < 4.5 * length, "{missing}");
    }
}

#[test]
fn corners_holes_and_cut_off_sides_are_met() {
    let [x, y, _] = Expr::axes();
    // A square with a round hole: distances in closed form.
    let square = x.abs().max(&y.abs()) - 0.75;
    let hole = Expr::constant(0.25) - (x.square() + y.square()).sqrt();
    let (lines, most) = made(&within(square.max(&hole), 1.0), 0.004);
    assert_eq!(lines.len(), 2);
    let to_square = |p: [f64; 2]| {
        let d = p.map(|x| x.abs() - 0.75);
        let out = d[0].max(0.0).hypot(d[1].max(0.0));
        (out + d[0].max(d[1]).min(0.0)).abs()
    };
    let far =
        points(&lines).iter().map(|p| to_square(*p).min((p[0].hypot(p[1]) - 0.25).abs())).fold(0.0, f64::max);
    assert!(far <= most, "{far} {most}");
    // From the corner, which no line reaches, to the lines.
    let corner =
        points(&lines).iter().map(|p| (p[0] - 0.75).hypot(p[1] - 0.75)).fold(f64::INFINITY, f64::min);
    assert!(corner <= most + 1e-3, "{corner} {most}");
    let whole = 2.25 - std::f64::consts::PI / 16.0;
    assert!((area(&lines) - whole).abs() < 0.05, "{}", area(&lines));
}

#[test]
fn parts_that_fall_between_points_are_found_by_the_proof() {
    let [x, y, _] = Expr::axes();
    let far = (x.square() + y.square()).sqrt() - 0.5;
    // A speck beside the disc, smaller than a square of the first lattice, and than any step of the proof.
    for radius in [0.004, 0.0005, 0.0001] {
        let speck = ((&x - 0.8).square() + (&y - 0.03).square()).sqrt() - radius;
        let (lines, _) = made(&within(far.min(&speck), 1.0), 0.01);
        assert_eq!(lines.len(), 2, "{radius}");
    }
}

#[test]
fn a_slit_that_no_lattice_meets_is_as_far_as_it_is_deep() {
    let [x, y, _] = Expr::axes();
    // A square of half a unit to each side, cut in two by a slit as thin as a millionth: its middle is 0.5
    // from its border. The root of the square is no line to anybody.
    let slit = Expr::constant(1e-6) - (&y - 0.1234).square().sqrt();
    let field = within(x.abs().max(&y.abs()).max(&(slit + 0.5)) - 0.5, 1.0);
    let budget = Budget::length(Tolerance::new(0.01).unwrap());
    let Err(Failure::Unmet(best)) = field_to_polyline(&field, &budget, &Job::default()) else {
        panic!("the slit was lost without a word");
    };
    // From the depth of the slit to the nearest border, along y.
    let most = best.bound.at_most().unwrap();
    assert!((0.376..0.4).contains(&most), "{most}");
}

/// The outline of a shape within a hundredth; what is claimed is rounding, where it has no arcs.
fn outline(field: &Field) -> Vec<Polyline<2>> {
    let (lines, most) = made(field, 0.01);
    let is_straight = lines.iter().all(|line| line.points.len() < 13);
    assert!(!is_straight || most < 1e-9, "{most}");
    lines
}

#[test]
fn shapes_with_straight_sides_have_a_segment_for_each() {
    let plate = shapes::rectangle([40.0, 20.0]).unwrap();
    let lines = outline(&plate);
    let mut corners = lines[0].points.clone();
    corners.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    assert_eq!(corners, [[-20.0, -10.0], [-20.0, 10.0], [20.0, -10.0], [20.0, 10.0]]);
    assert_eq!((lines.len(), area(&lines)), (1, 800.0));
    let moved = |field: &Field, x: f64, y: f64| field.moved([x, y, 0.0]).unwrap();
    let both = outline(&plate.union(&moved(&plate, 15.0, 7.0)));
    assert_eq!((both.len(), both[0].n_segments()), (1, 8));
    assert!((area(&both) - (1600.0 - 25.0 * 13.0)).abs() < 1e-9);
    // What meets along a side is one; what meets in a corner are two.
    let beside = outline(&plate.union(&moved(&plate, 40.0, 0.0)));
    assert_eq!((beside.len(), beside[0].n_segments()), (1, 4));
    let corner = outline(&plate.union(&moved(&plate, 40.0, 20.0)));
    assert_eq!(corner.iter().map(Polyline::n_segments).collect::<Vec<_>>(), [4, 4]);
    let apart = outline(&plate.difference(&shapes::rectangle([1e-6, 30.0]).unwrap()));
    assert_eq!(apart.iter().map(Polyline::n_segments).collect::<Vec<_>>(), [4, 4]);
    let hexagon = shapes::regular_polygon(6, 5.0).unwrap().rotated_deg([0.0, 0.0, 1.0], 11.0).unwrap();
    let holed = outline(&plate.difference(&hexagon));
    assert_eq!(holed.iter().map(Polyline::n_segments).sum::<usize>(), 10);
    assert!((area(&holed) - (800.0 - 1.5 * 3.0_f64.sqrt() * 25.0)).abs() < 1e-9);
}

#[test]
fn arcs_have_as_many_segments_as_their_sagitta_asks_for() {
    let plate = shapes::rectangle([40.0, 20.0]).unwrap();
    let disc = shapes::circle(5.0).unwrap();
    // Half of the angle of a chord is arccos(1 − 0.01/5).
    let whole = (std::f64::consts::PI / (1.0_f64 - 0.002).acos()).ceil() as usize;
    let holed = outline(&plate.difference(&disc));
    let mut counts: Vec<usize> = holed.iter().map(Polyline::n_segments).collect();
    counts.sort_unstable();
    assert_eq!(counts, [4, whole]);
    // A notch: half of the circle, and five sides.
    let notched = outline(&plate.difference(&disc.moved([0.0, 10.0, 0.0]).unwrap()));
    assert_eq!((notched.len(), notched[0].n_segments()), (1, 5 + whole.div_ceil(2)));
    // A slot, whose arcs touch its sides.
    let slot = shapes::rectangle([20.0, 10.0]).unwrap();
    let ends = [-10.0, 10.0].map(|x| disc.moved([x, 0.0, 0.0]).unwrap());
    let slot = outline(&slot.union(&ends[0]).union(&ends[1]));
    assert_eq!(slot.len(), 1);
    assert!(slot[0].n_segments() <= 4 + whole, "{}", slot[0].n_segments());
    let exact = 200.0 + 25.0 * std::f64::consts::PI;
    assert!(area(&slot) < exact && exact - area(&slot) < 0.01 * 10.0 * std::f64::consts::PI);
    let lens = outline(&ends[0].moved([6.0, 0.0, 0.0]).unwrap().intersection(&disc));
    assert_eq!(lens.len(), 1);
    let far = |p: &[f64; 2]| (p[0].hypot(p[1]) - 5.0).abs().min(((p[0] + 4.0).hypot(p[1]) - 5.0).abs());
    assert!(lens[0].points.iter().all(|p| far(p) < 1e-9));
}

/// What is claimed of the distance; nothing where the field is said to have no curve.
fn claimed(field: &Field, length: f64) -> Option<f64> {
    match field_to_polyline(field, &Budget::length(Tolerance::new(length).unwrap()), &Job::default()) {
        Ok(made) => made.bound.at_most(),
        Err(Failure::Unmet(best)) => best.bound.at_most(),
        Err(Failure::Refused(refusal)) => panic!("{refusal:?}"),
        Err(Failure::Cancelled) => panic!("nobody cancelled"),
    }
}

#[test]
fn a_part_that_is_inside_by_less_than_rounding_is_not_left_out() {
    // A minute: every lattice is tried before nothing is claimed.
    if !is_long() {
        return;
    }
    let [x, y, _] = Expr::axes();
    let (tiny, one) = (Expr::constant(5e-17), Expr::constant(1.0));
    // Both are constant, by a way that no graph folds: 1 − 5e-17 rounds to 1, and the smooth minimum is below
    // 5e-17 all the same.
    let a = x.min(&tiny).max(&tiny);
    let b = x.min(&Expr::constant(-50.0)).max(&one);
    let below = a.smooth_min(&b, 1.0) - &tiny;
    let square = below.max(&(x.abs() - 1.0)).max(&(y.abs() - 1.0));
    let disc = ((&x - 10.0).square() + y.square()).sqrt() - 1.0;
    let far = claimed(&within(square.min(&disc), 12.0), 0.01);
    // The square is 8 away from the disc.
    assert!(far.is_none_or(|far| far >= 8.0), "{far:?}");
}

#[test]
fn points_are_looked_for_where_the_tape_of_a_block_is_right() {
    let [x, y, _] = Expr::axes();
    let c = Expr::constant;
    let step = 2.0 / 64.0;
    let corner = |k: f64, n: f64| (-1.0 - step * k) + step * n;
    let (at_x, at_y) = (corner(1.618_034, 32.0), corner(1.381_966, 30.0));
    // Nowhere inside, but by rounding on a thin cross about a corner of the first lattice, which shortened
    // tapes beyond their block take for more.
    let two = x.min(&c(-50.0)).max(&c(2.0));
    let zero = c(2.0) - two.sqrt().square();
    let (u, v) = ((&x - at_x).abs(), (&y - at_y).abs());
    let out = (u.min(&v) - 1e-7).max(&(&u - 0.01)).max(&(&v - 0.03));
    let ridge = zero.max(&(out * 1e6).min(&c(1.0)));
    let side = |o: &Expr| {
        let t = &ridge * (c(1.0) - Expr::unary(Unary::Exp, &((o - 1e-3) * 1e5)));
        let b = (0..12).fold((o - 5e-4) * 1e6, |b, k| b + (o - (5e-4 + 1e-9 * f64::from(k))) * 1e5);
        t.max(&b)
    };
    let nothing = side(&(&x - at_x)).min(&side(&(c(at_x) - &x)));
    let (far_x, far_y) = (corner(1.618_034, 57.0), corner(1.381_966, 57.0));
    let square = Expr::binary(Binary::Compare, &(&x - far_x).abs().max(&(&y - far_y).abs()), &c(1.5 * step));
    let field = within(nothing.min(&(square * 1e9)), 1.0);
    // So little memory that the first lattice is the last.
    let mut job = Job::default();
    job.memory_limit = 256 * 17;
    let budget = Budget::length(Tolerance::new(1e-5).unwrap()); // far below the lattice
    let made = match field_to_polyline(&field, &budget, &job) {
        Ok(made) => made,
        Err(Failure::Unmet(best)) => *best,
        Err(other) => panic!("{other:?}"),
    };
    // The line at the cross is over 1 from the only curve, the square.
    assert!(made.bound.at_most().is_none_or(|most| most >= 1.0), "{:?}", made.bound);
}

#[test]
fn no_distance_is_claimed_to_a_curve_that_there_may_not_be() {
    // As above.
    if !is_long() {
        return;
    }
    let [x, _, _] = Expr::axes();
    // Nothing but rounding.
    let nothing = (&x + 1e3) - 1e3 - &x;
    assert_eq!(claimed(&within(nothing, 1.0), 10.0), None);
}

#[test]
fn lengths_whose_squares_vanish_are_not_lost() {
    let [x, y, _] = Expr::axes();
    let scale = 1e-160;
    // A square whose corners no lattice of these steps meets.
    let square = within(x.abs().max(&y.abs()) - scale, 1.1 * scale);
    let budget = Budget::length(Tolerance::new(0.02 * scale).unwrap());
    let made = match field_to_polyline(&square, &budget, &Job::default()) {
        Ok(made) => made,
        Err(Failure::Unmet(best)) => *best,
        Err(other) => panic!("{other:?}"),
    };
    let corner = [scale; 2];
    // In units of the square, where squares of lengths can be told apart.
    let to = |p: &[f64; 2]| ((p[0] - corner[0]) / scale).hypot((p[1] - corner[1]) / scale);
    let far = made.shape.iter().flat_map(|line| &line.points).map(to).fold(f64::INFINITY, f64::min);
    // Lines between points that cut the corner pass it at half of that or more.
    assert!(made.bound.at_most().is_none_or(|most| most >= 0.5 * far * scale), "{:?} {far}", made.bound);
}

#[test]
fn what_cannot_be_is_refused_with_the_reason() {
    let [x, y, _] = Expr::axes();
    let budget = Budget::length(Tolerance::new(0.01).unwrap());
    let code = |field: &Field, budget: &Budget| match field_to_polyline(field, budget, &Job::default()) {
        Err(Failure::Refused(refusal)) => refusal.code,
        other => panic!("{other:?}"),
    };
    let disc = x.square() + y.square() - 0.25;
    assert_eq!(code(&Field::new(disc.clone()), &budget), RefusalCode::Unsupported);
    assert_eq!(code(&within(disc.clone() + 1.0, 1.0), &budget), RefusalCode::Empty);
    assert_eq!(code(&within(disc.clone(), 1.0), &Budget::default()), RefusalCode::Budget);
    let few = Budget { segments: Some(40), ..Budget::default() };
    let made = field_to_polyline(&within(disc.clone(), 1.0), &few, &Job::default()).unwrap();
    assert!(made.shape[0].n_segments() <= 40 && made.bound.at_most().unwrap() < 0.05);
    let both = Budget { segments: Some(40), ..budget };
    let both = Budget { length: Some(Tolerance::new(1e-4).unwrap()), ..both };
    assert!(matches!(
        field_to_polyline(&within(disc.clone(), 1.0), &both, &Job::default()),
        Err(Failure::Unmet(_))
    ));
    let job = Job::default();
    job.cancel();
    assert!(matches!(field_to_polyline(&within(disc, 1.0), &budget, &job), Err(Failure::Cancelled)));
}

#[test]
fn threads_change_nothing() {
    let [x, y, _] = Expr::axes();
    let waves = (&x * 9.0).sin() + (&y * 7.0 + &x).sin() - 0.3;
    let field = within((x.abs().max(&y.abs()) - 0.9).max(&waves), 1.0);
    let budget = Budget::length(Tolerance::new(0.01).unwrap());
    let made = |threads| field_to_polyline(&field, &budget, &Job::default().with_threads(threads)).unwrap();
    let one = made(1);
    let three = made(3);
    assert!(one.shape.len() > 2);
    assert_eq!((one.shape, one.bound), (three.shape, three.bound));
}

#[test]
fn a_short_arc_in_one_corner_is_no_circle() {
    // A cap of a disc, 0.013 wide, between two walls that cross in the middle of it at an angle of rounding.
    let wall = |tilt: f64| {
        let plate = shapes::rectangle([20.0, 40.0]).unwrap().moved([10.0, 0.0, 0.0]).unwrap();
        let plate = plate.rotated_deg([0.0, 0.0, 1.0], tilt).unwrap();
        plate.moved([0.99998, 0.0, 0.0]).unwrap().rotated_deg([0.0, 0.0, 1.0], 45.0).unwrap()
    };
    for tilt in [3e-10, 5e-10, 9e-10] {
        let cap = shapes::circle(1.0).unwrap().intersection(&wall(0.0)).intersection(&wall(tilt));
        let budget = Budget::length(Tolerance::new(0.7).unwrap());
        // A lattice may miss it.
        let Ok(made) = field_to_polyline(&cap, &budget, &Job::default()) else { continue };
        let most = made.bound.at_most().unwrap();
        let middle = 0.5_f64.sqrt();
        let far =
            points(&made.shape).iter().map(|p| (p[0] - middle).hypot(p[1] - middle)).fold(0.0, f64::max);
        assert!(far <= most + 0.02, "{tilt} {far} {most}");
    }
}

#[test]
fn a_sliver_between_lines_that_cross_far_away_is_not_lost() {
    // Between two diamonds, below a line and above one that crosses it 50 to the left, outside of what all is cut to.
    let plate = |x: f64, y: f64| shapes::rectangle([x, y]).unwrap();
    let moved = |field: &Field, x: f64, y: f64| field.moved([x, y, 0.0]).unwrap();
    let diamond = |from: f64| {
        let corners = [[from, 0.0], [2.0 * from, 1.0], [3.0 * from, 0.0], [2.0 * from, -1.0]];
        shapes::polygon(&corners).unwrap()
    };
    for slope in [2e-15, 4e-15, 1e-14] {
        let below = moved(&plate(600.0, 200.0), 0.0, -100.0);
        let below = below.rotated_deg([0.0, 0.0, 1.0], f64::to_degrees(slope)).unwrap();
        let sliver = plate(2.0, 2.0).intersection(&moved(&plate(300.0, 200.0), 0.0, 100.0));
        let sliver = sliver.intersection(&moved(&below, -50.0, 0.0));
        let all = sliver.union(&diamond(-1.0)).union(&diamond(1.0)).intersection(&plate(40.0, 40.0));
        let budget = Budget::length(Tolerance::new(0.01).unwrap());
        let Ok(made) = field_to_polyline(&all, &budget, &Job::default()) else { continue };
        let near = points(&made.shape).iter().map(|p| p[0].hypot(p[1])).fold(f64::INFINITY, f64::min);
        assert!(near < 0.6, "{slope} {near} {:?}", made.bound);
    }
}
