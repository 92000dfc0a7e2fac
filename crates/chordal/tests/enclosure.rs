//! The laws of being inside: exact where a mesh is closed, bounded winding numbers where it is not, batches
//! as one by one.
use chordal::explicit::query::{Bvh, Enclosure, PointLocation, Ray};
use chordal::{Job, Mesh};
use chordal_testkit::Random;

/// The unit cube times `size`, each side in `n × n` squares of two triangles, outward.
fn cube(n: i32, size: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for axis in 0..3 {
        for end in [0, n] {
            let first = positions.len() as u32;
            for i in 0..=n {
                for j in 0..=n {
                    let mut p = [0.0; 3];
                    p[axis] = f64::from(end) * size / f64::from(n);
                    p[(axis + 1) % 3] = f64::from(i) * size / f64::from(n);
                    p[(axis + 2) % 3] = f64::from(j) * size / f64::from(n);
                    positions.push(p);
                }
            }
            let at = |i: i32, j: i32| first + (i * (n + 1) + j) as u32;
            for i in 0..n {
                for j in 0..n {
                    let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                    let quad = if end == 0 { [quad[3], quad[2], quad[1], quad[0]] } else { quad };
                    // Either diagonal, so that rays meet corners of all kinds.
                    let k = ((i + j) % 2) as usize;
                    faces.push([quad[k], quad[k + 1], quad[k + 2]]);
                    faces.push([quad[k], quad[k + 2], quad[(k + 3) % 4]]);
                }
            }
        }
    }
    (positions, faces)
}

/// A torus around z with radii 2 and 1, `n` times `n` quads.
fn torus(n: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let at = |i: u32, j: u32| (i % n) * n + j % n;
    let angle = |i: u32| libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(n));
    let position = |i: u32, j: u32| {
        let ((sin, cos), (up, out)) = (angle(i), angle(j));
        [(2.0 + out) * cos, (2.0 + out) * sin, up]
    };
    let rows = || (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let faces = rows().flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    (rows().map(|(i, j)| position(i, j)).collect(), faces.collect())
}

fn mesh((positions, faces): (Vec<[f64; 3]>, Vec<[u32; 3]>)) -> Mesh {
    Mesh::new(positions, faces).expect("valid")
}

fn bvh(mesh: &Mesh) -> Bvh {
    Bvh::build(mesh, &Job::default()).expect("small")
}

#[test]
fn points_of_a_lattice_are_inside_on_or_outside_of_a_cube_exactly() {
    // Every vertical line through the lattice runs along edges, through corners, or within sides.
    for (n, scale, shift) in [(4, 1.0, 0.0), (4, libm::ldexp(1.0, -20), 0.0), (3, 1.0, 1e6), (1, 1.0, 0.0)] {
        let (positions, faces) = cube(n, f64::from(n) * scale);
        let positions = positions.iter().map(|p| p.map(|x| x + shift)).collect();
        let mesh = mesh((positions, faces));
        let bvh = bvh(&mesh);
        let enclosure = Enclosure::new(&mesh, &bvh);
        assert!(enclosure.is_closed());
        let lattice = -1..=2 * n + 1;
        for (x, y, z) in lattice.clone().flat_map(|x| {
            let lattice = lattice.clone();
            lattice.clone().flat_map(move |y| lattice.clone().map(move |z| (x, y, z)))
        }) {
            let p = [x, y, z].map(|k| 0.5 * f64::from(k) * scale + shift);
            let inside = [x, y, z].iter().all(|k| *k > 0 && *k < 2 * n);
            let touches = [x, y, z].iter().all(|k| *k >= 0 && *k <= 2 * n);
            let expected = match (inside, touches) {
                (true, _) => PointLocation::Inside,
                (_, true) => PointLocation::On,
                _ => PointLocation::Outside,
            };
            let found = enclosure.inside(p);
            assert_eq!(found.side, expected, "{p:?} of {n}");
            if expected != PointLocation::On {
                assert_eq!(
                    (found.winding.value, found.winding.off_at_most),
                    (f64::from(u8::from(inside)), 0.0)
                );
            }
        }
    }
}

#[test]
fn a_hair_beside_the_surface_decides() {
    let mesh = mesh(cube(2, 1.0));
    let bvh = bvh(&mesh);
    let enclosure = Enclosure::new(&mesh, &bvh);
    for side in 0..3 {
        for (x, expected) in [
            (1.0, PointLocation::On),
            (1.0_f64.next_up(), PointLocation::Outside),
            (1.0_f64.next_down(), PointLocation::Inside),
            (1e-300, PointLocation::Inside),
            (-1e-300, PointLocation::Outside),
        ] {
            let mut p = [0.3, 0.4, 0.6];
            p[side] = x;
            assert_eq!(enclosure.inside(p).side, expected, "{p:?}");
        }
    }
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(enclosure.inside([0.5, bad, 0.5]).side, PointLocation::Outside);
        assert!(enclosure.winding_number([0.5, bad, 0.5], 0.1).is_none());
    }
}

#[test]
fn random_points_are_inside_a_torus_where_its_formula_says_so() {
    let seed = 5;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let mesh = mesh(torus(200));
    let bvh = bvh(&mesh);
    let enclosure = Enclosure::new(&mesh, &bvh);
    assert!(enclosure.is_closed());
    let points: Vec<[f64; 3]> = (0..20_000).map(|_| random.point_within::<3>(3.2)).collect();
    let found = enclosure.inside_all(&points, &Job::default());
    let mut inside = 0;
    for (p, found) in points.iter().zip(&found) {
        assert_eq!(*found, enclosure.inside(*p));
        let off = (p[0].hypot(p[1]) - 2.0).hypot(p[2]) - 1.0;
        // The triangles leave the torus by less than this.
        if off.abs() > 2e-3 {
            let expected = if off < 0.0 { PointLocation::Inside } else { PointLocation::Outside };
            assert_eq!(found.side, expected, "{p:?}");
            inside += usize::from(off < 0.0);
        }
    }
    assert!(inside > 1000);
}

#[test]
fn walls_that_overlap_or_face_inward_are_counted() {
    let (positions, faces) = cube(2, 2.0);
    let n = positions.len() as u32;
    // A second cube that overlaps the first, and a third that faces inward.
    let twice = |shift: f64, flip: bool| {
        let moved = positions.iter().map(|p| p.map(|x| x + shift));
        let all: Vec<_> = positions.iter().copied().chain(moved).collect();
        let second = faces.iter().map(|f| f.map(|i| i + n));
        let second = second.map(|[a, b, c]| if flip { [a, c, b] } else { [a, b, c] });
        mesh((all, faces.iter().copied().chain(second).collect()))
    };
    let winding = |mesh: &Mesh, p| {
        let bvh = bvh(mesh);
        let enclosure = Enclosure::new(mesh, &bvh);
        assert!(enclosure.is_closed());
        let found = enclosure.inside(p);
        (found.side, found.winding.value)
    };
    let two = twice(1.0, false);
    assert_eq!(winding(&two, [1.5; 3]), (PointLocation::Inside, 2.0));
    assert_eq!(winding(&two, [0.5; 3]), (PointLocation::Inside, 1.0));
    assert_eq!(winding(&two, [2.75; 3]), (PointLocation::Inside, 1.0));
    let less = twice(1.0, true);
    assert_eq!(winding(&less, [1.5; 3]), (PointLocation::Outside, 0.0));
    assert_eq!(winding(&less, [2.75; 3]), (PointLocation::Outside, -1.0));
    // Doubled walls that cancel out leave nothing.
    assert_eq!(winding(&twice(0.0, true), [1.25; 3]), (PointLocation::Outside, 0.0));
}

#[test]
fn a_cube_without_its_bottom_hides_five_sixths_from_its_middle() {
    let (positions, faces) = cube(8, 1.0);
    let kept: Vec<_> =
        faces.into_iter().filter(|f| f.iter().any(|i| positions[*i as usize][2] > 0.0)).collect();
    let mesh = mesh((positions, kept));
    let bvh = bvh(&mesh);
    let enclosure = Enclosure::new(&mesh, &bvh);
    assert!(!enclosure.is_closed());
    let middle = [0.5; 3];
    let exact = bvh.winding_number_plain(middle).expect("it has faces");
    assert!((exact.value - 5.0 / 6.0).abs() <= exact.off_at_most && exact.off_at_most < 1e-10);
    let found = enclosure.winding_number(middle, 1e-3).expect("it has faces");
    assert!((found.value - 5.0 / 6.0).abs() <= found.off_at_most && found.off_at_most <= 1e-3);
    assert_eq!(enclosure.inside(middle).side, PointLocation::Inside);
    assert_eq!(enclosure.inside([0.5, 0.5, 0.0]).side, PointLocation::Ambiguous);
    assert_eq!(enclosure.inside([0.5, 0.5, -2.0]).side, PointLocation::Outside);
    assert_eq!(enclosure.inside([0.5, 0.5, 1.0]).side, PointLocation::On);
}

#[test]
fn sums_by_clusters_stay_within_their_bound_of_the_plain_sum() {
    let seed = 6;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let soup = |random: &mut Random| {
        let positions: Vec<_> = (0..3000).map(|_| random.point_within::<3>(1.0)).collect();
        let faces = (0..1000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        mesh((positions, faces))
    };
    let half = |mut t: (Vec<[f64; 3]>, Vec<[u32; 3]>)| {
        t.1.retain(|f| t.0[f[0] as usize][1] > 0.0);
        mesh(t)
    };
    for (name, mesh) in
        [("soup", soup(&mut random)), ("half a torus", half(torus(60))), ("torus", mesh(torus(40)))]
    {
        let bvh = bvh(&mesh);
        let enclosure = Enclosure::new(&mesh, &bvh);
        let mut worst: f64 = 0.0;
        for round in 0..400 {
            let p = random.point_within::<3>([1.0, 3.5, 20.0][round % 3]);
            let exact = bvh.winding_number_plain(p).expect("it has faces");
            for within in [0.25, 1.0 / 16.0, 1e-3] {
                let found = enclosure.winding_number(p, within).expect("it has faces");
                let off = (found.value - exact.value).abs();
                assert!(off <= found.off_at_most + exact.off_at_most, "{name} {p:?}: {off:e} {found:?}");
                assert!(found.off_at_most <= within, "{name} {p:?}: {found:?}");
                worst = worst.max(off / found.off_at_most);
            }
            if name == "torus" {
                assert!((exact.value - exact.value.round()).abs() <= exact.off_at_most);
                let found = enclosure.inside(p);
                assert_eq!(found.winding.value, exact.value.round(), "{p:?}");
            }
        }
        println!("{name}: at worst {worst:.3} of the bound");
        assert!(worst > 0.0, "the clusters are never used");
    }
}

#[test]
fn scaling_by_powers_of_two_and_a_shift_keep_every_verdict() {
    let seed = 7;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    // On a lattice a shift by a million is exact.
    let lattice = |p: [f64; 3]| p.map(|x| (x * 1024.0).round() / 1024.0);
    let (positions, mut faces) = torus(30);
    faces.truncate(faces.len() - 100);
    let positions: Vec<_> = positions.into_iter().map(lattice).collect();
    let points: Vec<_> = (0..300).map(|_| lattice(random.point_within::<3>(3.0))).collect();
    let sides = |map: &dyn Fn([f64; 3]) -> [f64; 3]| {
        let moved = mesh((positions.iter().map(|p| map(*p)).collect(), faces.clone()));
        let bvh = bvh(&moved);
        let enclosure = Enclosure::new(&moved, &bvh);
        points.iter().map(|p| enclosure.inside(map(*p))).collect::<Vec<_>>()
    };
    let plain = sides(&|p| p);
    assert!(plain.iter().any(|found| found.side == PointLocation::Inside));
    for exponent in [-20, 20] {
        assert_eq!(sides(&|p| p.map(|x| libm::ldexp(x, exponent))), plain);
    }
    let shifted = sides(&|p| p.map(|x| x + 1e6));
    assert!(shifted.iter().zip(&plain).all(|(a, b)| a.side == b.side));
}

#[test]
fn batches_give_the_answers_of_single_queries_to_the_last_bit() {
    let seed = 8;
    println!("seed {seed}");
    let mut random = Random::new(seed);
    let mesh = mesh(torus(100));
    let bvh = bvh(&mesh);
    let far = |random: &mut Random| Ray::new(random.point_within::<3>(5.0), random.point_within::<3>(1.0));
    let mut rays: Vec<Ray> = (0..3000).map(|_| far(&mut random)).collect();
    // Side by side, as a camera has them, through corners of the mesh, and some that are no rays.
    rays.extend((0..3000).map(|i| {
        let at = [f64::from(i % 60) / 10.0 - 3.0, f64::from(i / 60) / 8.0 - 3.0, 4.0];
        Ray::new(at, [0.0, 0.0, -1.0])
    }));
    rays.extend(
        mesh.positions()
            .iter()
            .take(500)
            .map(|p| Ray::new([0.1, 0.2, 9.0], std::array::from_fn(|k| p[k] - [0.1, 0.2, 9.0][k]))),
    );
    rays.push(Ray::new([0.0; 3], [0.0; 3]));
    rays.push(Ray::new([f64::NAN; 3], [1.0; 3]));
    let mut limited = rays[0];
    limited.t_max = 0.5;
    rays.push(limited);
    let expected: Vec<_> = rays.iter().map(|ray| bvh.first_hit(ray)).collect();
    assert!(expected.iter().filter(|hit| hit.is_some()).count() > 1000);
    let points: Vec<_> = (0..3000).map(|_| random.point_within::<3>(4.0)).chain([[f64::NAN; 3]]).collect();
    let closest: Vec<_> = points.iter().map(|p| bvh.closest_point(*p)).collect();
    for threads in [1, 2, 3] {
        let job = Job::default().with_threads(threads);
        assert_eq!(bvh.first_hits(&rays, &job), expected);
        assert_eq!(bvh.closest_points(&points, &job), closest);
    }
    let empty = Bvh::build(&Mesh::default(), &Job::default()).expect("empty");
    assert_eq!(empty.first_hits(&rays[..2], &Job::default()), [None, None]);
    assert!(empty.first_hits(&[], &Job::default()).is_empty());
}
