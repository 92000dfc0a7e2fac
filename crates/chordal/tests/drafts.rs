//! Drafts of fields: `RequiredEvidence::Estimated`.
use chordal::budget::{Evidence, Failure, RefusalCode, RequiredEvidence};
use chordal::explicit::Topology;
use chordal::implicit::{Expr, Field, shapes};
use chordal::math::{Box3, greater};
use chordal::{Bounded, Budget, Job, Mesh, Tolerance, check, convert};

fn draft(field: &Field, length: f64) -> Result<Bounded<Mesh>, Failure<Mesh>> {
    let budget =
        Budget { require: RequiredEvidence::Estimated, ..Budget::length(Tolerance::new(length).unwrap()) };
    convert::field_to_mesh(field, &budget, &Job::default())
}

/// Six times the volume under a triangle is the determinant of its corners.
fn signed_volume(mesh: &Mesh) -> f64 {
    let six = |face: &[u32; 3]| {
        let [[a, b, c], [d, e, f], [g, h, i]] = face.map(|k| mesh.positions()[k as usize]);
        a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    };
    mesh.faces().iter().map(six).sum::<f64>() / 6.0
}

/// A ball by a formula whose value is no distance: its slope on the surface is 2000.
fn steep() -> Field {
    let [x, y, z] = Expr::axes();
    Field::new((x.square() + y.square() + z.square() - 1.0) * 1000.0)
        .with_bounds(Box3 { min: [-1.0; 3], max: [1.0; 3] })
}

#[test]
fn a_draft_is_closed_lies_on_the_surface_and_says_nothing_of_its_bound() {
    let ring = shapes::torus(1.0, 0.3).unwrap();
    let block = shapes::cuboid([2.0, 1.0, 1.0]).unwrap().difference(&shapes::sphere(0.45).unwrap());
    for (field, scale, volume) in [
        (&shapes::sphere(1.0).unwrap(), 1.0, 4.0 / 3.0 * std::f64::consts::PI),
        (&ring, 1.0, 2.0 * (std::f64::consts::PI * 0.3).powi(2)),
        (&block, 1.0, 2.0 - 4.0 / 3.0 * std::f64::consts::PI * 0.45_f64.powi(3)),
        (&steep(), 2000.0, 4.0 / 3.0 * std::f64::consts::PI),
    ] {
        let made = draft(field, 0.05).unwrap();
        let found = check::validity(&made.shape, Topology::Indices);
        assert!(found.closed && found.manifold() && found.oriented);
        assert_eq!((made.bound.at_least(), made.bound.at_most()), (0.0, None));
        assert_eq!(*made.bound.evidence(), Evidence::Estimated);
        // A vertex beside an edge may be on the plane of the other side, a cell away.
        let mut off = vec![0.0; made.shape.positions().len()];
        field.tape().at(made.shape.positions(), &mut off).unwrap();
        off.iter_mut().for_each(|value| *value = value.abs() / scale);
        assert!(off.iter().fold(0.0, |most, one| greater(most, *one)) < 0.05);
        let near = off.iter().filter(|one| **one < 1e-6).count();
        assert!(10 * near >= 9 * off.len(), "{near} of {}, {field:?}", off.len());
        let own = signed_volume(&made.shape);
        assert!((own / volume - 1.0).abs() < 0.05, "{own} {volume}");
    }
}

#[test]
fn a_number_of_triangles_is_kept_or_unmet() {
    let ball = shapes::sphere(1.0).unwrap();
    let ask = |most| {
        let budget = Budget { require: RequiredEvidence::Estimated, ..Budget::triangles(most) };
        convert::field_to_mesh(&ball, &budget, &Job::default())
    };
    for most in [1_000, 5_000, 100_000] {
        let count = ask(most).unwrap().shape.faces().len() as u64;
        assert!(count <= most && 4 * count >= most.min(20_000), "{count} of {most}");
    }
    assert!(matches!(ask(10), Err(Failure::Unmet(best)) if best.shape.faces().len() > 10));
}

#[test]
fn what_is_empty_or_too_thin_is_refused_in_a_sentence() {
    let [x, y, z] = Expr::axes();
    let nothing = Field::new(x.square() + y.square() + z.square() + 1.0)
        .with_bounds(Box3 { min: [-1.0; 3], max: [1.0; 3] });
    let refused = |field: &Field| match draft(field, 0.1) {
        Err(Failure::Refused(refusal)) => refusal.code,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(&nothing), RefusalCode::Empty);
    let endless = Field::new(Expr::axes()[0].clone());
    assert_eq!(refused(&endless), RefusalCode::Unsupported);
    assert_eq!("estimated".parse(), Ok(RequiredEvidence::Estimated));
}
