//! The limit surface of Loop's scheme: what rounds converge to, and the same whether a round was done before
//! or not; and its meshes, as a referee sees them that has only plain rounds and the masks of smooth
//! vertices, creases and corners.
use super::corpus::cages;
use chordal::budget::RefusalCode;
use chordal::check::{self, Goal};
use chordal::explicit::subdivision::{Boundary, CreasingMethod, INFINITELY_SHARP, Jet, Scheme};
use chordal::explicit::{Cage, Topology};
use chordal::{Bounded, Budget, Failure, Job, Mesh, Tolerance, convert};
use chordal_testkit::sampler::distance;
use chordal_testkit::{Random, is_long, some};
use std::collections::BTreeMap;

type Point = [f64; 3];

fn of_corpus() -> impl Iterator<Item = (String, Cage)> {
    cages().into_iter().filter(|(_, cage)| cage.scheme() == Scheme::Loop)
}

fn size(cage: &Cage) -> f64 {
    cage.positions().as_flattened().iter().fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most })
}

/// `rings` rings of triangles around a vertex of n neighbours, lifted at random.
fn star(n: u32, rings: u32, seed: u64) -> Cage {
    let mut random = Random::new(seed);
    let turn = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(n);
    let mut points = vec![[0.0, 0.0, 0.5 * random.signed()]];
    // Ring r has n·r points.
    for r in 1..=rings {
        for k in 0..n * r {
            let (sector, step) = (k / r, f64::from(k % r));
            let (a, b) = (turn(sector), turn(sector + 1));
            let along = |f: fn(f64) -> f64| (f64::from(r) - step) * f(a) + step * f(b);
            points.push([along(f64::cos), along(f64::sin), 0.75 * random.signed()]);
        }
    }
    let id = |r: u32, k: u32| if r == 0 { 0 } else { 1 + n * r * (r - 1) / 2 + k % (n * r) };
    let mut faces = Vec::new();
    for r in 0..rings {
        for sector in 0..n {
            for step in 0..=r {
                let (low, high) = (sector * r + step, sector * (r + 1) + step);
                faces.push([id(r, low), id(r + 1, high), id(r + 1, high + 1)]);
                if step < r {
                    faces.push([id(r, low), id(r + 1, high + 1), id(r, low + 1)]);
                }
            }
        }
    }
    Cage::new(points, faces).unwrap().with_scheme(Scheme::Loop).unwrap()
}

/// A cage of triangles at random: planes folded together, creases and corners of any sharpness.
fn random(seed: u64) -> Cage {
    let mut random = Random::new(seed);
    let mut pick = |n: u32| random.below(n as usize) as u32;
    let n = 4 + pick(6);
    let points: Vec<Point> = (0..n).map(|_| [0, 1, 2].map(|_| f64::from(pick(1000)) * 1e-3)).collect();
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for _ in 0..2 + pick(14) {
        let face = [pick(n), pick(n), pick(n)];
        if face[0] != face[1] && face[1] != face[2] && face[2] != face[0] {
            faces.push(face);
        }
    }
    if faces.is_empty() {
        faces.push([0, 1, 2]);
    }
    let sharps = [0.3, 1.0, 2.5, 10.0];
    let creases: Vec<([u32; 2], f64)> = (0..pick(4))
        .map(|_| {
            let face = faces[pick(faces.len() as u32) as usize];
            ([face[0], face[1]], sharps[pick(4) as usize])
        })
        .collect();
    let corners: Vec<(u32, f64)> = (0..pick(3)).map(|_| (pick(n), sharps[pick(4) as usize])).collect();
    let boundary = [Boundary::None, Boundary::EdgeOnly, Boundary::EdgeAndCorner][pick(3) as usize];
    let creasing = [CreasingMethod::Uniform, CreasingMethod::Chaikin][pick(2) as usize];
    let cage = Cage::new(points, faces).unwrap().with_scheme(Scheme::Loop).unwrap();
    let cage = cage.with_boundary(boundary).with_creasing(creasing);
    cage.with_creases(&creases).unwrap().with_sharp_vertices(&corners).unwrap()
}

/// The places of a triangle that tests look at.
const PLACES: [[f64; 2]; 8] =
    [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.3, 0.6], [0.25, 0.125], [0.9, 0.03], [0.0, 0.4], [0.002, 0.001]];

/// Where a place of a part of a triangle is in it: parts begin at their corner, the last one at the middle of
/// the first side.
fn in_face(part: usize, [s, t]: [f64; 2]) -> [f64; 2] {
    match part {
        0 => [0.5 * s, 0.5 * t],
        1 => [1.0 - 0.5 * (s + t), 0.5 * s],
        2 => [0.5 * t, 1.0 - 0.5 * (s + t)],
        _ => [0.5 - 0.5 * t, 0.5 * (s + t)],
    }
}

#[test]
fn rounds_converge_to_it() {
    for (name, cage) in of_corpus() {
        let limit = cage.limit().unwrap();
        let mut before = f64::INFINITY;
        for rounds in [3_u32, 6] {
            let fine = cage.refined_times(rounds).unwrap();
            let n = 1_usize << rounds;
            let mut worst = 0.0;
            for index in 0..limit.n_sheets() {
                let (face, _) = limit.face_of(index);
                let sheet = limit.sheet(index).unwrap();
                let mut first = face * n * n;
                for row in 0..n {
                    // Those that stand on the row, each with its first corner, in turn with those that hang.
                    for column in (0..n - row).filter(|column| (column + row) % (n / 8) == 0) {
                        let vertex = fine.face(first + 2 * column)[0];
                        let here = sheet.at(column as f64 / n as f64, row as f64 / n as f64).unwrap();
                        worst = f64::max(worst, distance(here.point, fine.positions()[vertex as usize]));
                    }
                    first += 2 * (n - row) - 1;
                }
            }
            worst /= size(&cage);
            eprintln!("{name}: {rounds} rounds, {worst:.2e}");
            let ends = cage.creases().iter().any(|crease| crease.1 < INFINITELY_SHARP);
            assert!(ends || worst < 0.3 * before, "{name}: {worst} after {before}");
            assert!(rounds == 3 || worst < 5e-3, "{name}: {worst}");
            before = worst;
        }
    }
}

/// Whether two faces have the same three vertices: edges of a round may then end alike, which
/// [`Cage::refined`] takes for one.
fn is_doubled(cage: &Cage) -> bool {
    let mut faces: Vec<[u32; 3]> = cage.faces().map(|face| [face[0], face[1], face[2]]).collect();
    faces.iter_mut().for_each(|face| face.sort_unstable());
    faces.sort_unstable();
    faces.windows(2).any(|pair| pair[0] == pair[1])
}

#[test]
fn faces_agree_on_their_edges() {
    let stars = (3..=12).map(|n| (format!("star {n}"), star(n, 2, 3)));
    let n = if is_long() { 3000 } else { 800 };
    let all = (0..n).map(|seed| (format!("random {seed}"), random(seed)));
    for (name, cage) in of_corpus().chain(stars).chain(all) {
        let limit = cage.limit().unwrap();
        let mut seen = BTreeMap::<([u32; 2], u32), Point>::new();
        for index in 0..limit.n_sheets() {
            let sheet = limit.sheet(index).unwrap();
            let face = cage.face(limit.face_of(index).0);
            for k in 0..3 {
                let (a, b) = (face[k], face[(k + 1) % 3]);
                for step in 0..=20_u32 {
                    let t = f64::from(step) / 20.0;
                    let [u, v] = [[t, 0.0], [1.0 - t, t], [0.0, 1.0 - t]][k];
                    let here = sheet.at(u, v).unwrap().point;
                    let key = if a < b { ([a, b], step) } else { ([b, a], 20 - step) };
                    let there = *seen.entry(key).or_insert(here);
                    let off = distance(here, there) / size(&cage);
                    assert!(off < 1e-12, "{name}: sheet {index} edge {a} {b} at {t}: off by {off}");
                }
            }
        }
    }
}

/// By how much a round moves the surface, as a share of the size; and the number of places.
fn moved(cage: &Cage) -> (f64, usize) {
    let once = cage.refined().unwrap();
    let (limit, after) = (cage.limit().unwrap(), once.limit().unwrap());
    let mut part_of = vec![None; once.n_faces()];
    (0..after.n_sheets()).for_each(|sheet| part_of[after.face_of(sheet).0] = Some(sheet));
    let (mut most, mut n) = (0.0, 0);
    for index in 0..limit.n_sheets() {
        let (face, _) = limit.face_of(index);
        let sheet = limit.sheet(index).unwrap();
        for part in 0..4 {
            let child = after.sheet(part_of[4 * face + part].unwrap()).unwrap();
            for place in PLACES {
                let [u, v] = in_face(part, place);
                let (a, b) = (sheet.at(u, v).unwrap(), child.at(place[0], place[1]).unwrap());
                let off = distance(a.point, b.point) / size(cage);
                assert!(off < 1e-12, "sheet {index} part {part} at {place:?}: {off}");
                most = f64::max(most, off);
                n += 1;
                if let (Jet { normal: Some(p), .. }, Jet { normal: Some(q), .. }) = (a, b) {
                    // Corners of several triangles settle slowly.
                    assert!(distance(p, q) < 5e-2, "sheet {index} part {part} at {place:?}: {p:?} {q:?}");
                }
            }
        }
    }
    (most, n)
}

#[test]
fn a_round_leaves_it_where_it_is() {
    for (name, cage) in of_corpus().filter(|(_, cage)| !is_doubled(cage)) {
        let (most, n) = moved(&cage);
        eprintln!("{name}: {n} places, off by {most:.2e} at most");
    }
    for n in 3..=12 {
        moved(&star(n, 2, 7));
    }
    let all = (0..400).map(random).filter(|cage| !is_doubled(cage));
    let mut n = 0;
    for cage in all {
        moved(&cage);
        n += 1;
    }
    assert!(n > 50, "{n}");
}

#[test]
fn derivatives_are_those_of_the_points() {
    let h = 1e-4;
    let mut n = 0;
    for (name, cage) in of_corpus().chain([(String::from("star"), star(7, 2, 1))]) {
        let limit = cage.limit().unwrap();
        for index in 0..limit.n_sheets() {
            let sheet = limit.sheet(index).unwrap();
            let point = |u: f64, v: f64| sheet.at(u, v).unwrap().point;
            // Nowhere near a line where polynomials meet.
            for [u, v] in [[0.3, 0.17], [0.09, 0.8], [0.71, 0.11], [0.41, 0.37]] {
                let jet = sheet.at(u, v).unwrap();
                let (Some(first), Some(second)) = (jet.first, jet.second) else { panic!("{name}") };
                let scale = 1.0 / h;
                let mixed: Point = std::array::from_fn(|k| {
                    let corner = |a: f64, b: f64| point(u + a * h, v + b * h)[k];
                    let cross =
                        (corner(1.0, 1.0) - corner(1.0, -1.0)) - (corner(-1.0, 1.0) - corner(-1.0, -1.0));
                    0.25 * scale * scale * cross
                });
                let along = |du: f64, dv: f64| -> [Point; 2] {
                    let (a, b) = (point(u - du * h, v - dv * h), point(u + du * h, v + dv * h));
                    let slope = std::array::from_fn(|k| 0.5 * scale * (b[k] - a[k]));
                    [
                        slope,
                        std::array::from_fn(|k| {
                            scale * scale * ((a[k] - jet.point[k]) + (b[k] - jet.point[k]))
                        }),
                    ]
                };
                let ([by_u, by_uu], [by_v, by_vv]) = (along(1.0, 0.0), along(0.0, 1.0));
                let found = [by_u, by_v, by_uu, mixed, by_vv];
                for (k, (a, b)) in
                    found.into_iter().zip([first[0], first[1], second[0], second[1], second[2]]).enumerate()
                {
                    // Rounding over h and over h², and what is left of the fourth derivative.
                    let off = distance(a, b) / size(&cage);
                    let most = if k < 2 { 1e-5 } else { 1e-3 };
                    assert!(off < most, "{name} sheet {index} at {u}, {v}: derivative {k}: {a:?} {b:?}");
                    n += 1;
                }
                if let Some(normal) = jet.normal {
                    let dot = |d: Point| (0..3).map(|k| d[k] * normal[k]).sum::<f64>() / size(&cage);
                    assert!(dot(first[0]).abs() < 1e-12 && dot(first[1]).abs() < 1e-12);
                }
            }
        }
    }
    assert!(n > 100, "{n}");
}

#[test]
fn masks_at_vertices_of_any_number_are_the_limits_of_rounds() {
    for n in 3..=12 {
        for (seed, crease) in [(0, false), (1, false), (2, true)] {
            let cage = star(n, 2, seed);
            // From the middle to both sides, along edges.
            let line = [([0, 1], INFINITELY_SHARP), ([0, 1 + n / 2], INFINITELY_SHARP)];
            let cage = if crease { cage.with_creases(&line).unwrap() } else { cage };
            let (mut fine, mut normal) = (cage.clone(), [0.0; 3]);
            // Only what is around the middle, so that many rounds cost nothing.
            for round in 1..=40 {
                fine = around_first(&fine.refined().unwrap(), n);
                // Later where it settles slowly, before all is as near as rounding where it does so fast.
                if round == 4 + 3 * n {
                    let at = |k: usize| fine.positions()[fine.face(0)[k] as usize];
                    let sides = [1, 2].map(|k| [0, 1, 2].map(|i| at(k)[i] - at(0)[i]));
                    let cross = [0, 1, 2].map(|i| {
                        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                        sides[0][j] * sides[1][k] - sides[0][k] * sides[1][j]
                    });
                    normal = cross.map(|x| x / distance(cross, [0.0; 3]));
                }
            }
            let jet = cage.limit().unwrap().sheet(0).unwrap().at(0.0, 0.0).unwrap();
            let there = fine.positions()[fine.face(0)[0] as usize];
            assert!(distance(jet.point, there) < 1e-12, "{n} {seed}: {:?} {there:?}", jet.point);
            assert!(distance(jet.normal.unwrap(), normal) < 5e-3, "{n} {seed}: {:?} {normal:?}", jet.normal);
        }
    }
}

/// The two rings around the middle of a star after a round, as a star that begins with the same face.
fn around_first(fine: &Cage, n: u32) -> Cage {
    let middle = fine.face(0)[0];
    let near: Vec<u32> = fine.faces().filter(|face| face.contains(&middle)).flatten().copied().collect();
    let faces: Vec<[u32; 3]> = fine
        .faces()
        .filter(|face| face.iter().any(|v| near.contains(v)))
        .map(|face| [face[0], face[1], face[2]])
        .collect();
    assert!(faces.len() > n as usize);
    let mut used: Vec<u32> = faces.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    let local = |v: u32| used.partition_point(|u| *u < v) as u32;
    let points = used.iter().map(|v| fine.positions()[*v as usize]).collect();
    let is_here = |v: &u32| used.binary_search(v).is_ok();
    let creases = fine.creases().iter().filter(|(ends, _)| ends.iter().all(is_here));
    let creases: Vec<_> = creases.map(|(ends, sharp)| (ends.map(local), *sharp)).collect();
    let cage = Cage::new(points, faces.iter().map(|face| face.map(local))).unwrap();
    cage.with_scheme(Scheme::Loop).unwrap().with_creases(&creases).unwrap()
}

#[test]
fn it_moves_with_the_cage() {
    let map =
        |p: Point| [0.5 * p[0] - 2.0 * p[1] + p[2] + 1.0, 0.25 * p[0] + p[1] - 3.0, p[0] + p[1] - 1.5 * p[2]];
    for (name, cage) in of_corpus().chain([(String::from("star"), star(5, 2, 9))]) {
        let faces: Vec<Vec<u32>> = cage.faces().map(<[u32]>::to_vec).collect();
        let moved = Cage::new(cage.positions().iter().map(|p| map(*p)).collect(), faces).unwrap();
        let moved = moved.with_scheme(Scheme::Loop).unwrap().with_boundary(cage.boundary());
        let moved = moved.with_creasing(cage.creasing()).with_holes(cage.holes()).unwrap();
        let moved =
            moved.with_creases(cage.creases()).unwrap().with_sharp_vertices(cage.sharp_vertices()).unwrap();
        let (limit, after) = (cage.limit().unwrap(), moved.limit().unwrap());
        assert_eq!(limit.n_sheets(), after.n_sheets());
        for index in 0..limit.n_sheets() {
            for [u, v] in PLACES {
                let here = limit.sheet(index).unwrap().at(u, v).unwrap().point;
                let there = after.sheet(index).unwrap().at(u, v).unwrap().point;
                let off = distance(map(here), there) / size(&moved);
                assert!(off < 1e-13, "{name} sheet {index} at {u}, {v}: {off}");
            }
        }
    }
}

fn diagonal(cage: &Cage) -> f64 {
    let axes = [0, 1, 2].map(|k| {
        let all = cage.positions().iter().map(|p| p[k]);
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    });
    axes.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The vertices of a cage of triangles on its limit surface, by masks; where creases end, about.
fn on_limit(cage: &Cage) -> Vec<Point> {
    let n = cage.positions().len();
    let mut edges = BTreeMap::<[u32; 2], (u32, f64)>::new();
    for face in cage.faces() {
        for k in 0..3 {
            let (a, b) = (face[k].min(face[(k + 1) % 3]), face[k].max(face[(k + 1) % 3]));
            edges.entry([a, b]).or_default().0 += 1;
        }
    }
    cage.creases().iter().for_each(|(ends, sharp)| edges.get_mut(ends).unwrap().1 = *sharp);
    let (mut around, mut sharp) = (vec![Vec::new(); n], vec![Vec::new(); n]);
    for (ends, (count, sharpness)) in edges {
        for [a, b] in [ends, [ends[1], ends[0]]] {
            around[a as usize].push(b);
            if count != 2 || sharpness > 0.0 {
                sharp[a as usize].push(b);
            }
        }
    }
    let corners: BTreeMap<u32, f64> = cage.sharp_vertices().iter().copied().collect();
    let at = |v: u32| cage.positions()[v as usize];
    let mean = |own: f64, v: u32, others: &[u32]| -> Point {
        let whole = own + others.len() as f64;
        [0, 1, 2].map(|k| (own * at(v)[k] + others.iter().map(|o| at(*o)[k]).sum::<f64>()) / whole)
    };
    (0..n as u32)
        .map(|v| {
            let (all, sharp) = (&around[v as usize], &sharp[v as usize]);
            if corners.contains_key(&v) || sharp.len() > 2 || all.is_empty() {
                return at(v);
            }
            if sharp.len() == 2 {
                return mean(4.0, v, sharp);
            }
            let n = all.len() as f64;
            let turn = 0.375 + 0.25 * (std::f64::consts::TAU / n).cos();
            mean(3.0 / 8.0 * n / (0.625 - turn * turn), v, all)
        })
        .collect()
}

/// Triangles between limit points after some rounds.
fn reference(cage: &Cage, rounds: u32) -> Mesh {
    let fine = cage.refined_times(rounds).unwrap();
    let is_there = |face: &usize| fine.holes().binary_search(&(*face as u32)).is_err();
    let faces = (0..fine.n_faces()).filter(is_there).map(|face| fine.face(face));
    Mesh::new(on_limit(&fine), faces.map(|f| [f[0], f[1], f[2]]).collect()).unwrap()
}

fn apart(a: &Mesh, b: &Mesh) -> f64 {
    check::deviation(a, b, &Goal::default(), &Job::default()).unwrap().bound.at_least()
}

fn meshed(cage: &Cage, share: f64) -> Bounded<Mesh> {
    let budget = Budget::length(Tolerance::new(share * diagonal(cage)).unwrap());
    convert::cage_to_mesh(cage, &budget, &Job::default()).unwrap()
}

#[test]
fn no_mesh_is_further_than_its_bound() {
    let stars = (3..=12).map(|n| (format!("star {n}"), star(n, 2, u64::from(n))));
    let mut ratios = Vec::new();
    for (name, cage) in some(of_corpus().chain(stars), 5) {
        let all: &[(f64, u32)] =
            if is_long() { &[(5e-2, 4), (1e-2, 5), (2e-3, 5)] } else { &[(5e-2, 4), (2e-3, 5)] };
        for &(share, rounds) in all {
            let rounds = if cage.n_faces() > 100 { rounds - 1 } else { rounds };
            let mesh = meshed(&cage, share);
            let bound = mesh.bound.at_most().unwrap();
            assert!(bound <= share * diagonal(&cage), "{name} {share}: {bound}");
            let fine = reference(&cage, rounds);
            // Twice what the round before was off by is more than this one is.
            let off = 2.0 / 3.0 * apart(&fine, &reference(&cage, rounds - 1));
            let found = apart(&mesh.shape, &fine);
            let n = mesh.shape.faces().len();
            eprintln!(
                "{name} {share}: {n} triangles, {:.3} of the bound, within {:.3}",
                found / bound,
                off / bound
            );
            assert!(found <= bound + off, "{name} {share}: {found} > {bound} + {off}");
            assert!(
                mesh.bound.at_least() <= found + off,
                "{name} {share}: at least {}",
                mesh.bound.at_least()
            );
            ratios.push(bound / found);
        }
    }
    ratios.sort_by(f64::total_cmp);
    eprintln!("bound over what was found: median {:.2}", ratios[ratios.len() / 2]);
    assert!(ratios[ratios.len() / 2] <= 2.3);
}

/// Whether each edge has two faces, and no two faces have the same vertices.
fn is_closed(cage: &Cage) -> bool {
    let mut count = BTreeMap::<[u32; 2], u32>::new();
    for face in cage.faces() {
        for k in 0..3 {
            let (a, b) = (face[k], face[(k + 1) % 3]);
            *count.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    count.values().all(|n| *n == 2) && cage.holes().is_empty() && !is_doubled(cage)
}

#[test]
fn a_closed_cage_gives_a_closed_manifold_at_every_budget() {
    let mut n = 0;
    for (name, cage) in of_corpus().filter(|(_, cage)| is_closed(cage)) {
        for share in [0.3, 0.1, 3e-2, 1e-2, 3e-3] {
            let mesh = meshed(&cage, share).shape;
            let found = check::validity(&mesh, Topology::Indices);
            assert!(found.closed && found.edge_manifold && found.oriented, "{name} {share}");
            n += 1;
        }
    }
    assert!(n >= 20 || cages().is_empty(), "{n}");
}

#[test]
fn threads_do_not_change_a_byte() {
    for (name, cage) in of_corpus() {
        let budget = Budget::length(Tolerance::new(5e-3 * diagonal(&cage)).unwrap());
        let by = |threads: usize| {
            convert::cage_to_mesh(&cage, &budget, &Job::default().with_threads(threads)).unwrap()
        };
        let (one, two) = (by(1), by(2));
        assert!(one.shape == two.shape && one.bound == two.bound, "{name}");
    }
}

#[test]
fn a_number_of_triangles_is_kept() {
    let cage = star(7, 2, 4);
    let mut before = f64::INFINITY;
    for most in [100, 1000, 10_000] {
        let mesh = convert::cage_to_mesh(&cage, &Budget::triangles(most), &Job::default()).unwrap();
        let bound = mesh.bound.at_most().unwrap();
        assert!(mesh.shape.faces().len() as u64 <= most && mesh.shape.faces().len() as u64 > most / 3);
        assert!(bound < 0.5 * before, "{bound} after {before}");
        before = bound;
    }
}

#[test]
fn what_cannot_be_met_is_refused() {
    let cage = star(5, 2, 4);
    let by = |length: f64, job: &Job| {
        let budget = Budget::length(Tolerance::new(length).unwrap());
        convert::cage_to_mesh(&cage, &budget, job).map(|_| ()).unwrap_err()
    };
    let mut few = Job::default();
    few.triangle_limit = 1000;
    let Failure::Refused(refusal) = by(1e-6, &few) else { panic!() };
    assert_eq!(refusal.code, RefusalCode::TooManyTriangles);
    let Failure::Refused(refusal) = by(1e-14, &Job::default()) else { panic!() };
    assert_eq!(refusal.code, RefusalCode::BelowPrecision);
}

#[test]
fn random_cages_are_meshed_within_their_bound() {
    for seed in 0..150 {
        let cage = random(seed);
        let Ok(limit) = cage.limit() else { panic!("{seed}") };
        if limit.n_sheets() == 0 {
            continue;
        }
        let mesh = meshed(&cage, 2e-2);
        let bound = mesh.bound.at_most().unwrap();
        // One way, by the surface itself.
        let samples = (0..limit.n_sheets()).flat_map(|sheet| {
            let sheet = limit.sheet(sheet).unwrap();
            (0..45).map(move |k| sheet.at(f64::from(k % 9) / 8.0, f64::from(k / 5) / 8.0).unwrap().point)
        });
        let samples: Vec<Point> = samples.collect();
        let (found, _) = check::surface_at_least(&samples, &mesh.shape).unwrap();
        assert!(found <= bound, "{seed}: {found} > {bound}");
    }
}

#[test]
fn levels_are_as_far_as_is_proved() {
    for (name, cage) in of_corpus().filter(|(_, cage)| !is_doubled(cage)) {
        let mut before = f64::INFINITY;
        for rounds in 0..3 {
            let fine = cage.refined_times(rounds).unwrap();
            let most = check::limit_deviation(&fine, &Job::default()).unwrap().at_most().unwrap();
            let limit = fine.limit().unwrap();
            let mut found = 0.0;
            for index in 0..limit.n_sheets() {
                let sheet = limit.sheet(index).unwrap();
                let [a, b, c] =
                    [0, 1, 2].map(|k| fine.positions()[fine.face(limit.face_of(index).0)[k] as usize]);
                for [u, v] in PLACES {
                    let flat = [0, 1, 2].map(|k| (1.0 - u - v) * a[k] + u * b[k] + v * c[k]);
                    found = f64::max(found, distance(flat, sheet.at(u, v).unwrap().point));
                }
            }
            assert!(found <= most && most < 1.3 * found, "{name} {rounds}: {found} {most}");
            // Rounds that keep creases sharp do nothing.
            assert!(most < 0.8 * before || cage.creases().len() > 1, "{name}: {most} after {before}");
            before = most;
        }
    }
}
