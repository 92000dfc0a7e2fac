//! Levels on the screen: each seen from the distance from which it may be shown, beside its source, by a
//! rasterizer that shares no code with the library.
mod picture;

use crate::lod::data;
use crate::solids::shapes;
use chordal::budget::Pixels;
use chordal::budget::camera::MinDistanceView;
use chordal::explicit::Topology;
use chordal::lod::selection::SwitchDistances;
use chordal::lod::{LodLevel, LodSource, LodSteps, chain};
use chordal::{Job, Mesh, Tolerance, View};
use chordal_testkit::sampler::dot;
use chordal_testkit::{Random, is_long, some};
use picture::{Camera, Picture};
use std::sync::OnceLock;

/// Roundings of projections and of the search for the switch distance.
const SLACK: f64 = 1e-6;

struct Shape {
    name: String,
    mesh: Mesh,
    levels: Vec<LodLevel>,
}

impl Shape {
    fn new(name: &str, mesh: Mesh) -> Self {
        let finest = Tolerance::new(0.002 * mesh.bounds().diagonal()).expect("a length");
        let steps = LodSteps { stop_at_triangles: 24, ..LodSteps::from_finest(finest) };
        let source = LodSource::Triangles(&mesh, Topology::Positions);
        let levels = chain(source, &steps, &Job::default().with_threads(2)).expect("levels");
        Self { name: name.to_owned(), mesh, levels }
    }

    fn switches(&self, lens: MinDistanceView, pixels: f64) -> SwitchDistances {
        let errors: Vec<f64> = self.levels.iter().map(LodLevel::error).collect();
        SwitchDistances::new(&errors, lens, Pixels::new(pixels).expect("pixels"))
    }
}

/// The same for all tests: making levels takes longest.
fn all() -> &'static [Shape] {
    static SHAPES: OnceLock<Vec<Shape>> = OnceLock::new();
    SHAPES.get_or_init(made)
}

/// Round and bumpy and thin, closed and open, and what others drew.
fn made() -> Vec<Shape> {
    let mut all = vec![
        Shape::new("torus", shapes::torus([80, 40], 0.0)),
        Shape::new("bumps", shapes::torus([100, 50], 0.1)),
        Shape::new("lobes", shapes::lobes(4)),
        Shape::new("hills", shapes::heights([50, 50], 0.001)),
        Shape::new("plate", shapes::plate(24)),
    ];
    all = some(all, 3);
    for name in some(["common/data/spot.obj", "odedstein/objects/goathead/goathead.obj"], 1) {
        all.extend(data::obj(name).map(|mesh| Shape::new(name, mesh)));
    }
    all
}

/// A square screen of so many pixels; its distance is of no interest.
fn lens(size_px: u32, fov_deg: f64) -> MinDistanceView {
    let text = format!("{size_px}x{size_px} fov={fov_deg} dist=1");
    let View::MinDistance(lens) = text.parse().expect("a view") else {
        panic!("one that keeps its distance")
    };
    lens
}

/// The distance from a point to the box of a mesh.
fn to_box(p: [f64; 3], mesh: &Mesh) -> f64 {
    let place = mesh.bounds();
    let off: [f64; 3] = std::array::from_fn(|k| (place.min[k] - p[k]).max(p[k] - place.max[k]).max(0.0));
    dot(off, off).sqrt()
}

/// An eye exactly so far from the box, somewhere around it, looking so that some vertex stands at some spot
/// of the screen: in a third of the cases in a corner of it.
fn camera(mesh: &Mesh, (size_px, fov_deg): (u32, f64), distance: f64, random: &mut Random) -> Camera {
    let place = mesh.bounds();
    let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * (place.min[k] + place.max[k]));
    let away: [f64; 3] = random.direction();
    let eye_at = |t: f64| -> [f64; 3] { std::array::from_fn(|k| middle[k] + t * away[k]) };
    let (mut near, mut far) = (0.0, 2.0 * (distance + place.diagonal()));
    for _ in 0..200 {
        let t = 0.5 * (near + far);
        if to_box(eye_at(t), mesh) < distance { near = t } else { far = t }
    }
    // Not nearer, by no rounding.
    let eye = eye_at(far);
    assert!(to_box(eye, mesh) >= distance && to_box(eye, mesh) < distance * (1.0 + 1e-9));
    let vertex = mesh.positions()[random.below(mesh.positions().len())];
    let size = f64::from(size_px);
    let spot = if random.below(3) == 0 {
        [0, 1].map(|_| if random.below(2) == 0 { 0.02 * size } else { 0.98 * size })
    } else {
        [0, 1].map(|_| random.between(0.0, size))
    };
    Camera::that_sees(vertex, spot, eye, size_px, fov_deg, random.direction())
}

/// How far samples of either picture are from the other, at most, in pixels, and how many were looked at.
fn apart(a: &Mesh, b: &Mesh, camera: &Camera) -> (f64, usize) {
    let pictures = [a, b].map(|mesh| Picture::of(mesh, camera));
    let [there, back] = [[0, 1], [1, 0]].map(|[p, q]| pictures[p].farthest_from(&pictures[q]));
    (there.0.max(back.0), there.1 + back.1)
}

#[test]
fn from_its_switch_distance_on_no_level_is_farther_off_than_the_pixels() {
    let mut random = Random::new(11);
    let mut closest_call = 0.0_f64;
    for shape in all() {
        let mut tight = 0.0_f64;
        let mut n_samples = 0;
        assert!(shape.levels.len() > 2, "{}: {} levels", shape.name, shape.levels.len());
        for (fov_deg, pixels) in [(40.0, 1.0), (90.0, 1.5)] {
            let switches = shape.switches(lens(256, fov_deg), pixels);
            for (k, level) in shape.levels.iter().enumerate() {
                let distance = switches.distance(k).expect("a level");
                for _ in 0..if is_long() { 4 } else { 2 } {
                    let camera = camera(&shape.mesh, (256, fov_deg), distance, &mut random);
                    let (most, n) = apart(&shape.mesh, &level.mesh, &camera);
                    assert!(
                        most <= pixels * (1.0 + SLACK),
                        "{}: level {k} is {most} of {pixels} pixels off at {distance}, {fov_deg} degrees",
                        shape.name
                    );
                    tight = tight.max(most / pixels);
                    n_samples += n;
                }
            }
        }
        println!(
            "{}: {} levels, {n_samples} samples beside the other picture, at most {tight:.3} of the pixels",
            shape.name,
            shape.levels.len()
        );
        assert!(n_samples > 100, "{}: nothing to see", shape.name);
        closest_call = closest_call.max(tight);
    }
    // The distances are not far on the safe side either.
    assert!(closest_call > 0.5, "{closest_call}");
}

#[test]
fn from_a_third_of_the_distance_coarse_levels_are_seen() {
    let mut random = Random::new(12);
    let mut n_seen = 0;
    for shape in all() {
        let switches = shape.switches(lens(256, 40.0), 1.0);
        let k = shape.levels.len() - 1;
        let distance = switches.distance(k).expect("a level") / 3.0;
        let most = (0..6).fold(0.0_f64, |most, _| {
            let camera = camera(&shape.mesh, (256, 40.0), distance, &mut random);
            most.max(apart(&shape.mesh, &shape.levels[k].mesh, &camera).0)
        });
        println!("{}: {most:.2} pixels from a third of the distance", shape.name);
        n_seen += usize::from(most > 1.0 + SLACK);
    }
    assert!(2 * n_seen >= all().len(), "only {n_seen} of the shapes");
}

#[test]
fn the_pictures_are_right() {
    // A square of 10 × 10 pixels seen straight on: focal length 128 / tan 45°, depth 128, so that a unit is a
    // pixel.
    let square = |low: f64, high: f64| {
        let at = |x, y| [x, y, 0.0];
        let corners = vec![at(low, low), at(high, low), at(high, high), at(low, high)];
        Mesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]).expect("valid")
    };
    let camera = Camera::that_sees([0.0; 3], [128.0; 2], [0.0, 0.0, 128.0], 256, 90.0, [0.3, 1.0, 0.0]);
    let small = Picture::of(&square(-5.0, 5.0), &camera);
    // Sixteen samples a pixel.
    assert!((small.n_covered() as f64 / 1600.0 - 1.0).abs() < 0.06, "{}", small.n_covered());
    let large = Picture::of(&square(-5.0, 8.0), &camera);
    assert_eq!(small.farthest_from(&large).0, 0.0);
    // Samples are up to one eighth of a pixel inside of the corner, along both axes of a turned picture.
    let (most, n) = large.farthest_from(&small);
    let expected = 3.0 * 2.0_f64.sqrt();
    assert!(most > expected - 0.4 && most <= expected + 1e-9 && n > 900, "{most} {n}");
}
