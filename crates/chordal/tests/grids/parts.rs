//! Parts of a surface, each simplified by itself and within a length of its own, fit and are as near as they say.
use super::blocks::block_of;
use chordal::check::{Goal, deviation, validity};
use chordal::convert::lattices::{VertexKey, block_normals, grid_to_block};
use chordal::convert::{Polygonize, grid_to_mesh};
use chordal::explicit::Topology;
use chordal::implicit::{Affine3, Grid, Samples};
use chordal::lod::tiling::{LatticeBox, SurfacePart};
use chordal::{Job, Tolerance};
use chordal_testkit::{Random, cases, is_long};

pub(super) fn grid(rng: &mut Random, kind: usize) -> Grid {
    let size = [0, 1, 2].map(|_| 5 + rng.below(9));
    let [nx, ny, _] = size;
    let value = |n: usize| {
        let [x, y, z] = [n % nx, n / nx % ny, n / (nx * ny)].map(|at| at as f64);
        let wave = libm::sin(0.9 * x) * libm::cos(0.7 * y) + libm::sin(0.8 * y) * libm::cos(0.9 * z);
        wave + [0.0, 0.15][kind % 2] * (rng.unit() - 0.5)
    };
    let values = (0..size.iter().product()).map(value).collect();
    let affine =
        Affine3::new([[0.7, 0.1, 0.0, -1.0], [0.0, 0.6, 0.05, -1.0], [0.02, 0.0, -0.5, 1.0]]).unwrap();
    Grid::new(size, Samples::F64(values), affine).unwrap()
}

/// The box of samples of a range along each axis, in a lattice that begins at zero.
pub(super) fn place(size: [usize; 3], low: [usize; 3], high: [usize; 3]) -> LatticeBox {
    LatticeBox {
        low: low.map(|at| at as i64),
        high: high.map(|at| at as i64),
        goes_on: [0, 1, 2].map(|k| [low[k] > 0, high[k] + 1 < size[k]]),
    }
}

#[test]
fn parts_of_any_lengths_make_a_closed_manifold_within_their_bounds() {
    let mut rng = Random::new(11);
    for round in 0..if is_long() { 80 } else { 3 } {
        let whole = grid(&mut rng, round);
        let size = whole.size();
        let rule = Polygonize::below(0.05);
        let Ok(mesh) = grid_to_mesh(&whole, &rule, None, &Job::default()) else { continue };
        let step = [0, 1, 2].map(|_| 2 + rng.below(5));
        let ranges = [0, 1, 2].map(|k| {
            let starts = (0..size[k] - 1).step_by(step[k]);
            starts.map(|low| [low, (low + step[k]).min(size[k] - 1)]).collect::<Vec<_>>()
        });
        let mut parts = Vec::new();
        for x in &ranges[0] {
            for y in &ranges[1] {
                for z in &ranges[2] {
                    let [low, high] = [0, 1].map(|end| [x[end], y[end], z[end]]);
                    let (grid, rule) = block_of(&whole, &rule, low, high);
                    let wanted = (round % 3 == 0).then(|| Tolerance::new(0.2).unwrap());
                    let block = grid_to_block(&grid, &rule, wanted, &Job::default()).unwrap();
                    let Some(part) = SurfacePart::from_block(block, &place(size, low, high)) else {
                        continue;
                    };
                    let length = Tolerance::new(0.02 + 0.8 * rng.unit() * rng.unit()).unwrap();
                    let (fewer, _) = part.simplified(length, &Job::default()).unwrap();
                    assert_eq!(fewer.shared.len(), part.shared.len(), "what is shared stays");
                    let lost = fewer.bound.at_most().unwrap() - part.bound.at_most().unwrap();
                    assert!(lost <= length.get() * (1.0 + 1e-12), "{lost} of {length:?}");
                    parts.push(fewer);
                }
            }
        }
        let all = place(size, [0; 3], size.map(|n| n - 1));
        let joined = SurfacePart::join(&parts, &all).unwrap();
        assert!(joined.shared.is_empty());
        let found = validity(&joined.mesh, Topology::Indices);
        assert!(found.closed && found.oriented && found.manifold(), "round {round}: {size:?} by {step:?}");
        let off = deviation(&joined.mesh, &mesh.shape, &Goal::default(), &Job::default()).unwrap();
        let [says, alone] = [&joined.bound, &mesh.bound].map(|bound| bound.at_most().unwrap());
        assert!(off.bound.at_least() <= says + alone, "round {round}: {:?} against {says}", off.bound);
        // The whole again: what was between the parts is free now.
        let (fewer, _) = joined.simplified(Tolerance::new(0.5).unwrap(), &Job::default()).unwrap();
        let found = validity(&fewer.mesh, Topology::Indices);
        assert!(found.closed && found.manifold() && fewer.mesh.faces().len() <= joined.mesh.faces().len());
    }
}

#[test]
fn normals_of_a_block_and_the_samples_beside_it_are_those_of_the_whole() {
    let mut rng = Random::new(5);
    for round in 0..cases(12) {
        let whole = grid(&mut rng, round);
        let size = whole.size();
        let rule = Polygonize::below(0.05);
        let all = block_normals(&whole, &rule, &Job::default()).unwrap();
        assert!(all.is_sorted_by_key(|(key, _)| *key) && all.len() > 8);
        let cut = [0, 1, 2].map(|k| 1 + rng.below(size[k] - 2));
        for corner in 0..8_usize {
            let side = |k: usize| if corner >> k & 1 == 0 { [0, cut[k]] } else { [cut[k], size[k] - 1] };
            let [low, high] = [0, 1].map(|end| [0, 1, 2].map(|k| side(k)[end]));
            let (own, own_rule) = block_of(&whole, &rule, low, high);
            let block = grid_to_block(&own, &own_rule, None, &Job::default()).unwrap();
            let around =
                [low.map(|at| at.saturating_sub(1)), [0, 1, 2].map(|k| (high[k] + 1).min(size[k] - 1))];
            let (larger, larger_rule) = block_of(&whole, &rule, around[0], around[1]);
            let normals = block_normals(&larger, &larger_rule, &Job::default()).unwrap();
            let normal = |of: &[(VertexKey, [f64; 3])], key: &VertexKey| {
                of.binary_search_by_key(key, |(known, _)| *known)
                    .map(|at| of[at].1)
                    .expect("a vertex of both")
            };
            for key in &block.vertex_keys {
                assert_eq!(normal(&normals, key), normal(&all, key), "round {round}: {key:?}");
            }
        }
    }
}

#[test]
fn parts_of_other_surfaces_are_refused() {
    let whole = grid(&mut Random::new(3), 0);
    let size = whole.size();
    let all = place(size, [0; 3], size.map(|n| n - 1));
    assert!(SurfacePart::join(&[] as &[SurfacePart], &all).unwrap_err().to_string().contains("no parts"));
    let cut = size[0] / 2;
    let half = |low, high| {
        let (grid, rule) = block_of(&whole, &Polygonize::below(0.05), low, high);
        let block = grid_to_block(&grid, &rule, None, &Job::default()).unwrap();
        SurfacePart::from_block(block, &place(size, low, high)).unwrap()
    };
    let one = half([0; 3], [cut, size[1] - 1, size[2] - 1]);
    let other = half([cut, 0, 0], size.map(|n| n - 1));
    assert!(SurfacePart::join(&[one.clone(), other.clone()], &all).is_ok());
    let mut moved = other;
    let mut positions = moved.mesh.positions().to_vec();
    positions[moved.shared[0].0 as usize][0] += 1e-9;
    moved.mesh = moved.mesh.with_positions(positions).unwrap();
    let apart = SurfacePart::join(&[one, moved], &all).unwrap_err();
    assert!(apart.to_string().contains("lie apart"), "{apart}");
}
