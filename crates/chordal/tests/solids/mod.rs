//! The surfaces that simplification is tried on are what they are said to be: so many triangles, this
//! topology.
pub mod shapes;

use chordal::Mesh;
use chordal::check::{components, validity};
use chordal::explicit::Topology;

fn solid(mesh: &Mesh, triangles: usize, genus: u64) {
    let found = validity(mesh, Topology::Positions);
    assert_eq!(mesh.faces().len(), triangles);
    assert!(found.closed && found.manifold() && found.oriented, "{found:?}");
    assert_eq!(found.genus, Some(genus));
    assert_eq!((found.zero_area_faces.count, found.components), (0, 1));
    assert!(found.measure.signed_volume > 0.0, "inside out");
}

#[test]
fn solids_are_closed() {
    solid(&shapes::torus([40, 20], 0.0), 1600, 1);
    solid(&shapes::torus([40, 20], 0.1), 1600, 1);
    solid(&shapes::sphere(3), 512, 0);
    solid(&shapes::lobes(4), 2048, 0);
    solid(&shapes::gear(2, 7), 48 * 2 * (2 * 7 + 2), 0);
    solid(&shapes::shaft(50), 1000, 1);
    solid(&shapes::plate(8), 96 * 8 + 108, 24);
    let tray = shapes::tray(20, 0.002);
    solid(&tray, tray.faces().len(), 0);
    let volume = validity(&tray, Topology::Positions).measure.signed_volume;
    let full = 0.1 - 0.996 * 0.996 * 0.098;
    // Coordinates are rounded to f32: a unit in its last place is 6e-8 here, over an area of 4.
    assert!((volume - full).abs() < 1e-6, "{volume} is not {full}");
}

#[test]
fn a_cube_of_blocks_is_a_cube() {
    let side = [0.0, 1.0, 2.0];
    solid(&shapes::blocks([&side, &side, &side], |_| true), 48, 0);
    solid(&shapes::blocks([&side, &side, &side], |cell| cell != [1, 1, 1]), 48, 0);
}

#[test]
fn open_ones_have_one_boundary() {
    let hills = validity(&shapes::heights([30, 20], 0.001), Topology::Positions);
    assert!(hills.manifold() && hills.oriented && !hills.closed);
    assert_eq!((hills.triangles, hills.boundary_loops, hills.genus), (1200, 1, Some(0)));
    let strip = validity(&shapes::mobius([60, 6]), Topology::Positions);
    assert!(strip.manifold() && !strip.orientable);
    assert_eq!((strip.triangles, strip.boundary_loops, strip.euler), (720, 1, 0));
}

#[test]
fn twice_is_two() {
    let two = shapes::twice(&shapes::sphere(2), [10.0, 0.0, 0.0]);
    assert_eq!(validity(&two, Topology::Positions).components, 2);
    assert_eq!(components(&two, Topology::Positions).len(), 2);
}
