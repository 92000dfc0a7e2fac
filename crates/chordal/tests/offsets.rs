//! Offsets of meshes: the referee measures both directions by the testkit's own distances, and sides by sums of angles.
use chordal::budget::{Evidence, Failure, RefusalCode};
use chordal::check::{self, findings::measure};
use chordal::explicit::Topology;
use chordal::lod::mesh_to_offset;
use chordal::{Budget, Job, Mesh, Tolerance};
use chordal_testkit::Random;
use chordal_testkit::sampler::Triangles;

/// A closed prism over a polygon that runs counter-clockwise and is cut into the given triangles.
fn prism(outline: &[[f64; 2]], cut: &[[u32; 3]], height: f64) -> Mesh {
    let n = outline.len() as u32;
    let at = |z: f64| outline.iter().map(move |[x, y]| [*x, *y, z]);
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for [a, b, c] in cut {
        faces.push([*a, *c, *b]);
        faces.push([a + n, b + n, c + n]);
    }
    for k in 0..n {
        let next = (k + 1) % n;
        faces.extend([[k, next, next + n], [k, next + n, k + n]]);
    }
    Mesh::new(at(0.0).chain(at(height)).collect(), faces).expect("indices are in range")
}

fn cuboid(size: [f64; 3]) -> Mesh {
    let [x, y, z] = size;
    prism(&[[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]], &[[0, 1, 2], [0, 2, 3]], z)
}

/// An angle profile: a valley along one edge.
fn bracket() -> Mesh {
    let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.6], [0.7, 0.6], [0.7, 1.5], [0.0, 1.5]];
    prism(&outline, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]], 1.0)
}

fn torus(n: u32) -> Mesh {
    let turn = |k: u32| f64::from(k) / f64::from(n) * std::f64::consts::TAU;
    let at = |i: u32, j: u32| {
        let (u, v) = (turn(i), turn(j));
        let r = 1.0 + 0.4 * v.cos();
        [r * u.cos(), r * u.sin(), 0.4 * v.sin()]
    };
    let id = |i: u32, j: u32| i % n * n + j % n;
    let cells = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let faces = cells().flat_map(|(i, j)| {
        let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    Mesh::new(cells().map(|(i, j)| at(i, j)).collect(), faces.collect()).expect("indices are in range")
}

/// A ball whose radius changes from vertex to vertex: ridges and valleys everywhere.
fn crumpled(n: u32, seed: u64) -> Mesh {
    let mut random = Random::new(seed);
    let turn = |k: u32, of: u32| f64::from(k) / f64::from(of);
    let mut positions = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    for ring in 1..n {
        let polar = std::f64::consts::PI * turn(ring, n);
        for k in 0..2 * n {
            let around = std::f64::consts::TAU * turn(k, 2 * n);
            let r = random.between(0.85, 1.15);
            let (s, c) = polar.sin_cos();
            positions.push([r * s * around.cos(), r * s * around.sin(), r * c]);
        }
    }
    let id = |ring: u32, k: u32| 2 + (ring - 1) * 2 * n + k % (2 * n);
    let mut faces = Vec::new();
    for k in 0..2 * n {
        faces.push([0, id(1, k), id(1, k + 1)]);
        faces.push([1, id(n - 1, k + 1), id(n - 1, k)]);
        for ring in 1..n - 1 {
            let [a, b, c, d] = [id(ring, k), id(ring + 1, k), id(ring + 1, k + 1), id(ring, k + 1)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    Mesh::new(positions, faces).expect("indices are in range")
}

/// What the referee knows of a mesh.
struct Referee<'a> {
    mesh: &'a Mesh,
    triangles: Triangles,
}

impl<'a> Referee<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        Self { mesh, triangles: Triangles::new(mesh.positions(), mesh.faces()) }
    }

    /// Whether the faces are seen all around a point: by the sum of solid angles (A. van Oosterom, J. Strackee, 1983).
    fn is_inside(&self, p: [f64; 3]) -> bool {
        let angle = |face: usize| {
            let [a, b, c] =
                self.mesh.corners(face).map(|q| std::array::from_fn::<f64, 3, _>(|k| q[k] - p[k]));
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
            let [la, lb, lc] = [a, b, c].map(|v| dot(v, v).sqrt());
            2.0 * dot(a, cross).atan2(la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
        };
        (0..self.mesh.faces().len()).map(angle).sum::<f64>() > std::f64::consts::TAU
    }

    fn signed_distance(&self, p: [f64; 3]) -> f64 {
        let distance = self.triangles.distance(p);
        if self.is_inside(p) { -distance } else { distance }
    }

    /// Points of the offset surface: between points on its two sides.
    fn points_of_offset(&self, by: f64, n: usize, random: &mut Random) -> Vec<[f64; 3]> {
        let bounds = self.mesh.bounds();
        let grown = |k: usize, random: &mut Random| {
            random.between(bounds.min[k] - by.abs() - 0.1, bounds.max[k] + by.abs() + 0.1)
        };
        let mut found = Vec::new();
        while found.len() < n {
            let [mut p, mut q] = [(); 2].map(|()| [0, 1, 2].map(|k| grown(k, random)));
            let is_free = |p: [f64; 3]| self.signed_distance(p) > by;
            if is_free(p) == is_free(q) {
                continue;
            }
            if is_free(p) {
                std::mem::swap(&mut p, &mut q);
            }
            for _ in 0..50 {
                let middle = std::array::from_fn(|k| 0.5 * (p[k] + q[k]));
                *(if is_free(middle) { &mut q } else { &mut p }) = middle;
            }
            found.push(p);
        }
        found
    }
}

fn budget(length: f64) -> Budget {
    Budget::length(Tolerance::new(length).expect("a length"))
}

/// The offset is closed, without crossings, and its bound holds in both directions.
fn check_offset(mesh: &Mesh, by: f64, length: f64) -> Mesh {
    let offset = mesh_to_offset(mesh, by, &budget(length), &Job::default());
    let offset = offset.unwrap_or_else(|failure| match failure {
        Failure::Unmet(best) => panic!("by {by} within {length}: {:?}", best.bound),
        failure => panic!("by {by} within {length}: {failure:?}"),
    });
    let bound = offset.bound.at_most().expect("it is proved");
    assert!(bound <= length && *offset.bound.evidence() == Evidence::Proved, "{bound}");
    let shape = offset.shape;
    let found = check::validity(&shape, Topology::Indices);
    assert!(found.closed && found.non_manifold_edges.count == 0, "by {by}: {found:?}");
    assert_eq!(check::self_intersections(&shape, &Job::default()).expect("not cancelled").count, 0);
    let (referee, result) = (Referee::new(mesh), Referee::new(&shape));
    let mut random = Random::new(5);
    // Samples of the result: their distance to the offset surface is at least the difference of their distance to the mesh.
    let mut most: f64 = 0.0;
    for _ in 0..2000 {
        let [a, b, c] = shape.corners(random.below(shape.faces().len()));
        let w = random.weights();
        let p = std::array::from_fn(|k| w[0] * a[k] + w[1] * b[k] + w[2] * c[k]);
        most = most.max((referee.signed_distance(p) - by).abs());
    }
    assert!(most <= bound + 1e-9, "by {by}: a point of the result is off by {most}, not {bound}");
    for p in referee.points_of_offset(by, 400, &mut random) {
        let off = result.triangles.distance(p);
        assert!(off <= bound + 1e-9, "by {by}: {p:?} is {off} away from the result, not {bound}");
    }
    shape
}

#[test]
fn offsets_are_within_their_bound_in_both_directions() {
    let shapes = [cuboid([2.0, 1.0, 0.6]), bracket(), torus(24), crumpled(8, 1)];
    for mesh in &shapes {
        for by in [0.15, -0.12] {
            check_offset(mesh, by, 0.01);
        }
    }
}

#[test]
fn a_box_becomes_a_rounded_box_outward_and_a_box_inward() {
    let size = [2.0, 1.0, 0.6];
    let box_volume = |[x, y, z]: [f64; 3]| x * y * z;
    let r = 0.1;
    let outward = check_offset(&cuboid(size), r, 0.002);
    // Steiner's formula.
    let [x, y, z] = size;
    let pi = std::f64::consts::PI;
    let exact = box_volume(size)
        + 2.0 * (x * y + y * z + z * x) * r
        + pi * (x + y + z) * r * r
        + 4.0 / 3.0 * pi * r.powi(3);
    let area = 2.0 * (x * y + y * z + z * x) + 2.0 * pi * r * (x + y + z) + 4.0 * pi * r * r;
    assert!((measure(&outward).signed_volume - exact).abs() <= 0.002 * area);
    let inward = check_offset(&cuboid(size), -r, 0.002);
    let exact = box_volume(size.map(|x| x - 2.0 * r));
    // The mitres are sharp: nothing of the volume is missing.
    assert!(
        (measure(&inward).signed_volume - exact).abs() <= 1e-6 * exact,
        "{}",
        measure(&inward).signed_volume
    );
}

#[test]
fn two_boxes_merge_when_the_gap_between_them_closes() {
    let one = cuboid([1.0; 3]);
    let moved =
        |by: f64| -> Vec<[f64; 3]> { one.positions().iter().map(|[x, y, z]| [x + by, *y, *z]).collect() };
    let positions = [one.positions().to_vec(), moved(1.2)].concat();
    let second = one.faces().iter().map(|face| face.map(|v| v + 8));
    let both = Mesh::new(positions, one.faces().iter().copied().chain(second).collect()).expect("in range");
    let parts = |mesh: &Mesh| check::components(mesh, Topology::Indices).len();
    assert_eq!(parts(&check_offset(&both, 0.08, 0.01)), 2);
    assert_eq!(parts(&check_offset(&both, 0.13, 0.01)), 1);
}

#[test]
fn a_wall_thinner_than_twice_the_distance_vanishes() {
    // A plate on a block.
    let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 0.1], [0.8, 0.1], [0.8, 1.0], [0.0, 1.0]];
    let mesh = prism(&outline, &[[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]], 1.0);
    let left = check_offset(&mesh, -0.2, 0.005);
    assert!(left.bounds().max[0] < 0.7, "{:?}", left.bounds());
    let nothing = mesh_to_offset(&mesh, -0.5, &budget(0.005), &Job::default());
    assert!(matches!(nothing, Err(Failure::Refused(refusal)) if refusal.code == RefusalCode::Empty));
}

#[test]
fn scale_and_threads_change_nothing_but_the_numbers() {
    let mesh = bracket();
    let reference = check_offset(&mesh, 0.1, 0.01);
    let one = mesh_to_offset(&mesh, 0.1, &budget(0.01), &Job::default().with_threads(1)).expect("as above");
    assert_eq!(one.shape.positions(), reference.positions());
    assert_eq!(one.shape.faces(), reference.faces());
    for scale in [2_f64.powi(-20), 2_f64.powi(20)] {
        let scaled = mesh.positions().iter().map(|p| p.map(|x| x * scale)).collect();
        let scaled = Mesh::new(scaled, mesh.faces().to_vec()).expect("in range");
        let offset =
            mesh_to_offset(&scaled, 0.1 * scale, &budget(0.01 * scale), &Job::default()).expect("as above");
        assert_eq!(offset.shape.faces(), reference.faces());
    }
}

#[test]
fn a_false_mesh_is_not_proved() {
    // The offset by another distance, one that lost a part, one with a hole.
    let (mesh, job) = (bracket(), Job::default());
    let offset = check_offset(&mesh, 0.1, 0.01);
    assert!(
        check::offset_deviation(&offset, &mesh, 0.125, 0.02, &job)
            .expect("not cancelled")
            .at_most()
            .is_none()
    );
    let mut faces = offset.faces().to_vec();
    faces.pop();
    let open = Mesh::new(offset.positions().to_vec(), faces).expect("in range");
    assert!(
        check::offset_deviation(&open, &mesh, 0.1, 0.02, &job).expect("not cancelled").at_most().is_none()
    );
    // A void: the offset of a hollow block has an inner wall, too.
    let block = cuboid([1.0; 3]);
    let inner: Vec<[f64; 3]> = block.positions().iter().map(|p| p.map(|x| 0.25 + 0.5 * x)).collect();
    let reversed = block.faces().iter().map(|[a, b, c]| [a + 8, c + 8, b + 8]);
    let hollow = Mesh::new(
        [block.positions().to_vec(), inner].concat(),
        block.faces().iter().copied().chain(reversed).collect(),
    );
    let hollow = hollow.expect("in range");
    let whole = check_offset(&hollow, 0.05, 0.01);
    assert_eq!(check::components(&whole, Topology::Indices).len(), 2);
    let outer = check_offset(&block, 0.05, 0.01);
    assert!(
        check::offset_deviation(&outer, &hollow, 0.05, 0.01, &job)
            .expect("not cancelled")
            .at_most()
            .is_none()
    );
}

#[test]
fn an_open_mesh_is_not_proved_even_if_its_faces_are_there_twice() {
    // A box without its bottom, whose faces are all there twice: around a corner of the solid it winds once, in floating point.
    let solid = cuboid([2.0; 3]);
    let shape = cuboid([3.0, 3.0, 2.5]);
    let positions = shape.positions().iter().map(|[x, y, z]| [x - 0.5, y - 0.5, *z]).collect();
    let is_bottom = |face: &&[u32; 3]| face.iter().all(|v| shape.positions()[*v as usize][2] == 0.0);
    let sides: Vec<[u32; 3]> = shape.faces().iter().filter(|face| !is_bottom(face)).copied().collect();
    assert_eq!(sides.len(), 10);
    let twice = Mesh::new(positions, [sides.clone(), sides].concat()).expect("in range");
    let bound = check::offset_deviation(&twice, &solid, 0.6, 0.5, &Job::default()).expect("not cancelled");
    assert!(bound.at_most().is_none(), "{bound:?}");
}

#[test]
fn rows_at_one_position_and_faces_with_a_corner_twice_change_nothing() {
    let solid = bracket();
    let offset = check_offset(&solid, 0.1, 0.01);
    // A soup, as an STL has it, and a face that is a point far away.
    let soup = |mesh: &Mesh, far: bool| {
        let mut positions: Vec<[f64; 3]> =
            (0..mesh.faces().len()).flat_map(|face| mesh.corners(face)).collect();
        positions.extend([[9.0; 3]].repeat(if far { 3 } else { 0 }));
        let faces = (0..positions.len() as u32 / 3).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]);
        Mesh::new(positions.clone(), faces.collect()).expect("in range")
    };
    let (job, limit) = (Job::default(), 0.01);
    let bound = check::offset_deviation(&soup(&offset, false), &soup(&solid, true), 0.1, limit, &job);
    assert!(bound.expect("not cancelled").at_most().is_some_and(|most| most <= limit));
    let again = mesh_to_offset(&soup(&solid, true), 0.1, &budget(limit), &job).expect("the same solid");
    assert!(again.shape.bounds().max[0] < 3.0);
}

#[test]
fn what_has_no_offset_is_refused() {
    let mesh = cuboid([1.0; 3]);
    let code = |mesh: &Mesh, by: f64| match mesh_to_offset(mesh, by, &budget(0.01), &Job::default()) {
        Err(Failure::Refused(refusal)) => refusal.code,
        other => panic!("{other:?}"),
    };
    assert_eq!(code(&mesh, 0.0), RefusalCode::Usage);
    assert_eq!(code(&mesh, f64::NAN), RefusalCode::Usage);
    let open = Mesh::new(mesh.positions().to_vec(), mesh.faces()[1..].to_vec()).expect("in range");
    assert_eq!(code(&open, 0.1), RefusalCode::Unsupported);
    assert_eq!(code(&Mesh::new(Vec::new(), Vec::new()).expect("empty"), 0.1), RefusalCode::Empty);
}
