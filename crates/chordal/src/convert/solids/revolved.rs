//! Plane shapes turned about an axis: cones, rings, and solids with any profile.
use super::FormMesh;
use super::arcs::UnitCircle;
use super::profile::{ProfileLoops, scale_of};
use crate::implicit::Affine3;
use crate::implicit::construction::PlanarForm;
use crate::math::{add_up, greater, mul_up};

/// The share of a length that a curved profile may use. Chosen: both circles of a ring then cost about the same.
const SHARE: f64 = 0.5;

/// A cone from one radius to another, between minus a height and the height.
pub(super) fn cone([bottom, top]: [f64; 2], half: f64, length: f64) -> Option<FormMesh> {
    let profile = vec![[0.0, -half], [bottom, -half], [top, half], [0.0, half]];
    swept(&[without_repeats(profile)], 0.0, length)
}

/// A ring around z; `None` if it meets itself.
pub(super) fn torus(major: f64, minor: f64, length: f64) -> Option<FormMesh> {
    if minor >= major {
        return None;
    }
    let profile = ProfileLoops::new(&PlanarForm::Disc { radius: minor }, SHARE * length)?;
    let moved: Vec<Vec<[f64; 2]>> =
        profile.loops.iter().map(|ring| ring.iter().map(|[x, y]| [major + x, *y]).collect()).collect();
    swept(&moved, profile.error, length)
}

/// A plane shape, first placed in the plane, turned about its y axis; `None` if a curved shape crosses the axis.
pub(super) fn revolved(profile: &PlanarForm, place: Option<&Affine3>, length: f64) -> Option<FormMesh> {
    let is_straight = matches!(profile, PlanarForm::Contours(_) | PlanarForm::Rectangle { radius: 0.0, .. });
    let share = if is_straight { length } else { SHARE * length / scale_of(place) };
    let profile_loops = ProfileLoops::new(profile, share)?.placed(place);
    let crosses = |ring: &Vec<[f64; 2]>| ring.iter().any(|p| p[0] < 0.0) && ring.iter().any(|p| p[0] > 0.0);
    if !is_straight && profile_loops.loops.iter().any(crosses) {
        return None;
    }
    let loops: Vec<Vec<[f64; 2]>> = profile_loops
        .loops
        .iter()
        .map(|ring| without_repeats(beyond_axis(ring)))
        .filter(|ring| ring.len() > 2)
        .collect();
    swept(&loops, profile_loops.error, length)
}

/// The part of a polygon at x ≥ 0. If it leaves the half-plane several times, sides on the axis overlap.
///
/// Source: I. Sutherland, G. Hodgman, *Reentrant polygon clipping*, 1974.
fn beyond_axis(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut kept = Vec::with_capacity(points.len());
    for (k, p) in points.iter().enumerate() {
        let q = points[(k + 1) % points.len()];
        if p[0] >= 0.0 {
            kept.push(*p);
        }
        // A corner on the axis is kept itself and must not come a second time, as a crossing.
        if (p[0] > 0.0 && q[0] < 0.0) || (p[0] < 0.0 && q[0] > 0.0) {
            let share = p[0] / (p[0] - q[0]);
            kept.push([0.0, p[1] + share * (q[1] - p[1])]);
        }
    }
    kept
}

fn without_repeats(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.dedup();
    while points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    points
}

/// The surface that loops at x ≥ 0 sweep about the axis.
///
/// All rings have corners in the same directions, so that the quads between two rings are flat. The distance of a quad's
/// points, along their radius, from the cone through both circles is at most that of the largest ring from its circle. The
/// distance of the cones from the surface is that of the loops from the profile.
fn swept(loops: &[Vec<[f64; 2]>], profile_error: f64, length: f64) -> Option<FormMesh> {
    let widest = loops.iter().flatten().fold(0.0, |most, p| greater(p[0], most));
    let circle = UnitCircle::new(widest, length - profile_error)?;
    let around = circle.turn();
    let n_ring = around.len() as u32;
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for corners in loops {
        // The row of the first vertex of each corner's ring; corners on the axis have a single vertex.
        let mut rows = Vec::with_capacity(corners.len());
        for [x, z] in corners {
            rows.push(u32::try_from(positions.len()).ok().filter(|row| *row < u32::MAX - n_ring)?);
            if *x == 0.0 {
                positions.push([0.0, 0.0, *z]);
            } else {
                positions.extend(around.iter().map(|[c, s]| [x * c, x * s, *z]));
            }
        }
        for k in 0..corners.len() {
            let next = (k + 1) % corners.len();
            let (p, q, first, second) = (corners[k], corners[next], rows[k], rows[next]);
            let corner = |row: u32, k: u32| row + k % n_ring;
            match (p[0] == 0.0, q[0] == 0.0) {
                (true, true) => {}
                // A flat end needs no vertex on the axis.
                (true, false) if p[1] == q[1] => {
                    faces.extend((1..n_ring - 1).map(|k| [second, second + k + 1, second + k]));
                }
                (false, true) if p[1] == q[1] => {
                    faces.extend((1..n_ring - 1).map(|k| [first, first + k, first + k + 1]));
                }
                (true, false) => {
                    faces.extend((0..n_ring).map(|k| [first, corner(second, k + 1), corner(second, k)]));
                }
                (false, true) => {
                    faces.extend((0..n_ring).map(|k| [corner(first, k), corner(first, k + 1), second]));
                }
                (false, false) => faces.extend((0..n_ring).flat_map(|k| {
                    let [a, b] = [k, k + 1].map(|k| corner(first, k));
                    let [c, d] = [k, k + 1].map(|k| corner(second, k));
                    [[a, b, d], [a, d, c]]
                })),
            }
        }
    }
    Some(FormMesh { positions, faces, error: add_up(profile_error, mul_up(circle.distance, widest)) })
}
