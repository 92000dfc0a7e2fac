//! Octahedron and tetrahedron: solids whose faces are equally far from the origin.
use super::{InvalidShape, centred, largest, positive};
use crate::implicit::{Distance, DistanceQuality, Expr, Field};
use crate::math::{div_up, sqrt_down};

/// The distance quality of the largest distance to the planes of a convex solid: exact inside, and a bound
/// outside, where it is the distance only next to a face.
const PLANES: Distance = Distance { outside: DistanceQuality::Bound, inside: DistanceQuality::Exact };

/// 1/√3, rounded.
const THIRD: f64 = 0.577_350_269_189_625_8;

/// The regular octahedron with its corners on the axes at `radius` from the origin. Exact inside, a bound
/// outside.
///
/// # Errors
/// When the radius is not a finite number above 0.
pub fn octahedron(radius: f64) -> Result<Field, InvalidShape> {
    let radius = positive("an octahedron's radius", radius)?;
    let [x, y, z] = Expr::axes();
    // The largest of these is the sum of the three absolute values.
    let sides = [&x + &y + &z, &x + &y - &z, &x - &y + &z, &y + &z - &x].map(|side| side.abs());
    let value = (largest(&sides) - radius) * THIRD;
    Ok(Field::new(value).known_distance(PLANES).known_bounds(centred([radius; 3])))
}

/// The regular tetrahedron with its corners at `radius` from the origin, in the directions (1, 1, 1), (1, −1,
/// −1), (−1, 1, −1) and (−1, −1, 1). Exact inside, a bound outside.
///
/// # Errors
/// When the radius is not a finite number above 0.
pub fn tetrahedron(radius: f64) -> Result<Field, InvalidShape> {
    let radius = positive("a tetrahedron's radius", radius)?;
    let [x, y, z] = Expr::axes();
    // Each face lies opposite a corner, at a third of its distance.
    let sides = [-(&x + &y + &z), &y + &z - &x, &z + &x - &y, &x + &y - &z];
    let value = largest(&sides) * THIRD - radius / 3.0;
    // The corners' coordinates are √3 · radius/3; four roundings are allowed for.
    let reach = div_up(radius, sqrt_down(3.0)) * (1.0 + 4.0 * f64::EPSILON);
    Ok(Field::new(value).known_distance(PLANES).known_bounds(centred([reach; 3])))
}
