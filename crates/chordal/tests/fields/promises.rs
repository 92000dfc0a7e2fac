//! What a proof about a field rests on: what ranges show is proved, and every other word of its maker is
//! listed.
use chordal::budget::{Evidence, Failure};
use chordal::implicit::shapes::{cuboid, rectangle, sphere};
use chordal::implicit::{Distance, Expr, Field, Repeat};
use chordal::math::Box3;
use chordal::{Bounded, Budget, Job, Mesh, Tolerance, check, convert};

fn cube(half: f64) -> Box3 {
    Box3 { min: [-half; 3], max: [half; 3] }
}

fn ball() -> Expr {
    let [x, y, z] = Expr::axes();
    x.square() + y.square() + z.square() - 1.0
}

fn promises(field: &Field) -> Vec<String> {
    match field.evidence() {
        Evidence::Proved => Vec::new(),
        Evidence::ProvedIf(sentences) => sentences,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_box_that_ranges_show_is_no_promise() {
    for (expr, half) in [(ball(), 1.0), (ball(), 7.0), (ball().max(&-ball()) + 0.25, 1.0)] {
        let field = Field::new(expr).with_bounds(cube(half));
        assert_eq!(promises(&field), [""; 0]);
        assert!(field.bounds().max[0] - half <= 1e-11 && field.bounds().max[0] >= half);
    }
    // Along z it has no end, and none is promised.
    let [x, y, _] = Expr::axes();
    let rod = Field::new(x.square() + y.square() - 1.0);
    let endless = Box3 { min: [-1.0, -1.0, f64::NEG_INFINITY], max: [1.0, 1.0, f64::INFINITY] };
    assert_eq!(promises(&rod.with_bounds(endless)), [""; 0]);
}

#[test]
fn a_box_that_is_too_small_or_beyond_ranges_is_a_promise() {
    let small = Field::new(ball()).with_bounds(cube(0.5));
    assert_eq!(promises(&small).len(), 1);
    assert!(
        promises(&small)[0].contains("outside the box from [-0.5, -0.5, -0.5]"),
        "{:?}",
        promises(&small)
    );
    let [x, ..] = Expr::axes();
    let unknown = Field::new(ball().max(&x.sqrt())).with_bounds(cube(1.0));
    assert_eq!(promises(&unknown).len(), 1);
}

#[test]
fn promises_go_through_every_operation() {
    let promised = Field::new(ball()).with_bounds(cube(0.5)).with_distance(Distance::BOUND);
    let flat = {
        let [x, y, _] = Expr::axes();
        let bounds = Box3 { min: [0.0, -0.5, f64::NEG_INFINITY], max: [0.5, 0.5, f64::INFINITY] };
        Field::new(x.square() + y.square() - 1.0).with_bounds(bounds)
    };
    let other = sphere(1.0).expect("a shape").moved([0.5, 0.0, 0.0]).expect("a shape");
    let made = [
        ("union", Ok(other.union(&promised))),
        ("intersection", Ok(promised.intersection(&other))),
        ("difference", Ok(other.difference(&promised))),
        ("complement", Ok(promised.complement())),
        ("xor", Ok(other.xor(&promised))),
        ("union_of", Ok(Field::union_of(&[other.clone(), other.clone(), promised.clone()]))),
        ("intersection_of", Ok(Field::intersection_of(&[other.clone(), promised.clone()]))),
        ("smooth_union", other.smooth_union(&promised, 0.1)),
        ("smooth_intersection", promised.smooth_intersection(&other, 0.1)),
        ("smooth_difference", other.smooth_difference(&promised, 0.1)),
        ("moved", promised.moved([1.0; 3])),
        ("rotated", promised.rotated_deg([0.0, 0.0, 1.0], 30.0)),
        ("scaled", promised.scaled([2.0, 1.0, 1.0])),
        ("mirrored", promised.mirrored([1.0, 0.0, 0.0])),
        ("repeated", promised.repeated([Repeat::Times(3, 4.0), Repeat::Every(4.0), Repeat::Once])),
        ("twisted", promised.twisted(1.0)),
        ("bent", promised.bent(1.0)),
        ("grown", promised.offset(0.1)),
        ("shrunk", promised.offset(-0.1)),
        ("shell", promised.shell(0.1)),
        ("displaced", promised.displaced(&Expr::constant(0.1), 0.1)),
        ("extruded", flat.extruded(1.0)),
        ("revolved", Ok(flat.revolved())),
        ("clipped", Ok(promised.clipped(cube(0.25)))),
    ];
    for (name, field) in made {
        let sentences = promises(&field.unwrap_or_else(|why| panic!("{name}: {why}")));
        let box_is_listed = sentences.iter().any(|sentence| sentence.contains("outside the box from"));
        assert!(box_is_listed, "{name}: {sentences:?}");
    }
}

#[test]
fn a_promised_distance_counts_once_it_is_used() {
    let field = Field::new(ball()).with_bounds(cube(1.0)).with_distance(Distance::BOUND);
    assert_eq!(promises(&field), [""; 0]);
    assert_eq!(promises(&field.union(&sphere(1.0).expect("a shape"))), [""; 0]);
    let grown = field.moved([1.0, 0.0, 0.0]).and_then(|field| field.offset(0.1)).expect("a shape");
    assert_eq!(promises(&grown).len(), 1);
    assert!(promises(&grown)[0].contains("lower bound"));
}

#[test]
fn a_second_expression_for_the_sign_is_a_promise() {
    let field = Field::new(ball()).with_bounds(cube(1.0)).with_sign(ball() * 2.0);
    assert_eq!(promises(&field).len(), 1);
    // Shapes of the library have one too, and it is known to be right.
    assert_eq!(promises(&cuboid([1.0; 3]).expect("a shape")), [""; 0]);
    let turned = rectangle([1.0, 2.0]).expect("a shape").revolved();
    assert_eq!(promises(&turned.shell(0.1).expect("a shape")), [""; 0]);
}

fn mesh(field: &Field) -> Bounded<Mesh> {
    let budget = Budget::length(Tolerance::new(0.1).expect("a length"));
    match convert::field_to_mesh(field, &budget, &Job::default()) {
        Ok(made) => made,
        Err(Failure::Unmet(best)) => panic!("not met: {:?}", best.bound),
        Err(Failure::Refused(refusal)) => panic!("{}", refusal.message),
        Err(Failure::Cancelled) => panic!("cancelled"),
    }
}

/// A dent that is a blob of its own, far beyond the amplitude that is said.
fn far_dent(depth: f64) -> Expr {
    let [x, y, z] = Expr::axes();
    let off = (x - 1.25).square() + y.square() + z.square();
    Expr::unary(chordal::implicit::evaluation::Unary::Exp, &(off * -30.0)) * -depth
}

#[test]
fn a_displacement_beyond_its_amplitude_is_found_whole() {
    let ball = sphere(0.75).expect("a shape");
    let field = ball.displaced(&far_dent(0.75), 0.01).expect("a shape");
    // The formula is nowhere below -0.75, so the box is as large as that needs.
    assert_eq!(promises(&field), [""; 0]);
    assert!(field.bounds().max[0] >= 1.5 && field.bounds().max[0] <= 1.5 + 1e-9);
    assert!(field.expr().at([1.25, 0.0, 0.0]).expect("a value") < 0.0);
    let made = mesh(&field);
    assert_eq!(*made.bound.evidence(), Evidence::Proved);
    assert!(made.shape.bounds().max[0] > 1.25, "the blob is there");
}

#[test]
fn an_amplitude_that_ranges_show_is_proved_and_one_that_none_shows_is_listed() {
    let [x, y, z] = Expr::axes();
    let ball = sphere(0.75).expect("a shape");
    let waves = (x.clone() * 9.0).sin() * (y.clone() * 9.0).sin() * 0.05;
    let field = ball.displaced(&waves, 0.05).expect("a shape");
    assert_eq!(promises(&field), [""; 0]);
    assert!(field.bounds().max[0] < 0.8 + 1e-9);
    // Without a lowest value anywhere, but with one within reach of the ball.
    let field = ball.displaced(&((x + y + z) * 0.05), 0.2).expect("a shape");
    assert_eq!(promises(&field), ["a displacement takes off no more than its amplitude, 0.2"]);
    let made = mesh(&field);
    assert!(matches!(made.bound.evidence(), Evidence::ProvedIf(_)), "{:?}", made.bound);
    let goal = check::Goal::default();
    let judged = check::field_deviation(&made.shape, &field, &goal, &Job::default()).expect("a distance");
    assert!(matches!(judged.bound.evidence(), Evidence::ProvedIf(_)), "{:?}", judged.bound);
}
