//! The fixed points at which a pixel, the sky and the lamp are sampled: the same for every picture.
use glam::DVec3;

/// The golden ratio minus 1: its multiples modulo 1 are spread most evenly.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// The inverse of the real root of x³ = x + 1 and its square: the same in the plane (M. Roberts, *The
/// unreasonable effectiveness of quasirandom sequences*, 2018).
const PLASTIC: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
/// Rotations of the points on the hemisphere and the lamp, so that neighbouring pixels do not repeat a
/// pattern. More are not seen.
const TURNS: usize = 64;
/// The fewest points on the sky and on the lamp for all rays of a pixel together. Compared side by side: with
/// 16, shadows show a weave.
const SKY: usize = 32;
const LAMP: usize = 32;

/// Sample points for `n` rays per pixel.
#[derive(Clone, Debug)]
pub(super) struct SamplePattern {
    /// Offsets from the corner of the pixel. Their density is a tent two pixels wide, so the plain mean of
    /// the rays is a filtered picture.
    pub pixel_offsets: Vec<[f64; 2]>,
    sky: Vec<[f64; 3]>,
    lamp: Vec<[f64; 2]>,
    turns: Vec<[f64; 2]>,
}

fn fraction(x: f64) -> f64 {
    x - x.floor()
}

/// Maps 0 … 1 to the density of a tent over −1 … 1.
fn tent(u: f64) -> f64 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 - 2.0 * u).sqrt() }
}

impl SamplePattern {
    /// The pattern for `side²` rays.
    pub fn new(side: u32) -> Self {
        let n = (side * side) as usize;
        // Each ray gets the same number of them.
        let [sky, lamp] = [SKY, LAMP].map(|least| n * least.div_ceil(n));
        let even = |n: usize, i: usize| (i as f64 + 0.5) / n as f64;
        let circle = |u: f64| [libm::cos(std::f64::consts::TAU * u), libm::sin(std::f64::consts::TAU * u)];
        let disc = |n: usize, i: usize| {
            let radius = even(n, i).sqrt();
            circle(fraction(0.5 + i as f64 * GOLDEN)).map(|x| x * radius)
        };
        let hemisphere = |n: usize, i: usize| {
            let [x, y] = disc(n, i);
            [x, y, (1.0 - even(n, i)).sqrt()]
        };
        let place = |i| [even(n, i), fraction(0.5 + i as f64 * GOLDEN)].map(|u| 0.5 + tent(u));
        Self {
            pixel_offsets: (0..n).map(place).collect(),
            sky: (0..sky).map(|i| hemisphere(sky, i)).collect(),
            lamp: (0..lamp).map(|i| disc(lamp, i)).collect(),
            turns: (0..TURNS).map(|i| circle(even(TURNS, i))).collect(),
        }
    }

    /// The pattern for the rays of one pixel.
    pub fn for_pixel(&self, x: u32, y: u32) -> PixelPattern<'_> {
        let turn = fraction(f64::from(x) * PLASTIC[0] + f64::from(y) * PLASTIC[1]);
        PixelPattern { pattern: self, turn: self.turns[(turn * TURNS as f64) as usize % TURNS] }
    }
}

/// The pattern, rotated for one pixel.
#[derive(Clone, Copy)]
pub(super) struct PixelPattern<'a> {
    pattern: &'a SamplePattern,
    turn: [f64; 2],
}

impl PixelPattern<'_> {
    fn rotate(&self, x: f64, y: f64) -> [f64; 2] {
        let [cos, sin] = self.turn;
        [cos * x - sin * y, sin * x + cos * y]
    }

    /// Directions around `normal`, as dense as their cosine with it, for one of the pixel's rays. All rays
    /// together have the whole set.
    pub fn sky(&self, ray: usize, normal: DVec3) -> impl ExactSizeIterator<Item = DVec3> {
        let [right, up] = tangents(normal);
        self.pattern.sky[ray..].iter().step_by(self.pattern.pixel_offsets.len()).map(move |[x, y, z]| {
            let [x, y] = self.rotate(*x, *y);
            right * x + up * y + normal * *z
        })
    }

    /// Points of the unit disc for one of the pixel's rays.
    pub fn lamp(&self, ray: usize) -> impl ExactSizeIterator<Item = [f64; 2]> {
        let own = self.pattern.lamp[ray..].iter().step_by(self.pattern.pixel_offsets.len());
        own.map(|[x, y]| self.rotate(*x, *y))
    }
}

/// Two unit vectors perpendicular to `n` and each other.
///
/// Source: T. Duff et al., *Building an orthonormal basis, revisited*, 2017.
pub(super) fn tangents(n: DVec3) -> [DVec3; 2] {
    let sign = if n.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y)]
}
