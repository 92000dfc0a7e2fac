//! Pieces: a component goes only where a length covers that, and never for a count.
use super::{bounds, length, made, n_faces, shapes};
use chordal::check::validity;
use chordal::explicit::Topology;
use chordal::{Budget, Failure, Job, Mesh, lod::simplify};
use chordal_testkit::Random;

fn components(mesh: &Mesh) -> u64 {
    validity(mesh, Topology::Positions).components
}

/// A box of 1,200 triangles, and 40 balls of radius 0.005 that are 0.01 above it.
fn debris() -> Mesh {
    let cuts: Vec<f64> = (0..=10).map(|i| f64::from(i) / 10.0).collect();
    let (body, speck) = (shapes::blocks([&cuts, &cuts, &cuts], |_| true), shapes::sphere(1));
    let (mut positions, mut faces) = (body.positions().to_vec(), body.faces().to_vec());
    for i in 0..40 {
        let centre = [0.1 * f64::from(i % 8) + 0.13, 0.15 * f64::from(i / 8) + 0.17, 1.015];
        let first = positions.len() as u32;
        positions.extend(
            speck
                .positions()
                .iter()
                .map(|p| -> [f64; 3] { std::array::from_fn(|k| centre[k] + 0.005 * p[k]) }),
        );
        faces.extend(speck.faces().iter().map(|f| f.map(|i| i + first)));
    }
    Mesh::new(positions, faces).expect("valid")
}

#[test]
fn debris_goes_where_the_length_covers_it() {
    let mesh = debris();
    assert_eq!(components(&mesh), 41);
    let made = made(&mesh, &length(0.05));
    assert_eq!((components(&made.shape.mesh), made.shape.stats.dropped_components), (1, 40));
    bounds::holds("debris", &mesh, &length(0.05), &made, &mut Random::new(1));
}

#[test]
fn debris_stays_where_the_length_does_not_cover_it() {
    let mesh = debris();
    let made = made(&mesh, &length(0.008));
    assert_eq!((components(&made.shape.mesh), made.shape.stats.dropped_components), (41, 0));
    assert!(n_faces(&made) < mesh.faces().len() / 2);
    bounds::holds("debris", &mesh, &length(0.008), &made, &mut Random::new(1));
}

#[test]
fn no_piece_goes_for_a_count() {
    let mesh = debris();
    for most in [1, 100, 400] {
        let made = made(&mesh, &Budget::triangles(most));
        assert_eq!((components(&made.shape.mesh), made.shape.stats.dropped_components), (41, 0), "{most}");
    }
}

#[test]
fn the_only_piece_stays_whatever_the_length() {
    let mesh = shapes::sphere(3);
    let made = made(&mesh, &length(100.0));
    assert_eq!(n_faces(&made), 4);
    bounds::holds("ball", &mesh, &length(100.0), &made, &mut Random::new(1));
}

#[test]
fn a_count_below_what_is_possible_gives_the_best() {
    let mesh = shapes::torus([60, 30], 0.0);
    let Err(Failure::Unmet(best)) =
        simplify(&mesh, &Budget::triangles(4), Topology::Indices, &Job::default())
    else {
        panic!("a torus of four triangles")
    };
    // The least that a torus without a double edge has is 14.
    assert!((14..40).contains(&n_faces(&best)), "{}", n_faces(&best));
    bounds::holds("torus", &mesh, &Budget::triangles(4), &best, &mut Random::new(1));
}

#[test]
fn a_length_and_a_count_hold_together_or_the_count_is_unmet() {
    let mesh = shapes::torus([60, 30], 0.0);
    let with = |most| Budget { triangles: Some(most), ..length(0.01) };
    let fits = simplify(&mesh, &with(2000), Topology::Indices, &Job::default()).expect("enough");
    let Err(Failure::Unmet(best)) = simplify(&mesh, &with(100), Topology::Indices, &Job::default()) else {
        panic!("100 triangles within 0.01")
    };
    assert!(n_faces(&best) > 100 && best.bound.at_most().expect("proved") <= 0.01);
    assert_eq!(n_faces(&best), n_faces(&fits));
}
