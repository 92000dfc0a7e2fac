//! Fields without a surface, leaves without ranges, leaves that lie, numbers without end, and tiny and huge
//! worlds.
use super::budget;
use super::shapes::cube;
use chordal::budget::{Evidence, RequiredEvidence};
use chordal::check::{Goal, field_deviation};
use chordal::convert::field_to_mesh;
use chordal::implicit::evaluation::Unary;
use chordal::implicit::leaves::{Leaf, LeafError};
use chordal::implicit::{Expr, Field, Lipschitz};
use chordal::math::{Box3, Interval};
use chordal::{Bounded, Budget, Failure, Job, Mesh};
use chordal_testkit::is_long;
use std::sync::Arc;

fn meshed(expr: Expr, budget: &Budget) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    meshed_until(10_000, expr, budget)
}

/// What cannot be proved is tried with finer cells until so many triangles.
fn meshed_until(limit: u64, expr: Expr, budget: &Budget) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let mut job = Job::default();
    job.triangle_limit = limit;
    field_to_mesh(&Field::new(expr).with_bounds(cube(1.0)), budget, &job)
}

fn ball(radius: f64) -> Expr {
    let [x, y, z] = Expr::axes();
    (x.square() + y.square() + z.square()).sqrt() - radius
}

fn is_empty(what: &str, expr: Expr) {
    match meshed(expr, &budget(0.05)) {
        Err(Failure::Refused(refusal)) => {
            assert!(refusal.message.contains("no surface"), "{what}: {refusal:?}");
        }
        other => panic!("{what}: {:?}", other.map(|made| made.shape.faces().len()).map_err(|f| f.code())),
    }
}

#[test]
fn h70_fields_without_a_surface_say_why() {
    let [x, ..] = Expr::axes();
    is_empty("never crosses the box", &ball(0.5) + 3.0);
    let [_, y, z] = Expr::axes();
    let beside = ((&x - 1.5).square() + y.square() + z.square()).sqrt() - 0.5;
    is_empty("touches the border only", beside.max(&(&x - 1.0)));
    is_empty("infinitely thin", x.abs());
    is_empty("no volume, on a sphere", ball(0.5).abs());
    is_empty("zero all over a volume", ball(0.5).max(&Expr::constant(0.0)));
    is_empty("no value anywhere", (-(x.square()) - 1.0).sqrt());
    is_empty("NaN", &x * f64::NAN);
}

#[test]
fn h70_a_field_that_fills_its_box_is_never_proved() {
    let [x, ..] = Expr::axes();
    for expr in [&x - 2.0, Expr::constant(-1.0), Expr::constant(f64::NEG_INFINITY)] {
        match meshed(expr, &budget(0.05)) {
            Err(Failure::Unmet(best)) => assert_eq!(best.bound.at_most(), None),
            Err(Failure::Refused(refusal)) => assert!(!refusal.message.is_empty()),
            other => panic!("{:?}", other.map(|made| made.bound)),
        }
    }
}

#[test]
fn steps_and_kinks_are_no_trap() {
    let [x, y, _] = Expr::axes();
    let steps = Expr::unary(Unary::Floor, &(&x * 4.0)) + 0.5;
    let cases = [
        ("steps", steps.max(&ball(0.8))),
        ("zero outside", ball(0.5).min(&Expr::constant(0.0))),
        ("a sign", ball(0.5) / ball(0.5).abs()),
        ("a jump", ball(0.7).max(&(Expr::unary(Unary::Ceil, &y) - 0.5))),
        ("an infinite constant", ball(0.5).min(&Expr::constant(f64::INFINITY))),
    ];
    for (what, expr) in cases {
        let limit = if is_long() { 10_000 } else { 1_000 };
        match meshed_until(limit, expr, &Budget { triangles: Some(50_000), ..budget(0.05) }) {
            Ok(made) => assert!(made.bound.at_most().is_some_and(|most| most <= 0.05), "{what}"),
            Err(Failure::Unmet(best)) => println!("{what}: unmet, {:?}", best.bound.at_most()),
            Err(other) => println!("{what}: {other:?}"),
        }
    }
}

#[test]
fn worlds_of_every_size_end() {
    let [x, y, z] = Expr::axes();
    for (i, size) in [1e-150, 1e-9, 1e9, 1e150].into_iter().enumerate() {
        for (j, far) in [0.0, 1e3, 1e15].into_iter().enumerate() {
            // By default each size at one place, and each place once.
            if (i + j) % 3 != 0 && !is_long() {
                continue;
            }
            let at = far * size;
            let expr = ((&x - at).square() + y.square() + z.square()) - size * size;
            let bounds = Box3 { min: [at - size, -size, -size], max: [at + size, size, size] };
            let field = Field::new(expr).with_bounds(bounds);
            match field_to_mesh(&field, &budget(0.05 * size), &Job::default()) {
                Ok(made) => {
                    let most = made.bound.at_most().expect("proved");
                    let p = made.shape.positions()[0].map(|x| x / size);
                    let seen = ((p[0] - far).hypot(p[1]).hypot(p[2]) - 1.0).abs();
                    assert!(
                        seen <= most / size + 4.0 * f64::EPSILON * (1.0 + far),
                        "{size:e} {far:e} {seen:e}"
                    );
                }
                Err(other) => println!("size {size:e}, {far:e} away: {other:?}"),
            }
        }
    }
}

#[derive(Clone, Copy, Debug)]
enum Word {
    Nothing,
    Lipschitz,
    Lies,
}

/// A ball of radius ½ by its distance, or as an occupancy.
#[derive(Debug)]
struct Ball(Word);

impl Leaf for Ball {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        for (value, p) in out.iter_mut().zip(points) {
            let d = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt() - 0.5;
            *value = if matches!(self.0, Word::Nothing) { 0.5 - 1.0 / (1.0 + (20.0 * d).exp()) } else { d };
        }
        Ok(())
    }

    fn over(
        &self,
        boxes: &[Box3],
        out: &mut [Interval],
    ) -> Result<chordal::implicit::leaves::LeafAnswer, LeafError> {
        if matches!(self.0, Word::Nothing) {
            return Ok(chordal::implicit::leaves::LeafAnswer::None);
        }
        for (range, b) in out.iter_mut().zip(boxes) {
            let c = b.centre();
            let d = (c[0] * c[0] + c[1] * c[1] + c[2] * c[2]).sqrt() - 0.5;
            let reach = b.diagonal();
            let lies = matches!(self.0, Word::Lies) && c[0] > 0.1 && reach < 0.5;
            *range = if lies {
                Interval::new(1.0, 2.0).expect("in order")
            } else {
                Interval::new(d - reach, d + reach).expect("in order")
            };
        }
        Ok(chordal::implicit::leaves::LeafAnswer::Given)
    }

    fn lipschitz(&self) -> Option<Lipschitz> {
        (!matches!(self.0, Word::Nothing)).then_some(Lipschitz { constant: 1.0, error: 0.0 })
    }

    fn evidence(&self) -> Evidence {
        match self.0 {
            Word::Nothing => Evidence::Measured { samples: 0 },
            _ => Evidence::ProvedIf(vec!["the leaf is of slope 1".into()]),
        }
    }
}

fn leaf(word: Word, budget: &Budget) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    meshed(Expr::leaf(Arc::new(Ball(word)), Expr::axes()), budget)
}

#[test]
fn an_occupancy_is_measured_and_never_proved() {
    let made =
        leaf(Word::Nothing, &Budget { require: RequiredEvidence::Measured, ..budget(0.05) }).expect("a mesh");
    assert!(matches!(made.bound.evidence(), Evidence::Measured { .. }), "{:?}", made.bound);
    assert_eq!(made.bound.at_most(), None);
    super::measure::is_good(&made.shape).expect("closed");
    // Nobody who asks for a proof gets it for one.
    assert!(leaf(Word::Nothing, &Budget { require: RequiredEvidence::Proved, ..budget(0.02) }).is_err());
}

#[test]
fn an_occupancy_that_is_met_within_a_length_is_met_within_longer_ones_with_no_more_triangles() {
    let mut before = usize::MAX;
    for length in [0.005, 0.01, 0.02, 0.05, 0.1] {
        let asked = Budget { require: RequiredEvidence::Measured, ..budget(length) };
        let made = leaf(Word::Nothing, &asked).expect("a mesh");
        let n_faces = made.shape.faces().len();
        assert!(
            made.bound.at_least() <= length && n_faces <= before,
            "{length}: {n_faces}, {:?}",
            made.bound
        );
        before = n_faces;
    }
}

#[test]
fn a_promise_gives_a_proof_on_condition() {
    let made = leaf(Word::Lipschitz, &budget(0.08)).expect("a mesh");
    assert!(matches!(made.bound.evidence(), Evidence::ProvedIf(_)), "{:?}", made.bound);
    let most = made.bound.at_most().expect("proved, if");
    let seen = made.shape.positions().iter().map(|p| (p[0].hypot(p[1]).hypot(p[2]) - 0.5).abs());
    assert!(seen.fold(0.0, f64::max) <= most && most <= 0.08);
}

#[test]
fn a_leaf_that_lies_is_no_panic() {
    match leaf(Word::Lies, &budget(0.05)) {
        Err(Failure::Refused(refusal)) => assert!(refusal.message.contains("contradicts"), "{refusal:?}"),
        other => println!("{:?}", other.map(|made| made.bound).map_err(|f| f.code())),
    }
}

#[test]
fn a_field_of_one_point_and_a_mesh_of_one_triangle() {
    let flat = Mesh::new(vec![[0.0; 3]; 3], vec![[0, 1, 2]]).expect("finite");
    let field = Field::new(ball(0.5)).with_bounds(cube(0.6));
    let found =
        field_deviation(&flat, &field, &Goal::default(), &Job::default()).expect("a mesh and a field");
    // From the middle of the ball to all of its surface.
    let [least, most] = [found.bound.at_least(), found.bound.at_most().unwrap_or(f64::INFINITY)];
    assert!(least <= 0.5 + 1e-12 && most >= 0.5, "[{least}, {most}]");
    let empty = Field::new(ball(0.5) + 5.0).with_bounds(cube(0.6));
    let found =
        field_deviation(&flat, &empty, &Goal::default(), &Job::default()).expect("a mesh and a field");
    assert_eq!(found.bound.at_most(), None, "there is no surface");
}
