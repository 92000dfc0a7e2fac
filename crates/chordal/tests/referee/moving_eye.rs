//! Meshes for one eye after another, whose tiles are kept while they hold: every one of them is judged as one that is
//! made anew.
use super::eyes::{Eye, Lens};
use super::pixels::{camera_of, furthest, pairs, rounding};
use super::shapes::shape;
use super::teapot::teapot;
use super::topology::Topology;
use super::{for_all, is_long, library_patches};
use chordal::budget::camera::{Projection, Screen};
use chordal::budget::{Failure, Pixels, RefusalCode};
use chordal::convert::batch::{TileReuse, ViewDependentMesher};
use chordal::{Bounded, Budget, Job, Mesh, Tolerance, View, convert};
use chordal_testkit::Random;
use chordal_testkit::sampler::{Surface, Triangles, add, evaluate, measure, quarters, scale};

fn budget_at(view: View, pixels: f64) -> Budget {
    Budget::pixels(Pixels::new(pixels).expect("positive"), view)
}

/// An eye around the teapot: how many of its radii away, and how far around.
fn around(away: f64, turn: f64) -> View {
    let (s, c) = turn.sin_cos();
    let eye = [4.0 * away * c, 4.0 * away * s, 1.5 + 1.2 * away];
    format!("1920x1080 fov=45 eye={},{},{} target=0,0,1.5", eye[0], eye[1], eye[2]).parse().expect("a view")
}

/// A path toward the teapot, then away from it.
fn there_and_back(n: u32) -> Vec<View> {
    let at = |k: u32| f64::from(if 2 * k < n { k } else { n - k }) / f64::from(n);
    (0..=n).map(|k| around(6.0 - 8.0 * at(k), 0.03 * f64::from(k))).collect()
}

/// Everything that a mesh holds, as numbers.
fn bits(made: &Bounded<Mesh>) -> Vec<u64> {
    let mesh = &made.shape;
    let attributes = mesh.attributes().iter().flat_map(|attribute| &attribute.values);
    let numbers = mesh.positions().as_flattened().iter().chain(attributes).map(|x| x.to_bits());
    let tied = mesh.position_id().unwrap_or_default();
    numbers.chain(mesh.faces().as_flattened().iter().chain(tied).map(|i| u64::from(*i))).collect()
}

#[test]
fn no_eye_on_a_path_sees_more_pixels_than_promised() {
    let n = if is_long() { 1000 } else { 14 };
    let kept = for_all(n, |seed| {
        let shape = shape(seed as u64);
        let r = &mut Random::new(seed as u64 + 31);
        let (lens, pixels) = (Lens::pinhole(r), [0.5, 1.0, 4.0][r.below(3)]);
        // Sixteen patches that share sides.
        let quarters = |control| quarters(control).map(|(quarter, _)| quarter);
        let parts: Vec<_> = quarters(&shape.control).iter().flat_map(quarters).collect();
        let mut mesher = ViewDependentMesher::from_patches(&library_patches(&parts)).expect("finite");
        let on = evaluate(&shape.control, [r.between(0.0, 1.0), r.between(0.0, 1.0)]);
        let at = add(on, scale(r.direction(), shape.size * 10_f64.powf(r.between(-0.2, 0.7))));
        let mut eye = Eye::aimed(at, on, lens, r);
        eye.near = [0.0, 0.03, 0.2][r.below(3)] * shape.size;
        let step = scale(r.direction(), 0.03 * shape.size);
        let (mut kept, mut made, mut seen) = (0, 0, 0);
        for frame in 0..6 {
            // A jump, and then on.
            let jump = if frame == 4 { 10.0 } else { 1.0 };
            eye.at = add(eye.at, scale(step, jump));
            let view = View::Camera(camera_of(&eye, shape.size));
            let mesh = match mesher.mesh(&budget_at(view, pixels), &Job::default().with_threads(1)) {
                Ok(mesh) => mesh,
                Err(Failure::Refused(why)) if why.code == RefusalCode::TooClose => continue,
                Err(other) => panic!("{other}"),
            };
            let promised = mesh.bound.pixels.expect("a view was given");
            let found = furthest(&eye, &pairs(&shape, &mesh));
            assert!(promised <= pixels, "{promised} for {pixels} px");
            assert!(
                found <= promised + rounding(&shape, &eye, promised),
                "{} (seed {seed}, frame {frame}): {found} px where {promised} were promised",
                shape.kind
            );
            let TileReuse { kept: own, made: new } = mesher.reuse();
            (kept, made, seen) = (kept + own, made + new, seen + 1);
        }
        (kept, made, seen)
    });
    let [kept, made, seen] =
        kept.into_iter().fold([0, 0, 0], |sum, (a, b, c)| [sum[0] + a, sum[1] + b, sum[2] + c]);
    eprintln!("{seen} meshes, {kept} tiles kept, {made} made");
    assert!(seen > 3 * n as u64 && kept > made, "{seen} meshes of {n} paths, {kept} tiles kept, {made} made");
}

#[test]
fn a_mesh_of_an_earlier_view_is_caught_at_a_nearer_one() {
    // What would come of a bound that is carried over instead of computed for the view.
    let shape = shape(2);
    let lens = Lens {
        projection: Projection::Perspective { fov_y_deg: 40.0 },
        screen: Screen { width_px: 600, height_px: 600 },
    };
    let on = evaluate(&shape.control, [0.5, 0.5]);
    let caught = (0..8).filter(|seed| {
        let r = &mut Random::new(*seed);
        let away = r.direction();
        let mut eye = Eye::aimed(add(on, scale(away, 4.0 * shape.size)), on, lens, r);
        let view = View::Camera(camera_of(&eye, shape.size));
        let mut mesher =
            ViewDependentMesher::from_patches(&library_patches(&[shape.control])).expect("finite");
        let mesh = mesher.mesh(&budget_at(view, 0.5), &Job::default()).expect("far enough");
        eye.at = add(on, scale(away, 0.8 * shape.size));
        furthest(&eye, &pairs(&shape, &mesh)) > 0.5
    });
    assert!(caught.count() >= 4, "the referee would not see a bound that is carried over");
}

#[test]
fn frames_of_the_teapot_have_no_cracks_and_keep_their_length() {
    let controls = teapot();
    let surface = Surface::new(controls.clone());
    let slack = controls.iter().map(super::length::rounding).fold(0.0, f64::max);
    let mut mesher = ViewDependentMesher::from_patches(&library_patches(&controls)).expect("finite");
    let (mut kept, mut made) = (0, 0);
    for (frame, view) in there_and_back(if is_long() { 120 } else { 24 }).into_iter().enumerate() {
        let mesh = mesher.mesh(&budget_at(view, 2.0), &Job::default()).expect("far enough");
        let topology = Topology::of(&mesh.shape);
        assert_eq!(topology.boundary_loops(), Ok(6), "frame {frame}");
        assert_eq!([topology.crowded_edges(), topology.degenerate_faces()], [0, 0], "frame {frame}");
        assert_eq!(topology.t_junctions(1e-12), 0, "frame {frame}");
        assert!(mesh.bound.pixels.is_some_and(|pixels| pixels <= 2.0), "{:?}", mesh.bound);
        if frame % 6 == 5 || is_long() {
            let at_most = mesh.bound.at_most().expect("proved");
            let triangles = Triangles::new(mesh.shape.positions(), mesh.shape.faces());
            let found = measure(&surface, &triangles).both();
            assert!(found <= at_most + slack, "frame {frame}: {found:e} where {at_most:e} was promised");
            assert!(mesh.bound.at_least() <= found * 1.002 + slack, "frame {frame}: {:?}", mesh.bound);
        }
        (kept, made) = (kept + mesher.reuse().kept, made + mesher.reuse().made);
    }
    assert!(kept > made, "{kept} tiles kept, {made} made");
}

#[test]
fn a_path_has_the_same_bytes_on_any_number_of_threads() {
    let patches = library_patches(&teapot());
    let of_threads = |threads| {
        let mut mesher = ViewDependentMesher::from_patches(&patches).expect("finite");
        let job = Job::default().with_threads(threads);
        let frames = there_and_back(8).into_iter().map(|view| {
            let mesh = mesher.mesh(&budget_at(view, 1.0), &job).expect("far enough");
            (bits(&mesh), mesh.bound, mesher.reuse())
        });
        frames.collect::<Vec<_>>()
    };
    let one = of_threads(1);
    assert!(one == of_threads(2) && one == of_threads(5), "threads change a mesh");
}

#[test]
fn an_eye_that_rests_costs_no_tile_and_one_that_goes_away_saves_triangles() {
    let patches = library_patches(&teapot());
    let mut mesher = ViewDependentMesher::from_patches(&patches).expect("finite");
    let job = Job::default();
    let anew =
        |view: View| convert::patches_to_mesh(&patches, &budget_at(view, 1.0), &job).expect("far enough");
    let near = mesher.mesh(&budget_at(around(2.0, 0.0), 1.0), &job).expect("far enough");
    let again = mesher.mesh(&budget_at(around(2.0, 0.0), 1.0), &job).expect("far enough");
    assert_eq!(bits(&near), bits(&again));
    assert_eq!(near.bound, again.bound);
    assert_eq!(mesher.reuse().made, 0);
    let mut view = around(2.0, 0.0);
    for k in 1..=40 {
        view = around(2.0 + 0.5 * f64::from(k), 0.0);
        let mesh = mesher.mesh(&budget_at(view, 1.0), &job).expect("far enough");
        let (own, new) = (mesh.shape.faces().len(), anew(view).shape.faces().len());
        // Half of the cells would do, and tiles of few cells have more triangles where they are stitched.
        assert!(own < 3 * new, "{own} triangles where {new} do");
    }
    let far = mesher.mesh(&budget_at(view, 1.0), &job).expect("far enough");
    assert!(far.shape.faces().len() * 3 < near.shape.faces().len());
}

#[test]
fn after_an_error_the_next_mesh_is_as_a_first_one() {
    let patches = library_patches(&teapot());
    let view = around(3.0, 0.0);
    let first = ViewDependentMesher::from_patches(&patches)
        .expect("finite")
        .mesh(&budget_at(view, 1.0), &Job::default())
        .expect("far enough");
    let mut mesher = ViewDependentMesher::from_patches(&patches).expect("finite");
    mesher.mesh(&budget_at(around(2.5, 0.0), 1.0), &Job::default()).expect("far enough");
    let inside: View = "640x480 fov=45 eye=0,0,1 target=1,0,1".parse().expect("a view");
    let refused = mesher.mesh(&budget_at(inside, 1.0), &Job::default());
    assert!(matches!(refused, Err(Failure::Refused(why)) if why.code == RefusalCode::TooClose));
    let next = mesher.mesh(&budget_at(view, 1.0), &Job::default()).expect("far enough");
    assert_eq!(bits(&next), bits(&first));
    let few = Budget { triangles: Some(100), ..budget_at(view, 1.0) };
    assert!(
        matches!(mesher.mesh(&few, &Job::default()), Err(Failure::Refused(why)) if why.code == RefusalCode::Unsupported)
    );
    let mut little = Job::default();
    little.triangle_limit = 1000;
    let refused = mesher.mesh(&budget_at(around(3.0, 0.1), 0.1), &little);
    assert!(matches!(refused, Err(Failure::Refused(why)) if why.code == RefusalCode::TooManyTriangles));
    let cancelled = Job::default();
    cancelled.cancel();
    assert!(matches!(mesher.mesh(&budget_at(view, 1.0), &cancelled), Err(Failure::Cancelled)));
    let by_length = Budget::length(Tolerance::new(0.01).expect("positive"));
    assert!(mesher.mesh(&by_length, &Job::default()).is_ok_and(|mesh| mesh.bound.at_most() <= Some(0.01)));
}
