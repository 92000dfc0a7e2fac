//! Chains: every level held against the source by the sampler.
use super::sampler::farthest;
use super::{data, shapes};
use chordal::budget::proof::{OpenPlace, OpenPlaces};
use chordal::budget::{Bound, Evidence, JobError, Reference, RefusalCode};
use chordal::explicit::{Attribute, Domain, Semantic, Topology};
use chordal::lod::{LodSource, LodSteps, chain};
use chordal::{Bounded, Job, Mesh, Tolerance};
use chordal_testkit::{Random, some};

/// The bound holds up to this share, and up to roundings of the coordinates: of points, and of their feet on
/// needles.
const SLACK: f64 = 1e-9;
const ROUNDED: f64 = 1e-12;
/// What the sampler finds at least of a bound: the worst place may be small.
const FOUND: f64 = 0.8;
/// Samples by area each way; corners, middles and centres come on top.
const N_SAMPLES: usize = 3_000;

fn levels_hold(meshes: Vec<(&str, Mesh)>) {
    let mut random = Random::new(31);
    for (name, mesh) in meshes {
        let finest = Tolerance::new(5e-4 * mesh.bounds().diagonal()).expect("a length");
        let source = LodSource::Triangles(&mesh, Topology::Positions);
        let levels =
            chain(source, &LodSteps::from_finest(finest), &Job::default().with_threads(2)).expect("levels");
        assert!(!levels.is_empty(), "{name}");
        let reach = mesh.positions().as_flattened().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let rounded = ROUNDED * reach;
        let mut ratios = Vec::new();
        for (k, level) in levels.iter().enumerate() {
            let said = format!("{name}, level {k} of {} triangles", level.mesh.faces().len());
            assert_eq!(*level.bound.evidence(), Evidence::Proved, "{said}");
            let [there, back] = [[&mesh, &level.mesh], [&level.mesh, &mesh]]
                .map(|[from, to]| farthest(from, to, (N_SAMPLES, &mut random)));
            let seen = there.max(back);
            assert!(
                seen <= level.error() * (1.0 + SLACK) + rounded,
                "{said}: {seen:e} of {:e}",
                level.error()
            );
            assert!(
                seen >= FOUND * level.error() - rounded,
                "{said}: only {seen:e} of {:e} found",
                level.error()
            );
            ratios.push(format!("{:.3}", if seen <= rounded { 0.0 } else { seen / level.error() }));
        }
        println!("{name}: {} triangles, found of the bounds: {}", mesh.faces().len(), ratios.join(" "));
    }
}

/// What is removed between levels is left out, and what stays gets other numbers there.
#[test]
fn attributes_follow_through_all_levels() {
    let plain = shapes::torus([120, 60], 0.05);
    let middle = |mesh: &Mesh, f: usize| mesh.corners(f).iter().map(|p| p[0]).sum::<f64>() / 3.0;
    let half = |x: f64| f64::from(u8::from(x > 0.0));
    let halves = Attribute {
        semantic: Semantic::Group("half".into()),
        domain: Domain::Face,
        width: 1,
        values: (0..plain.faces().len()).map(|f| half(middle(&plain, f))).collect(),
    };
    let corners = plain.faces().as_flattened().iter().map(|row| plain.positions()[*row as usize]);
    let texcoords = Attribute {
        semantic: Semantic::TexCoord(0),
        domain: Domain::Corner,
        width: 2,
        values: corners.flat_map(|p| [p[0], p[1]]).collect(),
    };
    let mesh =
        plain.with_attribute(halves).and_then(|mesh| mesh.with_attribute(texcoords)).expect("they fit");
    let steps = LodSteps::from_finest(Tolerance::new(5e-4 * mesh.bounds().diagonal()).expect("a length"));
    let source = LodSource::Triangles(&mesh, Topology::Positions);
    let levels = chain(source, &steps, &Job::default()).expect("levels");
    assert!(levels.len() > 4, "{}", levels.len());
    for level in &levels {
        let near = 4.0 * level.error();
        let [halves, texcoords] = level.mesh.attributes() else { panic!("two attributes") };
        for f in 0..level.mesh.faces().len() {
            let x = middle(&level.mesh, f);
            assert!(x.abs() <= near || halves.row(f)[0] == half(x), "{x} within {near}");
            for (k, p) in level.mesh.corners(f).iter().enumerate() {
                let t = texcoords.row(3 * f + k);
                let off = (t[0] - p[0]).abs().max((t[1] - p[1]).abs());
                assert!(off <= near, "{off} of {near}");
            }
        }
    }
}

#[test]
fn every_level_of_solids_is_within_its_bound() {
    let all = [
        ("torus", shapes::torus([60, 30], 0.0)),
        ("lobes", shapes::lobes(4)),
        ("gear", shapes::gear(2, 7)),
        ("heights", shapes::heights([40, 40], 0.002)),
        ("mobius", shapes::mobius([60, 8])),
    ];
    levels_hold(some(all, 3));
}

#[test]
fn every_level_of_drawn_meshes_is_within_its_bound() {
    let names = [
        "common/data/spot.obj",
        "common/data/suzanne.obj",
        "common/data/beetle.obj",
        "common/data/teapot.obj",
        "trimesh/models/quadknot.obj",
    ];
    levels_hold(
        some(names, 1).into_iter().filter_map(|name| data::obj(name).map(|mesh| (name, mesh))).collect(),
    );
}

/// Where an attempt deviates too much, the next one is more careful there, also in places whose faces earlier
/// levels have removed: no level is left out because of a few places.
#[test]
fn no_level_of_a_rough_surface_is_left_out() {
    for (name, mesh, share) in
        [("rough", shapes::heights([90, 90], 0.002), 8e-4), ("torus", shapes::torus([120, 60], 0.004), 6e-4)]
    {
        let finest = Tolerance::new(share * mesh.bounds().diagonal()).expect("a length");
        let source = LodSource::Triangles(&mesh, Topology::Positions);
        let levels = chain(source, &LodSteps::from_finest(finest), &Job::default()).expect("levels");
        let said: Vec<String> = levels
            .iter()
            .map(|level| format!("{} triangles at {:.3e}", level.mesh.faces().len(), level.error()))
            .collect();
        println!("{name}: {}", said.join(", "));
        let ratios = levels.windows(2).map(|pair| pair[1].error() / pair[0].error());
        assert!(levels.len() > 3 && ratios.clone().all(|ratio| ratio < 2.2), "{name}: {said:?}");
    }
}

#[test]
fn triangles_without_an_upper_bound_have_no_levels_and_the_reason_is_said() {
    let said = |bound: &Bound| {
        let mut make = |_: Tolerance| -> Result<Bounded<Mesh>, JobError> {
            Ok(Bounded { shape: shapes::sphere(2), bound: bound.clone() })
        };
        let steps = LodSteps::from_finest(Tolerance::new(0.1).expect("a length"));
        match chain(LodSource::Smooth(&mut make), &steps, &Job::default()) {
            Err(JobError::Refused(refusal)) => {
                assert_eq!(refusal.code, RefusalCode::Unsupported);
                refusal.message.to_string()
            }
            other => panic!("{other:?}"),
        }
    };
    let measured = Bound::with_evidence(0.01, None, Evidence::Measured { samples: 96 }, Reference::Field);
    let place = |x: f64, size: f64| OpenPlace { at: [x, 0.5, 0.0], size, area: 0.1, contact: None };
    let places = OpenPlaces::new(vec![place(2.0, 0.1), place(1.0, 0.3)], 8.0);
    let mut open = measured.clone();
    open.open = Some(Box::new(places));
    let estimated = Bound::with_evidence(0.0, None, Evidence::Estimated, Reference::Field);
    for (bound, why) in [
        (&measured, "only measured, at 96 points"),
        (&open, "left open at 2 places, the largest about (1.0000, 0.5000, 0.0000)"),
        (&estimated, "only estimated"),
    ] {
        let said = said(bound);
        assert!(said.contains(why) && said.contains("make levels of that mesh"), "{said}");
    }
}
