//! Levels of detail: a teapot on the desk and a mountain behind it, each with an error of at most a pixel.
use super::answer::ExhibitAnswer;
use super::picture_pair::{grey, pair_facts};
use super::plane::{once, or_text};
use super::request::ExhibitRequest;
use super::shapes;
use chordal::budget::camera::{Camera, MinDistanceView, Projection, Screen};
use chordal::budget::{JobError, Pixels};
use chordal::convert::patches_to_mesh;
use chordal::explicit::Topology;
use chordal::lod::selection::SwitchDistances;
use chordal::lod::{LodLevel, LodSource, LodSteps, chain};
use chordal::math::Box3;
use chordal::{Budget, Failure, Job, Patch, Tolerance, View};
use serde_json::{Value, json};
use std::sync::OnceLock;

/// The range of the distance from the camera to the teapot, in metres.
const DISTANCES: [f64; 2] = [0.6, 20_000.0]; // defined: what the slider offers
/// The distance of the mountain behind the teapot, in metres.
const BEHIND: f64 = 3000.0; // defined: by the lesson
/// The scale of the teapot: 6.4 units are 0.26 metres.
const METRES: f64 = 0.04; // defined: by the lesson
const SCREEN: Screen = Screen { width_px: 1920, height_px: 1080 };
const LENS: Projection = Projection::Perspective { fov_y_deg: 45.0 };
/// The errors of the finest levels of both, in metres.
const FINEST: [f64; 2] = [0.00025, 1.3]; // chosen: a pixel from 0.6 m, and from 3 km

/// The window in which a model is compared with its finest level, in pixels of that screen.
const WINDOW: Screen = Screen { width_px: 320, height_px: 192 };
/// The elevation of the camera above the horizon, for that window.
const ELEVATION_DEG: f64 = 20.0; // chosen: as in the figure

struct Levels {
    all: Vec<LodLevel>,
    switches: SwitchDistances,
}

/// Answers `{"distance": 0.6}`: for both the level whose error is at most a pixel from there. With
/// `"compare": "teapot"` also that model, as large as it is on the screen, by this level and by the finest one.
pub(super) fn levels(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["distance", "compare"])?;
    let distance = request.number("distance", DISTANCES)?;
    static MADE: OnceLock<[Levels; 2]> = OnceLock::new();
    let models = once(&MADE, || Ok([teapot()?, mountain()?]))?;
    let mut answer = ExhibitAnswer::default();
    let [near, far] = [0, 1].map(|i| {
        let at = distance + if i == 0 { 0.0 } else { BEHIND };
        level_facts(&models[i], at, &mut answer)
    });
    let pair = match request.word_or("compare", &["none", "teapot", "mountain"], "none")? {
        "none" => Value::Null,
        "teapot" => compared(&models[0], distance, &mut answer)?,
        _ => compared(&models[1], distance + BEHIND, &mut answer)?,
    };
    answer.facts = json!({ "teapot": near, "mountain": far, "off_axis": off_axis()?, "pair": pair });
    Ok(answer)
}

fn level_facts(levels: &Levels, distance: f64, answer: &mut ExhibitAnswer) -> Value {
    let choice = levels.switches.at(distance, None);
    let level = &levels.all[choice.level];
    let ladder: Vec<Value> = levels
        .all
        .iter()
        .enumerate()
        .map(|(i, level)| json!([levels.switches.distance(i), level.mesh.faces().len(), level.error()]))
        .collect();
    json!({
        "mesh": answer.mesh(&level.mesh),
        "distance": distance,
        "level": choice.level,
        "levels": ladder,
        "triangles": level.mesh.faces().len(),
        "most": levels.all[0].mesh.faces().len(),
        "error": level.error(),
        "pixels": choice.pixels,
        "is_enough": choice.is_enough,
    })
}

/// The chosen level and the finest one, seen from no point of the model nearer than this distance.
fn compared(levels: &Levels, distance: f64, answer: &mut ExhibitAnswer) -> Result<Value, String> {
    let finest = &levels.all[0].mesh;
    let bounds = Box3::from_points(finest.positions());
    let centre = bounds.centre();
    let (sin, cos) = chordal::math::elementary::sin_cos(ELEVATION_DEG.to_radians());
    let away = distance + 0.5 * bounds.diagonal();
    // A window of the screen has the field of view of its share of the height.
    let (half_sin, half_cos) = chordal::math::elementary::sin_cos(22.5_f64.to_radians());
    let half = half_sin / half_cos * f64::from(WINDOW.height_px) / f64::from(SCREEN.height_px);
    let camera = Camera {
        eye: [centre[0], centre[1] - away * cos, centre[2] + away * sin],
        target: centre,
        up: [0.0, 0.0, 1.0],
        near: 0.0,
        projection: Projection::Perspective {
            fov_y_deg: 2.0 * chordal::math::elementary::atan2(half, 1.0).to_degrees(),
        },
        screen: WINDOW,
    };
    let chosen = &levels.all[levels.switches.at(distance, None).level].mesh;
    let [first, second] = [chosen, finest].map(|mesh| grey(mesh, camera, 2));
    Ok(pair_facts(&first?, &second?, &camera, answer))
}

fn with_switches(all: Vec<LodLevel>) -> Result<Levels, String> {
    let errors: Vec<f64> = all.iter().map(LodLevel::error).collect();
    // The distance of this view is not used.
    let lens = MinDistanceView { distance: 1.0, projection: LENS, screen: SCREEN };
    let switches = SwitchDistances::new(&errors, lens, or_text(Pixels::new(1.0))?);
    Ok(Levels { all, switches })
}

fn steps(finest: f64) -> Result<LodSteps, String> {
    let finest = or_text(Tolerance::new(finest))?;
    Ok(LodSteps { stop_at_triangles: 8, ..LodSteps::from_finest(finest) })
}

fn teapot() -> Result<Levels, String> {
    let scaled =
        |patch: Patch| Patch { control: patch.control.map(|row| row.map(|p| p.map(|x| METRES * x))) };
    let patches: Vec<Patch> = shapes::teapot().into_iter().map(scaled).collect();
    let job = Job::default();
    let mut make = |length| {
        patches_to_mesh(&patches, &Budget::length(length), &job).map_err(|failure| match failure {
            Failure::Refused(refusal) => JobError::Refused(refusal),
            _ => JobError::Cancelled,
        })
    };
    with_switches(or_text(chain(LodSource::Smooth(&mut make), &steps(FINEST[0])?, &job))?)
}

fn mountain() -> Result<Levels, String> {
    let mesh = shapes::mountain()?;
    with_switches(or_text(chain(
        LodSource::Triangles(&mesh, Topology::Indices),
        &steps(FINEST[1])?,
        &Job::default(),
    ))?)
}

/// The ratio of the pixels of a length in the corner of the picture to those in its middle, at the same
/// distance.
fn off_axis() -> Result<f64, String> {
    let camera = Camera {
        eye: [0.0; 3],
        target: [1.0, 0.0, 0.0],
        up: [0.0, 0.0, 1.0],
        near: 0.0,
        projection: LENS,
        screen: SCREEN,
    };
    let (sin, cos) = chordal::math::elementary::sin_cos(22.5_f64.to_radians());
    let (up, wide) = (sin / cos, sin / cos * 1920.0 / 1080.0);
    let far = (1.0 + up * up + wide * wide).sqrt();
    // At the same distance as the middle, and just within the picture.
    let corner = [1.0 / far, 0.999 * wide / far, 0.999 * up / far]; // chosen: the margin only avoids rounding
    let pixels = |at: [f64; 3]| View::Camera(camera).pixels_of(1e-6, &Box3 { min: at, max: at }); // chosen: small
    match (pixels(corner), pixels([1.0, 0.0, 0.0])) {
        (Some(corner), Some(middle)) => Ok(corner / middle),
        _ => Err("the picture has no corner".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn farther_away_fewer_triangles_are_within_a_pixel_and_the_mountain_needs_fewer_than_the_teapot_on_the_desk()
     {
        let at = |distance: f64| {
            let question =
                json!({ "exhibit": "levels", "distance": distance, "compare": "teapot" }).to_string();
            levels(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
        };
        let mut before = [u64::MAX; 2];
        for distance in [0.6, 1.0, 3.0, 10.0, 100.0, 10_000.0] {
            let facts = at(distance);
            for (name, before) in ["teapot", "mountain"].iter().zip(&mut before) {
                let model = &facts[name];
                let triangles = model["triangles"].as_u64().unwrap();
                assert!(triangles <= *before, "{name} at {distance}");
                assert!(
                    model["pixels"].as_f64().unwrap() <= 1.0 && model["is_enough"] == true,
                    "{name} at {distance}"
                );
                *before = triangles;
            }
            // The outlines of the teapot are within a pixel of each other. No bound is on its tones.
            let [covered, outline] =
                ["covered", "outline"].map(|name| facts["pair"][name].as_u64().unwrap() as f64);
            assert!(outline <= 6.0 * covered.sqrt(), "{outline} of {covered} pixels at {distance}");
        }
        let desk = at(0.6);
        assert!(desk["mountain"]["triangles"].as_u64() < desk["teapot"]["triangles"].as_u64());
        let factor = desk["off_axis"].as_f64().unwrap();
        assert!(factor > 1.5 && factor < 3.0, "{factor}");
    }
}
