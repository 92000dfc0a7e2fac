//! Pairs of meshes of many kinds.
use chordal::Mesh;
use chordal_testkit::Random;

type Point = [f64; 3];

/// The kinds, each with its name.
pub const KINDS: [&str; 18] = [
    "soups",
    "grids",
    "rough and smooth",
    "plates cut differently",
    "spheres",
    "shifted",
    "needles",
    "points and segments",
    "far away",
    "tiny",
    "huge",
    "one against many",
    "folded",
    "open and closed",
    "whole numbers",
    "duplicates",
    "crossing",
    "stairs",
];

pub fn pair(kind: usize, random: &mut Random) -> [Mesh; 2] {
    match KINDS[kind] {
        "soups" => [soup(random, 1.0), soup(random, 1.0)],
        "grids" => {
            let height = random.power(-4.0, 0.0);
            [grid(random, 6, height), grid(random, 9, height)]
        }
        "rough and smooth" => {
            let noise = random.power(-9.0, -2.0);
            let mesh = grid(random, 7, 0.2);
            let other = moved(&mesh, |p| {
                let d: Point = random.point();
                std::array::from_fn(|k| p[k] + noise * d[k])
            });
            [mesh, other]
        }
        "plates cut differently" => {
            let (n, m) = (1 + random.below(3), 1 + random.below(9));
            [plate(n, 0.375), plate(m, 0.375)]
        }
        "spheres" => {
            let (n, m) = (4 + random.below(6), 4 + random.below(6));
            let radius = 1.0 + random.power(-6.0, 0.0);
            [sphere(n, 1.0, random.between(0.0, 1.0)), sphere(m, radius, random.between(0.0, 1.0))]
        }
        "shifted" => {
            let mesh = sphere(7, 1.0, 0.0);
            let d: Point = random.direction();
            let far = random.power(-6.0, 1.0);
            let other = moved(&mesh, |p| std::array::from_fn(|k| p[k] + far * d[k]));
            [mesh, other]
        }
        "needles" => [needles(random), needles(random)],
        "points and segments" => [flat_soup(random), soup(random, 0.5)],
        "far away" => {
            let offset: Point = random.direction::<3>().map(|x| 1e6 * x);
            let [a, b] = [grid(random, 5, 0.1), grid(random, 7, 0.1)];
            [a, b].map(|mesh| moved(&mesh, |p| std::array::from_fn(|k| p[k] + offset[k])))
        }
        "tiny" => {
            [grid(random, 5, 0.1), grid(random, 6, 0.1)].map(|mesh| moved(&mesh, |p| p.map(|x| x * 1e-200)))
        }
        "huge" => {
            [grid(random, 5, 0.1), grid(random, 6, 0.1)].map(|mesh| moved(&mesh, |p| p.map(|x| x * 1e200)))
        }
        "one against many" => {
            let corners: [Point; 3] = [random.point(), random.point(), random.point()];
            [Mesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap(), divided(corners, 12, random)]
        }
        "folded" => [strip(random, 12), strip(random, 5)],
        "open and closed" => {
            let closed = sphere(8, 1.0, 0.3);
            let n = closed.faces().len();
            let some = closed.faces()[..n - 1 - random.below(n / 2)].to_vec();
            [Mesh::new(closed.positions().to_vec(), some).unwrap(), closed]
        }
        "whole numbers" => [lattice(random), lattice(random)],
        "duplicates" => {
            let mesh = grid(random, 4, 0.3);
            let mut faces = mesh.faces().to_vec();
            for _ in 0..10 {
                let [a, b, c] = faces[random.below(faces.len())];
                faces.push(if random.below(2) == 0 { [a, b, c] } else { [c, b, a] });
            }
            [Mesh::new(mesh.positions().to_vec(), faces).unwrap(), grid(random, 6, 0.3)]
        }
        "crossing" => {
            let [a, b] = [grid(random, 4, 0.1), grid(random, 5, 0.1)];
            [a, moved(&b, |p| [p[2] + 0.5, p[1], p[0]])]
        }
        _ => [stairs(random, 6), stairs(random, 6)],
    }
}

pub fn moved(mesh: &Mesh, mut f: impl FnMut(Point) -> Point) -> Mesh {
    let positions = mesh.positions().iter().map(|p| f(*p)).collect();
    Mesh::new(positions, mesh.faces().to_vec()).expect("finite")
}

fn soup(random: &mut Random, size: f64) -> Mesh {
    let n = 3 * (1 + random.below(12)) as u32;
    let positions = (0..n).map(|_| random.point::<3>().map(|x| size * x)).collect();
    Mesh::new(positions, (0..n / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
}

/// A sheet of n × n quads over the unit square, with bumps.
fn grid(random: &mut Random, n: usize, height: f64) -> Mesh {
    let [a, b, c] = [(); 3].map(|()| random.between(1.0, 6.0));
    sheet(n, |x, y| [x, y, height * ((a * x).sin() * (b * y).cos() + 0.2 * (c * (x + y)).sin())])
}

fn sheet(n: usize, f: impl Fn(f64, f64) -> Point) -> Mesh {
    let at = |i: usize| i as f64 / n as f64;
    let positions =
        (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j))).map(|(i, j)| f(at(i), at(j))).collect();
    let row = (n + 1) as u32;
    let quads = (0..n as u32).flat_map(|i| (0..n as u32).map(move |j| i * row + j));
    let faces = quads.flat_map(|k| [[k, k + row, k + row + 1], [k, k + row + 1, k + 1]]).collect();
    Mesh::new(positions, faces).unwrap()
}

/// The same flat square in space, in so many cells.
fn plate(n: usize, tilt: f64) -> Mesh {
    sheet(n, |x, y| [x, y, tilt * x + 0.5 * y])
}

fn sphere(n: usize, radius: f64, turn: f64) -> Mesh {
    let tau = std::f64::consts::TAU;
    let rows = 2 * n;
    let mut positions = vec![[0.0, 0.0, radius], [0.0, 0.0, -radius]];
    for i in 1..n {
        for j in 0..rows {
            let (polar, around) = (0.5 * tau * i as f64 / n as f64, tau * (j as f64 + turn) / rows as f64);
            positions.push(
                [polar.sin() * around.cos(), polar.sin() * around.sin(), polar.cos()].map(|x| x * radius),
            );
        }
    }
    let id = |i: usize, j: usize| match i {
        0 => 0,
        i if i == n => 1,
        i => (2 + (i - 1) * rows + j % rows) as u32,
    };
    let mut faces = Vec::new();
    for i in 0..n {
        for j in 0..rows {
            if i + 1 < n {
                faces.push([id(i, j), id(i + 1, j), id(i + 1, j + 1)]);
            }
            if i > 0 {
                faces.push([id(i, j), id(i + 1, j + 1), id(i, j + 1)]);
            }
        }
    }
    Mesh::new(positions, faces).unwrap()
}

fn needles(random: &mut Random) -> Mesh {
    let n = 1 + random.below(8) as u32;
    let mut positions = Vec::new();
    for _ in 0..n {
        let (from, to): (Point, Point) = (random.point(), random.point());
        let (width, side): (f64, Point) = (random.power(-14.0, -1.0), random.direction());
        let t = random.between(-0.2, 1.2);
        positions.extend([
            from,
            to,
            std::array::from_fn(|k| from[k] + t * (to[k] - from[k]) + width * side[k]),
        ]);
    }
    Mesh::new(positions, (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
}

/// Triangles without area.
fn flat_soup(random: &mut Random) -> Mesh {
    let n = 1 + random.below(6) as u32;
    let mut positions = Vec::new();
    for _ in 0..n {
        let (a, b): (Point, Point) = (random.point(), random.point());
        positions.extend(match random.below(3) {
            0 => [a, a, a],
            1 => [a, b, a],
            _ => [a, b, std::array::from_fn(|k| 0.5 * (a[k] + b[k]))],
        });
    }
    Mesh::new(positions, (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
}

/// A triangle cut into n² pieces, a little off its plane.
fn divided([a, b, c]: [Point; 3], n: u32, random: &mut Random) -> Mesh {
    let off = random.power(-16.0, -1.0);
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    let first = |i: u32| i * (n + 1) - i * i.saturating_sub(1) / 2;
    for i in 0..=n {
        for j in 0..=n - i {
            let (s, t) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(n));
            let noise: Point = random.point();
            positions
                .push(std::array::from_fn(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]) + off * noise[k]));
            if i + j < n {
                let (here, next) = (first(i) + j, first(i + 1) + j);
                faces.push([here, next, here + 1]);
                if i + j + 1 < n {
                    faces.push([here + 1, next, next + 1]);
                }
            }
        }
    }
    Mesh::new(positions, faces).unwrap()
}

/// A band that goes back over itself.
fn strip(random: &mut Random, n: u32) -> Mesh {
    let mut positions = Vec::new();
    for i in 0..=n {
        let t = 6.0 * f64::from(i) / f64::from(n);
        let x = (1.3 * t).sin() + random.between(0.0, 0.05);
        positions.extend([[x, 0.0, 0.1 * t], [x, 1.0, 0.1 * t]]);
    }
    let faces = (0..n).flat_map(|i| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]]).collect();
    Mesh::new(positions, faces).unwrap()
}

/// Triangles between small whole numbers: many exact ties.
fn lattice(random: &mut Random) -> Mesh {
    let n = 3 * (1 + random.below(10)) as u32;
    let positions = (0..n).map(|_| [0.0; 3].map(|_: f64| random.below(4) as f64)).collect();
    Mesh::new(positions, (0..n / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).unwrap()
}

fn stairs(random: &mut Random, n: usize) -> Mesh {
    let steps = 2 + random.below(4);
    let rise = random.between(0.0, 0.4);
    sheet(n, |x, y| [x, y, rise * (x * steps as f64).floor()])
}
