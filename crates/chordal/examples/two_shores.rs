//! One shape written down both ways, as triangles and as a field, and what each costs: the tables of
//! `docs/two-shores.md`.
//!
//! `cargo run --release -p chordal --example two_shores` prints them. One thread, medians of three runs.
use chordal::boolean::{BooleanOp, BooleanStep, boolean};
use chordal::check::findings::measure;
use chordal::convert::{
    field_to_mesh, field_to_sparse_grid, lattices::Lattice, mesh_to_field, mesh_to_grid, redistance,
};
use chordal::explicit::query::{Bvh, Enclosure, PointLocation, Ray};
use chordal::explicit::{NormalWeight, smooth_normals};
use chordal::implicit::evaluation::Trilinear;
use chordal::implicit::query::{Beam, FieldOctree, FieldTracer, contains, normals};
use chordal::implicit::shapes::{cuboid, cylinder, sphere, torus};
use chordal::implicit::{Expr, Field};
use chordal::{Budget, Job, Mesh, Tolerance};
use std::sync::Arc;
use std::time::Instant;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// The shape as a script has it.
const SCRIPT: &str = "(sphere(1) | torus(1.3, 0.2)) - cylinder(0.45, 4)";
/// How far the triangles may be from the shape, which is 3 wide.
const WITHIN: f64 = 1e-3;
const N_POINTS: u32 = 100_000;
/// Bytes of a tree for each triangle.
const TREE: usize = 80;
/// Rays of a picture.
const PICTURE: [u32; 2] = [640, 480];

fn main() -> Outcome<()> {
    let job = Job::default().with_threads(1);
    let drill = cylinder(0.45, 4.0)?;
    let planet = sphere(1.0)?.union(&torus(1.3, 0.2)?);
    let shape = planet.difference(&drill);
    let within = Tolerance::new(WITHIN)?;
    let (seconds, made) = median(|| field_to_mesh(&shape, &Budget::length(within), &job))?;
    let mesh = made.shape;
    let most = made.bound.at_most().ok_or("no bound")?;
    println!(
        "The triangles: {} in {}, within {most:.1e} of the field, proved.\n",
        mesh.faces().len(),
        time(seconds)
    );
    println!("| | as triangles | as a field |\n|---|---|---|");
    let size = 24 * mesh.positions().len() + 12 * mesh.faces().len();
    let terms = chordal::implicit::evaluation::ExprGraph::from_expr(shape.expr()).terms().len();
    println!(
        "| what it is | {} vertices, {} triangles | {terms} operations |",
        mesh.positions().len(),
        mesh.faces().len()
    );
    println!("| memory | {} | {}, as a script |", bytes(size), bytes(SCRIPT.len()));

    // Drawing: one ray for each pixel.
    let rays = rays();
    let (build, bvh) = median(|| Bvh::build(&mesh, &job))?;
    let (hits, _) = median(|| Outcome::Ok(bvh.first_hits(&rays, &job)))?;
    let (plan, cells) = median(|| FieldOctree::build(&shape, &job))?;
    let beams: Vec<Beam> = rays
        .iter()
        .map(|ray| Beam {
            origin: ray.origin,
            direction: ray.direction,
            from: 0.0,
            to: f64::INFINITY,
            cone: [0.0, 7e-4],
        })
        .collect();
    let (marches, _) = median(|| FieldTracer::new(&cells).intersect(&beams))?;
    println!(
        "| {} rays | {}, after {} for the tree | {}, after {} for the cells |",
        rays.len(),
        time(hits),
        time(build),
        time(marches),
        time(plan)
    );

    // Inside or outside.
    let points = points();
    let enclosure = Enclosure::new(&mesh, &bvh);
    let (asks, by_mesh) = median(|| Outcome::Ok(enclosure.inside_all(&points, &job)))?;
    let tape = shape.tape();
    let (signs, by_field) = median(|| contains(&tape, &points))?;
    let agree =
        by_mesh.iter().zip(&by_field).filter(|(a, b)| (a.side == PointLocation::Inside) == **b).count();
    println!("| {N_POINTS} points: inside? | {} | {} |", time(asks), time(signs));

    // Another hole, across.
    let bar = cuboid([3.4, 0.5, 0.5])?;
    let bar_mesh = field_to_mesh(&bar, &Budget::length(within), &job)?.shape;
    let step = BooleanStep { op: BooleanOp::Difference, mesh: &bar_mesh };
    let (cuts, cut) = median(|| boolean(&mesh, &[step], &job))?;
    let (maxes, _) = median(|| Outcome::Ok(shape.difference(&bar)))?;
    println!("| a bar taken away | {}, {} triangles | {} |", time(cuts), cut.mesh.faces().len(), time(maxes));

    // A wall's thickness inwards. The mesh has no such operation of its own: it goes through a field and back.
    let back =
        |field: &Field| field_to_mesh(field, &Budget::length(Tolerance::new(0.03)?), &job).map_err(text);
    let (offsets, _) = median(|| shape.offset(-0.1))?;
    let (detour, _) = median(|| {
        let solid = mesh_to_field(&mesh, &job).map_err(text)?;
        back(&solid.field.offset(-0.1).map_err(text)?)
    })?;
    let (true_one, _) = median(|| redistance(&shape, within, &job).map_err(text))?;
    println!(
        "| offset by −0.1 | {}, through its distance to triangles within 0.03 | {}; {} more where the value is to be a \
         true distance first |",
        time(detour),
        time(offsets),
        time(true_one)
    );

    // Normals.
    let (sums, smooth) = median(|| Outcome::Ok(smooth_normals(&mesh, NormalWeight::Angle)))?;
    let (slopes, exact) = median(|| normals(&tape, mesh.positions()))?;
    let off: Vec<f64> = smooth.iter().zip(&exact).filter_map(|(a, b)| b.map(|b| angle(*a, b))).collect();
    println!(
        "| {} normals | {}, off by {:.2}° in the middle | {}, exact but for rounding |",
        smooth.len(),
        time(sums),
        middle(off),
        time(slopes)
    );
    println!("\nOf {N_POINTS} points {} are on the same side by both.\n", agree);
    println!("Volume by the triangles: {:.5}.\n", measure(&mesh).signed_volume);
    collide(&mesh, &points, &job)
}

/// Points against a solid: exact distances by the tree, and samples between which is interpolated.
fn collide(mesh: &Mesh, points: &[[f64; 3]], job: &Job) -> Outcome<()> {
    println!(
        "| {N_POINTS} points collide with | made in | memory | asked in | off by up to |\n|---|---|---|---|---|"
    );
    let solid = mesh_to_field(mesh, job).map_err(text)?.field;
    let tape = solid.tape();
    let ask = |tape: &chordal::implicit::evaluation::Tape| -> Outcome<Vec<f64>> {
        let mut values = vec![0.0; points.len()];
        tape.at(points, &mut values)?;
        Ok(values)
    };
    let (build, _) = median(|| Bvh::build(mesh, job))?;
    let (asks, exact) = median(|| ask(&tape))?;
    let size = 24 * mesh.positions().len() + 12 * mesh.faces().len() + TREE * mesh.faces().len();
    println!("| triangles, by a tree | {} | {} | {} | rounding |", time(build), bytes(size), time(asks));
    let worst = |values: &[f64], far: f64| {
        let near = values.iter().zip(&exact).filter(|(_, exact)| exact.abs() < far);
        near.map(|(value, exact)| (value - exact).abs()).fold(0.0, f64::max)
    };
    for cells in [32, 64] {
        let (bakes, baked) = median(|| mesh_to_grid(mesh, cells, None, job).map_err(text))?;
        let size = 8 * baked.grid.size().iter().product::<usize>();
        let leaf = Field::new(Expr::leaf(Arc::new(Trilinear::new(baked.grid)), Expr::axes())).tape();
        let (asks, values) = median(|| ask(&leaf))?;
        println!(
            "| samples, {cells} cells | {} | {} | {} | {:.4} |",
            time(bakes),
            bytes(size),
            time(asks),
            worst(&values, f64::INFINITY)
        );
    }
    let lattice = Lattice::around(&mesh.bounds(), 128, 3).ok_or("no lattice")?;
    let band = 3.0 * 3.0 / 128.0;
    let (bakes, sparse) = median(|| field_to_sparse_grid(&solid, &lattice, band, job).map_err(text))?;
    let size = sparse.bytes() as usize;
    let leaf = Field::new(Expr::leaf(Arc::new(Trilinear::new(sparse)), Expr::axes())).tape();
    let (asks, values) = median(|| ask(&leaf))?;
    println!(
        "| bricks of samples, 128 cells, 3 on each side | {} | {} | {} | {:.4} (in the band) |",
        time(bakes),
        bytes(size),
        time(asks),
        worst(&values, 0.5 * band)
    );
    Ok(())
}

fn text(failure: impl std::fmt::Debug) -> Box<dyn std::error::Error> {
    format!("{failure:?}").into()
}

/// The median of the seconds of three runs, and the last result.
fn median<T, E: std::fmt::Debug>(mut work: impl FnMut() -> Result<T, E>) -> Outcome<(f64, T)> {
    let mut seconds = Vec::new();
    loop {
        let start = Instant::now();
        let made = work().map_err(text)?;
        seconds.push(start.elapsed().as_secs_f64());
        if seconds.len() == 3 {
            return Ok((middle(seconds), made));
        }
    }
}

fn middle(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers[numbers.len() / 2]
}

fn time(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.1} µs", 1e6 * s),
        s if s < 1.0 => format!("{:.1} ms", 1e3 * s),
        s => format!("{s:.2} s"),
    }
}

fn bytes(n: usize) -> String {
    match n {
        n if n < 10_000 => format!("{n} bytes"),
        n if n < 10_000_000 => format!("{} kB", n / 1000),
        n => format!("{:.1} MB", n as f64 / 1e6),
    }
}

/// A camera that looks at the shape from above.
fn rays() -> Vec<Ray> {
    let [width, height] = PICTURE;
    let (from, side, up): ([f64; 3], [f64; 3], [f64; 3]) =
        ([0.0, -4.0, 3.0], [1.0, 0.0, 0.0], [0.0, 0.6, 0.8]);
    let ahead = [0.0, 0.8, -0.6];
    let ray = |i: u32| {
        let x = (f64::from(i % width) + 0.5) / f64::from(height) - 0.5 * f64::from(width) / f64::from(height);
        let y = 0.5 - (f64::from(i / width) + 0.5) / f64::from(height);
        Ray::new(from, std::array::from_fn(|k| ahead[k] + 0.7 * (x * side[k] + y * up[k])))
    };
    (0..width * height).map(ray).collect()
}

/// Points spread evenly over the box of the shape, by three rotations whose steps have no common period.
fn points() -> Vec<[f64; 3]> {
    let turn = |i: u32, step: f64| (f64::from(i) * step).fract();
    (0..N_POINTS)
        .map(|i| {
            let [x, y, z] = [turn(i, 0.819_172_513_4), turn(i, 0.671_043_606_7), turn(i, 0.549_700_477_9)];
            [3.0 * x - 1.5, 3.0 * y - 1.5, 2.0 * z - 1.0]
        })
        .collect()
}

/// The angle between two unit vectors in degrees.
fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let length = cross.iter().map(|x| x * x).sum::<f64>().sqrt();
    length.atan2(a.iter().zip(b).map(|(x, y)| x * y).sum()).to_degrees()
}
