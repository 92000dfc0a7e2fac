//! Surfaces to simplify, made here in any size; used by tests and by the bench. Every coordinate is one that
//! f32 holds, so that programs in f32 are given the same surface.
#![allow(dead_code, reason = "no test uses all of them")]

use chordal::Mesh;
use chordal::explicit::triangulate::polygon_with_holes;
use chordal_testkit::Random;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

type Point = [f64; 3];

fn made(positions: Vec<Point>, faces: Vec<[u32; 3]>) -> Mesh {
    let held = positions.iter().map(|p| p.map(|x| f64::from(x as f32))).collect();
    Mesh::new(held, faces).expect("valid indices, finite positions")
}

/// Both halves of quads between vertices in rows of `row`; `id` says which vertex is at a place.
fn quads([n, m]: [u32; 2], id: impl Fn(u32, u32) -> u32) -> Vec<[u32; 3]> {
    let cells = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let quad = |(i, j)| [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
    cells.map(quad).flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
}

/// A torus of radii 1 and 0.3 in n × m quads, its tube thicker and thinner by the share `bump`.
pub fn torus([n, m]: [u32; 2], bump: f64) -> Mesh {
    let at = |i: u32, j: u32| -> Point {
        let (u, v) = (TAU * f64::from(i) / f64::from(n), TAU * f64::from(j) / f64::from(m));
        let r = 0.3 * (1.0 + bump * (9.0 * u).sin() * (7.0 * v).cos());
        [(1.0 + r * v.cos()) * u.cos(), (1.0 + r * v.cos()) * u.sin(), r * v.sin()]
    };
    let positions = (0..n).flat_map(|i| (0..m).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect();
    made(positions, quads([n, m], |i, j| (i % n) * m + j % m))
}

/// An octahedron cut in four `level` times, its vertices moved along their rays: 8 · 4^level triangles.
fn star(level: u32, radius: impl Fn(Point) -> f64) -> Mesh {
    let mut points: Vec<Point> = vec![
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let mut faces: Vec<[u32; 3]> = (0..4).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]).collect();
    for _ in 0..level {
        let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                let [p, q] = [a, b].map(|i| points[i as usize]);
                let sum: Point = std::array::from_fn(|k| p[k] + q[k]);
                let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
                points.push(sum.map(|x| x / length));
                points.len() as u32 - 1
            })
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let positions = points.iter().map(|d| d.map(|x| radius(*d) * x)).collect();
    made(positions, faces)
}

/// The unit sphere in 8 · 4^level triangles, nearly even.
pub fn sphere(level: u32) -> Mesh {
    star(level, |_| 1.0)
}

/// Four balls that melt into none: their union, with creases that run across the triangles; 8 · 4^level of
/// them.
pub fn lobes(level: u32) -> Mesh {
    // The centre is in all of them, hence every ray leaves the union once: where it leaves the last ball.
    let centres = [[1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0]]
        .map(|c| c.map(|x: f64| 0.35 * x));
    let leaves = |d: Point, c: Point| {
        let along: f64 = (0..3).map(|k| d[k] * c[k]).sum();
        let square: f64 = c.iter().map(|x| x * x).sum();
        along + (along * along - square + 0.75 * 0.75).sqrt()
    };
    star(level, |d| centres.iter().map(|c| leaves(d, *c)).fold(0.0, f64::max))
}

/// A gear wheel: a profile of 12 teeth in 48 k sides, extruded in `layers`, its creases along edges; caps are
/// fans.
pub fn gear(k: u32, layers: u32) -> Mesh {
    let n = 48 * k;
    let profile = |i: u32| -> [f64; 2] {
        let (tooth, at) = (i % (4 * k), TAU * f64::from(i) / f64::from(n));
        let slope = f64::from(tooth % k) / f64::from(k);
        let high = [slope, 1.0, 1.0 - slope, 0.0][(tooth / k) as usize];
        [at.cos(), at.sin()].map(|x| (0.8 + 0.2 * high) * x)
    };
    let layer = |j: u32| 0.5 * f64::from(j) / f64::from(layers);
    let wall = (0..n).flat_map(|i| (0..=layers).map(move |j| (profile(i), layer(j))));
    let mut positions: Vec<Point> = wall.map(|([x, y], z)| [x, y, z]).collect();
    let id = |i: u32, j: u32| (i % n) * (layers + 1) + j;
    let mut faces = quads([n, layers], id);
    let ends = positions.len() as u32;
    positions.extend([[0.0, 0.0, 0.0], [0.0, 0.0, layer(layers)]]);
    faces.extend(
        (0..n).flat_map(|i| [[id(i + 1, 0), id(i, 0), ends], [id(i, layers), id(i + 1, layers), ends + 1]]),
    );
    made(positions, faces)
}

/// A turned part with a bore, steps and a cone, of long thin triangles as CAD makes them: 20 n of them.
pub fn shaft(n: u32) -> Mesh {
    // Radius and height, around the cut through one side.
    let profile = [
        [0.2, 0.0],
        [1.0, 0.0],
        [1.0, 0.5],
        [0.6, 0.5],
        [0.6, 1.5],
        [0.8, 1.7],
        [0.8, 2.2],
        [0.4, 2.2],
        [0.4, 3.0],
        [0.2, 3.0],
    ];
    let m = profile.len() as u32;
    let at = |i: u32, [r, z]: [f64; 2]| -> Point {
        let (sin, cos) = (TAU * f64::from(i) / f64::from(n)).sin_cos();
        [r * cos, r * sin, z]
    };
    let positions = (0..n).flat_map(|i| profile.map(|p| at(i, p))).collect();
    made(positions, quads([n, m], |i, j| (i % n) * m + j % m))
}

/// A plate of 6 × 4 with 24 round holes of k sides: 96 k + 108 triangles, those of its faces from hole to
/// hole.
pub fn plate(k: u32) -> Mesh {
    let outline = [[0.0, 0.0], [6.0, 0.0], [6.0, 4.0], [0.0, 4.0]];
    let hole = |i: u32, j: u32| -> Vec<[f64; 2]> {
        // Clockwise, so that the plate is at the left of every side.
        let corner = |s: u32| (TAU * f64::from(s) / f64::from(k)).sin_cos();
        let centre = [f64::from(i) + 0.5, f64::from(j) + 0.5];
        (0..k).map(corner).map(|(sin, cos)| [centre[0] + 0.3 * cos, centre[1] - 0.3 * sin]).collect()
    };
    let holes: Vec<_> = (0..6).flat_map(|i| (0..4).map(move |j| (i, j))).map(|(i, j)| hole(i, j)).collect();
    let cut = polygon_with_holes(&outline, &holes).expect("a plate");
    let flat: Vec<[f64; 2]> = outline.iter().chain(holes.iter().flatten()).copied().collect();
    let n = flat.len() as u32;
    let positions = [0.0, 0.4].iter().flat_map(|z| flat.iter().map(move |[x, y]| [*x, *y, *z])).collect();
    let caps = cut.triangles.iter().flat_map(|&[a, b, c]| [[a, c, b], [a + n, b + n, c + n]]);
    let mut faces: Vec<[u32; 3]> = caps.collect();
    let mut first = 0;
    for size in std::iter::once(4).chain(holes.iter().map(|_| k)) {
        let next = |i: u32| first + (i + 1) % size;
        faces.extend((0..size).flat_map(|i| {
            let (a, b) = (first + i, next(i));
            [[a, b, b + n], [a, b + n, a + n]]
        }));
        first += size;
    }
    made(positions, faces)
}

/// Hills over the unit square in n × m quads, each vertex up or down by as much as `noise`; open.
pub fn heights([n, m]: [u32; 2], noise: f64) -> Mesh {
    let mut random = Random::new(1);
    let mut positions = Vec::new();
    for i in 0..=n {
        for j in 0..=m {
            let (x, y) = (f64::from(i) / f64::from(n), f64::from(j) / f64::from(m));
            let hills = (9.0 * x).sin() * (7.0 * y).cos() + 0.3 * (31.0 * x + 17.0 * y).sin();
            positions.push([x, y, 0.08 * hills + noise * random.signed()]);
        }
    }
    made(positions, quads([n, m], |i, j| i * (m + 1) + j))
}

/// The surface of the cells of a lattice that `filled` says, a quad for each side between full and empty.
pub fn blocks(lattice: [&[f64]; 3], filled: impl Fn([usize; 3]) -> bool) -> Mesh {
    let size = lattice.map(<[f64]>::len);
    let full = |c: [Option<usize>; 3]| match c {
        [Some(x), Some(y), Some(z)] => {
            x + 1 < size[0] && y + 1 < size[1] && z + 1 < size[2] && filled([x, y, z])
        }
        _ => false,
    };
    let mut rows = vec![u32::MAX; size.iter().product()];
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    let mut row = |at: [usize; 3]| {
        let known = &mut rows[(at[0] * size[1] + at[1]) * size[2] + at[2]];
        if *known == u32::MAX {
            *known = positions.len() as u32;
            positions.push(std::array::from_fn(|k| lattice[k][at[k]]));
        }
        *known
    };
    let sites =
        (0..size[0]).flat_map(|x| (0..size[1]).flat_map(move |y| (0..size[2]).map(move |z| [x, y, z])));
    for site in sites {
        for axis in 0..3 {
            let behind =
                std::array::from_fn(|k| if k == axis { site[k].checked_sub(1) } else { Some(site[k]) });
            let (ahead, behind) = (full(site.map(Some)), full(behind));
            if ahead == behind {
                continue;
            }
            let step = |by: [usize; 2]| -> [usize; 3] {
                let mut to = site;
                to[(axis + 1) % 3] += by[0];
                to[(axis + 2) % 3] += by[1];
                to
            };
            let mut corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|by| row(step(by)));
            if ahead {
                corners.reverse();
            }
            let [a, b, c, d] = corners;
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    made(positions, faces)
}

/// A tray of side 1 and height 0.1 in about 10 n² triangles, whose bottom and walls are `thick`; closed.
pub fn tray(n: u32, thick: f64) -> Mesh {
    let between = |from: f64, to: f64, cells: u32| -> Vec<f64> {
        (0..=cells).map(|i| from + (to - from) * f64::from(i) / f64::from(cells)).collect()
    };
    let side = [vec![0.0], between(thick, 1.0 - thick, n), vec![1.0]].concat();
    let up = [vec![0.0], between(thick, 0.1, n.div_ceil(10))].concat();
    let inside = |i: usize| i > 0 && i < side.len() - 2;
    blocks([&side, &side, &up], |[x, y, z]| z == 0 || !inside(x) || !inside(y))
}

/// A Möbius strip of n × m quads: one side, one boundary.
pub fn mobius([n, m]: [u32; 2]) -> Mesh {
    let at = |i: u32, j: u32| -> Point {
        let (u, across) =
            (TAU * f64::from(i) / f64::from(n), 0.4 * (2.0 * f64::from(j) / f64::from(m) - 1.0));
        let r = 1.0 + across * (0.5 * u).cos();
        [r * u.cos(), r * u.sin(), across * (0.5 * u).sin()]
    };
    let positions = (0..n).flat_map(|i| (0..=m).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect();
    // Around once, what was up is down.
    made(positions, quads([n, m], |i, j| if i == n { m - j } else { i * (m + 1) + j }))
}

/// A mesh and itself again, moved by `off`.
pub fn twice(mesh: &Mesh, off: Point) -> Mesh {
    let n = mesh.positions().len() as u32;
    let moved = mesh.positions().iter().map(|p| std::array::from_fn(|k| p[k] + off[k]));
    let again = mesh.faces().iter().map(|face| face.map(|i| i + n));
    made(
        mesh.positions().iter().copied().chain(moved).collect(),
        mesh.faces().iter().copied().chain(again).collect(),
    )
}
