//! `SwitchDistances`: the distances from which a level of detail is fine enough.
use crate::budget::{MinDistanceView, Pixels, View};
use crate::math::{Box3, greater};

/// The switching distances of levels by their errors, the finest first, for one projection and a limit in
/// pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct SwitchDistances {
    /// By level: the nearest distance at which it may be shown. Nearer than the distance of the finest level,
    /// no level is fine enough.
    nearest: Vec<f64>,
    errors: Vec<f64>,
    lens: MinDistanceView,
    pixels: Pixels,
}

/// A coarser level takes over at its distance times this factor, a finer one at its distance. Chosen: so that
/// levels do not flicker if the viewer moves around at one distance; a larger factor keeps finer levels
/// longer.
pub const HYSTERESIS: f64 = 1.1;

/// The level to show at a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelChoice {
    /// The level, 0 the finest.
    pub level: usize,
    /// Upper bound of the error on the screen, anywhere in the picture; `None` if the eye is too close for
    /// a bound.
    pub pixels: Option<f64>,
    /// Whether that is within the limit.
    pub is_enough: bool,
}

impl SwitchDistances {
    /// The distances for levels with these proved errors, ascending. Only the projection and the
    /// screen of `lens` are used.
    ///
    /// Conservative: from a level's distance on, its error is at most `pixels` everywhere on the screen,
    /// corners included, by the full form of [`View::pixels_of`], for any direction of view.
    ///
    /// ```
    /// use chordal::View;
    /// use chordal::budget::View::MinDistance;
    /// use chordal::lod::selection::SwitchDistances;
    /// let MinDistance(lens) = "1920x1080 fov=45 dist=1".parse::<View>()? else { panic!() };
    /// let switches = SwitchDistances::new(&[0.001, 0.002, 0.004], lens, "1px".parse()?);
    /// let [a, b, c] = [0, 1, 2].map(|level| switches.distance(level).unwrap());
    /// assert!(a > 0.001 * 935.0 && b > 1.9 * a && c > 1.9 * b);
    /// assert_eq!(switches.at(1.01 * b, None).level, 1);
    /// assert_eq!(switches.at(1.01 * b, Some(0)).level, 0); // not yet: it was fine before
    /// assert_eq!(switches.at(1.2 * b, Some(0)).level, 1);
    /// # Ok::<(), chordal::budget::camera::InvalidView>(())
    /// ```
    #[must_use]
    pub fn new(errors: &[f64], lens: MinDistanceView, pixels: Pixels) -> Self {
        let nearest = errors.iter().map(|error| switch_distance(*error, lens, pixels)).collect();
        Self { nearest, errors: errors.to_vec(), lens, pixels }
    }

    /// The nearest distance at which a level may be shown; infinite if no distance is far enough.
    #[must_use]
    pub fn distance(&self, level: usize) -> Option<f64> {
        self.nearest.get(level).copied()
    }

    /// The level to show at a distance from the box, if `before` was shown last: a coarser level takes over
    /// [`HYSTERESIS`] times farther out than its distance, a finer one at once. Without levels, level 0.
    #[must_use]
    pub fn at(&self, distance: f64, before: Option<usize>) -> LevelChoice {
        let coarsest =
            |distance: f64| self.nearest.iter().rposition(|nearest| *nearest <= distance).unwrap_or(0);
        let now = coarsest(distance);
        let level = match before {
            Some(before) if now > before => {
                let late = coarsest(distance / HYSTERESIS);
                greater(late, before)
            }
            _ => now,
        };
        let pixels = self.errors.get(level).and_then(|error| pixels_at(*error, self.lens, distance));
        LevelChoice { level, pixels, is_enough: pixels.is_some_and(|px| px <= self.pixels.get()) }
    }
}

fn pixels_at(error: f64, lens: MinDistanceView, distance: f64) -> Option<f64> {
    // Any position would do, since only the distance matters.
    let anywhere = Box3 { min: [0.0; 3], max: [0.0; 3] };
    View::MinDistance(MinDistanceView { distance, ..lens }).pixels_of(error, &anywhere)
}

/// The relative precision of a distance. Chosen: the exact distance of a switch is invisible, as long as it
/// is not too near.
const CLOSE: f64 = 1e-6;

/// The nearest distance, up to a millionth, from which an error is at most `pixels`.
fn switch_distance(error: f64, lens: MinDistanceView, pixels: Pixels) -> f64 {
    if error <= 0.0 {
        return 0.0;
    }
    let is_enough = |distance: f64| pixels_at(error, lens, distance).is_some_and(|px| px <= pixels.get());
    // A distance that suffices suffices farther out as well: powers of two, then bisection.
    let Some(mut far) = (-60..=200).map(|k| error * libm::exp2(f64::from(k))).find(|d| is_enough(*d)) else {
        return f64::INFINITY;
    };
    let mut near = 0.5 * far;
    while far - near > CLOSE * far {
        let middle = 0.5 * (near + far);
        if is_enough(middle) {
            far = middle;
        } else {
            near = middle;
        }
    }
    far
}
