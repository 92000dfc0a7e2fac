//! Round shapes: sphere, capsule, torus, ellipsoid.
use super::{InvalidShape, centred, finite_point, length_of, positive, sum};
use crate::implicit::construction::{Construction, SolidForm};
use crate::implicit::{Distance, DistanceQuality, Expr, Field};
use crate::math::{Box3, add_up, cross, greater, length, lesser, sub_down, unit};

/// The ball with this radius around the origin. The value is the exact distance.
///
/// # Errors
/// When the radius is not a finite number above 0.
///
/// ```
/// use chordal::implicit::shapes::sphere;
/// assert_eq!(sphere(2.0)?.expr().at([0.0, 3.0, 0.0]).unwrap(), 1.0);
/// assert!(sphere(-1.0).is_err());
/// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
/// ```
pub fn sphere(radius: f64) -> Result<Field, InvalidShape> {
    let radius = positive("a sphere's radius", radius)?;
    let [x, y, z] = Expr::axes();
    let construction = Construction::solid(SolidForm::Sphere { radius });
    let field = Field::new(length_of(&[&x, &y, &z]) - radius).known_construction(construction);
    Ok(field.known_distance(Distance::EXACT).known_bounds(centred([radius; 3])))
}

/// All points nearer than `radius` to the segment from `a` to `b`. The value is the exact distance.
///
/// # Errors
/// When a number is not finite, or the radius not above 0.
pub fn capsule(a: [f64; 3], b: [f64; 3], radius: f64) -> Result<Field, InvalidShape> {
    let (a, b) = (finite_point("a capsule's end", a)?, finite_point("a capsule's end", b)?);
    let radius = positive("a capsule's radius", radius)?;
    let along: [f64; 3] = std::array::from_fn(|k| b[k] - a[k]);
    let square = along[0] * along[0] + along[1] * along[1] + along[2] * along[2];
    if !square.is_finite() {
        return Err(InvalidShape::Number("the ends of a capsule are too far apart for their squares".into()));
    }
    let construction = Construction::solid(SolidForm::Capsule { ends: [a, b], radius });
    let field = Field::new(length_of(&from_segment(a, along).iter().collect::<Vec<_>>()) - radius);
    let field = field.known_construction(construction);
    // The other end is `a + along`, rounded once each: a unit in the last place of the larger is more than
    // enough. If the direction is along no axis, all its components are rounded, and so are those of the
    // directions across it.
    let is_along_axis = along.iter().filter(|x| **x != 0.0).count() <= 1;
    let sizes = along.iter().fold(radius, |sum, x| sum + x.abs());
    let turned = if is_along_axis { 0.0 } else { 8.0 * f64::EPSILON * sizes };
    let mut bounds = Box3 { min: a, max: a };
    for k in 0..3 {
        let slack = (a[k].abs() + b[k].abs()) * f64::EPSILON + turned;
        bounds.min[k] = sub_down(sub_down(lesser(a[k], b[k]), slack), radius);
        bounds.max[k] = add_up(add_up(greater(a[k], b[k]), slack), radius);
    }
    Ok(field.known_distance(Distance::EXACT).known_bounds(bounds))
}

/// Components of the vector from a segment to a point, perpendicular to each other: two across the segment,
/// and one along it, beyond its ends. All are linear, or convex and at least 0, so that the length of the
/// vector is known to be convex, see
/// [`Curvature`](crate::implicit::csg::Curvature).
fn from_segment(from: [f64; 3], along: [f64; 3]) -> Vec<Expr> {
    let axes = Expr::axes();
    let way: [Expr; 3] = std::array::from_fn(|k| &axes[k] - from[k]);
    let Some(direction) = unit(along) else { return way.to_vec() };
    // The axis that turns away most, so that the cross product is not short.
    let smallest =
        (1..3).fold(0, |k, axis| if direction[axis].abs() < direction[k].abs() { axis } else { k });
    let axis = std::array::from_fn(|k| if k == smallest { 1.0 } else { 0.0 });
    let Some(across) = unit(cross(direction, axis)) else { return way.to_vec() };
    let linear = |factors: [f64; 3]| {
        sum((0..3).filter(|k| factors[*k] != 0.0).map(|k| match factors[k] {
            1.0 => way[k].clone(),
            factor => &way[k] * factor,
        }))
    };
    let along_segment = linear(direction);
    let beyond = (&along_segment - length(along)).max(&-&along_segment).max(&0.0.into());
    vec![linear(across), linear(cross(direction, across)), beyond]
}

/// All points nearer than `minor` to the circle of radius `major` around the z axis. The value is the exact
/// distance; inside it is a bound if `minor` is above `major`, because the tube then meets itself.
///
/// # Errors
/// When a radius is not a finite number above 0.
pub fn torus(major: f64, minor: f64) -> Result<Field, InvalidShape> {
    let (major, minor) =
        (positive("a torus's major radius", major)?, positive("a torus's minor radius", minor)?);
    let [x, y, z] = Expr::axes();
    let from_circle = length_of(&[&x, &y]) - major;
    let construction = Construction::solid(SolidForm::Torus { major, minor });
    let field = Field::new(length_of(&[&from_circle, &z]) - minor).known_construction(construction);
    let inside = if minor <= major { DistanceQuality::Exact } else { DistanceQuality::Bound };
    let reach = add_up(major, minor);
    let distance = Distance { outside: DistanceQuality::Exact, inside };
    Ok(field.known_distance(distance).known_bounds(centred([reach, reach, minor])))
}

/// The ellipsoid with these three radii. The value is a bound, the larger of two terms. One is `(s − 1)`
/// times the smallest radius, of slope at most 1, with `s = √(Σ (x/r)²)`. The other is the distance to the
/// ball around it, which is better far away. The exact distance would be the root of a polynomial of degree
/// 6.
///
/// # Errors
/// When a radius is not a finite number above 0.
pub fn ellipsoid(radii: [f64; 3]) -> Result<Field, InvalidShape> {
    radii.iter().try_for_each(|r| positive("an ellipsoid's radius", *r).map(|_| ()))?;
    let (smallest, largest) =
        radii.iter().fold((f64::INFINITY, 0.0), |(low, high), r| (lesser(*r, low), greater(*r, high)));
    let axes = Expr::axes();
    let scaled: [Expr; 3] = std::array::from_fn(|k| &axes[k] / radii[k]);
    let sign = (length_of(&[&scaled[0], &scaled[1], &scaled[2]]) - 1.0) * smallest;
    let ball = length_of(&[&axes[0], &axes[1], &axes[2]]) - largest;
    let field = Field::new(sign.max(&ball)).known_sign(sign);
    Ok(field.known_distance(Distance::BOUND).known_bounds(centred(radii)))
}
