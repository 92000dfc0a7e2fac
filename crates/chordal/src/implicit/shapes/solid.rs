//! Solids with flat sides: plane, box, cylinder, cone, octahedron, tetrahedron.
use super::{
    ContourFill, Contours, InvalidShape, axis_distance, centred, finite, finite_point, largest, length_of,
    not_negative, positive, rounded_slabs, slabs, sum,
};
use crate::implicit::construction::{Construction, SolidForm};
use crate::implicit::{Distance, DistanceQuality, Expr, Field};
use crate::math::{Box3, add_up, div_up, greater, sqrt_down};

/// The half-space of all points with `normal · p < offset`, where `normal` is first scaled to unit length
/// (rounded). The value is the exact distance to the plane.
///
/// # Errors
/// When a number is not finite, or the normal has no length.
pub fn plane(normal: [f64; 3], offset: f64) -> Result<Field, InvalidShape> {
    let (normal, offset) = (unit("a plane's normal", normal)?, finite("a plane's offset", offset)?);
    let axes = Expr::axes();
    let used: Vec<usize> = (0..3).filter(|k| normal[*k] != 0.0).collect();
    let field = Field::new(sum(used.iter().map(|k| &axes[*k] * normal[*k])) - offset);
    let mut bounds = Field::EVERYWHERE;
    if let [k] = used[..] {
        // The only component becomes 1 or −1, without rounding.
        if normal[k] > 0.0 {
            bounds.max[k] = offset;
        } else {
            bounds.min[k] = -offset;
        }
    }
    let construction = Construction::solid(SolidForm::HalfSpace { normal, offset });
    Ok(field.known_distance(Distance::EXACT).known_bounds(bounds).known_construction(construction))
}

/// The vector scaled to length 1, rounded.
pub(in crate::implicit) fn unit(name: &str, v: [f64; 3]) -> Result<[f64; 3], InvalidShape> {
    crate::math::unit(finite_point(name, v)?)
        .ok_or_else(|| InvalidShape::Number(format!("{name} has no length")))
}

/// The box with these full sizes. The value is the exact distance.
///
/// # Errors
/// When a size is not a finite number above 0.
///
/// ```
/// use chordal::implicit::shapes::cuboid;
/// let block = cuboid([2.0, 2.0, 1.0])?;
/// assert_eq!(block.expr().at([4.0, 0.0, 4.5]).unwrap(), 5.0);
/// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
/// ```
pub fn cuboid(sizes: [f64; 3]) -> Result<Field, InvalidShape> {
    let half = halves("a box's size", sizes)?;
    let q = walls(half);
    let field = Field::new(slabs(&q)).known_depth(largest(&q));
    let construction = Construction::solid(SolidForm::Cuboid { half });
    let field = field.known_construction(construction);
    Ok(field.known_distance(Distance::EXACT).known_bounds(centred(half)))
}

/// The box with these full sizes and edges and corners rounded to `radius`. The value is the exact distance.
///
/// # Errors
/// When a size is not a finite number above 0, or the radius is negative or more than half of a size.
pub fn rounded_cuboid(sizes: [f64; 3], radius: f64) -> Result<Field, InvalidShape> {
    let half = halves("a rounded box's size", sizes)?;
    let radius = fitting(radius, &half)?;
    if radius == 0.0 {
        return cuboid(sizes);
    }
    let inner = half.map(|h| h - radius);
    let construction = Construction::solid(SolidForm::RoundedCuboid { half: inner, radius });
    let field = rounded_slabs(&walls(inner), radius).known_construction(construction);
    Ok(field.known_distance(Distance::EXACT).known_bounds(centred(inner.map(|h| add_up(h, radius)))))
}

/// The cylinder of a radius and a full height, centred along z. The value is the exact distance.
///
/// # Errors
/// When the radius or the height is not a finite number above 0.
pub fn cylinder(radius: f64, height: f64) -> Result<Field, InvalidShape> {
    let (radius, height) =
        (positive("a cylinder's radius", radius)?, positive("a cylinder's height", height)?);
    let [x, y, z] = Expr::axes();
    let half = halved(height);
    let q = [length_of(&[&x, &y]) - radius, z.abs() - half];
    let construction = Construction::solid(SolidForm::Cone { bottom: radius, top: radius, half });
    let field = Field::new(slabs(&q)).known_depth(largest(&q)).known_construction(construction);
    Ok(field.known_distance(Distance::EXACT).known_bounds(centred([radius, radius, half])))
}

/// The cone of a full height centred along z, with the radius `bottom` at its lower end and `top` at its
/// upper end; one of them may be 0. The value is the exact distance.
///
/// # Errors
/// When a radius is not a finite number, 0 or above, both are 0, or the height is not a finite number
/// above 0.
pub fn capped_cone(bottom: f64, top: f64, height: f64) -> Result<Field, InvalidShape> {
    let (bottom, top) = (not_negative("a cone's radius", bottom)?, not_negative("a cone's radius", top)?);
    let half = halved(positive("a cone's height", height)?);
    if bottom == 0.0 && top == 0.0 {
        return Err(InvalidShape::Number("both radii of a cone are 0".into()));
    }
    let outline = match (bottom == 0.0, top == 0.0) {
        (true, _) => vec![[0.0, -half], [top, half], [-top, half]],
        (_, true) => vec![[-bottom, -half], [bottom, -half], [0.0, half]],
        _ => vec![[-bottom, -half], [bottom, -half], [top, half], [-top, half]],
    };
    let profile = Contours::new(&[outline], ContourFill::EvenOdd)?;
    let [x, y, z] = Expr::axes();
    let distance = profile.distance();
    let value = profile.expr([length_of(&[&x, &y]), z.clone()]);
    let widest = greater(bottom, top);
    // In exact arithmetic the side runs through (bottom, -half) and (top, half), without a division. Its
    // slope is known on the axis too, where the apex of a cone is.
    let side = axis_distance() * (2.0 * half) - (Expr::constant(half) - &z) * bottom - (&z + half) * top;
    let construction = Construction::solid(SolidForm::Cone { bottom, top, half });
    let field = Field::new(value).known_sign(side.max(&(z.abs() - half))).known_distance(distance);
    let field = field.known_construction(construction);
    Ok(field.known_bounds(Box3 { min: [-widest, -widest, -half], max: [widest, widest, half] }))
}

/// Half of a full size, or the full size if its half underflows.
pub(super) fn halved(size: f64) -> f64 {
    let half = 0.5 * size;
    if half > 0.0 { half } else { size }
}

pub(super) fn halves<const D: usize>(name: &str, sizes: [f64; D]) -> Result<[f64; D], InvalidShape> {
    sizes.iter().try_for_each(|s| positive(name, *s).map(|_| ()))?;
    Ok(sizes.map(halved))
}

/// The radius of rounding, if it fits into half sizes.
pub(super) fn fitting(radius: f64, half: &[f64]) -> Result<f64, InvalidShape> {
    let radius = not_negative("a radius of rounding", radius)?;
    match half.iter().find(|h| **h < radius) {
        None => Ok(radius),
        Some(h) => {
            Err(InvalidShape::Number(format!("a radius of rounding is {radius}, and half of a size is {h}")))
        }
    }
}

/// The amount by which each coordinate exceeds its half size.
pub(super) fn walls<const D: usize>(half: [f64; D]) -> Vec<Expr> {
    Expr::axes().iter().zip(half).map(|(axis, half)| axis.abs() - half).collect()
}

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
