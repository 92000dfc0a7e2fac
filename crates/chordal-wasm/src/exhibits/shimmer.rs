//! A relief that turns, drawn with one sample for each pixel, by triangles of several sizes.
use super::answer::ExhibitAnswer;
use super::plane::{once, or_text};
use super::request::ExhibitRequest;
use super::shapes;
use super::sight::{cross, dot};
use chordal::budget::camera::{Camera, Projection, Screen};
use chordal::check::shading::{flicker, overshade};
use chordal::explicit::Topology;
use chordal::explicit::query::{Bvh, HitSides, Ray};
use chordal::lod::count::{Effort, simplify_to_count};
use chordal::math::{elementary::sin_cos, unit};
use chordal::{Job, Mesh};
use serde_json::json;
use std::sync::OnceLock;

/// The picture.
const SCREEN: Screen = Screen { width_px: 44, height_px: 44 };
/// Half the side of the relief, in pixels. Chosen: turned to either side it stays within the picture.
const HALF: f64 = 19.0;
/// The sides of its triangles, in pixels: of the finest, and those it is simplified to.
const SIDES: [f64; 4] = [0.25, 1.0, 2.0, 4.0]; // defined: by the lesson, and two between
/// The turn between two frames, in degrees.
const STEP_DEG: f64 = 0.5; // chosen: the border moves by less than a pixel
/// Frames from one end of the turn to the other.
const FRAMES: f64 = 120.0; // derived: 30 degrees to either side
/// A pixel flickers if its shade changes by more than this, where 1 is from black to white.
const FLICKERS: f64 = 0.1; // chosen: clearly seen

/// Answers `{"size": 0, "frame": 60}`: this frame and the next one, and the pixels that change.
pub(super) fn shimmer(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["size", "frame"])?;
    let size = request.number("size", [0.0, SIDES.len() as f64 - 1.0])? as usize;
    let frame = request.number("frame", [0.0, FRAMES])?.round();
    static MADE: OnceLock<Vec<Relief>> = OnceLock::new();
    let reliefs = once(&MADE, reliefs)?;
    let relief = &reliefs[size];
    let pictures = [frame, frame + 1.0].map(|frame| relief.picture(frame));
    let changes: Vec<u32> =
        pictures[0].iter().zip(&pictures[1]).map(|(a, b)| u32::from(changes(*a, *b))).collect();
    let covered = pictures[0].iter().zip(&pictures[1]).filter(|(a, b)| a.is_some() && b.is_some()).count();
    let mut answer = ExhibitAnswer::default();
    let shown = pictures.map(|picture| answer.rows(&words(&picture)));
    answer.facts = json!({
        "width": SCREEN.width_px,
        "height": SCREEN.height_px,
        "frames": shown,
        "changed": answer.rows(&changes),
        "flickering": changes.iter().sum::<u32>(),
        "covered": covered,
        "rms": relief.rms,
        "triangles": relief.mesh.faces().len(),
        "missed": relief.missed,
        "side": SIDES[size],
        "all": reliefs.iter().map(|relief| relief.mean).collect::<Vec<_>>(),
    });
    Ok(answer)
}

/// A mesh prepared for rays.
struct Relief {
    mesh: Mesh,
    tree: Bvh,
    shades: Vec<[f64; 3]>,
    /// The mean number of flickering pixels over every twelfth frame.
    mean: f64,
    /// The noise below the pixel, and the triangles without a pixel, from the middle of the turn.
    rms: f64,
    missed: u64,
}

fn reliefs() -> Result<Vec<Relief>, String> {
    let finest = relief_mesh()?;
    let mut all = vec![Relief::new(finest.clone())?];
    for side in &SIDES[1..] {
        // Two triangles for each square of this side.
        let most = (2.0 * (2.0 * HALF / side) * (2.0 * HALF / side)) as u64;
        let made = simplify_to_count(&finest, most, Effort::Fast, Topology::Indices, &Job::default());
        all.push(Relief::new(or_text(made)?.shape.mesh)?);
    }
    Ok(all)
}

impl Relief {
    fn new(mesh: Mesh) -> Result<Self, String> {
        let tree = or_text(Bvh::build(&mesh, &Job::default()))?;
        let normal = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|row| mesh.positions()[row as usize]);
            let side = |p: [f64; 3]| std::array::from_fn(|k| p[k] - a[k]);
            unit(cross(side(b), side(c))).unwrap_or_default()
        };
        let shades = mesh.faces().iter().map(normal).collect();
        let camera = camera(0.5 * FRAMES);
        let counts = or_text(overshade(&mesh, &camera, HitSides::Both, &Job::default()))?;
        let noise = or_text(flicker(&mesh, &camera, HitSides::Both, &Job::default()))?;
        let mut relief = Self { mesh, tree, shades, mean: 0.0, rms: noise.rms, missed: counts.missed };
        let starts = (0..FRAMES as usize).step_by(12);
        let counts: Vec<usize> = starts.map(|k| relief.flickering(k as f64)).collect();
        relief.mean = counts.iter().sum::<usize>() as f64 / counts.len() as f64;
        Ok(relief)
    }

    fn flickering(&self, frame: f64) -> usize {
        let [a, b] = [frame, frame + 1.0].map(|frame| self.picture(frame));
        a.iter().zip(&b).filter(|(a, b)| changes(**a, **b)).count()
    }

    /// The shade of each pixel: of the triangle at its centre, lit from the upper left; `None` where there is none.
    fn picture(&self, frame: f64) -> Vec<Option<f64>> {
        let Eye { right, up, back } = Eye::at(frame);
        let light = unit(std::array::from_fn(|k| up[k] - right[k] + 2.0 * back[k])).unwrap_or_default();
        let [w, h] = [SCREEN.width_px, SCREEN.height_px];
        let ray = |row: u32| {
            let x = f64::from(row % w) + 0.5 - 0.5 * f64::from(w);
            let y = 0.5 * f64::from(h) - f64::from(row / w) - 0.5;
            let from = std::array::from_fn(|k| AWAY * back[k] + x * right[k] + y * up[k]);
            Ray::new(from, back.map(|c| -c))
        };
        let hits = (0..w * h).map(|row| self.tree.first_hit(&ray(row)));
        hits.map(|hit| hit.map(|hit| 0.5 + 0.5 * dot(self.shades[hit.face as usize], light))).collect()
    }
}

/// The distance of the eye.
const AWAY: f64 = 60.0; // chosen: outside of the relief

/// The axes of the picture.
struct Eye {
    right: [f64; 3],
    up: [f64; 3],
    back: [f64; 3],
}

impl Eye {
    /// It goes round the relief, a little above it.
    fn at(frame: f64) -> Self {
        let (sin, cos) = sin_cos((STEP_DEG * (frame - 0.5 * FRAMES)).to_radians());
        let (low, high) = sin_cos(0.2); // chosen: rows of the relief are not parallel to those of pixels
        let back = [high * sin, low, high * cos];
        let right = [cos, 0.0, -sin];
        Self { right, up: cross(back, right), back }
    }
}

fn camera(frame: f64) -> Camera {
    let Eye { up, back, .. } = Eye::at(frame);
    Camera {
        eye: back.map(|x| AWAY * x),
        target: [0.0; 3],
        up,
        near: 0.0,
        projection: Projection::Orthographic { height: f64::from(SCREEN.height_px) },
        screen: SCREEN,
    }
}

fn changes(a: Option<f64>, b: Option<f64>) -> bool {
    matches!((a, b), (Some(a), Some(b)) if (a - b).abs() > FLICKERS)
}

/// A medallion with waves of all lengths down to half a pixel, of which the finest triangles show all.
fn relief_mesh() -> Result<Mesh, String> {
    let n = (2.0 * HALF / SIDES[0]).round() as u32;
    let wave = |x: f64| sin_cos(x).0;
    let height = |x: f64, y: f64| {
        let far = x * x + y * y;
        let dome = 4.0 * (1.0 - far / (2.0 * HALF * HALF));
        let coarse = 0.9 * wave(0.42 * x + 0.3 * wave(0.3 * y)) * wave(0.38 * y);
        let fine = 0.16 * wave(5.1 * x + 1.7 * y) * wave(4.6 * y - 1.1 * x + 2.0);
        dome + coarse + fine
    };
    let place = |k: u32| HALF * (2.0 * f64::from(k) / f64::from(n) - 1.0);
    let wide = n + 1;
    let positions = (0..wide * wide).map(|row| {
        let [x, y] = [place(row % wide), place(row / wide)];
        [x, y, height(x, y)]
    });
    let quads: Vec<[u32; 4]> = (0..n * n)
        .map(|cell| cell / n * wide + cell % n)
        .map(|a| [a, a + 1, a + wide + 1, a + wide])
        .collect();
    shapes::mesh_from(positions.collect(), shapes::from_quads(&quads))
}

/// Greys, four pixels a word; where nothing is drawn, a light one.
fn words(picture: &[Option<f64>]) -> Vec<u32> {
    let byte = |shade: &Option<f64>| shade.map_or(0xee, |shade| (255.0 * shade).round() as u8);
    let bytes: Vec<u8> = picture.iter().map(byte).collect();
    bytes.chunks_exact(4).map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_finest_triangles_flicker_most_and_those_of_four_pixels_hardly() {
        let at = |size: usize| {
            let question = json!({ "exhibit": "shimmer", "size": size, "frame": 60 }).to_string();
            shimmer(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
        };
        let [fine, coarse] = [at(0), at(3)];
        let number = |facts: &serde_json::Value, name: &str| facts[name].as_f64().unwrap();
        assert!(
            number(&fine, "flickering") > 10.0 * number(&coarse, "flickering").max(1.0),
            "{fine} {coarse}"
        );
        assert!(number(&fine, "rms") > 3.0 * number(&coarse, "rms"));
        assert!(number(&fine, "triangles") > 40_000.0 && number(&coarse, "triangles") < 200.0);
    }
}
