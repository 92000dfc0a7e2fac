//! Heights on a lattice to a closed solid: their triangles, walls down to a floor, and the floor.
use chordal::Mesh;
use chordal::explicit::InvalidMesh;

/// A solid below heights.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeightSolid {
    /// The widths along x and along y; the middle is on the z axis.
    pub size: [f64; 2],
    /// The distance between heights of 0 and 1.
    pub height: f64,
    /// The distance of a height of 0 from the floor, which is at z = 0. Above 0, so that walls have two ends.
    pub base: f64,
}

/// The solid below `n[0]` by `n[1]` heights, at least two each way, row by row along x; the first row has the lowest y. The
/// cell of four neighbours is two triangles, cut from the lowest x and y to the highest.
///
/// # Errors
/// If a coordinate is not finite, or there are more vertices than a mesh may have.
pub(crate) fn heights_to_mesh(heights: &[f64], n: [u32; 2], solid: HeightSolid) -> Result<Mesh, InvalidMesh> {
    let HeightSolid { size, height, base } = solid;
    // The formula makes the two ends mirror images of each other to the last bit.
    let along = |axis: usize, k: u32| size[axis] * (f64::from(k) / f64::from(n[axis] - 1) - 0.5);
    let id = |i: u32, j: u32| j * n[0] + i;
    let lattice = (0..n[1]).flat_map(|j| (0..n[0]).map(move |i| (i, j)));
    let mut positions: Vec<[f64; 3]> = lattice
        .map(|(i, j)| [along(0, i), along(1, j), base + height * heights[id(i, j) as usize]])
        .collect();
    let mut faces = Vec::new();
    for j in 0..n[1] - 1 {
        for i in 0..n[0] - 1 {
            let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    // The border, counter-clockwise as seen from above: each side without its end, which is the start of the next side.
    let (right, back) = (n[0] - 1, n[1] - 1);
    let sides = [
        (0..right).map(|i| id(i, 0)).collect::<Vec<u32>>(),
        (0..back).map(|j| id(right, j)).collect(),
        (0..right).map(|i| id(right - i, back)).collect(),
        (0..back).map(|j| id(0, back - j)).collect(),
    ];
    let border = sides.concat();
    let first = positions.len() as u32;
    let centre = first + border.len() as u32;
    for top in &border {
        let [x, y, _] = positions[*top as usize];
        positions.push([x, y, 0.0]);
    }
    positions.push([0.0; 3]);
    for (k, top) in border.iter().enumerate() {
        let next = (k + 1) % border.len();
        let (next_top, below, next_below) = (border[next], first + k as u32, first + next as u32);
        faces.extend([[below, next_below, next_top], [below, next_top, *top]]);
        // The floor is a fan around its middle, so that it uses every lower corner of the walls.
        faces.push([centre, next_below, below]);
    }
    Mesh::new(positions, faces)
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal::check::validity;
    use chordal::explicit::Topology;

    #[test]
    fn heights_have_the_volume_of_their_triangles_and_are_closed() {
        type HeightAt = fn(f64, f64) -> f64;
        let solid = HeightSolid { size: [6.0, 2.0], height: 3.0, base: 0.5 };
        // A box, slopes, a roof over the middle row, and the base alone: all are linear between samples.
        let cases: [([u32; 2], HeightAt, f64); 5] = [
            ([2, 2], |_, _| 1.0, 1.0),
            ([7, 3], |x, _| x, 0.5),
            ([4, 5], |_, y| y, 0.5),
            ([5, 3], |_, y| 1.0 - (2.0 * y - 1.0).abs(), 0.5),
            ([3, 2], |_, _| 0.0, 0.0),
        ];
        for (n, height, mean) in cases {
            let [columns, rows] = n;
            let part = |k: u32, n: u32| f64::from(k) / f64::from(n - 1);
            let heights: Vec<f64> = (0..rows)
                .flat_map(|j| (0..columns).map(move |i| height(part(i, columns), part(j, rows))))
                .collect();
            let mesh = heights_to_mesh(&heights, n, solid).unwrap();
            let found = validity(&mesh, Topology::Positions);
            assert!(found.closed && found.manifold() && found.oriented, "{n:?} {found:?}");
            assert_eq!((found.components, found.genus), (1, Some(0)));
            let truth = 6.0 * 2.0 * (0.5 + 3.0 * mean);
            assert!((found.measure.signed_volume - truth).abs() < 1e-12, "{n:?}: {found:?}");
        }
    }

    #[test]
    fn the_first_row_has_the_lowest_y() {
        let solid = HeightSolid { size: [2.0, 4.0], height: 8.0, base: 1.0 };
        let mesh = heights_to_mesh(&[0.0, 0.25, 0.5, 1.0], [2, 2], solid).unwrap();
        let wanted = [[-1.0, -2.0, 1.0], [1.0, -2.0, 3.0], [-1.0, 2.0, 5.0], [1.0, 2.0, 9.0]];
        assert_eq!(mesh.positions()[..4], wanted);
    }
}
