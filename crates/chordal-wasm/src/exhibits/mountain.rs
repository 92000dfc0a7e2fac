//! A teapot on a desk and a mountain behind it in one picture, each within the same pixels, with a loupe.
use super::answer::ExhibitAnswer;
use super::landscape::Landscape;
use super::plane::{once, or_text};
use super::request::ExhibitRequest;
use super::shapes;
use super::sight::Sight;
use chordal::budget::Pixels;
use chordal::budget::camera::{Camera, Projection, Screen};
use chordal::convert::patches_to_mesh;
use chordal::math::{Box3, elementary::sin_cos};
use chordal::{Bounded, Budget, Job, Mesh, Patch, View};
use serde_json::{Value, json};
use std::sync::OnceLock;

/// The picture: a screen with the proportions and the angle of the figure.
const SCREEN: Screen = Screen { width_px: 1620, height_px: 1080 };
const LENS: Projection = Projection::Perspective { fov_y_deg: 28.0 }; // defined: by the figures of the studio
/// The eye above the desk, in metres.
const EYE_HEIGHT: f64 = 0.17; // chosen: both are in the picture from half a metre on
/// The range of the distance from the eye to the teapot, in metres.
const DISTANCES: [f64; 2] = [0.6, 2000.0]; // defined: what the slider offers
/// The distance from the teapot to the foot of the mountain's far side.
const BEHIND: f64 = 3000.0; // defined: by the lesson
/// The scale of the teapot: 6.4 units are 0.26 metres.
const METRES: f64 = 0.04; // defined: by the lesson
const BUDGETS: [f64; 2] = [0.25, 16.0]; // defined: what the slider offers
/// Pixels along the loupe.
const LOUPE: f64 = 12.0; // chosen: each is large enough to see
/// Pieces of the surface in the loupe are cut until they are shorter than this.
const FINE_PX: f64 = 0.5; // chosen: such pieces bend by less than a tenth of it
/// The depths at which the figure draws the two, in its own units.
const DRAWN_AT: [f64; 2] = [2.0, 30.0]; // chosen: so that nothing is too near or too far for it

/// Answers `{"distance": 1, "px": 1, "spot": [x, y]}`: the two meshes, and what a loupe shows around a pixel.
pub(super) fn mountain(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["distance", "px", "spot"])?;
    let distance = request.number("distance", DISTANCES)?;
    let px = or_text(Pixels::new(request.number("px", BUDGETS)?))?;
    let spot = request.point::<2>("spot")?;
    static MODELS: OnceLock<[Vec<Patch>; 2]> = OnceLock::new();
    let models = once(&MODELS, || Ok([teapot(), hills()]))?;
    let eye = [0.0, -distance, EYE_HEIGHT];
    // It looks at the horizon, so only its distance changes.
    let target = [0.0, 0.0, EYE_HEIGHT];
    let camera = Camera { eye, target, up: [0.0, 0.0, 1.0], near: 0.0, projection: LENS, screen: SCREEN };
    let view = or_text(View::Camera(camera).checked())?;
    let (budget, sight) = (Budget::pixels(px, view), Sight::new(&camera)?);
    let window = [0, 1].map(|k| [spot[k] - 0.5 * LOUPE, spot[k] + 0.5 * LOUPE]);
    let mut answer = ExhibitAnswer::default();
    let mut facts = Vec::new();
    let away = [distance, distance + BEHIND];
    for (k, model) in models.iter().enumerate() {
        let mesh = or_text(patches_to_mesh(model, &budget, &Job::default()))?;
        let frame = Frame { sight: &sight, window, eye, scale: DRAWN_AT[k] / away[k] };
        facts.push(model_facts(&mut answer, (&mesh, model), &frame));
    }
    let allowed = away.map(|away| {
        let at = [0.0, away - distance, EYE_HEIGHT];
        view.length_of(px, &Box3 { min: at, max: at })
    });
    answer.facts = json!({
        "screen": [SCREEN.width_px, SCREEN.height_px],
        "loupe": LOUPE,
        "distances": away,
        "allowed": allowed,
        "teapot": facts[0],
        "mountain": facts[1],
    });
    Ok(answer)
}

/// How a model is drawn.
struct Frame<'a> {
    sight: &'a Sight,
    window: [[f64; 2]; 2],
    eye: [f64; 3],
    /// The figure shows it shrunk towards the eye, which changes no direction.
    scale: f64,
}

fn model_facts(
    answer: &mut ExhibitAnswer,
    (mesh, patches): (&Bounded<Mesh>, &[Patch]),
    frame: &Frame,
) -> Value {
    let Frame { sight, window, eye, scale } = *frame;
    let shape = &mesh.shape;
    let places: Vec<[f64; 3]> =
        shape.positions().iter().map(|p| [0, 1, 2].map(|k| scale * (p[k] - eye[k]))).collect();
    let positions = answer.floats(places.as_flattened());
    let indices = answer.rows(shape.faces().as_flattened());
    let edges = answer.edges(&places, shape.faces());
    let pixels: Vec<_> = shape.positions().iter().map(|p| sight.pixel(*p)).collect();
    let mut triangles = Vec::new();
    for face in shape.faces() {
        if let [Some(a), Some(b), Some(c)] = face.map(|row| pixels[row as usize])
            && touches(&[a, b, c], window)
        {
            triangles.extend([a, b, c].iter().flat_map(|p| [p[0], p[1]]));
        }
    }
    let mut truth = Vec::new();
    for patch in patches {
        add_pieces(patch, sight, window, &mut truth);
    }
    json!({
        "mesh": { "positions": positions, "indices": indices },
        "edges": edges,
        "triangles": shape.faces().len(),
        "pixels": mesh.bound.pixels,
        "error": mesh.bound.at_most(),
        "loupe": answer.floats(&triangles),
        "truth": answer.floats(&truth),
    })
}

/// Whether a triangle's box overlaps the window.
fn touches(points: &[[f64; 3]], window: [[f64; 2]; 2]) -> bool {
    (0..2).all(|k| points.iter().any(|p| p[k] <= window[k][1]) && points.iter().any(|p| p[k] >= window[k][0]))
}

/// Adds the small quads of a patch that are in the window, as four corners each.
fn add_pieces(patch: &Patch, sight: &Sight, window: [[f64; 2]; 2], quads: &mut Vec<f64>) {
    let Some(hull) = patch.control.iter().flatten().map(|p| sight.pixel(*p)).collect::<Option<Vec<_>>>()
    else {
        return;
    };
    if !touches(&hull, window) {
        return;
    }
    let extent = |k: usize| {
        let values = || hull.iter().map(|p| p[k]);
        values().fold(f64::MIN, chordal::math::greater) - values().fold(f64::MAX, chordal::math::lesser)
    };
    if extent(0) < FINE_PX && extent(1) < FINE_PX {
        quads.extend([hull[0], hull[3], hull[15], hull[12]].iter().flat_map(|p| [p[0], p[1]]));
        return;
    }
    let along = |step: usize| {
        let ends = if step == 1 { [hull[0], hull[3]] } else { [hull[0], hull[12]] };
        (ends[1][0] - ends[0][0]).abs() + (ends[1][1] - ends[0][1]).abs()
    };
    let halves = if along(1) > along(4) { patch.halves_u() } else { patch.halves_v() };
    halves.iter().for_each(|half| add_pieces(half, sight, window, quads));
}

/// The teapot with its foot on the desk.
fn teapot() -> Vec<Patch> {
    let scaled =
        |patch: Patch| Patch { control: patch.control.map(|row| row.map(|p| p.map(|x| METRES * x))) };
    let left =
        |patch: Patch| Patch { control: patch.control.map(|row| row.map(|[x, y, z]| [x - 0.13, y, z])) };
    shapes::teapot().into_iter().map(scaled).map(left).collect()
}

/// A massif 700 m above the eye, with ridges and hills, 3 km behind the teapot.
fn hills() -> Vec<Patch> {
    let land = Landscape { from: [-2400.0, BEHIND - 1200.0], n: [24, 12], side: 200.0 };
    let wave = |x: f64| sin_cos(x).0;
    land.patches(&|[x, y]| {
        let [x, y] = [(x - 350.0) / 1000.0, (y - BEHIND) / 1000.0];
        let massif = 1.0 / (1.0 + 1.6 * (x * x + y * y));
        let ridges = 0.62 + 0.24 * wave(4.3 * x + 1.8 * y + 0.4) + 0.2 * wave(6.1 * y - 4.7 * x + 1.0);
        700.0 * massif * ridges + 30.0 * wave(9.0 * x + 1.3) * wave(8.0 * y + 0.5) - 60.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(distance: f64, px: f64) -> serde_json::Value {
        let question = json!({ "exhibit": "mountain", "distance": distance, "px": px, "spot": [517, 637] });
        mountain(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn both_are_within_the_pixels_and_far_away_the_teapot_needs_few() {
        let [desk, street, coarse] = [at(1.0, 1.0), at(100.0, 1.0), at(1.0, 8.0)];
        for facts in [&desk, &street] {
            for name in ["teapot", "mountain"] {
                assert!(facts[name]["pixels"].as_f64().unwrap() <= 1.0, "{name}");
            }
        }
        let triangles = |facts: &serde_json::Value, name: &str| facts[name]["triangles"].as_u64().unwrap();
        assert!(triangles(&street, "teapot") < triangles(&desk, "teapot") / 4);
        assert!(triangles(&coarse, "mountain") < triangles(&desk, "mountain"));
        // A pixel is 3,000 times as long on the mountain.
        let allowed = |k: usize| desk["allowed"][k].as_f64().unwrap();
        assert!((allowed(1) / allowed(0) - 3001.0).abs() < 3.0);
    }

    #[test]
    fn the_loupe_shows_triangles_and_the_true_surface_around_its_spot() {
        let facts = at(1.0, 1.0);
        for what in ["loupe", "truth"] {
            let n = facts["teapot"][what]["f32"][1].as_u64().unwrap();
            assert!(n > 0 && n < 80_000, "{what} {n}");
        }
    }
}
