//! What a smooth and a rough ball of 1 to 10,000,000 triangles cost a graphics processor on a screen of 1920
//! × 1080, as a table for docs/overshade.md: `cargo run --release -p chordal --example overshade`.
use chordal::budget::camera::{Camera, Projection, Screen};
use chordal::check::shading::{flicker, overshade};
use chordal::explicit::query::HitSides;
use chordal::{Job, Mesh};
use std::time::Instant;

/// The sphere of radius 1 from the sides of an octahedron, each cut into n² triangles; `lift` says how far
/// out a point is.
fn ball(n: u32, lift: impl Fn([f64; 3]) -> f64) -> Mesh {
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for signs in 0..8_u32 {
        let sign = [0, 1, 2].map(|k| if signs >> k & 1 == 0 { 1.0 } else { -1.0 });
        let first = positions.len() as u32;
        let row = |i: u32, j: u32| first + i * (n + 1) - i * i.saturating_sub(1) / 2 + j;
        for (i, j) in (0..=n).flat_map(|i| (0..=n - i).map(move |j| (i, j))) {
            let flat = [i, j, n - i - j].map(f64::from);
            let length = flat.iter().map(|x| x * x).sum::<f64>().sqrt();
            let at = [0, 1, 2].map(|k| sign[k] * flat[k] / length);
            positions.push(at.map(|x| x * lift(at)));
        }
        let outward = signs.count_ones() % 2 == 0;
        let mut add = |[a, b, c]: [u32; 3]| faces.push(if outward { [a, b, c] } else { [a, c, b] });
        for (i, j) in (0..n).flat_map(|i| (0..n - i).map(move |j| (i, j))) {
            add([row(i, j), row(i + 1, j), row(i, j + 1)]);
            if i + j + 2 <= n {
                add([row(i + 1, j), row(i + 1, j + 1), row(i, j + 1)]);
            }
        }
    }
    Mesh::new(positions, faces).expect("finite")
}

/// Waves of ever less length and as steep as each other, down to a third of a pixel: detail without end, for
/// this screen.
fn rough([x, y, z]: [f64; 3]) -> f64 {
    (0..12).fold(1.0, |sum, octave| {
        let rate = 4.0 * f64::from(1_u32 << octave);
        let turn = f64::from(octave);
        let waves =
            libm::sin(rate * x + turn) * libm::sin(rate * y + 2.0 * turn) * libm::sin(rate * z + 3.0 * turn);
        sum + 0.3 / rate * waves
    })
}

fn main() {
    let job = Job::default();
    let camera = Camera {
        eye: [1.6, 1.3, 3.2],
        target: [0.0; 3],
        up: [0.0, 1.0, 0.0],
        near: 0.0,
        projection: Projection::Perspective { fov_y_deg: 34.0 },
        screen: Screen { width_px: 1920, height_px: 1080 },
    };
    println!(
        "| triangles | pixels | quads | helper lanes | lanes a pixel | missed | under a pixel | flicker | of a rough ball | seconds |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for n in [0, 1, 4, 11, 35, 112, 354, 1118] {
        let of = |lift: &dyn Fn([f64; 3]) -> f64| match n {
            0 => Mesh::new(vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], vec![[0, 1, 2]])
                .expect("finite"),
            n => ball(n, lift),
        };
        let smooth = of(&|_| 1.0);
        let start = Instant::now();
        let found = overshade(&smooth, &camera, HitSides::Front, &job).expect("fits");
        let seconds = start.elapsed().as_secs_f64();
        let flickers = [smooth, of(&rough)]
            .map(|mesh| flicker(&mesh, &camera, HitSides::Front, &job).expect("fits").rms);
        println!(
            "| {} | {} | {} | {:.1} % | {:.2} | {:.1} % | {:.1} % | {:.2} % | {:.2} % | {:.3} |",
            found.n_triangles,
            found.covered_px,
            found.visible.quads,
            100.0 * found.visible.helper_share(),
            found.ratio(),
            100.0 * found.missed as f64 / found.in_view as f64,
            100.0 * found.micro_share(),
            100.0 * flickers[0],
            100.0 * flickers[1],
            seconds
        );
    }
}
