//! Surfaces that cross another one twice within a little, by a kink or a bend: what is between both creases has to be in
//! the mesh, however coarse the length is that is asked for.
use chordal::budget::RequiredEvidence;
use chordal::check::validity;
use chordal::convert::field_to_mesh;
use chordal::explicit::Topology;
use chordal::implicit::{Expr, Field, shapes};
use chordal::{Budget, Job, Tolerance};

fn cuboid(sizes: [f64; 3], by: [f64; 3]) -> Field {
    shapes::cuboid(sizes).unwrap().moved(by).unwrap()
}

/// A field with a kink of a slope, which a wall cuts at two places, in a block.
fn wedge(slope: f64) -> Field {
    let [x, y, _] = Expr::axes();
    let kinked = Field::new(x.abs() * slope + y - (20.0 + slope * 2.2));
    let wall = shapes::plane([0.0, 1.0, 0.0], 20.0).unwrap();
    let block = cuboid([60.0, 60.0, 9.0], [3.0, 1.0, 0.5]);
    block.intersection(&kinked).intersection(&wall)
}

fn kinds() -> Vec<(String, Field)> {
    let plate = shapes::rectangle([70.0, 50.0]).unwrap().extruded_with_bevel(6.0, 0.8).unwrap();
    let disc = shapes::circle(30.0).unwrap().extruded_with_bevel(6.0, 1.0).unwrap();
    let ball = |radius: f64, by: [f64; 3]| shapes::sphere(radius).unwrap().moved(by).unwrap();
    let rod = shapes::cylinder(30.0, 12.0).unwrap();
    let mut all = vec![
        ("bevelled plate".to_owned(), plate.clone()),
        ("a box on a bevelled plate".to_owned(), plate.union(&cuboid([10.0, 10.0, 9.0], [0.0, 0.0, 4.0]))),
        ("a ball on a bevelled plate".to_owned(), plate.union(&ball(8.0, [10.0, 0.0, 4.0]))),
        ("a bevelled disc less a ball".to_owned(), disc.difference(&ball(9.0, [3.0, 5.0, 4.0]))),
        ("a bevelled disc less a rod at its rim".to_owned(), {
            let rod = shapes::cylinder(2.2, 30.0).unwrap();
            disc.difference(&rod.moved([28.2, 11.0, 0.0]).unwrap())
        }),
        ("a rod with a flat".to_owned(), rod.intersection(&shapes::plane([0.0, 1.0, 0.0], 29.0).unwrap())),
        (
            "a ball with a flat".to_owned(),
            ball(30.0, [0.0; 3]).intersection(&shapes::plane([0.0, 0.0, 1.0], 29.4).unwrap()),
        ),
        ("a box that stands out of a rounded one".to_owned(), {
            let rounded = shapes::rounded_cuboid([60.0, 40.0, 12.0], 4.0).unwrap();
            rounded.union(&cuboid([58.0, 39.0, 10.0], [0.0, 1.2, 0.3]))
        }),
        ("two balls beside each other".to_owned(), ball(30.0, [0.0; 3]).union(&ball(30.3, [1.0, 0.5, 0.0]))),
    ];
    all.extend([0.1, 0.25, 0.5, 1.0, 2.0].map(|slope| (format!("a kink of {slope}"), wedge(slope))));
    all
}

#[test]
fn surfaces_between_two_creases_are_in_the_mesh() {
    for (name, field) in kinds() {
        for length in [1.0, 0.3, 0.1] {
            let mut budget = Budget::length(Tolerance::new(length).unwrap());
            budget.require = RequiredEvidence::Measured;
            let made = field_to_mesh(&field, &budget, &Job::default());
            let made = made.unwrap_or_else(|failure| panic!("{name} at {length}: {failure}"));
            assert!(made.bound.at_least() <= length, "{name} at {length}: {}", made.bound);
            let found = validity(&made.shape, Topology::Indices);
            assert!(found.closed && found.manifold() && found.oriented, "{name} at {length}: {found:?}");
        }
    }
}
