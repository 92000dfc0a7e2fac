//! Overshading: the shading work of a small screen for triangles of a given size.
use super::answer::ExhibitAnswer;
use super::picture_pair::{grey, pair_facts};
use super::plane::{once, or_text};
use super::request::ExhibitRequest;
use super::shapes;
use chordal::budget::camera::{Camera, Projection, Screen};
use chordal::check::shading::{Overshade, overshade as shaded};
use chordal::explicit::query::HitSides;
use chordal::{Job, Mesh};
use serde_json::json;
use std::sync::OnceLock;

/// The screen, in pixels: quads are 2 by 2.
const SCREEN: Screen = Screen { width_px: 36, height_px: 24 };
/// The range of the sides of triangles, in pixels.
const SIDES: [f64; 2] = [0.3, 16.0]; // defined: what the slider offers
/// The window with a ball, in pixels, and the ball's radius.
const WINDOW: Screen = Screen { width_px: 96, height_px: 64 };
const RADIUS: f64 = 28.0; // chosen: it fills the window
/// The rounds of subdivision of the finest ball: sides of half a pixel.
const FINEST: u32 = 6; // derived: the sides of an icosahedron in this ball are 29 pixels, and a round halves them
/// Meshes with more triangles are not drawn.
const DRAWN: usize = 3000; // chosen: the edges of more would be a grey area
/// The ratio of successive sides on the curve of costs.
const STEP: f64 = 0.85; // chosen: 25 of them

/// Answers `{"side": 4}`: a sheet of triangles with sides of that many pixels, and its shading work.
pub(super) fn overshade(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["side"])?;
    let side = request.number("side", SIDES)?;
    let sheet = sheet(side)?;
    let counts = counted(&sheet)?;
    static CURVE: OnceLock<Vec<(f64, f64)>> = OnceLock::new();
    let curve = once(&CURVE, costs)?;
    let mut answer = ExhibitAnswer::default();
    let drawn = if sheet.faces().len() <= DRAWN { answer.mesh(&sheet) } else { json!(null) };
    let ball = ball_facts(side, &mut answer)?;
    answer.facts = json!({
        "ball": ball,
        "mesh": drawn,
        "screen": [SCREEN.width_px, SCREEN.height_px],
        "launches": counts.launches,
        "columns": counts.quad_columns,
        "triangles": counts.in_view,
        "area_px": 0.25 * 3.0_f64.sqrt() * side * side,
        "missed": counts.missed,
        "missed_share": counts.missed as f64 / counts.in_view as f64,
        "micro_share": counts.micro_share(),
        "covered": counts.covered_px,
        "lanes": counts.visible.lanes(),
        "ratio": counts.ratio(),
        "curve": curve,
    });
    Ok(answer)
}

/// A ball of triangles with about these sides beside one with sides of half a pixel, a sample for each pixel.
fn ball_facts(side: f64, answer: &mut ExhibitAnswer) -> Result<serde_json::Value, String> {
    static BEST: OnceLock<Vec<u8>> = OnceLock::new();
    let camera = Camera {
        eye: [0.0, -100.0, 35.0],
        target: [0.0; 3],
        up: [0.0, 0.0, 1.0],
        near: 0.0,
        projection: Projection::Orthographic { height: 2.0 * 32.0 / RADIUS },
        screen: WINDOW,
    };
    let best = once(&BEST, || grey(&shapes::ball(FINEST)?, camera, 1))?;
    // 1.05 is the side of an icosahedron in a ball of radius one.
    let rounds = (0..=FINEST).find(|n| 1.05 * RADIUS / f64::from(1_u32 << n) <= 1.4 * side).unwrap_or(FINEST);
    let mesh = shapes::ball(rounds)?;
    let picture = grey(&mesh, camera, 1)?;
    let mut facts = pair_facts(&picture, best, &camera, answer);
    facts["triangles"] = json!(mesh.faces().len());
    facts["most"] = json!(20_u64 << (2 * FINEST));
    Ok(facts)
}

/// The lanes per pixel for each side, from the largest to the smallest.
fn costs() -> Result<Vec<(f64, f64)>, String> {
    let mut side = SIDES[1];
    let mut curve = Vec::new();
    while side >= SIDES[0] {
        curve.push((side, counted(&sheet(side)?)?.ratio()));
        side *= STEP;
    }
    Ok(curve)
}

fn counted(sheet: &Mesh) -> Result<Overshade, String> {
    let [w, h] = [SCREEN.width_px, SCREEN.height_px].map(|n| 0.5 * f64::from(n));
    let camera = Camera {
        eye: [w, h, 1.0],
        target: [w, h, 0.0],
        up: [0.0, 1.0, 0.0],
        near: 0.0,
        projection: Projection::Orthographic { height: 2.0 * h },
        screen: SCREEN,
    };
    or_text(shaded(sheet, &camera, HitSides::Both, &Job::default()))
}

/// Equal triangles that cover the screen, one unit a pixel, slightly rotated.
pub(super) fn sheet(side: f64) -> Result<Mesh, String> {
    let (sin, cos) = chordal::math::elementary::sin_cos(0.2); // chosen: no edge is parallel to a row of pixels
    let high = 0.5 * 3.0_f64.sqrt() * side;
    // The screen's half diagonal is below 22 pixels.
    let n = (22.0 / high) as i32 + 2;
    // Each row is shifted by half a triangle, and the outer ones have to reach across the screen too.
    let m = 2 * n;
    let at = |i: i32, j: i32| {
        let [x, y] = [side * (f64::from(i) + 0.5 * f64::from(j)), high * f64::from(j)];
        [cos * x - sin * y + 18.2, sin * x + cos * y + 12.1, 0.0]
    };
    let wide = (2 * m + 1) as u32;
    let positions = (-n..=n).flat_map(|j| (-m..=m).map(move |i| at(i, j))).collect();
    let cell = |j: u32, i: u32| {
        let a = j * wide + i;
        [[a, a + 1, a + wide], [a + 1, a + wide + 1, a + wide]]
    };
    let rows = 2 * n as u32;
    let faces = (0..rows).flat_map(|j| (0..wide - 1).flat_map(move |i| cell(j, i))).collect();
    shapes::mesh_from(positions, faces)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn below_a_pixel_the_picture_of_a_ball_stays_the_same() {
        let seen = |side: f64| {
            let question = json!({ "exhibit": "overshade", "side": side }).to_string();
            let answer = overshade(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap();
            answer.facts["ball"]["seen"].as_u64().unwrap()
        };
        let seen = [16.0, 4.0, 0.7, 0.3].map(seen);
        assert!(seen[0] > 200 && seen[0] > seen[1] && seen[1] > seen[2], "{seen:?}");
        assert!(seen[2] <= 20 && seen[3] == 0, "{seen:?}");
    }

    #[test]
    fn all_pixels_are_covered_and_the_cost_climbs_to_four_lanes_a_pixel() {
        let ratio = |side: f64| {
            let counts = counted(&sheet(side).unwrap()).unwrap();
            assert_eq!(counts.covered_px, 864);
            counts.ratio()
        };
        assert!(
            ratio(16.0) < 1.4 && ratio(2.0) > 1.8 && ratio(0.5) > 3.7,
            "{} {} {}",
            ratio(16.0),
            ratio(2.0),
            ratio(0.5)
        );
    }
}
