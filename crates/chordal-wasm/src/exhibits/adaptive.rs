//! A surface meshed for one eye: cut equally, or by its bends, its distance and its outline.
use super::answer::ExhibitAnswer;
use super::landscape::Landscape;
use super::plane::or_text;
use super::request::ExhibitRequest;
use super::shapes;
use super::sight::Sight;
use chordal::budget::Pixels;
use chordal::budget::camera::{Camera, Projection, Screen};
use chordal::convert::outlines::{OutlineLimit, patches_to_mesh_by_outline};
use chordal::{Budget, Job, Mesh, Patch, Tolerance, View};
use serde_json::json;

/// The picture that pixels are counted in.
const SCREEN: Screen = Screen { width_px: 720, height_px: 480 };
const LENS: Projection = Projection::Perspective { fov_y_deg: 28.0 }; // defined: by the figures of the studio
/// Nothing nearer to the eye is drawn.
const NEAR: f64 = 0.25; // chosen: a quarter of the teapot's height
/// The range of the budget, in pixels.
const BUDGETS: [f64; 2] = [0.25, 16.0]; // defined: what the slider offers
/// How many times as many pixels the surface may be off where it has no outline.
const ELSEWHERE: f64 = 4.0; // chosen: a chord that is off by four pixels along the line of sight still hardly shows
/// The most cells along a side of a patch if all are cut equally.
const MOST_EQUAL: u32 = 16; // chosen: 53,000 triangles of the landscape are as many as a page draws quickly
/// The classes of triangles by their area on the screen, in pixels: from the largest.
const CLASSES: [f64; 5] = [1024.0, 256.0, 64.0, 16.0, 4.0]; // chosen: sides of about 45, 22, 11, 6 and 3 pixels

/// Answers `{"scene": "teapot", "px": 2, "eye": …, "target": …, "bends": true, …}`: the mesh and its triangles by size.
pub(super) fn adaptive(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["scene", "px", "eye", "target", "cuts"])?;
    let scene = request.word("scene", &["teapot", "landscape"])?;
    let patches = match scene {
        "teapot" => teapot(),
        _ => landscape(),
    };
    let px = or_text(Pixels::new(request.number("px", BUDGETS)?))?;
    let [eye, target] = [request.point::<3>("eye")?, request.point::<3>("target")?];
    let camera = Camera { eye, target, up: [0.0, 0.0, 1.0], near: NEAR, projection: LENS, screen: SCREEN };
    let view = or_text(View::Camera(camera).checked())?;
    let cuts = request.words("cuts", 3)?;
    let has = |cut: &str| cuts.contains(&cut);
    let mut answer = ExhibitAnswer::default();
    let (mesh, bound) = if has("bends") {
        let budget = match has("near") {
            true => Budget::pixels(px, view),
            false => Budget::length(nearest_length(&patches, px, &view)?),
        };
        let elsewhere = if has("outline") { ELSEWHERE } else { 1.0 };
        let limit = OutlineLimit { eye, elsewhere };
        let made = or_text(patches_to_mesh_by_outline(&patches, &budget, &limit, &Job::default()))?;
        (made.mesh.shape, made.outline_pixels.or(made.mesh.bound.pixels))
    } else {
        (equal_cuts(&patches, px, &view)?, None)
    };
    let (groups, counts) = by_size(&mesh, &Sight::new(&camera)?);
    let (shown, sizes) = (answer.mesh(&mesh), answer.rows(&groups));
    answer.facts = json!({
        "asked": { "scene": scene, "px": px.get(), "eye": eye, "cuts": cuts },
        "mesh": shown,
        "edges": answer.edges(mesh.positions(), mesh.faces()),
        "groups": sizes,
        "counts": counts,
        "triangles": mesh.faces().len(),
        "pixels": bound,
        "elsewhere": ELSEWHERE,
    });
    Ok(answer)
}

/// The length that the budget allows at the patch that allows least.
fn nearest_length(patches: &[Patch], px: Pixels, view: &View) -> Result<Tolerance, String> {
    let lengths = patches.iter().filter_map(|patch| view.length_of(px, &patch.bounds()));
    or_text(Tolerance::new(lengths.fold(f64::MAX, chordal::math::lesser)))
}

/// All patches cut into the same number of cells: as many as the one that needs most, by its second derivatives (D.
/// Filip, R. Magedson, R. Markot, 1986).
fn equal_cuts(patches: &[Patch], px: Pixels, view: &View) -> Result<Mesh, String> {
    let cells = patches.iter().filter_map(|patch| {
        let length = view.length_of(px, &patch.bounds())?;
        let [uu, uv, vv] = second_differences(patch);
        // For n by n cells: (uu + 2 uv + vv) / (8 n²).
        Some(((uu + 2.0 * uv + vv) / (8.0 * length)).sqrt())
    });
    let most = cells.fold(1.0, chordal::math::greater);
    let n = if most < f64::from(MOST_EQUAL) { most.ceil() as u32 } else { MOST_EQUAL };
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for patch in patches {
        let (start, wide) = (positions.len() as u32, n + 1);
        let at = |k: u32| f64::from(k) / f64::from(n);
        positions.extend((0..wide * wide).map(|k| patch.at(at(k % wide), at(k / wide))));
        let quads: Vec<[u32; 4]> = (0..n * n)
            .map(|k| start + k / n * wide + k % n)
            .map(|a| [a, a + 1, a + wide + 1, a + wide])
            .collect();
        faces.extend(shapes::from_quads(&quads));
    }
    shapes::mesh_from(positions, faces)
}

/// Upper bounds of the second derivatives along u, u and v, and v, from differences of the control points.
fn second_differences(patch: &Patch) -> [f64; 3] {
    let c = &patch.control;
    let length = |v: [f64; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    let mut most = [0.0; 3];
    let mut raise = |which: usize, v: [f64; 3]| most[which] = chordal::math::greater(length(v), most[which]);
    for (i, j) in (0..4).flat_map(|i| (0..2).map(move |j| (i, j))) {
        raise(0, std::array::from_fn(|k| 6.0 * (c[i][j][k] - 2.0 * c[i][j + 1][k] + c[i][j + 2][k])));
        raise(2, std::array::from_fn(|k| 6.0 * (c[j][i][k] - 2.0 * c[j + 1][i][k] + c[j + 2][i][k])));
    }
    for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
        let twist = |k: usize| c[i][j][k] - c[i + 1][j][k] - c[i][j + 1][k] + c[i + 1][j + 1][k];
        raise(1, std::array::from_fn(|k| 9.0 * twist(k)));
    }
    most
}

/// The class of each triangle by its area on the screen, and the number of triangles of each class.
fn by_size(mesh: &Mesh, sight: &Sight) -> (Vec<u32>, Vec<u32>) {
    let pixels: Vec<_> = mesh.positions().iter().map(|p| sight.pixel(*p)).collect();
    let mut counts = vec![0; CLASSES.len() + 1];
    let class = |face: &[u32; 3]| {
        let [Some(a), Some(b), Some(c)] = face.map(|row| pixels[row as usize]) else { return 0 };
        let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
        CLASSES.iter().filter(|least| area < **least).count()
    };
    let groups: Vec<u32> = mesh.faces().iter().map(|face| class(face) as u32).collect();
    groups.iter().for_each(|group| counts[*group as usize] += 1);
    (groups, counts)
}

/// The teapot, one unit high.
fn teapot() -> Vec<Patch> {
    /// Its height is 3.15 units.
    const SCALE: f64 = 1.0 / 3.15; // derived
    let scaled = |patch: Patch| Patch { control: patch.control.map(|row| row.map(|p| p.map(|x| SCALE * x))) };
    shapes::teapot().into_iter().map(scaled).collect()
}

/// The teapot on a plain before hills.
fn landscape() -> Vec<Patch> {
    let land = Landscape { from: [-12.0, -4.0], n: [8, 10], side: 3.0 };
    let hills = |[x, y]: [f64; 2]| {
        let wave = |x: f64| chordal::math::elementary::sin_cos(x).0;
        // Flat around the teapot, and higher with the distance.
        let rise = chordal::math::greater((y - 3.0) / 23.0, 0.0);
        4.0 * rise
            * (0.5 + 0.35 * wave(0.55 * x + 1.2) + 0.3 * wave(0.5 * y - 0.35 * x) + 0.15 * wave(1.3 * x))
    };
    let mut patches = teapot();
    patches.extend(land.patches(&hills));
    patches
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(scene: &str, cuts: &[&str]) -> serde_json::Value {
        let question = json!({
            "exhibit": "adaptive", "scene": scene, "px": 2, "eye": [0.5, -5.0, 1.6], "target": [0, 0.5, 0.5], "cuts": cuts,
        });
        adaptive(&ExhibitRequest::parse(question.to_string().as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn each_cause_saves_triangles_and_the_outline_stays_within_the_pixels() {
        for scene in ["teapot", "landscape"] {
            let all: [&[&str]; 4] = [&[], &["bends"], &["bends", "near"], &["bends", "near", "outline"]];
            let counts = all.map(|cuts| at(scene, cuts)["triangles"].as_u64().unwrap());
            // Equal cuts of teapot and hills end at the most that a figure may have, and miss the pixels.
            let first = usize::from(scene == "landscape");
            assert!(counts[first..].is_sorted_by(|a, b| a > b), "{scene} {counts:?}");
            let facts = at(scene, all[3]);
            assert!(facts["pixels"].as_f64().unwrap() <= 2.0);
            let sizes = facts["counts"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap());
            assert_eq!(sizes.sum::<u64>(), counts[3]);
        }
    }

    #[test]
    fn second_differences_bound_the_second_derivatives() {
        for patch in shapes::teapot() {
            let bounds = second_differences(&patch);
            for (u, v) in [(0.0, 0.0), (0.3, 0.8), (1.0, 0.5), (0.5, 0.5)] {
                for (second, bound) in patch.second_derivatives(u, v).iter().zip(bounds) {
                    let length = (0..3).map(|k| second[k] * second[k]).sum::<f64>().sqrt();
                    assert!(length <= bound + 1e-9, "{length} {bound}"); // rounding: a few ulps of 1e3
                }
            }
        }
    }
}
