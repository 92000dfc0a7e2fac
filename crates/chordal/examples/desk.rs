//! A teapot on a desk and a mountain 3 km away, each within one pixel of its own and within the length of the
//! nearest.
//!
//! `cargo run --release -p chordal --example desk examples/teapot.bpt given.obj > desk.obj` writes the
//! triangles of all three as they are to begin with, and those within a pixel; the table of `docs/by_view.md`
//! goes to stderr. Units are metres.
use chordal::budget::View;
use chordal::budget::camera::{Camera, Projection};
use chordal::explicit::Topology;
use chordal::lod::simplify;
use chordal::{Budget, Job, Mesh, Patch, Tolerance, convert};
use std::io::Write;

/// Where one sits: the middle of the picture is level.
const VIEW: &str = "1920x1080 fov=45 eye=0,0,1.25 target=3000,0,1.25";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file =
        std::env::args().nth(1).ok_or("the first argument is the file of the teapot, examples/teapot.bpt")?;
    let job = Job::default();
    let things =
        [("teapot", teapot(&std::fs::read_to_string(file)?)?), ("desk", desk()?), ("mountain", mountain()?)];
    let budget = Budget::pixels("1px".parse()?, VIEW.parse()?);
    let Some(View::Camera(camera)) = budget.pixels.map(|pixels| pixels.view) else {
        return Err("no camera".into());
    };
    let by_view: Vec<_> = things
        .iter()
        .map(|(name, mesh)| Ok((*name, simplify(mesh, &budget, Topology::Indices, &job)?)))
        .collect::<Result<_, Box<dyn std::error::Error>>>()?;
    write(&mut std::io::stdout().lock(), by_view.iter().map(|(name, made)| (*name, &made.shape.mesh)))?;
    if let Some(file) = std::env::args().nth(2) {
        write(&mut std::fs::File::create(file)?, things.iter().map(|(name, mesh)| (*name, mesh)))?;
    }
    let worst = things.iter().filter_map(|(_, mesh)| budget.length_in(&mesh.bounds()));
    let everywhere = worst.fold(f64::INFINITY, f64::min);
    eprintln!("one length for all: {everywhere:e} m");
    eprintln!("| object | given | within its own pixel | with one length for all | proved | longest edge |");
    for ((name, mesh), (_, by_view)) in things.iter().zip(&by_view) {
        let alike = simplify(mesh, &Budget::length(Tolerance::new(everywhere)?), Topology::Indices, &job)?;
        eprintln!(
            "| {name} | {} | {} | {} | {:.3} px, {:.2e} m | {:.0} px |",
            mesh.faces().len(),
            by_view.shape.mesh.faces().len(),
            alike.shape.mesh.faces().len(),
            by_view.bound.pixels.unwrap_or(f64::NAN),
            by_view.bound.at_most().unwrap_or(f64::NAN),
            longest_edge(&by_view.shape.mesh, &camera),
        );
    }
    Ok(())
}

/// Objects of an OBJ file.
fn write<'a>(
    out: &mut dyn Write,
    things: impl Iterator<Item = (&'static str, &'a Mesh)>,
) -> Result<(), std::io::Error> {
    let mut out = std::io::BufWriter::new(out);
    let mut first = 1;
    for (name, mesh) in things {
        writeln!(out, "o {name}")?;
        for [x, y, z] in mesh.positions() {
            writeln!(out, "v {x} {y} {z}")?;
        }
        for [a, b, c] in mesh.faces() {
            writeln!(out, "f {} {} {}", a + first, b + first, c + first)?;
        }
        first += mesh.positions().len() as u32;
    }
    out.flush()
}

/// Newell's teapot, 30 cm wide, on the desk; finer than anybody sees.
fn teapot(text: &str) -> Result<Mesh, Box<dyn std::error::Error>> {
    let mut numbers = text.split_whitespace().map(str::parse::<f64>);
    let mut next = || numbers.next().ok_or("the file ends too early")?.map_err(|_| "no number");
    let n_patches = next()? as usize;
    let mut patches = Vec::new();
    for _ in 0..n_patches {
        next()?;
        next()?;
        let mut control = [[[0.0; 3]; 4]; 4];
        for point in control.as_flattened_mut() {
            let [x, y, z] = [next()?, next()?, next()?].map(|x| 0.3 / 6.4 * x);
            // Turned, so that spout and handle are to the left and right.
            *point = [1.05 - y, 0.15 + x, DESK + z];
        }
        patches.push(Patch { control });
    }
    let budget = Budget::length(Tolerance::new(2e-5)?);
    Ok(convert::patches_to_mesh(&patches, &budget, &Job::default())?.shape)
}

/// The height of the desk's top.
const DESK: f64 = 0.9;

/// A board, in cells of 2 cm.
fn desk() -> Result<Mesh, Box<dyn std::error::Error>> {
    Ok(heights([40, 80], |u, v| [0.75 + 0.8 * u, 1.6 * v - 0.8, DESK])?)
}

/// Ridges and gullies on a cone 1 km high, over 4 × 5 km.
fn mountain() -> Result<Mesh, Box<dyn std::error::Error>> {
    Ok(heights([400, 500], |u, v| {
        let (x, y) = (1200.0 + 4000.0 * u, 5000.0 * v - 2500.0);
        let far = (((x - 3100.0) / 1500.0).powi(2) + ((y - 200.0) / 1300.0).powi(2)).sqrt();
        let cone = if far < 1.0 { (1.0 - far).powf(1.2) } else { 0.0 };
        let (mut rough, mut size, mut most) = (0.0, 700.0, 0.5);
        for _ in 0..7 {
            let n = noise(x / size, y / size);
            rough += most * (1.0 - (2.0 * n - 1.0).abs());
            size *= 0.5;
            most *= 0.48;
        }
        [x, y, 620.0 * cone + (60.0 + 560.0 * cone) * rough - 60.0]
    })?)
}

fn heights(
    [n, m]: [u32; 2],
    at: impl Fn(f64, f64) -> [f64; 3],
) -> Result<Mesh, chordal::explicit::InvalidMesh> {
    let (at, share) = (&at, |i: u32, n: u32| f64::from(i) / f64::from(n));
    let positions = (0..=n).flat_map(|i| (0..=m).map(move |j| at(share(i, n), share(j, m)))).collect();
    let cell = |i: u32, j: u32| {
        let a = i * (m + 1) + j;
        let b = a + m + 1;
        [[a, b, b + 1], [a, b + 1, a + 1]]
    };
    Mesh::new(positions, (0..n).flat_map(|i| (0..m).flat_map(move |j| cell(i, j))).collect())
}

/// Smooth between random numbers at whole places.
fn noise(x: f64, y: f64) -> f64 {
    let (i, j) = (x.floor(), y.floor());
    let ease = |t: f64| t * t * t * (t * (6.0 * t - 15.0) + 10.0);
    let (u, v) = (ease(x - i), ease(y - j));
    let at = |di: f64, dj: f64| {
        let mut n = ((i + di) as i64 as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
            ^ ((j + dj) as i64 as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
        n = (n ^ n >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        ((n ^ n >> 32) >> 11) as f64 / (1_u64 << 53) as f64
    };
    let low = at(0.0, 0.0) * (1.0 - u) + at(1.0, 0.0) * u;
    let high = at(0.0, 1.0) * (1.0 - u) + at(1.0, 1.0) * u;
    low * (1.0 - v) + high * v
}

/// The longest edge of a mesh on the screen, in pixels, of those with both ends before the eye, which looks
/// along x.
fn longest_edge(mesh: &Mesh, camera: &Camera) -> f64 {
    let Projection::Perspective { fov_y_deg } = camera.projection else { return f64::NAN };
    let focal = 0.5 * f64::from(camera.screen.height_px) / (0.5 * fov_y_deg.to_radians()).tan();
    let at = |row: u32| {
        let p = mesh.positions()[row as usize];
        let [x, y, z] = std::array::from_fn(|k| p[k] - camera.eye[k]);
        (x > 0.0).then_some([y * focal / x, z * focal / x])
    };
    let edges = mesh.faces().iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]);
    let lengths = edges.filter_map(|[a, b]| Some((at(a)?, at(b)?)));
    lengths.map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max)
}
