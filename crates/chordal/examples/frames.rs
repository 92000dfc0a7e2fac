//! Sixty frames of a camera that goes a quarter around a shape and comes nearer, from six of its radii to two: the time and
//! the triangles of each mesh made anew, and of one that keeps the tiles of the frame before.
//!
//! `cargo run --release -p chordal --example frames examples/teapot.bpt [CAGE.obj ...]` prints rows of numbers between tabs:
//! shape, pixels, threads, then made anew and kept: milliseconds a frame in the mean, milliseconds of the slowest but the
//! first, triangles in the mean; and the part of the tiles that was kept. Both are timed in turns.
use chordal::budget::Pixels;
use chordal::convert::batch::{CageMesher, ViewDependentMesher};
use chordal::explicit::Cage;
use chordal::{Budget, Job, Mesh, Patch, View, convert};
use std::error::Error;
use std::time::Instant;

type Outcome<T> = Result<T, Box<dyn Error>>;

/// Frames of the path.
const FRAMES: u32 = 60;
/// Pixels that are asked for.
const PIXELS: [f64; 2] = [1.0, 0.25];

fn main() -> Outcome<()> {
    let mut files = std::env::args().skip(1);
    let teapot = files.next().ok_or("the first argument is the file of the teapot, examples/teapot.bpt")?;
    let patches = patches(&std::fs::read_to_string(teapot)?)?;
    let mut cages = vec![("torus of 1,152 quads".to_owned(), torus([48, 24])?)];
    for file in files {
        let name = file.rsplit('/').next().unwrap_or(&file).to_owned();
        cages.push((name, polygons(&std::fs::read_to_string(&file)?)?));
    }
    for threads in [1, 2] {
        let job = Job::default().with_threads(threads);
        for pixels in PIXELS {
            let control: Vec<[f64; 3]> = patches.iter().flat_map(|patch| patch.control.concat()).collect();
            let path = Path { around: Ball::around(&control), pixels };
            let anew = |budget: &Budget| Ok(convert::patches_to_mesh(&patches, budget, &job)?.shape);
            path.run("teapot, 32 patches", ViewDependentMesher::from_patches(&patches)?, anew, &job)?;
            for (name, cage) in &cages {
                let path = Path { around: Ball::around(cage.positions()), pixels };
                let mesher = CageMesher::new(cage, &job)?;
                let anew = |budget: &Budget| Ok(mesher.mesh(budget, &job)?.shape);
                path.run(name, ViewDependentMesher::from_cage(&mesher), anew, &job)?;
            }
        }
    }
    Ok(())
}

/// A ball around a shape.
struct Ball {
    middle: [f64; 3],
    radius: f64,
}

impl Ball {
    fn around(points: &[[f64; 3]]) -> Self {
        let axis = |k: usize| points.iter().map(move |point| point[k]);
        let low = [0, 1, 2].map(|k| axis(k).fold(f64::INFINITY, f64::min));
        let high = [0, 1, 2].map(|k| axis(k).fold(f64::NEG_INFINITY, f64::max));
        let square: f64 = (0..3).map(|k| (high[k] - low[k]) * (high[k] - low[k])).sum();
        Self { middle: [0, 1, 2].map(|k| 0.5 * (low[k] + high[k])), radius: 0.5 * square.sqrt() }
    }
}

/// Times of frames in milliseconds, and their triangles.
#[derive(Default)]
struct FrameCosts {
    times: Vec<f64>,
    triangles: usize,
}

impl FrameCosts {
    fn add(&mut self, frame: impl FnOnce() -> Outcome<Mesh>) -> Outcome<()> {
        let begin = Instant::now();
        let mesh = frame()?;
        self.times.push(1e3 * begin.elapsed().as_secs_f64());
        self.triangles += mesh.faces().len();
        Ok(())
    }

    /// The mean and the most of all frames but the first, and triangles.
    fn row(&self) -> String {
        let later = &self.times[1..];
        let mean = later.iter().sum::<f64>() / later.len() as f64;
        let most = later.iter().copied().fold(0.0, f64::max);
        format!("{mean:.2}\t{most:.2}\t{}", self.triangles / self.times.len())
    }
}

struct Path {
    around: Ball,
    pixels: f64,
}

impl Path {
    fn run(
        &self,
        name: &str,
        mut mesher: ViewDependentMesher<'_>,
        anew: impl Fn(&Budget) -> Outcome<Mesh>,
        job: &Job,
    ) -> Outcome<()> {
        let (mut scratch, mut coherent) = (FrameCosts::default(), FrameCosts::default());
        let (mut kept, mut all) = (0, 0);
        for k in 0..FRAMES {
            let budget = Budget::pixels(Pixels::new(self.pixels)?, self.view(k)?);
            scratch.add(|| anew(&budget))?;
            coherent.add(|| Ok(mesher.mesh(&budget, job)?.shape))?;
            (kept, all) = (kept + mesher.reuse().kept, all + mesher.reuse().kept + mesher.reuse().made);
        }
        let share = kept as f64 / all as f64;
        println!(
            "{name}\t{}\t{}\t{}\t{}\t{share:.3}",
            self.pixels,
            job.threads,
            scratch.row(),
            coherent.row()
        );
        Ok(())
    }

    fn view(&self, frame: u32) -> Outcome<View> {
        let t = f64::from(frame) / f64::from(FRAMES - 1);
        let Ball { middle: [x, y, z], radius } = self.around;
        let away = radius * (6.0 - 4.0 * t);
        let (s, c) = (0.5 * std::f64::consts::PI * t).sin_cos();
        let eye = [x + away * c, y + away * s, z + 0.3 * away];
        Ok(format!("1920x1080 fov=45 eye={},{},{} target={x},{y},{z}", eye[0], eye[1], eye[2]).parse()?)
    }
}

/// The patches of a file in Newell's form: a count, then for each two degrees and sixteen points.
fn patches(text: &str) -> Outcome<Vec<Patch>> {
    let numbers: Vec<f64> = text.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
    let patch = |numbers: &[f64]| {
        let point = |k: usize| [numbers[2 + 3 * k], numbers[3 + 3 * k], numbers[4 + 3 * k]];
        Patch { control: std::array::from_fn(|j| std::array::from_fn(|i| point(4 * j + i))) }
    };
    Ok(numbers[1..].chunks_exact(2 + 3 * 16).map(patch).collect())
}

/// A torus of n × m quads with bumps.
fn torus([n, m]: [u32; 2]) -> Outcome<Cage> {
    let tau = std::f64::consts::TAU;
    let at = |i: u32, j: u32| -> [f64; 3] {
        let (u, v) = (tau * f64::from(i) / f64::from(n), tau * f64::from(j) / f64::from(m));
        let r = 0.3 * (1.0 + 0.2 * (9.0 * u).sin() * (7.0 * v).cos());
        [(1.0 + r * v.cos()) * u.cos(), (1.0 + r * v.cos()) * u.sin(), r * v.sin()]
    };
    let id = |i: u32, j: u32| (i % n) * m + j % m;
    let cells = || (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let face = |(i, j): (u32, u32)| [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
    Ok(Cage::new(cells().map(|(i, j)| at(i, j)).collect(), cells().map(face).collect::<Vec<_>>())?)
}

/// The positions and faces of an OBJ file.
fn polygons(text: &str) -> Outcome<Cage> {
    let (mut positions, mut faces) = (Vec::new(), Vec::<Vec<u32>>::new());
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["v", x, y, z, ..] => positions.push([x.parse()?, y.parse()?, z.parse()?]),
            ["f", ref corners @ ..] => {
                let index = |word: &&str| word.split('/').next().unwrap_or_default().parse::<u32>();
                let face: Result<Vec<u32>, _> = corners.iter().map(index).collect();
                faces.push(face?.into_iter().map(|index| index.saturating_sub(1)).collect());
            }
            _ => {}
        }
    }
    Ok(Cage::new(positions, faces)?)
}
