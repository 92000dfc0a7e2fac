//! Meshes of limit surfaces keep their bound, as a referee sees it that has only plain rounds and the masks
//! of smooth vertices, creases and corners.
use super::corpus::cages;
use chordal::budget::Pixels;
use chordal::check::{self, Goal};
use chordal::explicit::subdivision::{INFINITELY_SHARP, Scheme};
use chordal::explicit::{Cage, Semantic, Topology};
use chordal::{Budget, Job, Mesh, Tolerance, convert};
use chordal_testkit::Random;
use chordal_testkit::{is_long, some};
use std::collections::BTreeMap;

fn diagonal(cage: &Cage) -> f64 {
    let mut sum = 0.0;
    for k in 0..3 {
        let axis = cage.positions().iter().map(|p| p[k]);
        let (low, high) = axis.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        sum += (high - low) * (high - low);
    }
    f64::sqrt(sum)
}

/// The vertices of a cage of quads on its limit surface, by masks; where creases end, about.
fn on_limit(cage: &Cage) -> Vec<[f64; 3]> {
    let n = cage.positions().len();
    let (mut faces, mut edges) = (vec![Vec::new(); n], BTreeMap::<[u32; 2], (u32, f64)>::new());
    for face in cage.faces() {
        for k in 0..4 {
            faces[face[k] as usize].push([face[(k + 1) % 4], face[(k + 2) % 4]]);
            let (a, b) = (face[k].min(face[(k + 1) % 4]), face[k].max(face[(k + 1) % 4]));
            edges.entry([a, b]).or_default().0 += 1;
        }
    }
    cage.creases().iter().for_each(|(ends, sharp)| edges.get_mut(ends).unwrap().1 = *sharp);
    let mut sharp = vec![Vec::new(); n];
    for (ends, _) in edges.iter().filter(|(_, (count, sharpness))| *count != 2 || *sharpness > 0.0) {
        sharp[ends[0] as usize].push(ends[1]);
        sharp[ends[1] as usize].push(ends[0]);
    }
    let corners: BTreeMap<u32, f64> = cage.sharp_vertices().iter().copied().collect();
    let at = |v: u32| cage.positions()[v as usize];
    let mean = |weights: &[(f64, u32)]| {
        let whole: f64 = weights.iter().map(|w| w.0).sum();
        [0, 1, 2].map(|k| weights.iter().map(|(weight, v)| weight * at(*v)[k]).sum::<f64>() / whole)
    };
    (0..n as u32)
        .map(|v| {
            let around = &sharp[v as usize];
            if corners.contains_key(&v) || around.len() > 2 || faces[v as usize].is_empty() {
                return at(v);
            }
            if let [a, b] = around[..] {
                return mean(&[(4.0, v), (1.0, a), (1.0, b)]);
            }
            let m = faces[v as usize].len() as f64;
            let mut weights = vec![(m * m, v)];
            faces[v as usize]
                .iter()
                .for_each(|[next, across]| weights.extend([(4.0, *next), (1.0, *across)]));
            mean(&weights)
        })
        .collect()
}

/// Triangles between limit points after some rounds.
fn reference(cage: &Cage, rounds: u32) -> Mesh {
    let fine = cage.refined_times(rounds).unwrap();
    let points = on_limit(&fine);
    let is_there = |face: &usize| fine.holes().binary_search(&(*face as u32)).is_err();
    let faces = (0..fine.n_faces()).filter(is_there).map(|face| fine.face(face));
    let triangles = faces.flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect();
    Mesh::new(points, triangles).unwrap()
}

fn distance(a: &Mesh, b: &Mesh) -> f64 {
    check::deviation(a, b, &Goal::default(), &Job::default()).unwrap().bound.at_least()
}

/// What the referee holds for the limit surface: triangles after some rounds, and how far they may be off.
struct Referee {
    fine: Mesh,
    off: f64,
}

impl Referee {
    fn new(cage: &Cage, rounds: u32) -> Self {
        let fine = reference(cage, rounds);
        let off = distance(&fine, &reference(cage, rounds - 1));
        Self { fine, off }
    }

    /// The bound of a mesh of `share` of the cage's diagonal, and what the referee finds.
    fn judged(&self, cage: &Cage, share: f64) -> (f64, f64) {
        let budget = Budget::length(Tolerance::new(share * diagonal(cage)).unwrap());
        let mesh = convert::cage_to_mesh(cage, &budget, &Job::default()).unwrap();
        let bound = mesh.bound.at_most().unwrap();
        assert!(bound <= share * diagonal(cage), "{bound}");
        let found = distance(&mesh.shape, &self.fine);
        assert!(mesh.bound.at_least() <= found + self.off, "{} against {found}", mesh.bound.at_least());
        (bound, found)
    }
}

#[test]
fn no_cage_of_the_corpus_is_further_than_its_bound() {
    for (name, cage) in some(cages().into_iter().filter(|(_, cage)| cage.scheme() != Scheme::Loop), 6) {
        let many = cage.n_faces() > 100;
        let shares: &[f64] = if many { &[1e-2] } else { &[5e-2, 1e-2, 2e-3] };
        let referee = Referee::new(&cage, if many { 2 } else { 5 });
        let off = referee.off;
        for share in shares {
            let (bound, found) = referee.judged(&cage, *share);
            eprintln!("{name} {share}: {:.3} of the bound, within {:.3}", found / bound, off / bound);
            assert!(found <= bound + off, "{name} {share}: {found} > {bound} + {off}");
        }
    }
}

/// Two rings of quads around a vertex of `n`, lifted at random.
fn star(n: u32, seed: u64) -> Cage {
    let mut random = Random::new(seed);
    let turn = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(n);
    let mut points = vec![[0.0, 0.0, 0.0]];
    // Sector k has the points a·E(k) + b·E(k+1), a > 0, b ≥ 0, a, b ≤ 3.
    for k in 0..n {
        for a in 1..=3 {
            for b in 0..=3 {
                let (a, b) = (f64::from(a), f64::from(b));
                points.push(
                    [0, 1]
                        .map(|i| {
                            let axis = |t: f64| if i == 0 { t.cos() } else { t.sin() };
                            a * axis(turn(k)) + b * axis(turn(k + 1))
                        })
                        .into_iter()
                        .chain([0.0])
                        .collect::<Vec<_>>()
                        .try_into()
                        .unwrap(),
                );
            }
        }
    }
    points.iter_mut().for_each(|p| p[2] = 0.75 * random.signed());
    let id = |k: u32, a: u32, b: u32| match (a, b) {
        (0, 0) => 0,
        (0, _) => 1 + ((k + 1) % n) * 12 + (b - 1) * 4,
        _ => 1 + (k % n) * 12 + (a - 1) * 4 + b,
    };
    let quads = (0..n).flat_map(|k| {
        (0..9)
            .map(move |q| (k, q / 3, q % 3))
            .map(|(k, a, b)| [id(k, a, b), id(k, a + 1, b), id(k, a + 1, b + 1), id(k, a, b + 1)])
    });
    Cage::new(points, quads).unwrap()
}

#[test]
fn stars_keep_their_bounds_and_bounds_are_near() {
    let mut ratios = Vec::new();
    for n in some(3..=12, 3) {
        for seed in 0..if is_long() { 10 } else { 1 } {
            let star = star(n, seed);
            let referee = Referee::new(&star, 4);
            for share in [2e-2, 4e-3] {
                let (bound, found) = referee.judged(&star, share);
                let off = referee.off;
                assert!(found <= bound + off, "{n} {seed} {share}: {found} > {bound} + {off}");
                ratios.push(bound / found);
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    let median = ratios[ratios.len() / 2];
    eprintln!("bound over what was found: {median:.2}, worst {:.2}", ratios[ratios.len() - 1]);
    assert!(median <= 2.3, "{median}");
}

#[test]
fn a_smooth_closed_cage_gives_a_closed_manifold_at_every_budget() {
    for (name, cage) in cages() {
        let creases = cage.creases().iter().any(|crease| crease.1 >= INFINITELY_SHARP);
        if cage.scheme() != Scheme::CatmullClark || creases || cage.n_faces() > 100 {
            continue;
        }
        let closed = {
            let mut count = BTreeMap::<[u32; 2], u32>::new();
            for face in cage.faces() {
                for k in 0..face.len() {
                    let (a, b) = (face[k], face[(k + 1) % face.len()]);
                    *count.entry([a.min(b), a.max(b)]).or_default() += 1;
                }
            }
            count.values().all(|n| *n == 2) && cage.holes().is_empty()
        };
        if !closed {
            continue;
        }
        for share in [0.3, 0.1, 3e-2, 1e-2, 3e-3] {
            let budget = Budget::length(Tolerance::new(share * diagonal(&cage)).unwrap());
            let mesh = convert::cage_to_mesh(&cage, &budget, &Job::default()).unwrap().shape;
            let found = check::validity(&mesh, Topology::Indices);
            assert!(found.closed && found.edge_manifold && found.oriented, "{name} {share}");
        }
    }
}

#[test]
fn threads_do_not_change_a_byte() {
    for (name, cage) in
        cages().into_iter().filter(|(name, _)| name.contains("helmet") || name.contains("nonquads"))
    {
        if cage.scheme() != Scheme::CatmullClark {
            continue;
        }
        let budget = Budget::length(Tolerance::new(1e-2 * diagonal(&cage)).unwrap());
        let by = |threads: usize| {
            convert::cage_to_mesh(&cage, &budget, &Job::default().with_threads(threads)).unwrap()
        };
        let (one, two) = (by(1), by(2));
        assert!(one.shape == two.shape && one.bound == two.bound, "{name}");
    }
}

/// The angle between two vectors in degrees.
fn angle_deg(a: [f64; 3], b: [f64; 3]) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    dot(cross, cross).sqrt().atan2(dot(a, b)).to_degrees()
}

#[test]
fn keeps_an_angle_beside_a_length() {
    for (name, cage) in cages().into_iter().filter(|(name, _)| {
        ["catmark_cube", "catmark_cube_creases1", "catmark_torus", "catmark_inf_crease0", "catmark_tent"]
            .contains(&name.as_str())
    }) {
        let length = 1e-2 * diagonal(&cage);
        let made = |angle_deg: Option<f64>| {
            let budget = Budget { angle_deg, ..Budget::length(Tolerance::new(length).unwrap()) };
            convert::cage_to_mesh(&cage, &budget, &Job::default()).unwrap_or_else(|e| panic!("{name}: {e}"))
        };
        let plain = made(None);
        assert_eq!(plain.bound.angle_deg, None);
        let mut last = plain.shape.faces().len();
        for asked in [8.0, 4.0] {
            let mesh = made(Some(asked));
            let found = mesh.bound.angle_deg.unwrap();
            assert!(found <= asked, "{name}: {found} of {asked}");
            // Half the angle takes about four times the triangles, and never fewer.
            assert!(mesh.shape.faces().len() > last, "{name}: {last}");
            last = mesh.shape.faces().len();
            let normals = mesh.shape.attribute(&Semantic::Normal).unwrap();
            let mut worst = 0.0_f64;
            for face in mesh.shape.faces() {
                let [a, b, c] = face.map(|k| mesh.shape.positions()[k as usize]);
                let minus = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
                let (u, v) = (minus(b, a), minus(c, a));
                let normal =
                    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
                let long = |p: [f64; 3]| (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt() > length;
                if long(u) || long(v) || long(minus(b, c)) {
                    for k in face {
                        worst = worst.max(angle_deg(normal, normals.row(*k as usize).try_into().unwrap()));
                    }
                }
            }
            // Normals of two sides that differ by less than a degree are one in the mesh.
            assert!(worst <= asked + 1.0, "{name}: {worst} of {asked}");
            // What was measured is what is seen.
            assert!(worst >= 0.5 * found, "{name}: {worst}, said to be {found}");
        }
    }
    let cage =
        Cage::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]], [[0, 1, 2, 3]]).unwrap();
    for angle in [0.0, -1.0, 181.0, f64::NAN] {
        let budget = Budget { angle_deg: Some(angle), ..Budget::triangles(10) };
        assert!(convert::cage_to_mesh(&cage, &budget, &Job::default()).is_err(), "{angle}");
    }
}

#[test]
fn a_mesher_that_is_kept_makes_the_meshes_that_a_new_one_makes() {
    for (name, cage) in cages().into_iter().filter(|(name, _)| {
        ["catmark_cube_creases1", "catmark_pole64", "bilinear_nonquads1", "loop_cube_creases0"]
            .contains(&name.as_str())
    }) {
        let mesher = convert::batch::CageMesher::new(&cage, &Job::default()).unwrap();
        for step in [0, 7, 3, 7, 1] {
            let eye = [6.0 - 0.3 * f64::from(step), 4.0, 2.0 + 0.2 * f64::from(step)]
                .map(|x| x * diagonal(&cage) / 4.0);
            let text = format!("640x480 fov=45 eye={},{},{} target=0,0,0", eye[0], eye[1], eye[2]);
            let budget = Budget::pixels(Pixels::new(1.0).unwrap(), text.parse().unwrap());
            let (kept, new) = (
                mesher.mesh(&budget, &Job::default()),
                convert::cage_to_mesh(&cage, &budget, &Job::default()),
            );
            let (kept, new) = (kept.unwrap(), new.unwrap());
            assert_eq!(kept.shape, new.shape, "{name}, {step}");
            assert_eq!(kept.bound, new.bound, "{name}, {step}");
        }
    }
}

#[test]
fn meshes_that_keep_tiles_are_closed_and_within_their_bound_at_every_view() {
    let names = ["catmark_cube_creases1", "catmark_gregory_test3", "bilinear_nonquads1", "catmark_rook"];
    // The last one has 777 faces, the others at most 11.
    let names = if is_long() { &names[..] } else { &names[..3] };
    for (name, cage) in cages().into_iter().filter(|(name, _)| names.contains(&name.as_str())) {
        // Fine enough that the creases have ended.
        let referee = Referee::new(&cage, if cage.n_faces() > 100 { 2 } else { 5 });
        let mesher = convert::batch::CageMesher::new(&cage, &Job::default()).unwrap();
        let mut kept = convert::batch::ViewDependentMesher::from_cage(&mesher);
        let n = cage.positions().len() as f64;
        let middle = [0, 1, 2].map(|k| cage.positions().iter().map(|p| p[k]).sum::<f64>() / n);
        let (mut n_kept, mut n_made) = (0, 0);
        for (number, step) in some([0, 1, 2, 3, 4, 5, 6, 3, 0, -12], 5).into_iter().enumerate() {
            let to = [1.5 - 0.1 * f64::from(step), 1.0, 0.5 + 0.02 * f64::from(step)];
            let eye: [f64; 3] = std::array::from_fn(|k| middle[k] + to[k] * diagonal(&cage));
            let place = |[x, y, z]: [f64; 3]| format!("{x},{y},{z}");
            let text = format!("640x480 fov=45 eye={} target={}", place(eye), place(middle));
            let budget = Budget::pixels(Pixels::new(0.5).unwrap(), text.parse().unwrap());
            let own = kept.mesh(&budget, &Job::default()).unwrap();
            let new = mesher.mesh(&budget, &Job::default()).unwrap();
            assert!(own.bound.pixels.unwrap() <= 0.5, "{name}, {step}");
            let is_closed = |mesh: &Mesh| {
                let found = check::validity(mesh, Topology::Indices);
                (found.closed, found.manifold())
            };
            assert_eq!(is_closed(&own.shape), is_closed(&new.shape), "{name}, {step}");
            // By default where the most was kept on the way there, and at the end.
            if is_long() || [2, 4].contains(&number) {
                let bound = own.bound.at_most().unwrap();
                let found = distance(&own.shape, &referee.fine);
                assert!(found <= bound + referee.off, "{name}, {step}: {found} > {bound} + {}", referee.off);
            }
            // Half of the cells would do, and tiles of few cells have more triangles where they are stitched.
            assert!(own.shape.faces().len() <= 3 * new.shape.faces().len(), "{name}, {step}");
            (n_kept, n_made) = (n_kept + kept.reuse().kept, n_made + kept.reuse().made);
        }
        assert!(n_kept > n_made, "{name}: {n_kept} tiles kept, {n_made} made");
    }
}
