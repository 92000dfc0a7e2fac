//! Blocks of one volume join bit for bit, and threads and instruction sets change nothing.
use super::shapes::sampled;
use chordal::Job;
use chordal::convert::lattices::{
    GridBlock, VertexKey, grid_to_block, grid_to_triangles, join_blocks, vertex_keys,
};
use chordal::convert::{Border, Polygonize, grid_to_mesh};
use chordal::implicit::{Affine3, Grid, Samples};
use chordal_testkit::{Random, cases};
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

/// The samples of a grid from `low` up to and with `high`, as a block of it.
pub(super) fn block_of(
    whole: &Grid,
    rule: &Polygonize,
    low: [usize; 3],
    high: [usize; 3],
) -> (Grid, Polygonize) {
    let mut values = Vec::new();
    for k in low[2]..=high[2] {
        for j in low[1]..=high[1] {
            values.extend((low[0]..=high[0]).map(|i| whole.sample([i, j, k])));
        }
    }
    let size = [0, 1, 2].map(|k| high[k] - low[k] + 1);
    let mut part = *rule;
    for k in 0..3 {
        part.offset[k] += low[k] as i64;
        let ends = [low[k] == 0, high[k] + 1 == whole.size()[k]];
        part.border[k] = [0, 1].map(|end| if ends[end] { rule.border[k][end] } else { Border::Open });
    }
    (Grid::new(size, Samples::F64(values), *whole.affine()).unwrap(), part)
}

#[test]
fn joined_blocks_are_the_whole_bit_for_bit_in_its_order() {
    let mut rng = Random::new(7);
    for round in 0..cases(30) {
        let size = [0, 1, 2].map(|_| 2 + rng.below(9));
        // Noise, a wave, or few values with many ties.
        let kind = round % 3;
        let values = (0..size.iter().product::<usize>())
            .map(|n| match kind {
                0 => rng.unit() - 0.5,
                1 => libm::sin(0.37 * n as f64),
                _ => rng.below(3) as f64 - 1.0,
            })
            .collect();
        let grid = Grid::new(size, Samples::F64(values), affine()).unwrap();
        let mut rule = Polygonize { offset: [-5, 1 << 10, 7], ..Polygonize::below(0.0) };
        if rng.below(2) == 0 {
            rule.border[rng.below(3)][rng.below(2)] = Border::Open;
        }
        let Ok(whole) = grid_to_mesh(&grid, &rule, None, &Job::default()) else { continue };
        let step = [0, 1, 2].map(|_| 2 + rng.below(6));
        let ranges = [0, 1, 2].map(|k| {
            let starts = (0..size[k] - 1).step_by(step[k]);
            starts.map(|low| (low, (low + step[k]).min(size[k] - 1))).collect::<Vec<_>>()
        });
        let mut blocks = Vec::new();
        for x in &ranges[0] {
            for y in &ranges[1] {
                for z in &ranges[2] {
                    let (grid, part) = block_of(&grid, &rule, [x.0, y.0, z.0], [x.1, y.1, z.1]);
                    blocks.push(grid_to_block(&grid, &part, None, &Job::default()).unwrap());
                }
            }
        }
        blocks.reverse();
        let joined = join_blocks(blocks, &Job::default()).unwrap();
        assert_eq!(joined.shape, whole.shape, "round {round}: {size:?} in blocks of {step:?}");
        let (far, alone) = (joined.bound.at_most().unwrap(), whole.bound.at_most().unwrap());
        assert!(far >= whole.bound.at_least(), "a bound below what was found: {far} {:?}", whole.bound);
        // Noise has no better bound than its cells, whose diagonal is the sum of their steps at most.
        let cell =
            affine().steps().map(|step| step.iter().map(|x| x * x).sum::<f64>().sqrt()).iter().sum::<f64>();
        assert!(far <= (4.0 * alone).max(cell), "{far} is much more than {alone}");
    }
}

#[test]
fn blocks_of_other_volumes_are_refused() {
    let one = sampled(waves, 9, &affine());
    let rule = Polygonize::below(0.0);
    let block = grid_to_block(&one, &rule, None, &Job::default()).unwrap();
    let twice = join_blocks([block.clone(), block.clone()], &Job::default()).unwrap_err();
    assert!(twice.to_string().contains("comes twice"), "{twice}");
    let mut moved = block.clone();
    moved.positions[0][0] += 1e-9;
    let apart = join_blocks([block, moved], &Job::default()).unwrap_err();
    assert!(apart.to_string().contains("lie apart"), "{apart}");
    let none = join_blocks([] as [GridBlock; 0], &Job::default()).unwrap_err();
    assert!(none.to_string().contains("no block"), "{none}");
}
