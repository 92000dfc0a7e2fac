//! Planar shapes, unbounded along z; [`Field::extruded`] and [`Field::revolved`] make them solids.
use super::half_planes::half_plane_formula;
use super::solid::{fitting, halved, halves, walls};
use super::{
    ContourFill, Contours, InvalidShape, capsule, finite_point, largest, length_of, positive, rounded_slabs,
    slabs,
};
use crate::implicit::construction::{Construction, PlanarForm};
use crate::implicit::{Distance, Expr, Field};
use crate::math::{Box3, add_up, elementary};
use std::sync::Arc;

/// A planar box, unbounded along z.
fn endless(min: [f64; 2], max: [f64; 2]) -> Box3 {
    Box3 { min: [min[0], min[1], f64::NEG_INFINITY], max: [max[0], max[1], f64::INFINITY] }
}

/// The disc with this radius. The value is the exact distance.
///
/// # Errors
/// When the radius is not a finite number above 0.
pub fn circle(radius: f64) -> Result<Field, InvalidShape> {
    let radius = positive("a circle's radius", radius)?;
    let [x, y, _] = Expr::axes();
    let construction = Construction::planar(PlanarForm::Disc { radius });
    let field = Field::new(length_of(&[&x, &y]) - radius).known_construction(construction);
    Ok(field.known_distance(Distance::EXACT).known_bounds(endless([-radius; 2], [radius; 2])))
}

/// The rectangle with these full sizes. The value is the exact distance.
///
/// # Errors
/// When a size is not a finite number above 0.
pub fn rectangle(sizes: [f64; 2]) -> Result<Field, InvalidShape> {
    let half = halves("a rectangle's size", sizes)?;
    let q = walls(half);
    let construction = Construction::planar(PlanarForm::Rectangle { half, radius: 0.0 });
    let field = Field::new(slabs(&q)).known_depth(largest(&q)).known_construction(construction);
    Ok(field.known_distance(Distance::EXACT).known_bounds(endless(half.map(|h| -h), half)))
}

/// The rectangle with these full sizes and corners rounded to `radius`. The value is the exact distance.
///
/// # Errors
/// When a size is not a finite number above 0, or the radius is negative or more than half of a size.
pub fn rounded_rectangle(sizes: [f64; 2], radius: f64) -> Result<Field, InvalidShape> {
    let half = halves("a rounded rectangle's size", sizes)?;
    let radius = fitting(radius, &half)?;
    if radius == 0.0 {
        return rectangle(sizes);
    }
    let inner = half.map(|h| h - radius);
    let outer = inner.map(|h| add_up(h, radius));
    let construction = Construction::planar(PlanarForm::Rectangle { half: inner, radius });
    let field = rounded_slabs(&walls(inner), radius).known_construction(construction);
    Ok(field.known_distance(Distance::EXACT).known_bounds(endless(outer.map(|h| -h), outer)))
}

/// All points of the plane nearer than `radius` to the segment from `a` to `b`. The value is the exact
/// distance.
///
/// # Errors
/// When a number is not finite, or the radius not above 0.
pub fn segment(a: [f64; 2], b: [f64; 2], radius: f64) -> Result<Field, InvalidShape> {
    let solid = capsule([a[0], a[1], 0.0], [b[0], b[1], 0.0], radius)?;
    let [x, y, _] = Expr::axes();
    let Box3 { min, max } = solid.bounds();
    let construction = Construction::planar(PlanarForm::Segment { ends: [a, b], radius });
    let field = Field::new(solid.expr().with_axes([x, y, Expr::constant(0.0)]));
    let field = field.known_construction(construction);
    Ok(field.known_distance(Distance::EXACT).known_bounds(endless([min[0], min[1]], [max[0], max[1]])))
}

impl Contours {
    /// The shape, unbounded along z.
    #[must_use]
    pub fn into_field(self) -> Field {
        let (distance, [min, max]) = (self.distance, self.bounds);
        let [x, y, _] = Expr::axes();
        let sign = half_plane_formula(&self.edges, [&x, &y]);
        let contours = Arc::new(self);
        let construction = Construction::planar(PlanarForm::Contours(Arc::clone(&contours)));
        let field = Field::new(Self::shared_expr(contours, [x, y])).known_construction(construction);
        let field = field.known_distance(distance).known_bounds(endless(min, max));
        sign.map_or(field.clone(), |sign| field.known_sign(sign))
    }
}

/// The polygon through these corners, joined in order and closed. If it crosses itself, the even-odd rule
/// decides the inside. The value is the exact distance for simple polygons, and a bound for polygons that
/// cross or touch themselves.
///
/// # Errors
/// When there are fewer than three corners, or a number is not finite.
///
/// ```
/// use chordal::implicit::shapes::polygon;
/// let arrow = polygon(&[[0.0, 0.0], [4.0, 0.0], [2.0, 1.0], [4.0, 2.0], [0.0, 2.0]])?;
/// assert_eq!(arrow.expr().at([4.0, -3.0, 7.0]).unwrap(), 3.0);
/// assert!(arrow.expr().at([3.0, 1.0, 0.0]).unwrap() > 0.0);
/// # Ok::<(), chordal::implicit::shapes::InvalidShape>(())
/// ```
pub fn polygon(corners: &[[f64; 2]]) -> Result<Field, InvalidShape> {
    if corners.len() < 3 {
        return Err(InvalidShape::Number(format!(
            "a polygon has {} corners, and must have at least 3",
            corners.len()
        )));
    }
    corners.iter().try_for_each(|p| finite_point("a polygon's corner", *p).map(|_| ()))?;
    Ok(Contours::new(&[corners.to_vec()], ContourFill::EvenOdd)?.into_field())
}

/// The regular polygon with `sides` corners at `radius` from the origin, the first on the x axis (coordinates
/// rounded). The value is the exact distance.
///
/// # Errors
/// When there are fewer than three sides or more than 65,536, or the radius is not a finite number above 0.
pub fn regular_polygon(sides: u32, radius: f64) -> Result<Field, InvalidShape> {
    let radius = positive("a regular polygon's radius", radius)?;
    if !(3..=65_536).contains(&sides) {
        return Err(InvalidShape::Number(format!(
            "a regular polygon has {sides} sides, and must have 3 to 65536"
        )));
    }
    let corner = |k: u32| {
        let angle = std::f64::consts::TAU * (f64::from(k) / f64::from(sides));
        [radius * elementary::cos(angle), radius * elementary::sin(angle)]
    };
    polygon(&(0..sides).map(corner).collect::<Vec<_>>())
}

/// The regular polygon of [`regular_polygon`] with a full height, centred along z. The value is the exact
/// distance.
///
/// # Errors
/// As for [`regular_polygon`], and when the height is not a finite number above 0.
pub fn prism(sides: u32, radius: f64, height: f64) -> Result<Field, InvalidShape> {
    regular_polygon(sides, radius)?.extruded(2.0 * halved(height))
}
