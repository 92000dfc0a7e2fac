//! Boxes that share planes: where a proof is found, the mesh is judged by a referee that knows the faces of a union of
//! boxes exactly.
use super::{SLACK, budget};
use crate::deviation_referee::triangles_of;
use chordal::budget::RequiredEvidence;
use chordal::check::{Goal, field_deviation};
use chordal::convert::field_to_mesh;
use chordal::implicit::{Field, shapes};
use chordal::{Bounded, Budget, Job, Mesh, Tolerance};
use chordal_testkit::{Random, cases, is_long, some};

/// A box, added or taken away.
#[derive(Clone, Copy, Debug)]
struct Block {
    min: [f64; 3],
    max: [f64; 3],
    is_cut: bool,
}

impl Block {
    fn field(&self) -> Field {
        let sides = std::array::from_fn(|k| self.max[k] - self.min[k]);
        let middle = std::array::from_fn(|k| 0.5 * (self.max[k] + self.min[k]));
        shapes::cuboid(sides).unwrap().moved(middle).unwrap()
    }

    fn holds(&self, p: [f64; 3]) -> bool {
        (0..3).all(|k| self.min[k] < p[k] && p[k] < self.max[k])
    }
}

fn solid(blocks: &[Block]) -> Field {
    let mut whole = blocks[0].field();
    for block in &blocks[1..] {
        whole = if block.is_cut { whole.difference(&block.field()) } else { whole.union(&block.field()) };
    }
    whole
}

fn contains(blocks: &[Block], p: [f64; 3]) -> bool {
    blocks.iter().fold(false, |inside, block| if block.holds(p) { !block.is_cut } else { inside })
}

/// A rectangle of the boundary: across an axis, from a corner to the opposite one.
#[derive(Clone, Copy, Debug)]
struct Side {
    min: [f64; 3],
    max: [f64; 3],
}

/// All rectangles of the boundary, from the cells that the planes of the boxes cut space into.
fn sides(blocks: &[Block]) -> Vec<Side> {
    let cuts: [Vec<f64>; 3] = std::array::from_fn(|k| {
        let mut all: Vec<f64> = blocks.iter().flat_map(|block| [block.min[k], block.max[k]]).collect();
        all.extend([-100.0, 100.0]);
        all.sort_by(f64::total_cmp);
        // Planes that are one but for rounding.
        all.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        all
    });
    let middle = |k: usize, i: usize| 0.5 * (cuts[k][i] + cuts[k][i + 1]);
    let is_inside = |at: [usize; 3]| contains(blocks, std::array::from_fn(|k| middle(k, at[k])));
    let mut found = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for i in 1..cuts[axis].len() - 1 {
            for j in 0..cuts[u].len() - 1 {
                for k in 0..cuts[v].len() - 1 {
                    let mut cell = [0; 3];
                    (cell[axis], cell[u], cell[v]) = (i, j, k);
                    let mut before = cell;
                    before[axis] -= 1;
                    if is_inside(cell) != is_inside(before) {
                        let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
                        (min[axis], max[axis]) = (cuts[axis][i], cuts[axis][i]);
                        (min[u], max[u]) = (cuts[u][j], cuts[u][j + 1]);
                        (min[v], max[v]) = (cuts[v][k], cuts[v][k + 1]);
                        found.push(Side { min, max });
                    }
                }
            }
        }
    }
    found
}

fn distance_to_sides(sides: &[Side], p: [f64; 3]) -> f64 {
    let far = |side: &Side| {
        let off = (0..3).map(|k| (side.min[k] - p[k]).max(p[k] - side.max[k]).max(0.0));
        off.map(|x| x * x).sum::<f64>().sqrt()
    };
    sides.iter().map(far).fold(f64::INFINITY, f64::min)
}

/// How far samples of the mesh are from the sides, and samples of the sides from the mesh.
fn seen(mesh: &Mesh, sides: &[Side], random: &mut Random) -> f64 {
    let soup = triangles_of(mesh);
    let mut most = 0.0_f64;
    for corners in &soup.corners {
        for _ in 0..4 {
            let (mut a, mut b) = (random.unit(), random.unit());
            if a + b > 1.0 {
                (a, b) = (1.0 - a, 1.0 - b);
            }
            let p = std::array::from_fn(|k| {
                corners[0][k] + a * (corners[1][k] - corners[0][k]) + b * (corners[2][k] - corners[0][k])
            });
            most = most.max(distance_to_sides(sides, p));
        }
        most = corners.iter().map(|p| distance_to_sides(sides, *p)).fold(most, f64::max);
    }
    for side in sides {
        for step in 0..8 {
            // The corners, and points between them.
            let share = |bit: usize, random: &mut Random| {
                if step < 4 { (step >> bit & 1) as f64 } else { random.unit() }
            };
            let shares = [share(0, random), share(1, random)];
            let mut next = 0;
            let p = std::array::from_fn(|k| {
                let span = side.max[k] - side.min[k];
                if span == 0.0 {
                    return side.min[k];
                }
                next += 1;
                side.min[k] + shares[next - 1] * span
            });
            most = most.max(soup.distance(p));
        }
    }
    most
}

/// A box with a side in the plane of one of another's, added outside of it or cut out of it; wider or narrower.
fn flush_with(last: &Block, random: &mut Random) -> Block {
    let axis = random.below(3);
    let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
    for k in 0..3 {
        // In tenths, which are rounded: some more sides are in one plane by chance, and but for rounding.
        let middle = 0.5 * (last.min[k] + last.max[k]) + 0.7 * (random.below(9) as f64 - 4.0);
        let half = 0.7 * (2.0 + random.below(9) as f64);
        (min[k], max[k]) = (middle - half, middle + half);
    }
    let thick = 1.0 + random.below(4) as f64;
    let is_above = random.below(2) == 0;
    let is_cut = random.below(4) == 0;
    // What is cut away starts at the plane and goes inward, what is added outward.
    if is_above != is_cut {
        (min[axis], max[axis]) = if is_cut {
            (last.min[axis], last.min[axis] + 0.5 * thick)
        } else {
            (last.max[axis], last.max[axis] + thick)
        };
    } else {
        (min[axis], max[axis]) = if is_cut {
            (last.max[axis] - 0.5 * thick, last.max[axis])
        } else {
            (last.min[axis] - thick, last.min[axis])
        };
    }
    Block { min, max, is_cut }
}

fn random_blocks(random: &mut Random) -> Vec<Block> {
    let mut blocks = vec![Block { min: [-5.0; 3], max: [5.0; 3], is_cut: false }];
    for _ in 0..1 + random.below(2) {
        let added: Vec<Block> = blocks.iter().filter(|block| !block.is_cut).copied().collect();
        let last = added[random.below(added.len())];
        blocks.push(flush_with(&last, random));
    }
    blocks
}

/// Whether four boxes about an edge or a corner meet in it alone: a mesh has to decide whether they are joined there.
fn touches(blocks: &[Block], sides: &[Side]) -> bool {
    let near = 1e-3;
    let around = |p: [f64; 3], axis: usize| -> [bool; 4] {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(a, b)| {
            let mut q = p;
            q[u] += near * a;
            q[v] += near * b;
            contains(blocks, q)
        })
    };
    let middles = sides.iter().flat_map(|side| {
        let flat = (0..3).find(|k| side.min[*k] == side.max[*k]).unwrap();
        let middle: [f64; 3] = std::array::from_fn(|k| 0.5 * (side.min[k] + side.max[k]));
        (0..3).filter(move |k| *k != flat).flat_map(move |k| {
            [side.min[k], side.max[k]].map(|end| {
                let mut p = middle;
                p[k] = end;
                (p, 3 - k - flat)
            })
        })
    });
    let is_edge = |(p, axis): ([f64; 3], usize)| {
        let [a, b, c, d] = around(p, axis);
        a == c && b == d && a != b
    };
    let is_corner = |p: [f64; 3]| {
        let octant = |bits: usize| -> bool {
            contains(blocks, std::array::from_fn(|k| p[k] + if bits >> k & 1 == 1 { near } else { -near }))
        };
        let inside: Vec<bool> = (0..8).map(octant).collect();
        // Octants of one kind that are not joined across faces.
        let parts = |kind: bool| {
            let mut seen = [false; 8];
            let mut n = 0;
            for start in (0..8).filter(|bits| inside[*bits] == kind) {
                if seen[start] {
                    continue;
                }
                n += 1;
                let mut open = vec![start];
                while let Some(at) = open.pop() {
                    if std::mem::replace(&mut seen[at], true) {
                        continue;
                    }
                    open.extend((0..3).map(|k| at ^ 1 << k).filter(|to| inside[*to] == kind && !seen[*to]));
                }
            }
            n
        };
        parts(true) > 1 || parts(false) > 1
    };
    let corners = sides.iter().flat_map(|side| {
        (0..8_usize)
            .map(|bits| std::array::from_fn(|k| if bits >> k & 1 == 1 { side.max[k] } else { side.min[k] }))
    });
    middles.into_iter().any(is_edge) || corners.into_iter().any(is_corner)
}

fn made(field: &Field, length: f64, name: &str) -> Bounded<Mesh> {
    proved(field, length).unwrap_or_else(|| panic!("{name}: not proved"))
}

/// The mesh, if a proof was found.
fn proved(field: &Field, length: f64) -> Option<Bounded<Mesh>> {
    let made = field_to_mesh(field, &budget(length), &Job::default()).ok()?;
    let most = made.bound.at_most().expect("proved");
    assert!(made.bound.evidence().bounds_above() && most <= length, "{most}");
    Some(made)
}

/// Where two overhang on one side each there is a corner at which proofs mostly do not end yet.
#[test]
fn random_flush_boxes_are_within_their_bound_where_one_is_proved() {
    let mut random = Random::new(20);
    let (mut n, mut n_tried, mut n_proved, mut n_overhanging) = (0, 0, 0, 0);
    while n < cases(10) {
        let blocks = random_blocks(&mut random);
        let truth = sides(&blocks);
        if truth.is_empty() || touches(&blocks, &truth) {
            continue;
        }
        n += 1;
        let is_within =
            |k: usize| blocks[1].min[k] >= blocks[0].min[k] && blocks[1].max[k] <= blocks[0].max[k];
        n_overhanging += usize::from((0..3).filter(|k| !is_within(*k)).count() > 1);
        if n % 2 == 0 && !is_long() {
            continue;
        }
        n_tried += 1;
        let Some(made) = proved(&solid(&blocks), 0.1) else { continue };
        n_proved += 1;
        let far = seen(&made.shape, &truth, &mut random);
        assert!(far <= made.bound.at_most().unwrap() + SLACK, "{n}: {blocks:?}: {far:e}");
    }
    assert!(n_overhanging > n / 4, "{n_overhanging} of {n}");
    println!("{n_proved} of {n_tried} are proved");
    assert!(3 * n_proved >= n_tried, "{n_proved} of {n_tried}");
}

/// A plate with a bore and a countersink that ends above the plate by some height, so that its rim is cut cleanly.
#[test]
fn steps_thinner_than_the_length_are_proved() {
    let bores = [0.1, 0.01, 0.001].into_iter().flat_map(|raised| [2.1, 3.0].map(|bore| (raised, bore)));
    let all = bores.flat_map(|(raised, bore)| [0.5, 0.1, 0.05].map(|length| (raised, bore, length)));
    // Five by default, with each height, each bore and each length among them.
    for (raised, bore, length) in some(all, 5) {
        let head = shapes::capped_cone(2.1, 4.6, 2.5).unwrap().moved([0.0, 0.0, 0.75 + raised]).unwrap();
        let plate = shapes::cuboid([20.0, 20.0, 4.0]).unwrap();
        let field = plate.difference(&head).difference(&shapes::cylinder(bore, 20.0).unwrap());
        made(&field, length, &format!("{raised} {bore} {length}"));
    }
}

#[test]
fn planted_faults_at_a_flush_joint_are_not_proved() {
    let blocks = [
        Block { min: [-5.0; 3], max: [5.0; 3], is_cut: false },
        Block { min: [-3.0, 5.0, -6.0], max: [3.0, 9.0, 6.0], is_cut: false },
    ];
    let length = 0.1;
    let limit = Goal { max: Some(Tolerance::new(length).unwrap()), ..Goal::default() };
    let judged = |mesh: &Mesh, blocks: &[Block]| {
        field_deviation(mesh, &solid(blocks), &limit, &Job::default()).unwrap().bound.at_most()
    };
    let asked = Budget { require: RequiredEvidence::Measured, ..budget(length) };
    let good = field_to_mesh(&solid(&blocks), &asked, &Job::default()).unwrap().shape;
    let truth = sides(&blocks);
    // Each corner moved by 1.5 lengths.
    let corners = 0..good.positions().len();
    let ways = [(0, 0.15), (1, -0.15), (2, 0.15)];
    // By default two corners, each along another axis.
    let moves: Vec<(usize, (usize, f64))> = match is_long() {
        true => corners.flat_map(|v| ways.map(|way| (v, way))).collect(),
        false => some(corners, 2).into_iter().zip(ways).collect(),
    };
    for (v, (axis, by)) in moves {
        let mut positions = good.positions().to_vec();
        positions[v][axis] += by;
        let moved = Mesh::new(positions, good.faces().to_vec()).unwrap();
        let far = seen(&moved, &truth, &mut Random::new(3));
        let most = judged(&moved, &blocks);
        assert!(most.is_none_or(|most| most >= far - SLACK), "{v} {axis}: {most:?} of {far}");
    }
    // Against boxes one of which is farther off, is missing, or has a hole in the shared face.
    let mut off = blocks;
    (off[1].min[1], off[1].max[1]) = (5.15, 9.15);
    let mut corner = blocks.to_vec();
    corner.push(Block { min: [2.5, 4.5, 4.5], max: [3.5, 5.5, 5.5], is_cut: true });
    let mut hole = blocks.to_vec();
    hole.push(Block { min: [-1.0, 4.5, -1.0], max: [1.0, 5.5, 1.0], is_cut: true });
    for (name, other) in
        [("off", off.to_vec()), ("corner", corner), ("hole", hole), ("missing", vec![blocks[0]])]
    {
        let most = judged(&good, &other);
        assert!(most.is_none_or(|most| most > length), "{name}: {most:?}");
    }
}
