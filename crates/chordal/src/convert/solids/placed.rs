//! Meshes under similarities.
use super::ROUNDING;
use crate::budget::{Bound, Bounded, Reference};
use crate::explicit::Mesh;
use crate::implicit::Affine3;
use crate::math::{add_up, greater, mul_up};

pub(super) fn placed(mesh: &Bounded<Mesh>, map: &Affine3) -> Option<Bounded<Mesh>> {
    let positions: Vec<[f64; 3]> =
        mesh.shape.positions().iter().map(|p| map.at(*p).map(|x| x + 0.0)).collect();
    let is_mirrored = map.orientation() < 0;
    let turned = |[a, b, c]: [u32; 3]| if is_mirrored { [a, c, b] } else { [a, b, c] };
    let faces: Vec<[u32; 3]> = mesh.shape.faces().iter().map(|face| turned(*face)).collect();
    let rows = map.rows();
    // The columns of a similarity are equally long.
    let scale = (rows[0][0] * rows[0][0] + rows[1][0] * rows[1][0] + rows[2][0] * rows[2][0]).sqrt();
    // Derived: matrices of rounded sines and unit vectors have errors of some 20 roundings, and a length of 8 more.
    let scale = mul_up(scale, 1.0 + 64.0 * f64::EPSILON);
    // Terms may be larger than their sum, so the size of the terms is taken.
    let reach =
        |points: &[[f64; 3]]| points.as_flattened().iter().fold(0.0, |most: f64, x| greater(x.abs(), most));
    let shift = rows.iter().fold(0.0, |most: f64, row| greater(row[3].abs(), most));
    let size = add_up(add_up(mul_up(2.0 * scale, reach(mesh.shape.positions())), shift), reach(&positions));
    let at_most = mesh.bound.at_most().map(|most| add_up(mul_up(most, scale), mul_up(ROUNDING, size)));
    let bound = Bound::with_evidence(0.0, at_most, mesh.bound.evidence().clone(), Reference::Field);
    Some(Bounded { shape: Mesh::new(positions, faces).ok()?, bound })
}
