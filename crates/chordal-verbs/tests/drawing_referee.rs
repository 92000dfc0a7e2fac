//! Drawings far from zero under nested transforms: what is proved of their polylines is compared with arithmetic of twice as
//! many digits. Double precision is no referee there: at coordinates of millions a point is off by 1e-9 before
//! anything is measured, and a chain of transforms by more.
use chordal::Job;
use chordal_io::{Format, Limits};
use chordal_testkit::{Random, is_long};
use chordal_verbs::{BudgetSpec, FormatHint, Tessellation, load, mesh};

/// A sum of two numbers, the second below half a step of the first: some 106 bits.
#[derive(Clone, Copy, Debug)]
struct Twofold(f64, f64);

impl Twofold {
    fn of(x: f64) -> Self {
        Self(x, 0.0)
    }

    fn sum(a: f64, b: f64) -> Self {
        let s = a + b;
        let back = s - a;
        Self(s, (a - (s - back)) + (b - back))
    }

    fn add(self, other: Self) -> Self {
        let high = Self::sum(self.0, other.0);
        let low = Self::sum(self.1, other.1);
        let one = Self::sum(high.0, high.1 + low.0);
        Self::sum(one.0, one.1 + low.1)
    }

    fn sub(self, other: Self) -> Self {
        self.add(Self(-other.0, -other.1))
    }

    fn mul(self, other: Self) -> Self {
        let product = self.0 * other.0;
        let rest = self.0.mul_add(other.0, -product);
        Self::sum(product, rest + (self.0 * other.1 + self.1 * other.0))
    }

    fn div(self, other: Self) -> Self {
        let first = self.0 / other.0;
        let left = self.sub(other.mul(Self::of(first)));
        Self::of(first).add(Self::of(left.0 / other.0))
    }
}

type Point = [Twofold; 2];

fn within(a: Point, b: Point, t: Twofold) -> Point {
    [0, 1].map(|k| a[k].add(b[k].sub(a[k]).mul(t)))
}

/// The square of the distance from a point to a segment.
fn distance_sq(p: Point, a: Point, b: Point) -> Twofold {
    let dot = |u: Point, v: Point| u[0].mul(v[0]).add(u[1].mul(v[1]));
    let minus = |u: Point, v: Point| [0, 1].map(|k| u[k].sub(v[k]));
    let (along, from) = (minus(b, a), minus(p, a));
    let length = dot(along, along);
    let share = if length.0 == 0.0 { Twofold::of(0.0) } else { dot(from, along).div(length) };
    let share = if share.0 < 0.0 { Twofold::of(0.0) } else { share };
    let share = if share.0 > 1.0 { Twofold::of(1.0) } else { share };
    let off = minus(from, along.map(|x| x.mul(share)));
    dot(off, off)
}

/// A cubic of a path, its control points in the path's own coordinates, by exact decimals.
type Cubic = [[f64; 2]; 4];

struct Drawn {
    /// Scales and shifts, the outermost first.
    transforms: Vec<([f64; 2], [f64; 2])>,
    cubics: Vec<Cubic>,
}

impl Drawn {
    fn new(random: &mut Random) -> Self {
        let transforms = (0..3)
            .map(|_| {
                let scale = [random.between(0.5, 9.0), random.between(0.5, 9.0)];
                (scale, [random.signed() * 30.0, random.signed() * 30.0])
            })
            .collect();
        let mut from = [random.between(1e4, 3e4), random.between(1e4, 3e4)];
        let cubics = (0..4)
            .map(|_| {
                let near = |random: &mut Random| [0, 1].map(|k| from[k] + 80.0 * random.signed());
                let cubic = [from, near(random), near(random), near(random)];
                from = cubic[3];
                cubic
            })
            .collect();
        Self { transforms, cubics }
    }

    fn svg(&self) -> String {
        let mut text = "<svg xmlns='http://www.w3.org/2000/svg'>".to_owned();
        for ([sx, sy], [x, y]) in &self.transforms {
            text += &format!("<g transform='scale({sx} {sy}) translate({x} {y})'>");
        }
        let [x, y] = self.cubics[0][0];
        text += &format!("<path d='M{x} {y}");
        for [_, b, c, d] in &self.cubics {
            text += &format!("C{} {} {} {} {} {}", b[0], b[1], c[0], c[1], d[0], d[1]);
        }
        text += "'/>";
        text + &"</g>".repeat(self.transforms.len()) + "</svg>"
    }

    fn at(&self, cubic: &Cubic, t: f64) -> Point {
        let t = Twofold::of(t);
        let mut points: Vec<Point> = cubic.iter().map(|p| p.map(Twofold::of)).collect();
        while points.len() > 1 {
            points = points.windows(2).map(|pair| within(pair[0], pair[1], t)).collect();
        }
        let inside_out = self.transforms.iter().rev();
        inside_out.fold(points[0], |p, (scale, shift)| {
            [0, 1].map(|k| p[k].add(Twofold::of(shift[k])).mul(Twofold::of(scale[k])))
        })
    }
}

#[test]
fn polylines_of_far_drawings_are_as_near_as_is_proved_to_the_last_digits() {
    let mut random = Random::new(41);
    for round in 0..6 {
        let drawn = Drawn::new(&mut random);
        let svg = drawn.svg();
        let length = 0.013 * f64::from(1 << (2 * (round % 3)));
        let input = load(svg.as_bytes(), FormatHint::default(), &Limits::default()).expect("readable");
        let spec = BudgetSpec { length: Some(length.to_string().parse().unwrap()), ..BudgetSpec::default() };
        let made = mesh(input, &spec, Format::Json, &Job::default()).expect("within the length");
        // What is judged are the numbers in the text.
        let mut text = Vec::new();
        made.write(&mut text).unwrap();
        let read = load(
            &text,
            FormatHint { format: Some(Format::Json), ..FormatHint::default() },
            &Limits::default(),
        );
        assert!(read.is_ok());
        let Tessellation::Polylines(_) = &made.made else { panic!("no polylines") };
        let json: serde_json::Value = serde_json::from_slice(&text).unwrap();
        let points: Vec<[f64; 2]> = json["polylines"][0]["points"]
            .as_array()
            .unwrap()
            .iter()
            .map(|p| [p[0].as_f64().unwrap(), p[1].as_f64().unwrap()])
            .collect();
        let line: Vec<Point> = points.iter().map(|p| p.map(Twofold::of)).collect();
        let most = made.bound.at_most().unwrap();
        let limit = Twofold::of(most).mul(Twofold::of(most));
        let mut worst = 0.0;
        let n = if is_long() { 4096 } else { 1024 };
        for cubic in &drawn.cubics {
            for step in 0..=n {
                let p = drawn.at(cubic, f64::from(step) / f64::from(n));
                // All segments: where a drawing crosses itself the nearest one jumps.
                let squares = line.windows(2).map(|ends| distance_sq(p, ends[0], ends[1]));
                let square = squares.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
                assert!(square.sub(limit).0 <= 0.0, "round {round}: {} beyond {most}", square.0.sqrt());
                worst = f64::max(worst, square.0.sqrt());
            }
        }
        assert!(worst > 0.9 * most, "round {round}: {worst} of {most}");
    }
}
