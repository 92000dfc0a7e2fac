//! The bench of nearness: `rays [QUADS [QUERY]]` prints CSV of queries on a bumpy torus of about 2 · QUADS²
//! triangles, on one thread: rays side by side as a camera has them and random ones, nearest points, and
//! points inside. Millions a second of CPU time.
use chordal::explicit::query::{Bvh, Enclosure, Ray};
use chordal::{Job, Mesh};
use cpu_time::ProcessTime;
use std::hint::black_box;

fn torus(n: u32) -> Mesh {
    let at = |i: u32, j: u32| (i % n) * n + j % n;
    let angle = |i: u32| (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
    let position = |i: u32, j: u32| {
        let ((sin, cos), (up, out)) = (angle(i), angle(j));
        let bump = 1.0 + 0.05 * (40.0 * sin).sin() * (30.0 * up).sin();
        [(2.0 + bump * out) * cos, (2.0 + bump * out) * sin, bump * up]
    };
    let rows = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let faces = rows().flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    Mesh::new(rows().map(|(i, j)| position(i, j)).collect(), faces.collect()).expect("valid")
}

/// Millions a second.
fn rate(n: usize, work: &dyn Fn() -> usize) -> f64 {
    let mut best = f64::INFINITY;
    for _ in 0..3 {
        let start = ProcessTime::now();
        black_box(work());
        best = best.min(start.elapsed().as_secs_f64());
    }
    n as f64 / best / 1e6
}

pub fn main() {
    let quads: u32 = std::env::args().nth(1).map_or(707, |n| n.parse().expect("a number"));
    let mesh = torus(quads);
    let job = Job::default().with_threads(1);
    let bvh = Bvh::build(&mesh, &job).expect("it fits");
    let mut state = 1_u64;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let n = 1 << 20;
    let eye = [0.5, -7.0, 4.0];
    let coherent: Vec<Ray> = (0..n)
        .map(|i| {
            let (x, y) = ((i % 1024) as f64 / 512.0 - 1.0, (i / 1024) as f64 / 512.0 - 1.0);
            Ray::new(eye, [0.45 * x, 0.87 - 0.2 * y, -0.5 + 0.35 * y])
        })
        .collect();
    let mut point = |size: f64| -> [f64; 3] { std::array::from_fn(|_| size * (2.0 * unit() - 1.0)) };
    let random: Vec<Ray> = (0..n / 2).map(|_| Ray::new(point(3.0), point(1.0))).collect();
    let points: Vec<[f64; 3]> = (0..n / 4).map(|_| point(3.0)).collect();
    println!("triangles,query,million_a_second");
    let faces = mesh.faces().len();
    let only = std::env::args().nth(2);
    let print = |what: &str, n: usize, work: &dyn Fn() -> usize| {
        if only.as_ref().is_none_or(|only| what.contains(only.as_str())) {
            println!("{faces},{what},{:.3}", rate(n, work));
        }
    };
    let one_by_one = |rays: &[Ray]| rays.iter().filter(|ray| bvh.first_hit(ray).is_some()).count();
    let at_once = |rays: &[Ray]| bvh.first_hits(rays, &job).iter().flatten().count();
    print("coherent rays one by one", n, &|| one_by_one(&coherent));
    print("coherent rays at once", n, &|| at_once(&coherent));
    print("random rays one by one", n / 2, &|| one_by_one(&random));
    print("random rays at once", n / 2, &|| at_once(&random));
    print("nearest points", n / 4, &|| bvh.closest_points(&points, &job).len());
    let enclosure = Enclosure::new(&mesh, &bvh);
    print("inside closed", n / 4, &|| enclosure.inside_all(&points, &job).len());
    let mut open = mesh.faces().to_vec();
    open.truncate(open.len() - 1000);
    let open = Mesh::new(mesh.positions().to_vec(), open).expect("valid");
    let open_bvh = Bvh::build(&open, &job).expect("it fits");
    let enclosure = Enclosure::new(&open, &open_bvh);
    let some = &points[..n / 128];
    print("inside open", some.len(), &|| enclosure.inside_all(some, &job).len());
    print("winding within 1e-2", some.len(), &|| {
        some.iter().filter_map(|p| enclosure.winding_number(*p, 1e-2)).count()
    });
}
