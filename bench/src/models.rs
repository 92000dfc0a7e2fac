//! Fields as op lists, so that every side reads the same text.
use chordal::implicit::Expr;
use chordal::implicit::evaluation::{Binary, Unary};
use std::collections::HashMap;
use std::fmt::Write;

/// An op list under construction; every line is a new name.
#[derive(Default)]
struct Text {
    lines: String,
    n: usize,
}

impl Text {
    fn line(&mut self, op: &str, operands: &[String]) -> String {
        let name = format!("_{:x}", self.n);
        self.n += 1;
        writeln!(self.lines, "{name} {op} {}", operands.join(" ")).expect("a string takes it");
        name
    }
    fn number(&mut self, value: f64) -> String {
        self.line("const", &[format!("{value}")])
    }
    fn two(&mut self, op: &str, a: &str, b: &str) -> String {
        self.line(op, &[a.to_owned(), b.to_owned()])
    }
    fn one(&mut self, op: &str, a: &str) -> String {
        self.line(op, &[a.to_owned()])
    }
    fn axes(&mut self) -> [String; 3] {
        ["var-x", "var-y", "var-z"].map(|axis| self.line(axis, &[]))
    }
    /// |p − centre|, per axis.
    fn moved(&mut self, axes: &[String; 3], centre: [f64; 3]) -> [String; 3] {
        [0, 1, 2].map(|k| {
            let c = self.number(centre[k]);
            self.two("sub", &axes[k], &c)
        })
    }
    fn sphere(&mut self, axes: &[String; 3], centre: [f64; 3], radius: f64) -> String {
        let squares = self.moved(axes, centre).map(|d| self.one("square", &d));
        let sum = self.two("add", &squares[0], &squares[1]);
        let sum = self.two("add", &sum, &squares[2]);
        let root = self.one("sqrt", &sum);
        let radius = self.number(radius);
        self.two("sub", &root, &radius)
    }
    fn cube(&mut self, axes: &[String; 3], centre: [f64; 3], half: f64) -> String {
        let half = self.number(half);
        let sides = self.moved(axes, centre).map(|d| {
            let size = self.one("abs", &d);
            self.two("sub", &size, &half)
        });
        let most = self.two("max", &sides[0], &sides[1]);
        self.two("max", &most, &sides[2])
    }
}

/// `count` spheres and cubes, each joined to or cut from what is there.
pub fn csg(count: usize) -> String {
    let mut text = Text::default();
    let axes = text.axes();
    let mut state = 1_u64;
    let mut unit = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut whole = text.sphere(&axes, [0.0; 3], 0.6);
    for k in 1..count {
        let centre = [0, 1, 2].map(|_| 1.6 * unit() - 0.8);
        let size = 0.1 + 0.25 * unit();
        let part = if k % 2 == 0 { text.sphere(&axes, centre, size) } else { text.cube(&axes, centre, size) };
        whole = if k % 3 == 0 {
            let outside = text.one("neg", &part);
            text.two("max", &whole, &outside)
        } else {
            text.two("min", &whole, &part)
        };
    }
    text.lines
}

/// A gyroid, sin·cos three times, and a second one of another period taken from it.
pub fn gyroids() -> String {
    let mut text = Text::default();
    let axes = text.axes();
    let mut gyroid = |frequency: f64| {
        let frequency = text.number(frequency);
        let angles = [0, 1, 2].map(|k| text.two("mul", &axes[k], &frequency));
        let sines = angles.clone().map(|a| text.one("sin", &a));
        let cosines = angles.map(|a| text.one("cos", &a));
        let products = [0, 1, 2].map(|k| text.two("mul", &sines[k], &cosines[(k + 1) % 3]));
        let sum = text.two("add", &products[0], &products[1]);
        text.two("add", &sum, &products[2])
    };
    let (large, small) = (gyroid(9.0), gyroid(23.0));
    text.two("max", &large, &small);
    text.lines
}

/// A ball.
pub fn ball() -> String {
    let mut text = Text::default();
    let axes = text.axes();
    text.sphere(&axes, [0.0; 3], 0.6);
    text.lines
}

/// A torus around z.
pub fn torus() -> String {
    let mut text = Text::default();
    let axes = text.axes();
    let squares = axes.clone().map(|axis| text.one("square", &axis));
    let flat = text.two("add", &squares[0], &squares[1]);
    let flat = text.one("sqrt", &flat);
    let major = text.number(0.55);
    let off = text.two("sub", &flat, &major);
    let off = text.one("square", &off);
    let sum = text.two("add", &off, &squares[2]);
    let root = text.one("sqrt", &sum);
    let minor = text.number(0.25);
    text.two("sub", &root, &minor);
    text.lines
}

/// A cube with a ball taken out of its middle, which comes through its faces.
pub fn cube_without_ball() -> String {
    let mut text = Text::default();
    let axes = text.axes();
    let cube = text.cube(&axes, [0.0; 3], 0.5);
    let ball = text.sphere(&axes, [0.0; 3], 0.64);
    let outside = text.one("neg", &ball);
    text.two("max", &cube, &outside);
    text.lines
}

/// A gyroid's one side within a ball.
pub fn gyroid_in_ball() -> String {
    let mut text = Text::default();
    let axes = text.axes();
    let frequency = text.number(8.0);
    let angles = [0, 1, 2].map(|k| text.two("mul", &axes[k], &frequency));
    let sines = angles.clone().map(|a| text.one("sin", &a));
    let cosines = angles.map(|a| text.one("cos", &a));
    let products = [0, 1, 2].map(|k| text.two("mul", &sines[k], &cosines[(k + 1) % 3]));
    let sum = text.two("add", &products[0], &products[1]);
    let sum = text.two("add", &sum, &products[2]);
    let ball = text.sphere(&axes, [0.0; 3], 0.8);
    text.two("max", &sum, &ball);
    text.lines
}

/// A hundred balls along a spiral that melt into each other (the quadratic blend of I. Quilez, "smooth
/// minimum").
pub fn blobs() -> String {
    let mut text = Text::default();
    let axes = text.axes();
    let width = 0.05;
    let mut whole = String::new();
    for k in 0..100 {
        let t = f64::from(k) / 99.0;
        let (angle, out) = (40.0 * t, 0.15 + 0.6 * t);
        let ball = text.sphere(&axes, [out * angle.cos(), out * angle.sin(), 0.8 * t - 0.4], 0.08);
        if k == 0 {
            whole = ball;
            continue;
        }
        // min(a, b) − max(w − |a − b|, 0)² / 4w.
        let least = text.two("min", &whole, &ball);
        let apart = text.two("sub", &whole, &ball);
        let apart = text.one("abs", &apart);
        let limit = text.number(width);
        let near = text.two("sub", &limit, &apart);
        let zero = text.number(0.0);
        let near = text.two("max", &near, &zero);
        let near = text.one("square", &near);
        let quarter = text.number(0.25 / width);
        let bulge = text.two("mul", &near, &quarter);
        whole = text.two("sub", &least, &bulge);
    }
    text.lines
}

/// Our expression of an op list; the last line is the value.
pub fn expression(text: &str) -> Expr {
    let axes = Expr::axes();
    let mut known: HashMap<&str, Expr> = HashMap::new(); // Only looked up: no order depends on it.
    let mut last = Expr::constant(0.0);
    for line in text.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty()) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let of = |k: usize| known[words[k]].clone();
        let unary = Unary::ALL.iter().find(|(_, name)| *name == words[1]);
        let binary = Binary::ALL.iter().find(|(_, name)| *name == words[1]);
        last = match (words[1], unary, binary) {
            ("const", ..) => Expr::constant(f64::from(words[2].parse::<f32>().expect("a number"))),
            ("var-x", ..) => axes[0].clone(),
            ("var-y", ..) => axes[1].clone(),
            ("var-z", ..) => axes[2].clone(),
            (_, Some((op, _)), _) => Expr::unary(*op, &of(2)),
            (_, _, Some((op, _))) => Expr::binary(*op, &of(2), &of(3)),
            (name, ..) => panic!("{name} is no operation"),
        };
        known.insert(words[0], last.clone());
    }
    last
}
