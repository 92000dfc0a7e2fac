//! `SvgTransform`: transforms and view boxes, with bounds on their rounding.
use super::cursor::{CursorResult, SvgSyntaxError, TextCursor};
use chordal::explicit::parametric::AffineMap;
use chordal::explicit::{Curve, InvalidCurve};
use chordal::math::{add_up, greater, lesser, mul_up};
use std::f64::consts::PI;

/// An affine map of the plane, and bounds on the error of each of its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SvgTransform {
    affine: AffineMap<2>,
    /// Upper bounds of the errors of the map's numbers, at the same positions.
    error: AffineMap<2>,
    is_identity: bool,
}

const NOTHING: AffineMap<2> = AffineMap { columns: [[0.0; 2]; 2], offset: [0.0; 2] };

impl SvgTransform {
    pub fn identity() -> Self {
        Self { affine: AffineMap::identity(), error: NOTHING, is_identity: true }
    }

    /// A map whose numbers are exactly those of the file.
    fn exact(columns: [[f64; 2]; 2], offset: [f64; 2]) -> Self {
        let affine = AffineMap { columns, offset };
        Self { affine, error: NOTHING, is_identity: affine == AffineMap::identity() }
    }

    pub fn translation(by: [f64; 2]) -> Self {
        Self::exact([[1.0, 0.0], [0.0, 1.0]], by)
    }

    /// A map with rounded numbers, each with a relative error below `relative`.
    fn rounded(columns: [[f64; 2]; 2], offset: [f64; 2], relative: f64) -> Self {
        let error = |x: f64| mul_up(relative, x.abs());
        let error = AffineMap { columns: columns.map(|c| c.map(error)), offset: offset.map(error) };
        Self { affine: AffineMap { columns, offset }, error, is_identity: false }
    }

    /// A rotation by an angle in degrees, from x towards y.
    fn rotation(deg: f64) -> Self {
        let deg = deg % 360.0;
        if deg % 90.0 == 0.0 {
            let quarters = (deg / 90.0).rem_euclid(4.0) as usize;
            let [cos, sin] = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][quarters];
            return Self::exact([[cos, sin], [-sin, cos]], [0.0; 2]);
        }
        let rad = deg * (PI / 180.0);
        let (sin, cos) = libm::sincos(rad);
        // The angle is rounded twice, each by half a step; sine and cosine are off by less than one step
        // more.
        let error = 2.0 * f64::EPSILON * (rad.abs() + 1.0);
        let affine = AffineMap { columns: [[cos, sin], [-sin, cos]], offset: [0.0; 2] };
        Self { affine, error: AffineMap { columns: [[error; 2]; 2], offset: [0.0; 2] }, is_identity: false }
    }

    /// The tangent of an angle in degrees, and a bound on its error.
    fn tangent(deg: f64) -> Option<(f64, f64)> {
        let deg = deg % 180.0;
        if deg.abs() == 90.0 {
            return None;
        }
        if deg == 0.0 {
            return Some((0.0, 0.0));
        }
        let rad = deg * (PI / 180.0);
        let tan = libm::tan(rad);
        // As for a rotation, times the slope of the tangent.
        Some((tan, 4.0 * f64::EPSILON * (rad.abs() + 1.0) * (1.0 + tan * tan)))
    }

    /// The composition: first `inner`, then this map.
    pub fn after(&self, inner: &Self) -> Self {
        if self.is_identity {
            return *inner;
        }
        if inner.is_identity {
            return *self;
        }
        let size = |map: &AffineMap<2>| AffineMap {
            columns: map.columns.map(|c| c.map(f64::abs)),
            offset: map.offset.map(f64::abs),
        };
        let sum = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        let (outer_size, inner_size) = (size(&self.affine), size(&inner.affine));
        // |AB - ab| ≤ |a||δb| + |δa|(|b| + |δb|) + rounding: two products, two sums, half a step each.
        let of_vector = |b: [f64; 2], error: [f64; 2]| {
            let propagated = sum(outer_size.vector(error), self.error.vector(sum(b, error)));
            sum(propagated, outer_size.vector(b).map(|x| 4.0 * f64::EPSILON * x))
        };
        let padded = |vector: [f64; 2]| vector.map(|x| mul_up(x, 1.0 + 16.0 * f64::EPSILON));
        let columns = [0, 1].map(|k| padded(of_vector(inner_size.columns[k], inner.error.columns[k])));
        let offset = of_vector(inner_size.offset, inner.error.offset);
        let offset = sum(offset, sum(self.error.offset, outer_size.offset.map(|x| 4.0 * f64::EPSILON * x)));
        let error = AffineMap { columns, offset: padded(offset) };
        Self { affine: self.affine.after(&inner.affine), error, is_identity: false }
    }

    /// Applies the map to a curve; the slack of the result bounds all rounding.
    pub fn apply(&self, curve: &Curve<2>) -> Result<Curve<2>, InvalidCurve> {
        let moved = curve.transformed(&self.affine)?;
        let reach = curve.bounds().iter().flatten().fold(0.0, |most: f64, x| greater(x.abs(), most));
        let [a, b] = self.error.vector([add_up(reach, curve.slack()); 2]);
        let error = add_up(add_up(a, b), add_up(self.error.offset[0], self.error.offset[1]));
        let slack = mul_up(add_up(moved.slack(), error), 1.0 + 8.0 * f64::EPSILON);
        if slack.is_finite() {
            Ok(moved.with_slack(slack))
        } else {
            Err(InvalidCurve::NotFinite { piece: 0 })
        }
    }

    pub fn is_identity(&self) -> bool {
        self.is_identity
    }

    /// Whether the map is singular, so that nothing is drawn.
    pub fn is_singular(&self) -> bool {
        // Scaling keeps products from vanishing or overflowing.
        let scaled = |[x, y]: [f64; 2]| {
            let most = greater(x.abs(), y.abs());
            if most > 0.0 { [x / most, y / most] } else { [0.0; 2] }
        };
        let [[a, b], [c, d]] = self.affine.columns.map(scaled);
        a * d == b * c
    }

    /// The same map, with bounds that allow for an error of up to `lost` in the position and size of the
    /// viewport.
    pub fn with_error(mut self, lost: f64, view: Option<[f64; 4]>) -> Self {
        if lost > 0.0 {
            let [x, y, w, h] = view.unwrap_or([0.0, 0.0, 1.0, 1.0]);
            let least = lesser(w, h);
            // A scale is the quotient of a size by the view's. An offset is the position minus that of the
            // view's corner, plus half of the unused length.
            let of_scale = if view.is_some() { mul_up(2.0, lost / least) } else { 0.0 };
            let of_corner = mul_up(of_scale, add_up(add_up(x.abs(), y.abs()), add_up(w, h)));
            let of_offset = add_up(mul_up(2.0, lost), of_corner);
            self.error.columns = self.error.columns.map(|c| c.map(|x| add_up(x, of_scale)));
            self.error.offset = self.error.offset.map(|x| add_up(x, of_offset));
            self.is_identity = false;
        }
        self
    }

    /// Parses a list of transforms, as in `rotate(30 10 10) scale(2)`.
    pub fn read(text: &str) -> CursorResult<Self> {
        let mut cursor = TextCursor::new(text);
        let mut map = Self::identity();
        cursor.skip_space();
        while !cursor.is_at_end() {
            map = map.after(&read_one(&mut cursor)?);
            cursor.skip_comma();
        }
        Ok(map)
    }

    /// Maps a view box into a viewport, both as x, y, width and height.
    pub fn fit(view: [f64; 4], port: [f64; 4], aspect: PreserveAspectRatio) -> Self {
        let mut scale = [port[2] / view[2], port[3] / view[3]];
        if let Some(slice) = aspect.uniform {
            let least = lesser(scale[0], scale[1]);
            let most = greater(scale[1], scale[0]);
            scale = [if slice { most } else { least }; 2];
        }
        let columns = [[scale[0], 0.0], [0.0, scale[1]]];
        let unused = [0, 1].map(|k| aspect.align[k] * (port[2 + k] - view[2 + k] * scale[k]));
        let offset = [0, 1].map(|k| port[k] + unused[k] - view[k] * scale[k]);
        // A quotient is rounded by half a step; offsets follow below.
        let mut map = Self::rounded(columns, offset, 4.0 * f64::EPSILON);
        // A sum can be smaller than its parts: five roundings of half a step each, relative to its parts.
        for k in 0..2 {
            let parts =
                port[k].abs() + port[2 + k].abs() + (view[k].abs() + view[2 + k].abs()) * scale[k].abs();
            map.error.offset[k] = 8.0 * f64::EPSILON * parts;
        }
        map
    }
}

fn read_one(cursor: &mut TextCursor) -> CursorResult<SvgTransform> {
    let at = cursor.at();
    let name = cursor.word();
    cursor.skip_space();
    if name.is_empty() || !cursor.take(b'(') {
        return Err(cursor.trouble("a transform, as in scale(2),"));
    }
    let mut n = 0;
    let mut numbers = [0.0; 6];
    cursor.skip_space();
    while !cursor.take(b')') {
        let value = cursor.number()?;
        if n < 6 {
            numbers[n] = value;
        }
        n += 1;
        if cursor.skip_comma() && !cursor.at_number() {
            return Err(cursor.trouble("a number"));
        }
    }
    let [a, b, c, d, e, f] = numbers;
    let wrong = |what: String| SvgSyntaxError { at, what, not_finite: false };
    let name = String::from_utf8_lossy(name);
    Ok(match (name.as_ref(), n) {
        ("matrix", 6) => SvgTransform::exact([[a, b], [c, d]], [e, f]),
        ("translate", 1 | 2) => SvgTransform::translation([a, b]),
        ("scale", 1) => SvgTransform::exact([[a, 0.0], [0.0, a]], [0.0; 2]),
        ("scale", 2) => SvgTransform::exact([[a, 0.0], [0.0, b]], [0.0; 2]),
        ("rotate", 1) => SvgTransform::rotation(a),
        ("rotate", 3) => SvgTransform::translation([b, c])
            .after(&SvgTransform::rotation(a))
            .after(&SvgTransform::translation([-b, -c])),
        ("skewX" | "skewY", 1) => {
            let (tan, tan_off) = SvgTransform::tangent(a)
                .ok_or_else(|| wrong(format!("{name}({a}) takes the plane to infinity")))?;
            let k = usize::from(name == "skewX");
            let mut map = SvgTransform::identity();
            map.affine.columns[k][1 - k] = tan;
            map.error.columns[k][1 - k] = tan_off;
            map.is_identity = tan == 0.0;
            map
        }
        _ => return Err(wrong(format!("'{name}' with {n} numbers is no transform"))),
    })
}

/// How a view box sits in a viewport.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PreserveAspectRatio {
    /// `None` for `none`; else whether the view box covers the viewport (`slice`) or fits inside it (`meet`).
    uniform: Option<bool>,
    /// The share of the unused length before the view box: 0, a half or 1.
    align: [f64; 2],
}

impl Default for PreserveAspectRatio {
    fn default() -> Self {
        Self { uniform: Some(false), align: [0.5, 0.5] }
    }
}

impl PreserveAspectRatio {
    /// Parses the value of `preserveAspectRatio`; `None` if it is malformed.
    pub fn read(text: &str) -> Option<Self> {
        let mut words = text.split_ascii_whitespace().skip_while(|word| *word == "defer");
        let name = words.next()?;
        let uniform = match words.next() {
            None | Some("meet") => Some(false),
            Some("slice") => Some(true),
            Some(_) => return None,
        };
        if words.next().is_some() {
            return None;
        }
        if name == "none" {
            return Some(Self { uniform: None, align: [0.0; 2] });
        }
        let share = |word: &str| match word {
            "Min" => Some(0.0),
            "Mid" => Some(0.5),
            "Max" => Some(1.0),
            _ => None,
        };
        let x = share(name.strip_prefix('x')?.get(..3)?)?;
        let y = share(name.get(4..)?.strip_prefix('Y')?)?;
        Some(Self { uniform, align: [x, y] })
    }

    /// The scale from a view box into a viewport of these sizes, if it is the same for both axes.
    pub fn scale(self, view: [f64; 2], port: [f64; 2]) -> Option<f64> {
        let [x, y] = [port[0] / view[0], port[1] / view[1]];
        match self.uniform {
            None => (x == y).then_some(x),
            Some(slice) => Some(if (x < y) == slice { y } else { x }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: [f64; 2], b: [f64; 2]) {
        assert!((a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-12, "{a:?} {b:?}");
    }

    #[test]
    fn transforms_apply_from_the_right() {
        let to = |text: &str, p: [f64; 2]| SvgTransform::read(text).unwrap().affine.point(p);
        near(to("translate(10) scale(2, 3)", [1.0, 1.0]), [12.0, 3.0]);
        near(to("scale(2)translate(1,2)", [0.0, 0.0]), [2.0, 4.0]);
        assert_eq!(to("rotate(90)", [1.0, 0.0]), [0.0, 1.0]);
        assert_eq!(to("rotate(-450, 5, 5)", [6.0, 5.0]), [5.0, 4.0]);
        near(to("rotate(30)", [1.0, 0.0]), [0.75_f64.sqrt(), 0.5]);
        near(to("skewX(45)", [0.0, 1.0]), [1.0, 1.0]);
        near(to("skewY(-45)", [1.0, 0.0]), [1.0, -1.0]);
        assert_eq!(to("matrix(1 2 3 4 5 6)", [1.0, 1.0]), [9.0, 12.0]);
        assert!(
            SvgTransform::read("").unwrap().is_identity()
                && SvgTransform::read("rotate(360)").unwrap().is_identity()
        );
    }

    #[test]
    fn what_is_no_transform_is_refused() {
        for text in [
            "scale",
            "scale(",
            "scale(1,)",
            "scale(1 2 3)",
            "spin(3)",
            "rotate(1,2)",
            "skewX(90)",
            "matrix(1)",
        ] {
            assert!(SvgTransform::read(text).is_err(), "{text}");
        }
    }

    #[test]
    fn the_error_of_a_chain_covers_what_it_loses() {
        // Eighteen rotations by 20 degrees are the identity.
        let mut map = SvgTransform::identity();
        for _ in 0..18 {
            map = map.after(&SvgTransform::rotation(20.0));
        }
        let point = Curve::point([3.0, 4.0]).unwrap();
        let moved = map.apply(&point).unwrap();
        let [x, y] = moved.start();
        let error = ((x - 3.0).powi(2) + (y - 4.0).powi(2)).sqrt();
        assert!(error <= moved.slack() && moved.slack() < 1e-10, "{error} {}", moved.slack());
    }

    #[test]
    fn a_view_box_sits_where_its_aspect_says() {
        let view = [10.0, 20.0, 100.0, 50.0];
        let port = [0.0, 0.0, 200.0, 200.0];
        for (text, corner) in [
            ("xMidYMid", [0.0, 50.0]),
            ("xMinYMin meet", [0.0, 0.0]),
            ("xMaxYMax", [0.0, 100.0]),
            ("xMidYMid slice", [-100.0, 0.0]),
            ("none", [0.0, 0.0]),
        ] {
            let map = SvgTransform::fit(view, port, PreserveAspectRatio::read(text).unwrap());
            near(map.affine.point([10.0, 20.0]), corner);
        }
        for text in ["", "xMid", "xMidYMid fill", "xMidyMid", "xMidYMid meet x"] {
            assert_eq!(PreserveAspectRatio::read(text), None, "{text}");
        }
    }
}
