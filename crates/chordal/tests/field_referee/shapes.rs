//! Shapes as expressions of the library and, apart from them, as functions of the referee's own.
use chordal::implicit::evaluation::Unary;
use chordal::implicit::{Expr, Field};
use chordal::math::Box3;
use chordal_testkit::{Random, is_long};

pub type Point = [f64; 3];

/// A shape that the referee can judge.
pub struct Shape {
    pub name: String,
    pub field: Field,
    /// Negative inside, 0 on the surface, with a slope of at most `slope`.
    pub own: Box<dyn Fn(Point) -> f64>,
    pub slope: f64,
    /// Half of the side of a cube around it.
    pub half: f64,
}

/// Solids joined and cut; every function is of slope 1.
#[derive(Clone)]
pub enum Node {
    Ball(Point, f64),
    /// Where all `n · p < d`, with unit normals.
    Planes(Vec<(Point, f64)>),
    Either(Box<Node>, Box<Node>),
    Both(Box<Node>, Box<Node>),
    Cut(Box<Node>, Box<Node>),
}

impl Node {
    pub fn own(&self, p: Point) -> f64 {
        match self {
            Self::Ball(c, r) => {
                ((p[0] - c[0]).powi(2) + (p[1] - c[1]).powi(2) + (p[2] - c[2]).powi(2)).sqrt() - r
            }
            Self::Planes(all) => all
                .iter()
                .map(|(n, d)| n[0] * p[0] + n[1] * p[1] + n[2] * p[2] - d)
                .fold(f64::NEG_INFINITY, f64::max),
            Self::Either(a, b) => a.own(p).min(b.own(p)),
            Self::Both(a, b) => a.own(p).max(b.own(p)),
            Self::Cut(a, b) => a.own(p).max(-b.own(p)),
        }
    }

    pub fn expr(&self) -> Expr {
        let [x, y, z] = Expr::axes();
        match self {
            Self::Ball(c, r) => ball(*c) - *r,
            Self::Planes(all) => all
                .iter()
                .map(|(n, d)| &x * n[0] + &y * n[1] + &z * n[2] - *d)
                .reduce(|a, b| a.max(&b))
                .expect("planes"),
            Self::Either(a, b) => a.expr().min(&b.expr()),
            Self::Both(a, b) => a.expr().max(&b.expr()),
            Self::Cut(a, b) => a.expr().max(&-b.expr()),
        }
    }
}

fn ball(c: Point) -> Expr {
    let [x, y, z] = Expr::axes();
    ((x - c[0]).square() + (y - c[1]).square() + (z - c[2]).square()).sqrt()
}

pub fn cube(half: f64) -> Box3 {
    Box3 { min: [-half; 3], max: [half; 3] }
}

fn shape(name: &str, expr: Expr, own: impl Fn(Point) -> f64 + 'static, (slope, half): (f64, f64)) -> Shape {
    Shape {
        name: name.into(),
        field: Field::new(expr).with_bounds(cube(half)),
        own: Box::new(own),
        slope,
        half,
    }
}

pub fn solid(name: &str, node: Node, half: f64) -> Shape {
    shape(name, node.expr(), move |p| node.own(p), (1.0, half))
}

/// Three unit vectors across each other.
fn frame(random: &mut Random) -> [Point; 3] {
    let n: Point = random.direction();
    let m: Point = random.direction();
    let cross = |a: Point, b: Point| {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    };
    let unit = |a: Point| {
        let norm = (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt();
        a.map(|x| x / norm)
    };
    let u = unit(cross(n, m));
    [n, u, cross(n, u)]
}

fn turned_box(c: Point, half: Point, axes: [Point; 3]) -> Node {
    let planes = (0..6).map(|k| {
        let n = axes[k / 2].map(|x| if k % 2 == 0 { x } else { -x });
        (n, n[0] * c[0] + n[1] * c[1] + n[2] * c[2] + half[k / 2])
    });
    Node::Planes(planes.collect())
}

const AXES: [Point; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A random tree of `n` solids.
fn tree(n: usize, random: &mut Random) -> Node {
    if n <= 1 {
        let c: Point = random.point::<3>().map(|x| 0.8 * x);
        return match random.below(3) {
            0 => Node::Ball(c, random.between(0.3, 0.9)),
            1 => turned_box(c, [0.3, 0.5, 0.7].map(|x| x * random.between(0.5, 1.2)), frame(random)),
            _ => Node::Planes(vec![(random.direction(), random.between(-0.2, 0.6))]),
        };
    }
    let left = 1 + random.below(n - 1);
    let [a, b] = [left, n - left].map(|n| Box::new(tree(n, random)));
    match random.below(3) {
        0 => Node::Either(a, b),
        1 => Node::Both(a, b),
        _ => Node::Cut(a, b),
    }
}

pub fn menger() -> Node {
    let mut holes = vec![([0.0, 0.0], 1.0 / 3.0)];
    for n in (0..9).filter(|n| *n != 4) {
        holes.push(([f64::from(n % 3 - 1) * 2.0 / 3.0, f64::from(n / 3 - 1) * 2.0 / 3.0], 1.0 / 9.0));
    }
    let mut all = turned_box([0.0; 3], [1.0; 3], AXES);
    for axis in 0..3 {
        let (u, v) = (AXES[(axis + 1) % 3], AXES[(axis + 2) % 3]);
        for (c, half) in &holes {
            let side = |n: Point, d: f64| [(n, d + half), (n.map(|x| -x), half - d)];
            let hole = [side(u, c[0]), side(v, c[1])].concat();
            all = Node::Cut(Box::new(all), Box::new(Node::Planes(hole)));
        }
    }
    all
}

pub fn two_balls() -> Node {
    let at = |x: f64| Box::new(Node::Ball([x, 0.0, 0.0], 0.5));
    Node::Either(at(-0.5), at(0.5))
}

pub fn sphere() -> Shape {
    solid("sphere", Node::Ball([0.0; 3], 1.0), 1.1)
}

pub fn torus() -> Shape {
    let [x, y, z] = Expr::axes();
    let expr = ((&(x.square() + y.square()).sqrt() - 0.7).square() + z.square()).sqrt() - 0.25;
    let own = |p: Point| (p[0].hypot(p[1]) - 0.7).hypot(p[2]) - 0.25;
    shape("torus", expr, own, (1.0, 1.0))
}

/// The gyroid in a ball.
pub fn gyroid() -> Shape {
    let axes = Expr::axes().map(|a| a * 4.0);
    let term = |i: usize, j: usize| axes[i].sin() * axes[j].cos();
    let expr = (term(0, 1) + term(1, 2) + term(2, 0)).max(&((ball([0.0; 3]) - 1.0) * 4.0));
    let own = |p: Point| {
        let [x, y, z] = p.map(|x| 4.0 * x);
        let wave = x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos();
        wave.max(4.0 * ((p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt() - 1.0))
    };
    // Each derivative of the wave is below 4 in size, so its slope is below 4 √3.
    shape("gyroid in a ball", expr, own, (7.0, 1.05))
}

/// Bells around random points; inside is where their sum is above a half.
pub fn blobs(count: usize, narrow: f64, random: &mut Random) -> Shape {
    let centres: Vec<Point> = (0..count).map(|_| random.point::<3>().map(|x| 0.8 * x)).collect();
    let sum = centres
        .iter()
        .map(|c| Expr::unary(Unary::Exp, &(ball(*c).square() * -narrow)))
        .reduce(|a, b| a + b)
        .expect("blobs");
    let slope = count as f64 * (2.0 * narrow / std::f64::consts::E).sqrt();
    let own = move |p: Point| {
        let far = |c: &Point| (p[0] - c[0]).powi(2) + (p[1] - c[1]).powi(2) + (p[2] - c[2]).powi(2);
        0.5 - centres.iter().map(|c| (-narrow * far(c)).exp()).sum::<f64>()
    };
    shape("blobs", -sum + 0.5, own, (slope, 1.6))
}

fn cones() -> Shape {
    let [x, y, z] = Expr::axes();
    let expr = ((x.square() + y.square()).sqrt() - z.abs() * 0.5).max(&(z.abs() - 1.0));
    let own = |p: Point| (p[0].hypot(p[1]) - 0.5 * p[2].abs()).max(p[2].abs() - 1.0);
    shape("cones tip to tip", expr, own, (1.2, 1.05))
}

pub fn drilled() -> Shape {
    let [x, y, z] = Expr::axes();
    let block = x.abs().max(&y.abs()).max(&z.abs()) - 0.8;
    let hole = (x.square() + z.square()).sqrt() - 0.4;
    let own = |p: Point| (p[0].abs().max(p[1].abs()).max(p[2].abs()) - 0.8).max(0.4 - p[0].hypot(p[2]));
    shape("drilled block", block.max(&-hole), own, (1.0, 0.9))
}

pub fn cube_without_ball() -> Shape {
    let cut =
        Node::Cut(Box::new(turned_box([0.0; 3], [0.7; 3], AXES)), Box::new(Node::Ball([0.7, 0.7, 0.7], 0.6)));
    solid("cube without a ball", cut, 0.8)
}

/// One of each, and some trees.
pub fn all(trees: usize) -> Vec<Shape> {
    let mut random = Random::new(5);
    let turned = frame(&mut random);
    let mut all = vec![
        sphere(),
        torus(),
        gyroid(),
        solid("turned box", turned_box([0.1, -0.1, 0.05], [0.7, 0.5, 0.3], turned), 1.1),
        drilled(),
        blobs(if is_long() { 30 } else { 10 }, 20.0, &mut random),
        solid("menger sponge", menger(), 1.05),
        solid("touching spheres", two_balls(), 1.1),
        cones(),
    ];
    for seed in 0..trees {
        let mut random = Random::new(100 + seed as u64);
        let hold = Node::Both(Box::new(tree(4, &mut random)), Box::new(turned_box([0.0; 3], [1.0; 3], AXES)));
        all.push(solid(&format!("tree {seed}"), hold, 1.05));
    }
    all
}
