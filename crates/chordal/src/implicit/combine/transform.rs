//! Shapes moved, rotated, scaled and mirrored.
use crate::implicit::construction::Construction;
use crate::implicit::shapes::{InvalidShape, finite_point, sum, unit};
use crate::implicit::{Affine3, Distance, DistanceQuality, Expr, Field};
use crate::math::{Box3, Interval, add_down, add_up, elementary, greater, lesser, mul_up, sqrt_up};

impl Field {
    /// The shape moved by a vector.
    ///
    /// # Errors
    /// When a number is not finite.
    pub fn moved(&self, by: [f64; 3]) -> Result<Self, InvalidShape> {
        let by = finite_point("a move", by)?;
        let axes = Expr::axes();
        let at = std::array::from_fn(|k| if by[k] == 0.0 { axes[k].clone() } else { &axes[k] - by[k] });
        let bounds = self.bounds();
        let shift = |x: f64, by: f64, add: fn(f64, f64) -> f64| {
            // Not rounded if nothing moves.
            if by == 0.0 || x.is_infinite() { x } else { add(x, by) }
        };
        let bounds = Box3 {
            min: std::array::from_fn(|k| shift(bounds.min[k], by[k], add_down)),
            max: std::array::from_fn(|k| shift(bounds.max[k], by[k], add_up)),
        };
        let moved = self.at(&at).known_distance(self.distance()).known_bounds(bounds);
        let shift =
            |k: usize| std::array::from_fn(|j| if j == 3 { by[k] } else { f64::from(u8::from(j == k)) });
        let moved = moved.known_construction(self.placed([0, 1, 2].map(shift))).known_slack(self.slack());
        Ok(moved.with_pattern_at(self, &at))
    }

    /// The shape rotated counter-clockwise around an axis through the origin, seen from the axis's tip. The
    /// rounded sine and cosine define the rotation.
    ///
    /// # Errors
    /// When a number is not finite, or the axis has no length.
    pub fn rotated_deg(&self, axis: [f64; 3], angle_deg: f64) -> Result<Self, InvalidShape> {
        let n = unit("an axis of rotation", axis)?;
        let [angle_deg] = finite_point("an angle", [angle_deg])?;
        let (sin, cos) = sine_cosine_deg(angle_deg);
        let one_minus_cos = 1.0 - cos;
        // The inverse rotation, which maps points back to the shape's own space.
        let rows = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let (next, last) = ((i + 1) % 3, (i + 2) % 3);
                let cross = if j == next {
                    sin * n[last]
                } else if j == last {
                    -sin * n[next]
                } else {
                    cos
                };
                if i == j { n[i] * n[j] * one_minus_cos + cos } else { n[i] * n[j] * one_minus_cos + cross }
            })
        });
        // Its inverse is its transpose.
        let construction = self.placed([0, 1, 2].map(|i| [rows[0][i], rows[1][i], rows[2][i], 0.0]));
        Ok(self.map_linear(rows, [0.0; 3]).known_construction(construction))
    }

    /// The shape scaled about the origin, by one factor along each axis; a negative factor mirrors. Equal
    /// factors keep the distance quality; otherwise an exact distance becomes a bound.
    ///
    /// # Errors
    /// When a factor is not finite, or 0.
    pub fn scaled(&self, by: [f64; 3]) -> Result<Self, InvalidShape> {
        let by = finite_point("a scale", by)?;
        let sizes = by.map(f64::abs);
        let smallest = sizes.iter().fold(f64::INFINITY, |m, s| lesser(*s, m));
        if smallest < f64::MIN_POSITIVE {
            return Err(InvalidShape::Number(format!("a scale is {smallest}, and must not be 0")));
        }
        let axes = Expr::axes();
        let at = std::array::from_fn(|k| &axes[k] / by[k]);
        let even = sizes.iter().all(|s| *s == smallest);
        let distance = if even { self.distance() } else { bounds_at_most(self.distance()) };
        let scaled = self.at(&at);
        // All distances grow by the smallest factor at least …
        let value = scaled.expr() * smallest;
        let field = Self::from_parts(value, &[self]).map_sign(&scaled, |sign| sign * smallest);
        let field = field.with_depth(self.depth().is_some());
        let (min, max) = (self.bounds().min, self.bounds().max);
        let ends = |k: usize| side(min[k], max[k]) * Interval::point(by[k]);
        let bounds = Box3 { min: [0, 1, 2].map(|k| ends(k).lo()), max: [0, 1, 2].map(|k| ends(k).hi()) };
        let bounds = if self.bounds().is_empty() { Box3::EMPTY } else { bounds };
        let factor = |k: usize| std::array::from_fn(|j| if j == k { by[k] } else { 0.0 });
        let field = field.known_construction(if even { self.placed([0, 1, 2].map(factor)) } else { None });
        // … and by the largest at most.
        let largest = sizes.iter().fold(0.0, |largest, size| greater(*size, largest));
        let field = field.known_slack(self.stretched_slack(largest));
        Ok(field.known_distance(distance).known_bounds(bounds).with_pattern_at(self, &at))
    }

    /// The mirror image in the plane through the origin with this normal.
    ///
    /// # Errors
    /// When a number is not finite, or the normal has no length.
    pub fn mirrored(&self, normal: [f64; 3]) -> Result<Self, InvalidShape> {
        let n = unit("a mirror's normal", normal)?;
        let rows = std::array::from_fn(|i| {
            std::array::from_fn(|j| if i == j { 1.0 - 2.0 * n[i] * n[j] } else { -2.0 * n[i] * n[j] })
        });
        let construction = self.placed(rows.map(|[a, b, c]: [f64; 3]| [a, b, c, 0.0]));
        Ok(self.map_linear(rows, [0.0; 3]).known_construction(construction))
    }

    /// The shape under an affine map: its point `p` goes to `map.at(p)`. The rounded inverse of the map
    /// defines the result. Rotations, reflections, translations and uniform scaling keep the distance
    /// quality; otherwise an exact distance becomes a bound.
    ///
    /// # Errors
    /// When the map's inverse is not finite.
    pub fn transformed(&self, map: &Affine3) -> Result<Self, InvalidShape> {
        let rows = map.rows();
        let linear = rows.map(|[a, b, c, _]| [a, b, c]);
        let flat = || InvalidShape::Number("a transform's inverse is not finite".into());
        let inverse = inverse(linear).ok_or_else(flat)?.map(|row| row.map(middle));
        let shift = inverse.map(|row| -((row[0] * rows[0][3] + row[1] * rows[1][3]) + row[2] * rows[2][3]));
        if !inverse.as_flattened().iter().chain(&shift).all(|x| x.is_finite()) {
            return Err(flat());
        }
        Ok(self.map_linear(inverse, shift))
    }

    /// The shape's construction under a further map.
    fn placed(&self, rows: [[f64; 4]; 3]) -> Option<Construction> {
        self.construction()?.placed(rows)
    }

    /// The points that `rows` and `shift` map into this shape, with the value divided by the largest stretch.
    pub(super) fn map_linear(&self, rows: [[f64; 3]; 3], shift: [f64; 3]) -> Self {
        let axes = Expr::axes();
        let at: [Expr; 3] = std::array::from_fn(|i| {
            let terms = (0..3).filter(|j| rows[i][*j] != 0.0).map(|j| &axes[j] * rows[i][j]);
            sum(terms) + shift[i]
        });
        let placed = self.at(&at);
        let (stretch, rigid) = stretch(rows);
        let distance = if rigid { self.distance() } else { bounds_at_most(self.distance()) };
        let field = if stretch == 1.0 {
            placed
        } else {
            let value = placed.expr() / stretch;
            let field = Self::from_parts(value, &[self]).map_sign(&placed, |sign| sign / stretch);
            field.with_depth(self.depth().is_some())
        };
        let field = field.known_distance(distance).known_bounds(preimage(self.bounds(), rows, shift));
        // The rows map points back into the shape.
        let slack = if rigid { self.stretched_slack((1.0 / stretch).next_up()) } else { field.slack() };
        field.known_slack(slack).with_pattern_at(self, &at)
    }

    /// The slack after the shape and its ideal are both stretched by a factor.
    fn stretched_slack(&self, factor: f64) -> f64 {
        /// Derived: matrices of rounded sines and unit vectors are off by some 64 roundings.
        const MARGIN: f64 = 1.0 + 1.0 / (1_u64 << 40) as f64;
        if self.slack() == 0.0 { 0.0 } else { mul_up(self.slack(), mul_up(factor, MARGIN)) }
    }

    /// Adds the pattern of another field at mapped points, if it has one.
    pub(super) fn with_pattern_at(self, other: &Self, at: &[Expr; 3]) -> Self {
        match other.pattern() {
            Some(pattern) => self.with_pattern(pattern.placed(at)),
            None => self,
        }
    }

    /// The field with its value and sign at mapped points.
    pub(in crate::implicit) fn at(&self, at: &[Expr; 3]) -> Self {
        let value = self.expr().with_axes(at.clone());
        let placed = Self::from_parts(value, &[self]).map_sign(self, |sign| sign.with_axes(at.clone()));
        placed.with_depth(self.depth().is_some())
    }
}

/// The distance quality after uneven scaling.
pub(super) fn bounds_at_most(distance: Distance) -> Distance {
    let weaker = |q: DistanceQuality| lesser(q, DistanceQuality::Bound);
    Distance { outside: weaker(distance.outside), inside: weaker(distance.inside) }
}

/// Sine and cosine; exact at multiples of 90°.
fn sine_cosine_deg(angle: f64) -> (f64, f64) {
    let turned = angle.rem_euclid(360.0);
    let quarter = (turned / 90.0).round();
    let remainder = (turned - 90.0 * quarter).to_radians();
    let (sin, cos) = (elementary::sin(remainder), elementary::cos(remainder));
    match quarter as i32 % 4 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// The largest stretch of a vector, rounded up, and whether all vectors are stretched equally, up to
/// rounding.
fn stretch(rows: [[f64; 3]; 3]) -> (f64, bool) {
    // Mᵀ M, whose largest eigenvalue is at most the largest sum of a row.
    let product =
        |i: usize, j: usize| rows[0][i] * rows[0][j] + rows[1][i] * rows[1][j] + rows[2][i] * rows[2][j];
    let size = (product(0, 0) + product(1, 1) + product(2, 2)) / 3.0;
    // Derived: matrices of rounded sines and unit vectors are off by some 20 roundings.
    let slack = 64.0 * f64::EPSILON * size;
    let rigid =
        (0..3).all(|i| (0..3).all(|j| (product(i, j) - if i == j { size } else { 0.0 }).abs() <= slack));
    if rigid {
        let length = size.sqrt();
        return (if (length - 1.0).abs() <= 64.0 * f64::EPSILON { 1.0 } else { length }, true);
    }
    let row = |i: usize| {
        (0..3).fold(0.0, |sum, j| {
            let terms = (0..3).fold(0.0, |sum, k| add_up(sum, mul_up(rows[k][i].abs(), rows[k][j].abs())));
            // The product itself, with twice the rounding of its three terms.
            add_up(sum, add_up(product(i, j).abs(), 8.0 * f64::EPSILON * terms))
        })
    };
    let largest = [0, 1, 2].map(row).into_iter().fold(0.0, |m, x| greater(x, m));
    (sqrt_up(largest), false)
}

fn side(low: f64, high: f64) -> Interval {
    Interval::new(low, high).unwrap_or(Interval::UNKNOWN)
}

fn middle(range: Interval) -> f64 {
    range.midpoint().unwrap_or(f64::NAN)
}

/// The inverse, enclosed in intervals; `None` if the determinant may be 0.
fn inverse(rows: [[f64; 3]; 3]) -> Option<[[Interval; 3]; 3]> {
    let m = rows.map(|row| row.map(Interval::point));
    let minor = |i: usize, j: usize| {
        // With cyclic indices, minors have the signs of cofactors.
        let [a, b] = [(i + 1) % 3, (i + 2) % 3];
        let [c, d] = [(j + 1) % 3, (j + 2) % 3];
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let det = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    if det.lo() <= 0.0 && det.hi() >= 0.0 {
        return None;
    }
    Some(std::array::from_fn(|i| std::array::from_fn(|j| minor(j, i) / det)))
}

/// A box around all points that are mapped into another box.
fn preimage(bounds: Box3, rows: [[f64; 3]; 3], shift: [f64; 3]) -> Box3 {
    if bounds.is_empty() {
        return bounds;
    }
    let Some(back) = inverse(rows) else { return Field::EVERYWHERE };
    let from: [Interval; 3] =
        std::array::from_fn(|k| side(bounds.min[k], bounds.max[k]) - Interval::point(shift[k]));
    let to: [Interval; 3] =
        std::array::from_fn(|k| (back[k][0] * from[0] + back[k][1] * from[1]) + back[k][2] * from[2]);
    Box3 { min: to.map(Interval::lo), max: to.map(Interval::hi) }
}
