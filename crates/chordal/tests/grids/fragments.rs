//! Parts of a surface in whole numbers of boxes: closed where these are together, cut where they are to be, and as near as
//! they say.
use super::blocks::block_of;
use super::parts::{grid, place};
use chordal::check::{Goal, deviation};
use chordal::convert::Polygonize;
use chordal::convert::lattices::grid_to_block;
use chordal::explicit::Mesh;
use chordal::implicit::Affine3;
use chordal::lod::tiling::{FragmentBox, LatticeBox, LatticeFragment, SurfacePart};
use chordal::{Bound, Job, Tolerance};
use chordal_testkit::{Random, is_long};
use std::collections::BTreeMap;

/// The steps of a side, and the one in the middle: those of Neuroglancer's format and viewer.
const STEPS: i64 = 65_535;
const MIDDLE: u16 = 32_768;

/// For each edge how many more triangles run along it than back.
#[derive(Default)]
struct Balance(BTreeMap<[[i64; 3]; 2], i64>);

impl Balance {
    fn add(&mut self, fragment: &LatticeFragment, place: [i64; 3]) {
        let at = |row: u32| {
            let local = fragment.positions[row as usize];
            [0, 1, 2].map(|k| place[k] * STEPS + i64::from(local[k]))
        };
        for [a, b, c] in &fragment.faces {
            for (from, to) in [(at(*a), at(*b)), (at(*b), at(*c)), (at(*c), at(*a))] {
                assert_ne!(from, to, "a triangle has three corners");
                let (edge, sign) = if from < to { ([from, to], 1) } else { ([to, from], -1) };
                *self.0.entry(edge).or_default() += sign;
            }
        }
    }

    fn is_closed(&self) -> bool {
        self.0.values().all(|n| *n == 0)
    }
}

/// A fragment as a mesh, by the rule of the format.
fn as_mesh(fragment: &LatticeFragment, within: &FragmentBox) -> Mesh {
    let point = |local: &[u16; 3]| {
        let share = local.map(|x| f64::from(x) / STEPS as f64);
        within.affine.at([0, 1, 2].map(|k| within.low[k] as f64 + within.sides[k] as f64 * share[k]))
    };
    Mesh::new(fragment.positions.iter().map(point).collect(), fragment.faces.clone()).unwrap()
}

fn octants_of(fragment: &LatticeFragment) -> u8 {
    let mut octants = 0;
    for face in &fragment.faces {
        let corners = face.map(|row| fragment.positions[row as usize]);
        let mut eighth = 0;
        for axis in 0..3 {
            let at = corners.map(|corner| corner[axis]);
            assert!(
                at.iter().all(|x| *x <= MIDDLE) || at.iter().all(|x| *x >= MIDDLE),
                "a triangle crosses the middle: {corners:?}"
            );
            eighth |= usize::from(at.iter().any(|x| *x > MIDDLE)) << axis;
        }
        octants |= 1 << eighth;
    }
    octants
}

#[test]
fn fragments_are_closed_together_cut_in_the_middle_and_within_their_bounds() {
    let mut rng = Random::new(23);
    for round in 0..if is_long() { 160 } else { 5 } {
        let whole = grid(&mut rng, round);
        let size = whole.size();
        let rule = Polygonize::below(0.05);
        let side = [0, 1, 2].map(|_| 2 + rng.below(6));
        let counts = [0, 1, 2].map(|k| (size[k] - 1).div_ceil(side[k]));
        let is_halved = round % 4 != 0;
        let mut balance = Balance::default();
        for n in 0..counts.iter().product() {
            let at = [n % counts[0], n / counts[0] % counts[1], n / (counts[0] * counts[1])];
            let low = [0, 1, 2].map(|k| at[k] * side[k]);
            let high = [0, 1, 2].map(|k| (low[k] + side[k]).min(size[k] - 1));
            let (own, own_rule) = block_of(&whole, &rule, low, high);
            let block = grid_to_block(&own, &own_rule, None, &Job::default()).unwrap();
            let own_place = place(size, low, high);
            let Some(part) = SurfacePart::from_block(block, &own_place) else { continue };
            let length = Tolerance::new(0.02 + rng.unit()).unwrap();
            let (part, _) = part.simplified(length, &Job::default()).unwrap();
            let within = FragmentBox {
                low: low.map(|x| x as i64),
                sides: side.map(|x| x as i64),
                affine: *whole.affine(),
                is_halved,
            };
            let made = LatticeFragment::new(&part, &own_place, &within).unwrap();
            balance.add(&made, at.map(|x| x as i64));
            if is_halved {
                assert_eq!(made.octants, octants_of(&made), "round {round}");
            } else {
                assert!(made.octants == 0 && made.faces.len() <= part.mesh.faces().len());
            }
            let off =
                deviation(&as_mesh(&made, &within), &part.mesh, &Goal::default(), &Job::default()).unwrap();
            // As much again as the places of this test are rounded by.
            let says = made.moved_at_most + 1e-12;
            assert!(off.bound.at_least() <= says, "round {round}: {:?} against {says}", off.bound);
        }
        assert!(balance.is_closed(), "round {round}: {size:?} by {side:?}");
    }
}

/// A part that shares nothing, its place, and the box of `side` cells around it.
fn alone(
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
    side: i64,
) -> (SurfacePart, LatticeBox, FragmentBox) {
    let mesh = Mesh::new(positions, faces).unwrap();
    let bound = Bound::exact(chordal::budget::Reference::Trilinear);
    let place = LatticeBox { low: [0; 3], high: [side; 3], goes_on: [[false; 2]; 3] };
    let affine = Affine3::cubes([0.0; 3], 1.0).unwrap();
    let within = FragmentBox { low: [0; 3], sides: [side; 3], affine, is_halved: true };
    (SurfacePart { mesh, shared: Vec::new(), bound }, place, within)
}

const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

#[test]
fn what_is_smaller_than_a_step_stays_as_two_triangles() {
    let mut rng = Random::new(4);
    for round in 0..200 {
        // A tetrahedron that becomes a point or, stretched along an axis, a segment; also at the ends and in the middle.
        let side = 65_535;
        let low = [0.0, 32_767.0, 32_768.0, 65_534.9, 1234.5];
        let at = [0, 1, 2].map(|_| low[rng.below(5)]);
        let mut positions: Vec<[f64; 3]> = (0..4).map(|_| at.map(|x| x + 0.1 * rng.unit())).collect();
        if round % 2 == 0 {
            positions[rng.below(4)][rng.below(3)] = [3.0, 40_000.0][rng.below(2)];
        }
        let (part, place, within) = alone(positions, TETRAHEDRON.to_vec(), side);
        let made = LatticeFragment::new(&part, &place, &within).unwrap();
        assert!(made.faces.len() >= 2, "round {round}: it is still there");
        let mut balance = Balance::default();
        balance.add(&made, [0; 3]);
        assert!(balance.is_closed(), "round {round}");
        assert_eq!(made.octants, octants_of(&made));
        let off = deviation(&as_mesh(&made, &within), &part.mesh, &Goal::default(), &Job::default()).unwrap();
        assert!(
            off.bound.at_least() <= made.moved_at_most + 1e-9,
            "round {round}: {:?} {}",
            off.bound,
            made.moved_at_most
        );
    }
}

#[test]
fn what_leaves_the_box_is_put_back_and_counted() {
    let positions = vec![[-3.0, 1.0, 1.0], [4.0, 1.0, 1.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0]];
    let (part, place, within) = alone(positions, TETRAHEDRON.to_vec(), 8);
    let made = LatticeFragment::new(&part, &place, &within).unwrap();
    // Three cells out of the box, and half a step for what is rounded, thrice with the cuts.
    assert!(made.moved_at_most >= 3.0 && made.moved_at_most < 3.0 + 5.0 * 8.0 / STEPS as f64);
    assert_eq!(made.octants, octants_of(&made));
}

#[test]
fn boxes_that_cannot_be_are_refused() {
    let positions = vec![[1.0, 1.0, 1.0], [4.0, 1.0, 1.0], [1.0, 4.0, 1.0], [1.0, 1.0, 4.0]];
    let (part, place, within) = alone(positions, TETRAHEDRON.to_vec(), 8);
    for wrong in [
        FragmentBox { sides: [8, 0, 8], ..within },
        FragmentBox { sides: [8, 8, i64::MAX], ..within },
        FragmentBox { low: [0, i64::MIN, 0], ..within },
    ] {
        let refused = LatticeFragment::new(&part, &place, &wrong).unwrap_err();
        assert!(refused.to_string().contains("the box of a fragment has no cells"), "{refused}");
    }
}
