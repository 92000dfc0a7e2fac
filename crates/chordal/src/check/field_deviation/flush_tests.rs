//! Tests of the prover where solids share planes: vertices without a common direction, and steps that are thinner than
//! the length.
use super::prover::{SandwichProver, SandwichVerdict};
use super::sandwich::SandwichGoal;
use crate::budget::Job;
use crate::explicit::Mesh;
use crate::implicit::{Csg, Field, shapes};
use std::collections::BTreeMap;

/// The lowest and the highest corner of a box.
type BoxCorners = [[f64; 3]; 2];

fn field_of([min, max]: BoxCorners) -> Field {
    let sides = std::array::from_fn(|k| max[k] - min[k]);
    let middle = std::array::from_fn(|k| 0.5 * (max[k] + min[k]));
    shapes::cuboid(sides).unwrap().moved(middle).unwrap()
}

/// The boundary of what `inside` says of the cells that some planes cut space into: two triangles for each side.
fn boundary(blocks: &[BoxCorners], inside: impl Fn([f64; 3]) -> bool) -> Mesh {
    let cuts: [Vec<f64>; 3] = std::array::from_fn(|k| {
        let mut all: Vec<f64> = blocks.iter().flat_map(|block| [block[0][k], block[1][k]]).collect();
        all.extend([-99.0, 99.0]);
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    });
    let middle = |cell: [usize; 3]| std::array::from_fn(|k| 0.5 * (cuts[k][cell[k]] + cuts[k][cell[k] + 1]));
    let (mut positions, mut known) = (Vec::new(), BTreeMap::new());
    let mut vertex = |at: [usize; 3]| {
        *known.entry(at).or_insert_with(|| {
            positions.push(std::array::from_fn(|k| cuts[k][at[k]]));
            positions.len() as u32 - 1
        })
    };
    let mut faces = Vec::new();
    for axis in 0..3 {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        for i in 1..cuts[axis].len() - 1 {
            for j in 0..cuts[u].len() - 1 {
                for k in 0..cuts[v].len() - 1 {
                    let mut cell = [0; 3];
                    (cell[axis], cell[u], cell[v]) = (i, j, k);
                    let mut before = cell;
                    before[axis] -= 1;
                    let (is_above, is_below) = (inside(middle(cell)), inside(middle(before)));
                    if is_above == is_below {
                        continue;
                    }
                    let mut corner = |a: usize, b: usize| {
                        let mut at = cell;
                        at[u] += a;
                        at[v] += b;
                        vertex(at)
                    };
                    let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                    let up = [[a, b, c], [a, c, d]];
                    faces.extend(if is_below { up } else { up.map(|[a, b, c]| [b, a, c]) });
                }
            }
        }
    }
    Mesh::new(positions, faces).unwrap()
}

fn holds([min, max]: BoxCorners, p: [f64; 3]) -> bool {
    (0..3).all(|k| min[k] < p[k] && p[k] < max[k])
}

fn look(field: &Field, mesh: &Mesh, limit: Option<f64>) -> (SandwichVerdict, u64) {
    let job = Job::default().with_threads(1);
    let csg = Csg::from_expr(field.sign());
    let mut judge = SandwichProver::new(&csg, &field.bounds(), &job).unwrap();
    let verdict = judge.prove(mesh, &SandwichGoal::new(limit, 0.25)).unwrap();
    (verdict, judge.n_boxes())
}

const T_JOINT: [BoxCorners; 2] = [[[-5.0; 3], [5.0; 3]], [[-3.0, 5.0, -6.0], [3.0, 9.0, 6.0]]];

#[test]
fn an_overhanging_box_is_proved_to_the_last_digits() {
    let mesh = boundary(&T_JOINT, |p| T_JOINT.iter().any(|block| holds(*block, p)));
    let field = field_of(T_JOINT[0]).union(&field_of(T_JOINT[1]));
    for limit in [None, Some(1.0), Some(0.1), Some(1e-6)] {
        let (found, _) = look(&field, &mesh, limit);
        assert!(found.is_proved(), "{limit:?}: {:?} {:?} {:?}", found.open, found.wrong, found.unresolved);
        assert!(found.bound <= limit.unwrap_or(1e-9), "{limit:?}: {:e}", found.bound);
    }
    // A corner of the joint moved by more than the length is seen, by less is not held against it.
    let joint = mesh.positions().iter().position(|p| *p == [3.0, 5.0, 5.0]).unwrap();
    for (by, is_near) in [(0.15, false), (0.02, true)] {
        let mut positions = mesh.positions().to_vec();
        positions[joint][1] += by;
        let moved = Mesh::new(positions, mesh.faces().to_vec()).unwrap();
        assert_eq!(look(&field, &moved, Some(0.1)).0.is_proved(), is_near, "{by}");
    }
    // The second box somewhere else.
    let off = [[-3.0, 5.15, -6.0], [3.0, 9.15, 6.0]];
    assert!(!look(&field_of(T_JOINT[0]).union(&field_of(off)), &mesh, Some(0.1)).0.is_proved());
}

#[test]
fn a_step_thinner_than_the_length_takes_no_smaller_cells() {
    let plate = [[-5.0, -5.0, -1.0], [5.0, 5.0, 1.0]];
    let work = |above: f64| {
        let pocket = [[-2.0, -2.0, -0.5], [2.0, 2.0, 1.0 + above]];
        let field = field_of(plate).difference(&field_of(pocket));
        let mesh = boundary(&[plate, [[-2.0, -2.0, -0.5], [2.0, 2.0, 0.9]]], |p| {
            holds(plate, p) && !(p[2] > -0.5 && p[0].abs() < 2.0 && p[1].abs() < 2.0)
        });
        let (found, n_boxes) = look(&field, &mesh, Some(0.2));
        assert!(found.is_proved(), "{above}: {:?} {:?}", found.open, found.unresolved.first());
        n_boxes
    };
    let usual = work(0.5);
    for above in [0.1, 1e-2, 1e-3] {
        assert!(work(above) < 3 * usual, "{above}: {} of {usual}", work(above));
    }
}
