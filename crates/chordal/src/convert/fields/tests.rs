//! Tests of grids and extracted surfaces: models with known truth, and highly degenerate random ones.
use super::extract::{ExtractedSurface, extract};
use super::grid::{FieldGrid, GridOptions};
use super::sizing::SizingPoint;
use crate::budget::{Evidence, Job};
use crate::check::{self_intersections, validity};
use crate::explicit::{Mesh, Topology};
use crate::implicit::evaluation::Unary;
use crate::implicit::{Csg, Expr, Leaf, LeafError, Lipschitz, PrimitiveEvaluator, shapes};
use crate::math::{Box3, cross, difference, distance, dot, greater, length};
use chordal_testkit::Random;
use std::sync::Arc;

fn ball(centre: [f64; 3], radius: f64) -> Expr {
    let [x, y, z] = Expr::axes();
    ((x - centre[0]).square() + (y - centre[1]).square() + (z - centre[2]).square()).sqrt() - radius
}

fn cuboid(centre: [f64; 3], half: [f64; 3]) -> Expr {
    let axes = Expr::axes();
    let slab = |k: usize| (&axes[k] - (centre[k] + half[k])).max(&(-&axes[k] + (centre[k] - half[k])));
    slab(0).max(&slab(1)).max(&slab(2))
}

fn csg6() -> Expr {
    // Three pieces, one of them with a hollow, as counted on a lattice of 400 points a side.
    let mut random = Random::new(5);
    let mut whole = ball([0.0; 3], 0.6);
    for k in 1..6 {
        let centre = [0, 1, 2].map(|_| 0.8 * random.signed());
        let size = 0.1 + 0.25 * random.unit();
        let part = if k % 2 == 0 { ball(centre, size) } else { cuboid(centre, [size; 3]) };
        whole = if k % 3 == 0 { whole.max(&-part) } else { whole.min(&part) };
    }
    whole
}

fn gyroid_in_ball() -> Expr {
    // The period of sines of eight times the coordinates.
    let gyroid = shapes::gyroid(std::f64::consts::FRAC_PI_4, 0.0).unwrap().sign().clone();
    gyroid.max(&ball([0.0; 3], 0.8))
}

fn xor(a: &Expr, b: &Expr) -> Expr {
    a.max(&-b).min(&b.max(&-a))
}

fn bars() -> Expr {
    let bar = |i: u32, j: u32| {
        cuboid([-0.9 + 0.2 * f64::from(i), -0.9 + 0.2 * f64::from(j), 0.0], [0.05, 0.05, 0.8])
    };
    let all = (0..100).map(|k| bar(k / 10, k % 10));
    all.reduce(|a, b| a.min(&b)).expect("there are bars")
}

fn blobs() -> Expr {
    let blob = |k: u32| {
        let t = f64::from(k) / 99.0;
        let (angle, out) = (40.0 * t, 0.15 + 0.6 * t);
        ball([out * libm::cos(angle), out * libm::sin(angle), 0.8 * t - 0.4], 0.08)
    };
    (0..100).map(blob).reduce(|a, b| a.smooth_min(&b, 0.05)).expect("there are blobs")
}

struct ExtractedModel {
    csg: Csg,
    surface: ExtractedSurface,
    n_cells: usize,
}

fn make(sign: &Expr, half: f64, [floor, coarsest]: [f64; 2], threads: usize) -> ExtractedModel {
    let csg = Csg::from_expr(sign);
    let job = Job::default().with_threads(threads);
    let bounds = Box3 { min: [-half; 3], max: [half; 3] };
    let mut evaluator = PrimitiveEvaluator::new(&csg, &bounds, &job);
    let grid = FieldGrid::build(&mut evaluator, GridOptions { bounds, floor, coarsest }, &job).unwrap();
    let surface = extract(&grid, &job);
    let n_cells = grid.n_cells();
    ExtractedModel { csg, surface, n_cells }
}

fn mesh(surface: &ExtractedSurface) -> Mesh {
    Mesh::new(surface.positions.clone(), surface.faces.clone()).unwrap()
}

/// Checks that a surface is closed, manifold and oriented; counts the pairs of faces that cross.
fn sound(surface: &ExtractedSurface, name: &str) -> u64 {
    let mesh = mesh(surface);
    let found = validity(&mesh, Topology::Indices);
    assert!(found.closed && found.manifold() && found.oriented, "{name}");
    assert_eq!((found.duplicate_faces.count, found.unused_vertices.count), (0, 0), "{name}");
    self_intersections(&mesh, &Job::default()).unwrap().count
}

/// Checks that vertices are near the primitives of their labels, within the size of cells, and that faces
/// look where their primitive grows.
fn labelled(made: &ExtractedModel, name: &str) {
    let ExtractedModel { csg, surface, .. } = made;
    let job = Job::default();
    let mut evaluator = PrimitiveEvaluator::new(csg, &Box3 { min: [-3.0; 3], max: [3.0; 3] }, &job);
    let mut questions = Vec::new();
    for (face, label) in surface.faces.iter().zip(&surface.labels) {
        for vertex in face {
            let on = surface.vertex_primitives[*vertex as usize];
            assert!(on.contains(&(label >> 1)), "{name}: a face has a corner that is not on its primitive");
            questions.push((label >> 1, surface.positions[*vertex as usize]));
        }
    }
    let slopes = evaluator.duals(&questions).unwrap();
    for (k, (face, label)) in surface.faces.iter().zip(&surface.labels).enumerate() {
        let [a, b, c] = face.map(|v| surface.positions[v as usize]);
        let normal = cross(difference(b, a), difference(c, a));
        let longest = distance(b, a) + distance(c, a);
        // Normals of slivers are rounding errors.
        if length(normal) < 1e-6 * longest * longest {
            continue;
        }
        let sign = if label & 1 == 1 { -1.0 } else { 1.0 };
        let slopes = &slopes[3 * k..3 * k + 3];
        let along = slopes
            .iter()
            .map(|slope| sign * dot(slope.gradient, normal))
            .fold(f64::MIN, |a, b| greater(b, a));
        assert!(along > 0.0, "{name}: a face looks the wrong way");
        for (slope, vertex) in slopes.iter().zip(face) {
            let size = surface.cell_sizes[*vertex as usize];
            assert!(
                slope.value.abs() <= size * length(slope.gradient),
                "{name}: a vertex is far from its primitive"
            );
        }
    }
}

fn volume(surface: &ExtractedSurface) -> f64 {
    validity(&mesh(surface), Topology::Indices).measure.signed_volume
}

#[test]
fn models_are_closed_embedded_and_labelled() {
    let [x, y, z] = Expr::axes();
    let torus = (((x.square() + y.square()).sqrt() - 0.55).square() + z.square()).sqrt() - 0.25;
    let block = cuboid([0.0; 3], [1.0, 1.0, 0.5]).max(&-((x.square() + y.square()).sqrt() - 0.4));
    let quartic = |a: &Expr| a.square().square() - a.square() * 5.0;
    // The sine and cosine of 2.5 degrees.
    let (sine, cosine) = (libm::sin(0.043_633_231_299_858_24), libm::cos(0.043_633_231_299_858_24));
    let wedge = (&z * cosine - &x * sine).max(&(-&z * cosine - &x * sine)).max(&ball([0.0; 3], 1.0));
    let wall = (ball([0.0; 3], 1.0).abs() - 0.5 / 1024.0).max(&(&z - 0.5));
    // Each with half the cube's side, and its number of components.
    let models: [(&str, Expr, f64, u64); 13] = [
        ("ball", ball([0.0; 3], 0.6), 1.25, 1),
        ("torus", torus, 1.25, 1),
        ("block", block, 1.3, 1),
        ("cube − ball", cuboid([0.0; 3], [0.5; 3]).max(&-ball([0.0; 3], 0.64)), 1.25, 1),
        ("csg6", csg6(), 1.25, 4),
        ("gyroid in a ball", gyroid_in_ball(), 1.25, 1),
        ("tanglecube", quartic(&x) + quartic(&y) + quartic(&z) + 11.8, 3.0, 1),
        ("wedge", wedge, 1.25, 1),
        ("wall", wall, 1.25, 1),
        ("hollow ball", ball([0.0; 3], 0.95).abs() - 0.05, 1.25, 2),
        ("tangent balls", ball([-0.5, 0.0, 0.0], 0.5).min(&ball([0.5, 0.0, 0.0], 0.5)), 1.25, 2),
        ("xor", xor(&ball([-0.3, 0.0, 0.0], 0.5), &ball([0.3, 0.1, 0.0], 0.5)), 1.25, 2),
        ("bars", bars(), 1.25, 100),
    ];
    for (name, sign, half, n_pieces) in models {
        let made = make(&sign, half, [1e-3, f64::INFINITY], 1);
        assert_eq!(sound(&made.surface, name), 0, "{name}: faces cross");
        labelled(&made, name);
        let found = validity(&mesh(&made.surface), Topology::Indices);
        assert_eq!(found.components, n_pieces, "{name}");
        assert_eq!(made.surface.unresolved.is_empty(), name != "tangent balls", "{name}");
        let again = make(&sign, half, [1e-3, f64::INFINITY], 2);
        assert_eq!(made.surface, again.surface, "{name} on two threads");
    }
}

#[test]
fn flat_models_are_exact() {
    for (sign, expected) in [
        (cuboid([0.1, 0.2, -0.3], [0.5, 0.25, 0.75]), 0.75),
        // Stacked boxes: no boundary is between them where they touch.
        (
            cuboid([0.0, 0.0, -0.25], [0.5, 0.5, 0.25]).min(&cuboid([0.0, 0.0, 0.25], [0.375, 0.625, 0.25])),
            0.96875,
        ),
        (bars(), 1.6),
    ] {
        let made = make(&sign, 1.25, [1e-3, f64::INFINITY], 1);
        assert!((volume(&made.surface) - expected).abs() < 1e-7, "{}", volume(&made.surface));
    }
}

#[test]
fn values_full_of_rounding_leave_no_holes() {
    let [x, y, z] = Expr::axes();
    // A double cone whose values are off by some 1e-9, in cells whose values are far below that.
    let cone = (x.square() - y.square() - z.square() + 1e7) - 1e7;
    for floor in [1e-3, 1e-6, 1e-9] {
        let made = make(&cone.max(&ball([0.0; 3], 1.0)), 1.25, [floor, f64::INFINITY], 1);
        sound(&made.surface, "noisy cone");
        assert!(!made.surface.unresolved.is_empty());
    }
}

#[test]
fn cells_hardly_depend_on_the_floor() {
    let coarse = make(&csg6(), 1.25, [1e-2, f64::INFINITY], 1);
    let fine = make(&csg6(), 1.25, [1e-6, f64::INFINITY], 1);
    // A few more are for creases that may be double.
    let most = coarse.n_cells + coarse.n_cells / 20;
    assert!((coarse.n_cells..=most).contains(&fine.n_cells), "{} {}", coarse.n_cells, fine.n_cells);
    assert!(fine.n_cells < 5000 && fine.surface.unresolved.is_empty());
}

#[test]
fn extruded_shapes_take_the_cells_of_their_outlines() {
    let [x, y, z] = Expr::axes();
    let disc = |k: u32| {
        let middle = 0.15 * f64::from(k) - 0.8;
        ((&x - middle).square() + (&y - 0.3 * middle).square()).sqrt() - 0.06
    };
    let outline = (0..12).map(disc).reduce(|a, b| a.min(&b)).expect("there are discs");
    let made = |height: f64| make(&outline.max(&(z.abs() - height)), 1.25, [1e-3, f64::INFINITY], 1);
    let (thin, thick) = (made(0.01), made(0.9));
    assert_eq!((sound(&thin.surface, "thin"), sound(&thick.surface, "thick")), (0, 0));
    // Some 60 cells a disc; in unstretched cells the thick one would have ten layers of them.
    assert!(thick.n_cells < 1500 && thick.n_cells < 2 * thin.n_cells, "{} {}", thin.n_cells, thick.n_cells);
}

#[test]
fn blends_at_a_coarse_floor_are_closed_and_say_where_they_are_unresolved() {
    let made = make(&blobs(), 1.25, [0.1, f64::INFINITY], 0);
    assert_eq!(sound(&made.surface, "blobs"), 0);
    assert!(!made.surface.unresolved.is_empty());
    assert!(made.surface.unresolved.iter().all(|place| place.size <= 0.1));
}

#[test]
fn refining_makes_cells_small_where_it_is_asked_for() {
    let csg = Csg::from_expr(&ball([0.0; 3], 0.6));
    let job = Job::default();
    let bounds = Box3 { min: [-1.25; 3], max: [1.25; 3] };
    let mut evaluator = PrimitiveEvaluator::new(&csg, &bounds, &job);
    let options = GridOptions { bounds, floor: 1e-3, coarsest: f64::INFINITY };
    let mut grid = FieldGrid::build(&mut evaluator, options, &job).unwrap();
    let before = grid.n_cells();
    grid.refine(&mut evaluator, &[SizingPoint { at: [0.6, 0.0, 0.0], size: 0.02 }]).unwrap();
    assert!(grid.n_cells() > before && grid.n_cells() < 8 * before);
    let surface = extract(&grid, &job);
    assert_eq!(sound(&surface, "refined ball"), 0);
    let near = |p: &[f64; 3]| distance(*p, [0.6, 0.0, 0.0]) < 0.02;
    let close: Vec<f64> =
        surface.positions.iter().zip(&surface.cell_sizes).filter(|(p, _)| near(p)).map(|(_, s)| *s).collect();
    assert!(close.len() > 3 && close.iter().all(|size| *size < 0.1));
}

#[test]
fn little_memory_ends_in_a_closed_mesh_all_the_same() {
    let csg = Csg::from_expr(&gyroid_in_ball());
    let mut job = Job::default();
    job.memory_limit = 4_000_000;
    let bounds = Box3 { min: [-1.25; 3], max: [1.25; 3] };
    let mut evaluator = PrimitiveEvaluator::new(&csg, &bounds, &job);
    let options = GridOptions { bounds, floor: 1e-3, coarsest: f64::INFINITY };
    let grid = FieldGrid::build(&mut evaluator, options, &job).unwrap();
    assert!(grid.n_cells() < 6000 && !grid.unresolved().is_empty());
    assert_eq!(sound(&extract(&grid, &job), "gyroid in little memory"), 0);
}

/// A torus that is known at points only, or with its Lipschitz constant.
#[derive(Debug)]
struct OpaqueTorus {
    lipschitz: Option<Lipschitz>,
}

impl Leaf for OpaqueTorus {
    fn at(&self, points: &[[f64; 3]], out: &mut [f64]) -> Result<(), LeafError> {
        for ([x, y, z], value) in points.iter().zip(out) {
            let around = (x * x + y * y).sqrt() - 0.7;
            *value = (around * around + z * z).sqrt() - 0.25;
        }
        Ok(())
    }

    fn lipschitz(&self) -> Option<Lipschitz> {
        self.lipschitz
    }

    fn evidence(&self) -> Evidence {
        Evidence::Measured { samples: 0 }
    }
}

#[test]
fn functions_known_at_points_are_meshed_by_samples() {
    let slope = Lipschitz { constant: 1.0, error: 0.0 };
    for (lipschitz, coarsest) in [(None, 0.3), (Some(slope), f64::INFINITY)] {
        let torus = Expr::leaf(Arc::new(OpaqueTorus { lipschitz }), Expr::axes());
        let [_, _, z] = Expr::axes();
        let made = make(&torus.max(&(z - 0.1)), 1.0, [1e-2, coarsest], 1);
        assert_eq!(sound(&made.surface, "half a torus"), 0);
        let found = validity(&mesh(&made.surface), Topology::Indices);
        assert_eq!((found.components, found.genus), (1, Some(1)));
        assert!(made.surface.unresolved.is_empty() && made.n_cells < 30_000, "{}", made.n_cells);
    }
}

/// Parts with small integers, so that planes coincide, and four meet in a point; some have integer values.
fn random_part(random: &mut Random) -> Expr {
    let [x, y, z] = Expr::axes();
    let mut whole = || random.below(5) as f64 - 2.0;
    let (a, b, c, d) = (whole(), whole(), whole(), whole());
    let centre = [0.5 * a, 0.5 * b, 0.5 * c];
    let plane = &x * a + &y * b + &z * c;
    match random.below(8) {
        0 | 1 => ball(centre, 1.0 + 0.25 * d),
        2 | 3 => cuboid(centre, [1.0 + 0.25 * d, 0.5, 0.75]),
        4 => plane + 0.5 * (d + 0.5),
        5 => cuboid(centre, [0.5; 3]) * (1.0 + random.below(3) as f64),
        6 => ball(centre, 1.0).abs() - 0.125,
        _ if random.below(2) == 0 => Expr::unary(Unary::Round, &(plane * 2.0 + d)),
        _ => Expr::unary(Unary::Round, &(ball(centre, 1.0) * 4.0)),
    }
}

fn random_solid(random: &mut Random) -> Expr {
    let mut whole = random_part(random);
    for _ in 0..1 + random.below(6) {
        let part = random_part(random);
        whole = match random.below(6) {
            0 | 1 => whole.min(&part),
            2 => whole.max(&part),
            3 | 4 => whole.max(&-&part),
            _ => xor(&whole, &part),
        };
    }
    whole.max(&cuboid([0.0; 3], [1.75; 3]))
}

#[test]
fn random_solids_are_closed_however_degenerate_they_are() {
    let mut n_crossed = 0;
    let mut n_faces = 0;
    let n_seeds = if chordal_testkit::is_long() { 4000 } else { 130 };
    for seed in 1..=n_seeds {
        let mut random = Random::new(seed);
        let solid = random_solid(&mut random);
        // Mostly too coarse: the extracted surface is far from the solid, but still a closed one.
        let floor = [0.3, 0.6, 1.5, 8.0][random.below(4)];
        let coarsest = [0.7, 1.0, 4.0, 9.0][random.below(4)];
        let made = make(&solid, 1.75, [floor, coarsest], 1);
        n_faces += made.surface.faces.len();
        if !made.surface.faces.is_empty() {
            n_crossed += u32::from(sound(&made.surface, &format!("seed {seed}")) > 0);
        }
    }
    assert!(n_faces as u64 > 250 * n_seeds, "{n_faces}");
    // Sheets closer than the precision of coordinates may cross; with shifts of 16 bits about one in 3,000 of
    // such solids has some.
    assert!(n_crossed <= if n_seeds > 3000 { 4 } else { 1 }, "{n_crossed}");
}
