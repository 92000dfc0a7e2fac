//! Overshading: what a screen of few pixels shades for triangles of a size.
use super::answer::ExhibitAnswer;
use super::plane::{once, told};
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
/// Sides of triangles, in pixels.
const SIDES: [f64; 2] = [0.3, 16.0]; // defined: what the slider offers
/// More edges than this are a grey, and are not drawn.
const DRAWN: usize = 3000; // chosen
/// Each side on the curve of costs is so much shorter than the one before.
const STEP: f64 = 0.85; // chosen: 25 of them

/// Answers `{"side": 4}`: a sheet of triangles with sides of so many pixels, and what is shaded for it.
pub(super) fn overshade(asked: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    asked.only(&["side"])?;
    let side = asked.number("side", SIDES)?;
    let sheet = sheet(side)?;
    let found = counted(&sheet)?;
    static CURVE: OnceLock<Vec<(f64, f64)>> = OnceLock::new();
    let curve = once(&CURVE, costs)?;
    let mut answer = ExhibitAnswer::default();
    let drawn = if sheet.faces().len() <= DRAWN { answer.mesh(&sheet) } else { json!(null) };
    answer.facts = json!({
        "mesh": drawn,
        "screen": [SCREEN.width_px, SCREEN.height_px],
        "launches": found.launches,
        "columns": found.quad_columns,
        "triangles": found.in_view,
        "area_px": 0.25 * 3.0_f64.sqrt() * side * side,
        "missed": found.missed,
        "missed_share": found.missed as f64 / found.in_view as f64,
        "micro_share": found.micro_share(),
        "covered": found.covered_px,
        "lanes": found.visible.lanes(),
        "ratio": found.ratio(),
        "curve": curve,
    });
    Ok(answer)
}

/// The cost of triangles from the largest sides to the smallest.
fn costs() -> Result<Vec<(f64, f64)>, String> {
    let mut side = SIDES[1];
    let mut all = Vec::new();
    while side >= SIDES[0] {
        all.push((side, counted(&sheet(side)?)?.ratio()));
        side *= STEP;
    }
    Ok(all)
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
    told(shaded(sheet, &camera, HitSides::Both, &Job::default()))
}

/// Equal triangles that cover the screen, a unit a pixel, somewhat turned as those of a surface are.
pub(super) fn sheet(side: f64) -> Result<Mesh, String> {
    let (sin, cos) = chordal::math::elementary::sin_cos(0.2); // chosen: along no row of pixels
    let high = 0.5 * 3.0_f64.sqrt() * side;
    // The screen's half diagonal is below 22 pixels.
    let n = (22.0 / high) as i32 + 2;
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
    shapes::made(positions, (0..rows).flat_map(|j| (0..wide - 1).flat_map(move |i| cell(j, i))).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_pixels_are_covered_and_the_cost_climbs_to_four_lanes_a_pixel() {
        let ratio = |side: f64| {
            let found = counted(&sheet(side).unwrap()).unwrap();
            assert_eq!(found.covered_px, 864);
            found.ratio()
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
