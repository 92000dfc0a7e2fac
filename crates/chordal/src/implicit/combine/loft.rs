//! Lofted and tapered solids, and plane sections.
use super::common;
use super::distribute_blend::{ExactSign, MOST_LOOKS, find_extremum};
use super::sweep::farthest;
use super::transform::bounds_at_most;
use crate::implicit::shapes::{InvalidShape, finite, positive, sum};
use crate::implicit::{Distance, DistanceQuality, Expr, Field, Tape};
use crate::math::{Box3, Interval, add_up, div_up, greater, lesser, mul_up, sqrt_up};

/// The most profiles of a loft. Chosen: its weights are polynomials of one degree less.
const MOST_PROFILES: usize = 16;
/// The most blends of faces of a loft; an expression with more is left unchanged. Chosen: two outlines of a
/// dozen sides.
const MOST_FACES: usize = 512;
/// The radius of the rim over the reach of the shape. Chosen: so close to 1 that distances hardly suffer.
const BEYOND: f64 = 1.0 + 1.0 / 1024.0;

/// Factor for the roundings of a map. Chosen: far more than its few roundings.
const ROUNDED: f64 = 1.0 + 1.0 / (1_u64 << 40) as f64;

impl Field {
    /// The section of the shape with the plane at a height, as a planar shape.
    ///
    /// # Errors
    /// When the height is not finite.
    pub fn section(&self, height: f64) -> Result<Self, InvalidShape> {
        let height = finite("a section's height", height)?;
        let [x, y, _] = Expr::axes();
        let Box3 { mut min, mut max } = self.bounds();
        let bounds = if min[2] <= height && height <= max[2] {
            (min[2], max[2]) = (f64::NEG_INFINITY, f64::INFINITY);
            Box3 { min, max }
        } else {
            Box3::EMPTY
        };
        let cut = self.at(&[x, y, Expr::constant(height)]);
        let is_flat = !self.tape().axes()[2];
        let distance = if is_flat { self.distance() } else { bounds_at_most(self.distance()) };
        Ok(cut.known_distance(distance).known_bounds(bounds))
    }

    /// A solid whose cross-section is a planar shape that is scaled about the z axis with the height: by 1 at
    /// the bottom, half of `height` below 0, and by `factor` at the top. A solid is scaled in the same way
    /// between these heights.
    ///
    /// The value is a bound, divided by the largest stretch; it is only a sign if the shape is unbounded
    /// around the axis.
    ///
    /// # Errors
    /// When the factor or the height is not a finite number above 0.
    pub fn tapered(&self, factor: f64, height: f64) -> Result<Self, InvalidShape> {
        let factor = positive("a taper's factor", factor)?;
        let height = positive("a height", height)?;
        let half = 0.5 * height;
        let [x, y, z] = Expr::axes();
        let slope = (factor - 1.0) / height;
        let scale = |z: &Expr| (z + half) * slope + 1.0;
        let cap = z.abs() - half;
        // Beyond the ends the scale is kept above 0, and no longer matters.
        let smallest = lesser(factor, 1.0);
        let open = scale(&z).max(&(0.5 * smallest).into());
        let plain = self.at(&[&x / open.clone(), &y / open, z.clone()]);
        let sign = plain.sign().max(&cap);
        let reach = farthest(&self.bounds());
        let Box3 { min, max } = self.bounds();
        let wide = |k: usize, side: f64, pick: fn(f64, f64) -> f64| {
            if k == 2 { side } else { pick(side, side * factor) }
        };
        let bounds = Box3 {
            min: [0, 1, 2].map(|k| wide(k, min[k], lesser).next_down()),
            max: [0, 1, 2].map(|k| wide(k, max[k], greater).next_up()),
        };
        let endless = [f64::NEG_INFINITY, f64::NEG_INFINITY, -half];
        let slab = Box3 { min: endless, max: endless.map(|x| -x) };
        let bounds = if self.bounds().is_empty() { Box3::EMPTY } else { common(bounds, slab) };
        let construction = self.construction().and_then(|solids| solids.tapered(factor, half));
        if !reach.is_finite() || self.distance().weakest() == DistanceQuality::Sign {
            let tapered = Self::from_parts(sign, &[self]).known_construction(construction);
            return Ok(tapered.known_bounds(bounds));
        }
        // Clamp to the slab, and to the shape's reach around the axis; points beyond take the value of the
        // nearest such point.
        let rim = mul_up(reach, BEYOND);
        let clamped_z = z.max(&(-half).into()).min(&half.into());
        let clamped_scale = scale(&clamped_z);
        let [u, v] = [&x / clamped_scale.clone(), &y / clamped_scale];
        let from_axis = (u.square() + v.square()).sqrt();
        let share = Expr::constant(rim) / from_axis.max(&rim.into());
        let near = self.at(&[u * &share, v * &share, clamped_z]);
        // A step is divided by the scale, and a step along z also moves points off the axis. Rounded by a few
        // units.
        let narrow = div_up(1.0, smallest.next_down());
        let pull = div_up(mul_up(rim, slope.abs().next_up()), smallest.next_down());
        let stretch = mul_up(add_up(greater(1.0, narrow), pull), ROUNDED);
        let value = (near.expr() / stretch).max(&cap);
        let field = Self::from_parts(value, &[&self.as_distance()]).known_sign(sign);
        let field = field.known_construction(construction);
        Ok(field.known_distance(Distance::BOUND).known_bounds(bounds))
    }

    /// A solid between planar shapes: the first at the bottom, half of `height` below 0, the last at the top.
    /// Between two shapes the surface is ruled where their faces are flat. More than two are blended as a
    /// Bézier curve blends its control points, so the inner ones attract the solid.
    ///
    /// The value is a bound, divided by the largest slope.
    ///
    /// # Errors
    /// When there are fewer than two shapes or more than 16, one has only a sign or no end, or the height is
    /// not a finite number above 0.
    pub fn lofted(profiles: &[Self], height: f64) -> Result<Self, InvalidShape> {
        let height = positive("a height", height)?;
        if !(2..=MOST_PROFILES).contains(&profiles.len()) {
            let message =
                format!("a loft has {} profiles, and must have 2 to {MOST_PROFILES}", profiles.len());
            return Err(InvalidShape::Number(message));
        }
        let [x, y, z] = Expr::axes();
        let mut around = Box3::EMPTY;
        for profile in profiles {
            for (side, quality) in
                [("outside", profile.distance().outside), ("inside", profile.distance().inside)]
            {
                if quality == DistanceQuality::Sign {
                    return Err(InvalidShape::NeedsDistance { operation: "a loft", side });
                }
            }
            around = around.union(profile.bounds());
        }
        let reach = farthest(&around);
        if around.is_empty() || !reach.is_finite() {
            return Err(InvalidShape::Number("a loft needs bounded profiles".into()));
        }
        let half = 0.5 * height;
        let flat = |profile: &Self| profile.at(&[x.clone(), y.clone(), Expr::constant(0.0)]).expr().clone();
        let sections: Vec<Expr> = profiles.iter().map(flat).collect();
        let rim = mul_up(reach, BEYOND);
        let mut blend = LoftBlend { left: MOST_FACES, apart: 0.0, rim };
        let blended = blend.distribute(&sections);
        let cap = z.abs() - half;
        // The value at the nearest point within the rim, where the difference of the sections is known.
        let from_axis = (x.square() + y.square()).sqrt();
        let share = Expr::constant(rim) / from_axis.max(&rim.into());
        let clamped_z = z.max(&(-half).into()).min(&half.into());
        // The blend's third coordinate is the share of the height.
        let share_of_height = |z: &Expr| (z + half) / height;
        let sign = blended.with_axes([x.clone(), y.clone(), share_of_height(&z)]).max(&cap);
        let near = blended.with_axes([&x * &share, &y * &share, share_of_height(&clamped_z)]);
        let degree = (profiles.len() - 1) as f64;
        // A Bézier curve's derivative is its degree times a mean of the differences of neighbouring control
        // points. Across z, the blend is a mean of sections, which has no more slope than these.
        let rise = div_up(mul_up(degree, blend.apart), height);
        let stretch = mul_up(sqrt_up(add_up(1.0, mul_up(rise, rise))), ROUNDED);
        let value = (near / stretch).max(&cap);
        let parts: Vec<Self> = profiles.iter().map(Self::as_distance).collect();
        let field = Self::from_parts(value, &parts.iter().collect::<Vec<_>>()).known_sign(sign);
        let slab =
            Box3 { min: [around.min[0], around.min[1], -half], max: [around.max[0], around.max[1], half] };
        Ok(field.known_distance(Distance::BOUND).known_bounds(slab))
    }
}

/// The blend of sections, whose third coordinate is the share of the height.
struct LoftBlend {
    left: usize,
    /// The largest difference of neighbouring sections within the rim.
    apart: f64,
    rim: f64,
}

impl LoftBlend {
    /// The blend grows with each section between the ends, so minima and maxima of sections become those of
    /// blends.
    fn distribute(&mut self, sections: &[Expr]) -> Expr {
        if self.left > 0 {
            for (k, section) in sections.iter().enumerate() {
                let mut looks = MOST_LOOKS;
                let Some(choice) = find_extremum(section, ExactSign::Faces, &mut looks) else { continue };
                self.left -= 1;
                let [p, q] = choice.parts.each_ref().map(|part| {
                    let mut sections = sections.to_vec();
                    sections[k] = part.clone();
                    self.distribute(&sections)
                });
                return if choice.is_min { p.min(&q) } else { p.max(&q) };
            }
        }
        let n = sections.len() - 1;
        for two in sections.windows(2) {
            self.apart = greater(self.apart, self.farthest_apart(&(&two[1] - &two[0])));
        }
        let t = Expr::axes()[2].clone();
        let complement = Expr::constant(1.0) - &t;
        let power = |base: &Expr, k: usize| (0..k).map(|_| base.clone()).reduce(|a, b| a * b);
        let mut choose = 1.0;
        let terms = sections.iter().enumerate().map(|(k, section)| {
            // Bernstein's polynomials.
            let weight = [power(&t, k), power(&complement, n - k)].into_iter().flatten().reduce(|a, b| a * b);
            let weight = weight.unwrap_or_else(|| Expr::constant(1.0));
            let term = section * (weight * choose);
            // The next binomial coefficient.
            choose = choose * (n - k) as f64 / (k + 1) as f64;
            term
        });
        sum(terms.collect::<Vec<_>>())
    }

    /// The largest size of a difference within the rim, as intervals prove it.
    fn farthest_apart(&self, difference: &Expr) -> f64 {
        /// Boxes along each side. Chosen: within some percent of the truth, and cheap.
        const SIDE: usize = 8;
        let at = |k: usize| self.rim * (2.0 * k as f64 / SIDE as f64 - 1.0);
        let ends = |k: usize| (at(k).next_down(), at(k + 1).next_up());
        let boxes: Vec<Box3> = (0..SIDE * SIDE)
            .map(|k| {
                let ((x, x_end), (y, y_end)) = (ends(k % SIDE), ends(k / SIDE));
                Box3 { min: [x, y, 0.0], max: [x_end, y_end, 0.0] }
            })
            .collect();
        let mut ranges = vec![Interval::UNKNOWN; boxes.len()];
        if Tape::new(difference).over(&boxes, &mut ranges).is_err() {
            return f64::INFINITY;
        }
        ranges.iter().fold(0.0, |most, range| greater(most, range.abs().hi()))
    }
}
