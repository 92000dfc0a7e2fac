//! Two meshes drawn by one camera, pixel by pixel, and how far the pictures differ.
use super::answer::ExhibitAnswer;
use chordal::budget::camera::Camera;
use chordal::render::{Background, RenderOptions, RenderStyle, UpAxis, Viewpoint, render};
use chordal::{Job, Mesh};
use serde_json::{Value, json};

/// The direction to the light.
const LIGHT: [f64; 3] = [0.36, -0.48, 0.8]; // defined: from the front, the right and above, of length one
/// The tone of what faces away from the light.
const DARK: f64 = 60.0; // chosen
/// The tone of the background.
const EMPTY: f64 = 255.0; // defined: white
/// The share of the light that reaches what faces it.
const LIT: f64 = 0.85; // chosen: lighter than that is background
/// Tones that differ by so many of 255 are told apart by no eye: less than one percent.
const SAME: u8 = 2; // chosen: Weber's law puts the threshold at one to two percent of a tone
/// The factor by which a difference is darkened in its picture.
const SHOWN: u8 = 16; // chosen: a difference of 16 of 255 is black

/// A grey picture, a byte for each pixel.
pub(super) fn grey(mesh: &Mesh, camera: Camera, samples: u32) -> Result<Vec<u8>, String> {
    let options = RenderOptions {
        // Normals alone: the light below costs nothing, and shadows would cost most of the time.
        show: RenderStyle::Normals,
        viewpoint: Viewpoint::Camera(camera),
        up: UpAxis::Z,
        background: Background::Transparent,
        samples,
        ..RenderOptions::sized(camera.screen.width_px, camera.screen.height_px)
    };
    let picture = render(mesh, &options, &Job::default()).map_err(|error| format!("{error:?}"))?;
    let tone = |pixel: &[u8]| {
        let normal = [0, 1, 2].map(|k| f64::from(pixel[k]) / 127.5 - 1.0);
        let cosine = (0..3).fold(0.0, |sum, k| sum + normal[k] * LIGHT[k]);
        let lit = DARK + (EMPTY - DARK) * cosine.clamp(0.0, 1.0) * LIT;
        let share = f64::from(pixel[3]) / 255.0;
        (share * lit + (1.0 - share) * EMPTY).round() as u8
    };
    Ok(picture.rgba.chunks_exact(4).map(tone).collect())
}

/// Both pictures, their difference, and how many pixels are covered in one alone, differ at all, and differ so that
/// an eye could tell.
pub(super) fn pair_facts(first: &[u8], second: &[u8], camera: &Camera, answer: &mut ExhibitAnswer) -> Value {
    let apart: Vec<u8> = first.iter().zip(second).map(|(a, b)| a.abs_diff(*b)).collect();
    let darkened: Vec<u8> = apart.iter().map(|d| 255 - d.saturating_mul(SHOWN)).collect();
    // Only the background is white.
    let outline = first.iter().zip(second).filter(|(a, b)| (**a == 255) != (**b == 255)).count();
    let covered = first.iter().zip(second).filter(|(a, b)| **a < 255 || **b < 255).count();
    let mut words = |grey: &[u8]| {
        let words: Vec<u32> = grey
            .chunks_exact(4)
            // An answer has arrays of 32-bit numbers alone: each holds four pixels.
            .map(|pixels| u32::from_le_bytes([pixels[0], pixels[1], pixels[2], pixels[3]]))
            .collect();
        answer.rows(&words)
    };
    json!({
        "width": camera.screen.width_px,
        "height": camera.screen.height_px,
        "pictures": [words(first), words(second), words(&darkened)],
        "covered": covered,
        "outline": outline,
        "differ": apart.iter().filter(|d| **d > 0).count(),
        "seen": apart.iter().filter(|d| **d > SAME).count(),
        "largest": apart.iter().max(),
    })
}
