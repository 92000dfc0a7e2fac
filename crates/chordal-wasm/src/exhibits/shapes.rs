//! The models that exhibits show.
use chordal::convert::patches_to_mesh;
use chordal::{Budget, Job, Mesh, Patch, Tolerance};
use std::collections::BTreeMap;

/// The teapot of the examples: 32 bicubic patches.
const TEAPOT: &str = include_str!("../../../../examples/teapot.bpt");
/// Sides of the cylinder.
const SIDES: u32 = 24;

/// A model by its name.
pub(super) fn by_name(name: &str) -> Result<Mesh, String> {
    match name {
        "cube" => cube(),
        "cylinder" => cylinder(),
        "ball" => ball(2),
        "teapot" => teapot_mesh(),
        _ => Err(format!("there is no model '{name}'")),
    }
}

/// The patches of the teapot. Its file has a count, then for each patch its degrees and its points.
pub(super) fn teapot() -> Vec<Patch> {
    let numbers: Vec<f64> = TEAPOT.split_ascii_whitespace().filter_map(|word| word.parse().ok()).collect();
    // 1 for the count; 2 degrees and 16 points for each patch.
    let patch = |rows: &[f64]| Patch {
        control: std::array::from_fn(|i| {
            std::array::from_fn(|j| std::array::from_fn(|k| rows[2 + 3 * (4 * i + j) + k]))
        }),
    };
    numbers[1..].chunks_exact(50).map(patch).collect()
}

/// The teapot as some 500 triangles, 2 wide and centred.
fn teapot_mesh() -> Result<Mesh, String> {
    const LENGTH: f64 = 0.06; // chosen: single triangles can be seen, and the shape is still a teapot
    const SCALE: f64 = 1.0 / 3.2; // the teapot is 6.4 units wide
    let length = Tolerance::new(LENGTH).map_err(|error| error.to_string())?;
    let meshed = patches_to_mesh(&teapot(), &Budget::length(length), &Job::default());
    let mesh = meshed.map_err(|failure| failure.to_string())?.shape;
    let place = |[x, y, z]: &[f64; 3]| [SCALE * x, SCALE * y, SCALE * (z - 1.5)];
    mesh_from(mesh.positions().iter().map(place).collect(), mesh.faces().to_vec())
}

/// The cube of edge 2 about the origin.
pub(super) fn cube() -> Result<Mesh, String> {
    let corners = (0..8).map(|i: u32| [0, 1, 2].map(|k| f64::from(i >> k & 1) * 2.0 - 1.0)).collect();
    mesh_from(corners, from_quads(&CUBE))
}

/// The faces of a cube whose corner `i` has its coordinates in the bits of `i`.
pub(super) const CUBE: [[u32; 4]; 6] =
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

/// Two triangles for each quad.
pub(super) fn from_quads(quads: &[[u32; 4]]) -> Vec<[u32; 3]> {
    quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect()
}

/// A prism of 24 sides with fans as its ends.
fn cylinder() -> Result<Mesh, String> {
    let mut positions = Vec::new();
    for z in [-1.0, 1.0] {
        for i in 0..SIDES {
            let turn = std::f64::consts::TAU * f64::from(i) / f64::from(SIDES);
            let (sin, cos) = chordal::math::elementary::sin_cos(turn);
            positions.push([cos, sin, z]);
        }
    }
    let sides = (0..SIDES).map(|i| [i, (i + 1) % SIDES, SIDES + (i + 1) % SIDES, SIDES + i]);
    let mut faces = from_quads(&sides.collect::<Vec<_>>());
    for (low, flip) in [(0, true), (SIDES, false)] {
        let fan = (1..SIDES - 1).map(|i| [low, low + i, low + i + 1]);
        faces.extend(fan.map(|[a, b, c]| if flip { [a, c, b] } else { [a, b, c] }));
    }
    mesh_from(positions, faces)
}

/// An icosahedron whose triangles are split in four `rounds` times, with its vertices on the unit sphere.
pub(super) fn ball(rounds: u32) -> Result<Mesh, String> {
    let golden = 0.5 + 0.5 * 5.0_f64.sqrt();
    let mut positions: Vec<[f64; 3]> = Vec::new();
    for k in 0..3 {
        for (short, long) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
            let mut p = [0.0; 3];
            (p[k], p[(k + 1) % 3]) = (short, long);
            positions.push(p);
        }
    }
    // Any three vertices that are an edge apart form a face, counter-clockwise from outside.
    let apart_sq = |a: [f64; 3], b: [f64; 3]| (0..3).fold(0.0, |sum, k| sum + (a[k] - b[k]) * (a[k] - b[k]));
    // Edges have length 2; the next larger distance is twice the golden ratio.
    let is_edge = |a: [f64; 3], b: [f64; 3]| apart_sq(a, b) < 5.0;
    let mut faces = Vec::new();
    for a in 0..12 {
        for b in 0..12 {
            for c in 0..12 {
                let corners = [a, b, c].map(|i: u32| positions[i as usize]);
                let [p, q, r] = corners;
                let is_face = a < b && a < c && b != c && is_edge(p, q) && is_edge(q, r) && is_edge(r, p);
                if is_face && chordal::math::exact::orient3d(p, q, r, [0.0; 3]) == BEHIND {
                    faces.push([a, b, c]);
                }
            }
        }
    }
    positions.iter_mut().for_each(to_sphere);
    for _ in 0..rounds {
        faces = cut_in_four(&mut positions, &faces);
    }
    mesh_from(positions, faces)
}

/// The centre is behind every face.
const BEHIND: chordal::math::exact::Orientation = chordal::math::exact::Orientation::Back;

fn cut_in_four(positions: &mut Vec<[f64; 3]>, faces: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = BTreeMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry(if a < b { [a, b] } else { [b, a] }).or_insert_with(|| {
            let (p, q) = (positions[a as usize], positions[b as usize]);
            let mut at = std::array::from_fn(|k| 0.5 * (p[k] + q[k]));
            to_sphere(&mut at);
            positions.push(at);
            positions.len() as u32 - 1
        })
    };
    let cut = |[a, b, c]: &[u32; 3]| {
        let [ab, bc, ca] = [middle(*a, *b), middle(*b, *c), middle(*c, *a)];
        [[*a, ab, ca], [ab, *b, bc], [ca, bc, *c], [ab, bc, ca]]
    };
    faces.iter().flat_map(cut).collect()
}

fn to_sphere(p: &mut [f64; 3]) {
    let length = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
    *p = p.map(|x| x / length);
}

/// A mountain of 4 by 4 km, 1.4 km high, in metres: a massif with ridges and smaller hills.
pub(super) fn mountain() -> Result<Mesh, String> {
    /// Cells along a side.
    const CELLS: u32 = 64; // chosen: 8,192 triangles, some of which are finer than a pixel at 3 km
    let sin = |x: f64| chordal::math::elementary::sin_cos(x).0;
    let height = |x: f64, y: f64| {
        let massif = 1.0 / (1.0 + 2.2 * (x * x + y * y));
        let ridges = 1.0 - (sin(2.3 * x + 0.8 * y + 0.4)).abs();
        let spurs = 1.0 - (sin(4.1 * y - 2.7 * x + 1.0)).abs();
        let hills = sin(7.0 * x + 1.3) * sin(6.0 * y + 0.5) + 0.4 * sin(15.0 * x - 2.0) * sin(13.0 * y + 1.0);
        1400.0 * massif * (0.55 + 0.3 * ridges + 0.15 * spurs) + 2.5 * hills
    };
    let place = |i: u32| 4.0 * f64::from(i) / f64::from(CELLS) - 2.0;
    let wide = CELLS + 1;
    let positions = (0..wide * wide).map(|row| {
        let [x, y] = [row % wide, row / wide].map(place);
        [1000.0 * x, 1000.0 * y, height(x, y)]
    });
    let quads = (0..CELLS * CELLS).map(|cell| {
        let a = cell / CELLS * wide + cell % CELLS;
        [a, a + 1, a + wide + 1, a + wide]
    });
    mesh_from(positions.collect(), from_quads(&quads.collect::<Vec<_>>()))
}

/// A mesh from positions and faces.
pub(super) fn mesh_from(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>) -> Result<Mesh, String> {
    Mesh::new(positions, faces).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal::check::validity;
    use chordal::explicit::Topology;

    #[test]
    fn every_model_is_closed_and_faces_outward() {
        for (mesh, faces) in [(cube(), 12), (cylinder(), 92), (ball(0), 20), (ball(1), 80), (ball(2), 320)] {
            let valid = validity(&mesh.unwrap(), Topology::Indices);
            assert_eq!(valid.triangles, faces);
            assert!(valid.closed && valid.manifold() && valid.oriented && valid.measure.signed_volume > 0.5);
        }
        assert_eq!(teapot().len(), 32);
    }
}
