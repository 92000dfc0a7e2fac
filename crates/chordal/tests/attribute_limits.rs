//! Limits on attributes: what is made within them is measured to be within them, and they cost triangles.
use crate::solids::shapes;

use chordal::budget::attributes::AttributeLimits;
use chordal::budget::{Failure, Reference, RefusalCode};
use chordal::check::findings::attribute_deviation;
use chordal::explicit::{Attribute, Domain, NormalWeight, Semantic, Shading, Topology, with_normals};
use chordal::lod::tiling::{TilingOptions, tree};
use chordal::lod::{LodSource, LodSteps, chain, simplify};
use chordal::{Bound, Bounded, Budget, Job, Mesh, Tolerance};
use chordal_testkit::is_long;

const TEXTURE: Semantic = Semantic::TexCoord(0);

fn length(x: f64) -> Tolerance {
    Tolerance::new(x).expect("a length")
}

fn limits(texcoord: Option<f64>, normal_deg: Option<f64>) -> AttributeLimits {
    AttributeLimits::new(texcoord, normal_deg).expect("limits")
}

/// A torus with smooth normals, and texture coordinates with two seams that run unevenly.
fn torus([n, m]: [u32; 2]) -> Mesh {
    let mesh = shapes::torus([n, m], 0.0);
    let faces = mesh.faces().to_vec();
    let texcoord = |f: usize, k: usize| {
        let (row, cell) = (faces[f][k], f as u32 / 2);
        let wrap = |at: u32, cell: u32, n: u32| if at < cell { n } else { at };
        let (i, j) = (wrap(row / m, cell / m, n), wrap(row % m, cell % m, m));
        let (u, v) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(m));
        [u + 0.02 * (40.0 * u).sin() * (30.0 * v).cos(), v + 0.02 * (35.0 * u * v).sin()]
    };
    let corners = (0..faces.len()).flat_map(|f| [0, 1, 2].map(|k| (f, k)));
    let values = corners.flat_map(|(f, k)| texcoord(f, k)).collect();
    let texture = Attribute { semantic: TEXTURE, domain: Domain::Corner, width: 2, values };
    let mesh = mesh.with_attribute(texture).expect("it fits");
    with_normals(&mesh, Topology::Indices, Shading::Smooth(NormalWeight::Angle)).expect("it fits")
}

/// The largest measured difference of one attribute.
fn largest(a: &Mesh, b: &Mesh, semantic: &Semantic, moved: Tolerance) -> f64 {
    let all = attribute_deviation(a, b, Some(moved), &Job::default()).expect("measured");
    all.iter().find(|found| found.semantic == *semantic).expect("both have it").largest
}

fn within(mesh: &Mesh, tolerance: f64, attributes: AttributeLimits) -> Mesh {
    let budget = Budget { attributes, ..Budget::length(length(tolerance)) };
    let made = simplify(mesh, &budget, Topology::Indices, &Job::default()).expect("proved");
    assert!(made.bound.at_most().is_some_and(|most| most <= tolerance));
    made.shape.mesh
}

#[test]
fn texture_coordinates_stay_within_their_limit_and_cost_triangles() {
    let mesh = torus([90, 45]);
    let tolerance = 0.05;
    let free = within(&mesh, tolerance, AttributeLimits::default());
    let off = largest(&mesh, &free, &TEXTURE, length(tolerance));
    assert!(off > 0.03, "a free result is off by {off}, so limits have nothing to do");
    let mut before = free.faces().len();
    let all = [0.02, 0.008];
    for &most in &all[usize::from(!is_long())..] {
        let made = within(&mesh, tolerance, limits(Some(most), None));
        let off = largest(&mesh, &made, &TEXTURE, length(tolerance));
        assert!(off <= most && off > 0.2 * most, "{off} of {most}");
        assert!(made.faces().len() > before && made.faces().len() < mesh.faces().len() * 9 / 10);
        before = made.faces().len();
    }
}

#[test]
fn normals_stay_within_their_limit_and_cost_triangles() {
    let mesh = torus([90, 45]);
    let free = within(&mesh, 0.05, AttributeLimits::default());
    let off = largest(&mesh, &free, &Semantic::Normal, length(0.05));
    let made = within(&mesh, 0.05, limits(None, Some(0.4 * off)));
    let less = largest(&mesh, &made, &Semantic::Normal, length(0.05));
    assert!(off > 3.0 && less <= 0.4 * off, "{less} after {off}");
    assert!(made.faces().len() > free.faces().len() && made.faces().len() < mesh.faces().len() / 2);
}

#[test]
fn every_level_and_every_tile_keeps_the_limits() {
    let (size, max_triangles) = if is_long() { ([64, 32], 1500) } else { ([40, 20], 600) };
    let mesh = torus(size);
    let attributes = limits(Some(0.03), Some(20.0));
    let steps = LodSteps { attributes, ..LodSteps::from_finest(length(0.01)) };
    let levels =
        chain(LodSource::Triangles(&mesh, Topology::Indices), &steps, &Job::default()).expect("proved");
    assert!(levels.len() > 1);
    for level in &levels {
        let moved = length(level.error());
        assert!(largest(&mesh, &level.mesh, &TEXTURE, moved) <= 0.03);
        assert!(largest(&mesh, &level.mesh, &Semantic::Normal, moved) <= 20.0);
    }
    let bound = Bound::exact(Reference::InputTriangles);
    let finest = Bounded { shape: mesh, bound };
    let n_coarser = |attributes| {
        let cuts = TilingOptions { attributes, max_triangles, ..TilingOptions::from_step(length(0.02)) };
        let made = tree(&finest, Topology::Indices, &cuts, &Job::default()).expect("a tree");
        let coarser = made.tiles.iter().filter(|tile| !tile.children.is_empty());
        coarser.map(|tile| tile.mesh.faces().len()).sum::<usize>()
    };
    let [free, limited] = [AttributeLimits::default(), limits(Some(0.01), None)].map(n_coarser);
    assert!(free > 0 && limited > free, "{limited} against {free}");
}

#[test]
fn a_limit_without_a_length_is_refused_and_flat_shading_has_none() {
    let mesh = torus([24, 12]);
    let budget = Budget { attributes: limits(Some(0.1), None), ..Budget::triangles(100) };
    match simplify(&mesh, &budget, Topology::Indices, &Job::default()) {
        Err(Failure::Refused(refusal)) => assert_eq!(refusal.code, RefusalCode::Budget),
        other => panic!("{other:?}"),
    }
    let flat = shapes::torus([24, 12], 0.0);
    let flat = with_normals(&flat, Topology::Indices, Shading::Flat).expect("it fits");
    let free = within(&flat, 0.1, AttributeLimits::default());
    assert_eq!(within(&flat, 0.1, limits(None, Some(1.0))), free);
}
