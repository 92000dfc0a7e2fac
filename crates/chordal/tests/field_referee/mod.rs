//! The referee of fields and their meshes: measures with functions of its own, and shares no code with the
//! evaluator or the distances of the library. `CHORDAL_LONG=1` makes it look at ten times as many trees.
mod corpus;
mod damaged;
mod flush;
mod hostile;
mod measure;
mod same;
mod shapes;

use crate::deviation_referee::triangles_of;
use chordal::check::{FieldDeviation, Goal, field_deviation, validity};
use chordal::convert::field_to_mesh;
use chordal::explicit::Topology;
use chordal::{Bounded, Budget, Failure, Job, Mesh, Tolerance};
use chordal_testkit::Random;
use chordal_testkit::is_long;
use measure::{backward, forward, is_good, surface};
use shapes::Shape;

fn budget(length: f64) -> Budget {
    Budget::length(Tolerance::new(length).expect("a length"))
}

/// The mesh within a budget, or the best.
fn made(shape: &Shape, budget: &Budget) -> Bounded<Mesh> {
    match field_to_mesh(&shape.field, budget, &Job::default()) {
        Ok(made) => made,
        Err(Failure::Unmet(best)) => {
            println!("{}: unmet, {:?}", shape.name, best.bound.at_most());
            *best
        }
        Err(other) => panic!("{}: {other:?}", shape.name),
    }
}

/// What the referee's arithmetic may be off by.
const SLACK: f64 = 1e-12;

/// What of the bound the referee sees; fails where it sees more.
fn judged(shape: &Shape, mesh: &Mesh, found: &FieldDeviation, random: &mut Random) -> Option<f64> {
    let most = found.bound.at_most()?;
    // The boxes of some of these shapes are this test's word.
    assert!(found.bound.evidence().bounds_above(), "{}", shape.name);
    let soup = triangles_of(mesh);
    let (ahead, back) = (forward(&soup, shape, random), backward(&surface(shape, 300, random), &soup));
    assert!(
        ahead <= found.forward.at_most + SLACK,
        "{}: forward {ahead:e} of {:?}",
        shape.name,
        found.forward
    );
    assert!(
        back <= found.backward.at_most + SLACK,
        "{}: backward {back:e} of {:?}",
        shape.name,
        found.backward
    );
    assert!(found.bound.at_least() <= most, "{}", shape.name);
    Some(ahead.max(back) / most)
}

fn deviation(shape: &Shape, mesh: &Mesh, most: Option<f64>) -> FieldDeviation {
    let goal = Goal { max: most.map(|most| Tolerance::new(most).expect("a length")), ..Goal::default() };
    field_deviation(mesh, &shape.field, &goal, &Job::default()).expect("a mesh and a field")
}

fn trees() -> usize {
    if is_long() { 60 } else { 3 }
}

#[test]
fn no_point_is_farther_than_proved() {
    let mut random = Random::new(1);
    for shape in shapes::all(trees()) {
        // Takes 170,000 faces for 0.04 about the point where the spheres touch.
        if shape.name == "touching spheres" && trees() < 60 {
            continue;
        }
        // Where it takes long a longer length does by default.
        let length = match shape.name.as_str() {
            "menger sponge" => 0.1,
            "blobs" | "cones tip to tip" if !is_long() => 0.1,
            _ => 0.04,
        };
        // A tree may be empty.
        let made = match field_to_mesh(&shape.field, &budget(length), &Job::default()) {
            Ok(made) => made,
            Err(Failure::Refused(_)) if shape.name.starts_with("tree") => {
                assert!(surface(&shape, 300, &mut random).len() < 300, "{}: there is a surface", shape.name);
                continue;
            }
            Err(Failure::Unmet(best)) => *best,
            Err(other) => panic!("{}: {other:?}", shape.name),
        };
        let most = made.bound.at_most();
        is_good(&made.shape).unwrap_or_else(|what| panic!("{}: {what}", shape.name));
        assert!(validity(&made.shape, Topology::Indices).manifold(), "{}", shape.name);
        let soup = triangles_of(&made.shape);
        let ahead = forward(&soup, &shape, &mut random);
        let back = backward(&surface(&shape, 300, &mut random), &soup);
        println!(
            "{}: {} faces, [{:.4}, {most:?}], seen {ahead:.4} {back:.4}",
            shape.name,
            soup.corners.len(),
            made.bound.at_least()
        );
        let most = most.unwrap_or_else(|| panic!("{}: nothing proved", shape.name));
        assert!(ahead.max(back) <= most + SLACK, "{}: {ahead:e} {back:e} of {most:e}", shape.name);
    }
}
