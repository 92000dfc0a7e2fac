//! Blocks of one volume join bit for bit, and threads and instruction sets change nothing.
use super::shapes::sampled;
use chordal::Job;
use chordal::convert::lattices::{VertexKey, grid_to_triangles, vertex_keys};
use chordal::convert::{Border, Polygonize};
use chordal::implicit::{Affine3, Grid, Samples};
use std::collections::BTreeMap;

fn waves([x, y, z]: [f64; 3]) -> f64 {
    libm::sin(7.0 * x) + libm::sin(5.0 * y) * libm::cos(3.0 * z) + 0.1
}

fn affine() -> Affine3 {
    Affine3::new([[0.07, 0.01, 0.0, -1.0], [0.0, 0.06, 0.005, -1.0], [0.002, 0.0, -0.05, 1.0]]).unwrap()
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let grid = sampled(waves, 90, &affine());
    let rule = Polygonize::below(0.0);
    let made =
        |threads| grid_to_triangles::<f64>(&grid, &rule, &Job::default().with_threads(threads)).unwrap();
    let one = made(1);
    assert!(one.faces.len() > 10_000);
    assert_eq!(made(2), one);
    assert_eq!(made(3), one);
}

#[test]
fn single_precision_has_the_same_triangles() {
    let grid = sampled(waves, 20, &affine());
    let rule = Polygonize::below(0.0);
    let double = grid_to_triangles::<f64>(&grid, &rule, &Job::default()).unwrap();
    let single = grid_to_triangles::<f32>(&grid, &rule, &Job::default()).unwrap();
    assert_eq!(double.faces, single.faces);
    assert!(double.positions.iter().zip(&single.positions).all(|(d, s)| d.map(|x| x as f32) == *s));
}

/// The triangles by the names of their corners, and where those are.
type Named = (Vec<[VertexKey; 3]>, BTreeMap<VertexKey, [u64; 3]>);

fn named(grid: &Grid, rule: &Polygonize) -> Named {
    let made = grid_to_triangles::<f64>(grid, rule, &Job::default()).unwrap();
    let keys = vertex_keys(grid, rule, &Job::default()).unwrap();
    assert_eq!(keys.len(), made.positions.len());
    let places: BTreeMap<_, _> =
        keys.iter().copied().zip(made.positions.iter().map(|p| p.map(f64::to_bits))).collect();
    assert_eq!(places.len(), keys.len(), "every vertex has a name of its own");
    let turned = |f: &[u32; 3]| {
        let mut corners = f.map(|i| keys[i as usize]);
        let first = (0..3).min_by_key(|i| corners[*i]).unwrap();
        corners.rotate_left(first);
        corners
    };
    (made.faces.iter().map(turned).collect(), places)
}

#[test]
fn blocks_with_offsets_join_bit_for_bit() {
    let n = 23;
    let whole = sampled(waves, n, &affine());
    let rule = Polygonize { offset: [-5, 1 << 20, 7], ..Polygonize::below(0.0) };
    let (mut expected, places) = named(&whole, &rule);
    let cuts = [0, 9, 22];
    let mut joined = Vec::new();
    for block in 0..8_usize {
        let range = [0, 1, 2].map(|k| [cuts[block >> k & 1], cuts[(block >> k & 1) + 1]]);
        let size = range.map(|[low, high]| high - low + 1);
        let mut values = Vec::new();
        for k in range[2][0]..=range[2][1] {
            for j in range[1][0]..=range[1][1] {
                values.extend((range[0][0]..=range[0][1]).map(|i| whole.sample([i, j, k])));
            }
        }
        let grid = Grid::new(size, Samples::F64(values), affine()).unwrap();
        let mut part = rule;
        #[expect(clippy::needless_range_loop, reason = "the axis names places in several lists")]
        for k in 0..3 {
            part.offset[k] += range[k][0] as i64;
            let ends = [range[k][0] == 0, range[k][1] == n - 1];
            part.border[k] = ends.map(|whole| if whole { Border::Capped } else { Border::Open });
        }
        let (faces, at) = named(&grid, &part);
        assert!(at.iter().all(|(key, place)| places.get(key) == Some(place)), "block {block}");
        joined.extend(faces);
    }
    joined.sort_unstable();
    expected.sort_unstable();
    assert_eq!(joined, expected);
}
