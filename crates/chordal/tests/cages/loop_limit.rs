//! The limit surface of Loop's scheme: what rounds converge to, and the same whether a round was done before or not; and its meshes, as a
//! referee sees them that has only plain rounds and the masks of smooth vertices, creases and corners.
use super::corpus::cages;
use chordal::explicit::{Boundary, Cage, Creasing, INFINITELY_SHARP, Jet, Scheme};
use std::collections::BTreeMap;

type Point = [f64; 3];

fn of_corpus() -> impl Iterator<Item = (String, Cage)> {
    cages().into_iter().filter(|(_, cage)| cage.scheme() == Scheme::Loop)
}

fn size(cage: &Cage) -> f64 {
    cage.positions().as_flattened().iter().fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most })
}

fn distance(a: Point, b: Point) -> f64 {
    (0..3).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>().sqrt()
}

/// Numbers between −0.5 and 0.5.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }
}

/// `rings` rings of triangles around a vertex of n neighbours, lifted at random.
fn star(n: u32, rings: u32, seed: u64) -> Cage {
    let mut noise = Noise(seed);
    let turn = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(n);
    let mut points = vec![[0.0, 0.0, noise.next()]];
    // Ring r has n·r points.
    for r in 1..=rings {
        for k in 0..n * r {
            let (sector, step) = (k / r, f64::from(k % r));
            let (a, b) = (turn(sector), turn(sector + 1));
            let along = |f: fn(f64) -> f64| (f64::from(r) - step) * f(a) + step * f(b);
            points.push([along(f64::cos), along(f64::sin), 1.5 * noise.next()]);
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
    let mut noise = Noise(seed.wrapping_mul(77) + 5);
    let mut pick = |n: u32| ((noise.next() + 0.5) * f64::from(n)) as u32;
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
    let creasing = [Creasing::Uniform, Creasing::Chaikin][pick(2) as usize];
    let cage = Cage::new(points, faces).unwrap().with_scheme(Scheme::Loop).unwrap();
    let cage = cage.with_boundary(boundary).with_creasing(creasing);
    cage.with_creases(&creases).unwrap().with_sharp_vertices(&corners).unwrap()
}

/// The places of a triangle that tests look at.
const PLACES: [[f64; 2]; 8] = [
    [0.0, 0.0],
    [1.0, 0.0],
    [0.0, 1.0],
    [0.3, 0.6],
    [0.25, 0.125],
    [0.9, 0.03],
    [0.0, 0.4],
    [0.002, 0.001],
];

/// Where a place of a part of a triangle is in it: parts begin at their corner, the last one at the middle of the first side.
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

/// Whether two faces have the same three vertices: edges of a round may then end alike, which [`Cage::refined`] takes for one.
fn is_doubled(cage: &Cage) -> bool {
    let mut faces: Vec<[u32; 3]> = cage.faces().map(|face| [face[0], face[1], face[2]]).collect();
    faces.iter_mut().for_each(|face| face.sort_unstable());
    faces.sort_unstable();
    faces.windows(2).any(|pair| pair[0] == pair[1])
}

#[test]
fn faces_agree_on_their_edges() {
    let stars = (3..=12).map(|n| (format!("star {n}"), star(n, 2, 3)));
    let all = (0..3000).map(|seed| (format!("random {seed}"), random(seed)));
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
    let n = all.map(|cage| moved(&cage)).count();
    assert!(n > 50, "{n}");
}
