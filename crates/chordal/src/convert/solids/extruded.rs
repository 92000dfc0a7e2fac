//! Plane shapes between two heights.
use super::FormMesh;
use super::profile::{ProfileLoops, doubled_area};
use crate::explicit::polygons::winding_number;
use crate::explicit::triangulate::polygon_with_holes;
use crate::implicit::construction::PlanarForm;

/// The solid from minus a height to the height; `None` if the shape's loops are not simple and disjoint.
///
/// Its error is that of its loops, since exact and approximate loops are extruded to the same heights.
pub(super) fn extruded(profile: &PlanarForm, half: f64, length: f64) -> Option<FormMesh> {
    let ProfileLoops { loops, error } = ProfileLoops::new(profile, length)?;
    let at = |z: f64| move |[x, y]: [f64; 2]| [x, y, z];
    raised(&loops, &[at(-half), at(half)], error)
}

/// The solid whose sections are the loops, mapped to each section's height, with triangles between the sections and
/// over the ends; `None` if the loops are not simple and disjoint.
pub(super) fn raised(
    loops: &[Vec<[f64; 2]>],
    sections: &[impl Fn([f64; 2]) -> [f64; 3]],
    error: f64,
) -> Option<FormMesh> {
    let plane: Vec<[f64; 2]> = loops.concat();
    let n_sections = u32::try_from(sections.len()).ok()?;
    let n = u32::try_from(plane.len()).ok().filter(|n| *n < u32::MAX / n_sections)?;
    let last = (n_sections - 1) * n;
    let mut faces = Vec::new();
    for [a, b, c] in filled(loops)? {
        faces.push([a, c, b]);
        faces.push([a + last, b + last, c + last]);
    }
    let mut first = 0;
    for ring in loops {
        let count = ring.len() as u32;
        for k in 0..count {
            for below in (0..last).step_by(n as usize) {
                let (a, b) = (below + first + k, below + first + (k + 1) % count);
                faces.push([a, b, b + n]);
                faces.push([a, b + n, a + n]);
            }
        }
        first += count;
    }
    let positions = sections.iter().flat_map(|at| plane.iter().map(|p| at(*p))).collect();
    Some(FormMesh { positions, faces, error })
}

/// The triangles of the area that loops enclose; indices run through all points of the loops, one after the other. `None`
/// if the loops are not simple and disjoint.
fn filled(loops: &[Vec<[f64; 2]>]) -> Option<Vec<[u32; 3]>> {
    let mut first = 0;
    let firsts: Vec<u32> = loops
        .iter()
        .map(|ring| {
            let row = first;
            first += ring.len() as u32;
            row
        })
        .collect();
    let areas: Vec<f64> = loops.iter().map(|ring| doubled_area(ring)).collect();
    // Each hole belongs to the smallest loop around it.
    let mut holes_of: Vec<Vec<usize>> = vec![Vec::new(); loops.len()];
    for hole in (0..loops.len()).filter(|ring| areas[*ring] < 0.0) {
        let around = (0..loops.len()).filter(|ring| {
            areas[*ring] > -areas[hole]
                && winding_number(&loops[*ring], loops[hole][0]).is_some_and(|n| n != 0)
        });
        let around = around.reduce(|best, ring| if areas[ring] < areas[best] { ring } else { best })?;
        holes_of[around].push(hole);
    }
    let mut triangles = Vec::new();
    for outer in (0..loops.len()).filter(|ring| areas[*ring] > 0.0) {
        let holes: Vec<&[[f64; 2]]> = holes_of[outer].iter().map(|hole| loops[*hole].as_slice()).collect();
        let polygon = polygon_with_holes(&loops[outer], &holes).ok().filter(|polygon| polygon.is_clean())?;
        let rows: Vec<u32> = std::iter::once(&outer)
            .chain(&holes_of[outer])
            .flat_map(|ring| (0..loops[*ring].len() as u32).map(|k| firsts[*ring] + k))
            .collect();
        triangles.extend(polygon.triangles.iter().map(|face| face.map(|k| rows[k as usize])));
    }
    // A loop without area has no triangles, and would leave the solid open.
    areas.iter().all(|area| *area != 0.0).then_some(triangles)
}
