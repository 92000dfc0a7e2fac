//! Screw threads.
use super::FormMesh;
use crate::implicit::construction::ThreadProfile;
use crate::math::elementary::{sin, sin_cos};
use crate::math::{greater, mul_up};
use std::f64::consts::{PI, TAU};

/// The most vertices. Chosen: some hundred megabytes.
const MOST: f64 = 1_048_576.0;
/// The turns beyond both ends. Chosen: the fans that close the mesh extend over two turns, and are one turn outside.
const BEYOND: f64 = 3.0;
/// The most parts of a flank. Chosen: more parts save triangles only if a turn is as high as it is wide.
const MOST_PARTS: u32 = 4;
/// The most rows of a turn. Chosen: as many as a circle has sides.
const MOST_AROUND: u32 = 1 << 16;

/// A thread from below minus a height to above the height; a fan closes it at each end.
///
/// Its surface is R(θ) q + θ pitch / 2π for the points q of a profile over one turn. For each direction θ of a turn there is
/// a row of the profile's corners; two triangles form a quad between two rows and two corners.
///
/// ```text
///    corner k + 1   o-----o      rows at −α and α;
///                   |   / |      p in one of the triangles,
///                   | p   |      paired with the surface's point
///    corner k       o-----o      at the same direction Θ
///                  −α     α
/// ```
///
/// **Bound.** Let two rows be at −α and α, and p = Σ λᵢ vᵢ a point of a triangle between them and between two corners of the
/// radii r₀ and r₁. It is paired with the point of the surface at its own direction Θ and at the radius Σ λᵢ rᵢ. Along the
/// radius these differ by Σ λᵢ rᵢ − |p|, which is from 0 to (1 − cos α) times the larger radius, since the component of p
/// along the middle direction is cos α Σ λᵢ rᵢ. Along the axis they differ by pitch / 2π times Σ λᵢ θᵢ − Θ. With
/// u = Σ λᵢ θᵢ / α, and v the same weighted by the radii, Θ = atan(v tan α). That is from v α to v α + (tan α − α) if v ≥ 0,
/// and |u − v| ≤ 2 (√κ − 1) / (√κ + 1) for the ratio κ of the radii, the largest change of a mean of two numbers by other
/// weights. On the borders of a quad this map to the surface is one to one and onto, so it reaches every point of the
/// surface.
///
/// `None` if a fan would leave the thread; its root then has too small a radius for its pitch.
pub(super) fn thread(profile: &ThreadProfile, half: f64, length: f64) -> Option<FormMesh> {
    let pitch = profile.pitch;
    let corners = profile.corners();
    // From the middle of a turn on the axis every flank is visible, since its slope is 1/√3.
    if corners.iter().any(|q| q[0] < pitch) {
        return None;
    }
    let rows = (1..=MOST_PARTS)
        .filter_map(|parts| ThreadRows::new(pitch, &with_parts(&corners, pitch, parts), length));
    let ThreadRows { around, row, error } = rows.min_by_key(|rows| rows.around as usize * rows.row.len())?;
    let turns = (half / pitch).ceil() + BEYOND;
    if 2.0 * turns * f64::from(around) * row.len() as f64 > MOST {
        return None;
    }
    let (around, turns, n_row) = (around as i32, turns as i32, row.len() as u32);
    let directions: Vec<(f64, f64)> = (0..around).map(|k| direction(k, around)).collect();
    let mut positions = Vec::new();
    for k in -turns * around..=turns * around {
        let (s, c) = directions[k.rem_euclid(around) as usize];
        let height = pitch * (f64::from(k) / f64::from(around));
        positions.extend(row.iter().map(|[r, z]| [r * c, r * s, z + height]));
    }
    let (n_rows, around) = (2 * turns as u32 * around as u32 + 1, around as u32);
    let at = |row: u32, corner: u32| row * n_row + corner;
    // The corner above; above the last corner is the first one of the next turn.
    let above =
        |row: u32, corner: u32| if corner + 1 < n_row { at(row, corner + 1) } else { at(row + around, 0) };
    let mut faces = Vec::new();
    for k in 0..n_rows - 1 {
        // Above the last turn there is no other to join its last corners to.
        let n_quads = if k + 1 + around < n_rows { n_row } else { n_row - 1 };
        for corner in 0..n_quads {
            let [a, b, c, d] = [at(k, corner), at(k + 1, corner), above(k + 1, corner), above(k, corner)];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    // Fans around two points on the axis close the ends.
    let (first, last) = (positions.len() as u32, positions.len() as u32 + 1);
    let (lowest, highest) = (positions[0][2], positions[positions.len() - 1][2]);
    positions.extend([[0.0, 0.0, lowest + 0.5 * pitch], [0.0, 0.0, highest - 0.5 * pitch]]);
    let end = n_rows - 1;
    for corner in 0..n_row {
        faces.push([first, at(0, corner), above(0, corner)]);
        let (row, corner) = if corner + 1 < n_row { (end, corner) } else { (end - around, corner) };
        faces.push([last, above(row, corner), at(row, corner)]);
    }
    for k in 0..around {
        faces.push([first, at(k + 1, 0), at(k, 0)]);
        let k = end - around + k;
        faces.push([last, at(k, n_row - 1), at(k + 1, n_row - 1)]);
    }
    Some(FormMesh { positions, faces, error })
}

/// The rows of a turn, and the error of the triangles between them.
struct ThreadRows {
    /// The number of rows.
    around: u32,
    /// A row: the radius and the height of its vertices.
    row: Vec<[f64; 2]>,
    error: f64,
}

impl ThreadRows {
    /// The fewest rows of these vertices whose error is within a length; `None` if there are too many.
    fn new(pitch: f64, row: &[[f64; 2]], length: f64) -> Option<Self> {
        let next = row.iter().cycle().skip(1);
        let (mut widest, mut ratio) = (0.0, 1.0);
        for (p, q) in row.iter().zip(next) {
            widest = greater(p[0], widest);
            ratio = greater(greater(p[0] / q[0], q[0] / p[0]), ratio);
        }
        let root = ratio.sqrt();
        let skew = 2.0 * (root - 1.0) / (root + 1.0);
        let error = |around: u32| {
            let half = 0.5 * TAU / f64::from(around);
            let s = sin(0.5 * half);
            let across = 2.0 * widest * s * s;
            // The difference between the tangent and the angle would lose digits: t³/2 is larger, up to 45°.
            let t = sin(half) / sin(0.5 * PI - half);
            let along = pitch / TAU * (0.5 * t * t * t + half * skew);
            // Derived: sines (2 u each), products, sums and a root are below 64 u together.
            mul_up((across * across + along * along).sqrt(), 1.0 + 64.0 * f64::EPSILON)
        };
        // Multiples of four, so that rows lie on both axes, where flat sides may be flush with them.
        let mut rows = (2..=MOST_AROUND / 4).map(|quarter| 4 * quarter);
        let around = rows.find(|around| error(*around) <= length)?;
        Some(Self { around, row: row.to_vec(), error: error(around) })
    }
}

/// The corners of a profile for one turn, with `parts` parts between corners of different radii.
fn with_parts(corners: &[[f64; 2]], pitch: f64, parts: u32) -> Vec<[f64; 2]> {
    let above = [corners[0][0], corners[0][1] + pitch];
    let next = corners.iter().skip(1).chain(std::iter::once(&above));
    let mut row = Vec::new();
    for (p, q) in corners.iter().zip(next) {
        let parts = if p[0] == q[0] { 1 } else { parts };
        let at =
            |i: u32| [0, 1].map(|axis| p[axis] + (q[axis] - p[axis]) * (f64::from(i) / f64::from(parts)));
        row.extend((0..parts).map(at));
    }
    row
}

/// The sine and the cosine of a part of a turn, exact at its quarters.
fn direction(k: i32, around: i32) -> (f64, f64) {
    let quarter = around / 4;
    let (s, c) = sin_cos(TAU * (f64::from(k % quarter) / f64::from(around)));
    match k / quarter {
        0 => (s, c),
        1 => (c, -s),
        2 => (-s, -c),
        _ => (-c, s),
    }
}
