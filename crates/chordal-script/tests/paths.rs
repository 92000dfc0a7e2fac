//! Paths in scripts, and the shapes made of them: against curves that are sampled here, point by point.
use chordal::implicit::DistanceQuality;
use chordal_script::{RunOptions, Script, run};
use chordal_testkit::Random;

fn script(text: &str) -> Script {
    run(text, &RunOptions::default(), &Default::default()).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn error(text: &str) -> String {
    match run(text, &RunOptions::default(), &Default::default()) {
        Ok(_) => panic!("{text}: a shape"),
        Err(error) => error.message,
    }
}

fn values(script: &Script, points: &[[f64; 3]]) -> Vec<f64> {
    let mut values = vec![0.0; points.len()];
    script.field.tape().at(points, &mut values).unwrap();
    values
}

fn apart<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|k| (a[k] - b[k]) * (a[k] - b[k])).sum::<f64>().sqrt()
}

/// Points of cubics in a row.
fn cubics<const D: usize>(control: &[[f64; D]], steps: usize) -> Vec<[f64; D]> {
    let mut points = Vec::new();
    for piece in (0..control.len() - 1).step_by(3) {
        for step in 0..=steps {
            let t = step as f64 / steps as f64;
            let weights =
                [(1.0 - t).powi(3), 3.0 * t * (1.0 - t).powi(2), 3.0 * t * t * (1.0 - t), t.powi(3)];
            points.push(std::array::from_fn(|k| (0..4).map(|i| weights[i] * control[piece + i][k]).sum()));
        }
    }
    points
}

/// The parity of crossings of a polygon's sides with a ray.
fn is_inside(polygon: &[[f64; 2]], p: [f64; 2]) -> bool {
    let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
    sides
        .filter(|(a, b)| {
            (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        })
        .count()
        % 2
        == 1
}

fn shown<const D: usize>(points: &[[f64; D]]) -> String {
    let point = |p: &[f64; D]| format!("{p:?}");
    format!("[{}]", points.iter().map(point).collect::<Vec<_>>().join(", "))
}

/// No value exceeds the distance to a point on the other side.
fn is_a_bound(text: &str, reach: f64, random: &mut Random) {
    let made = script(text);
    assert_ne!(made.field.distance().weakest(), DistanceQuality::Sign, "{text}");
    let places: Vec<[f64; 3]> = (0..4000).map(|_| random.point_within(reach)).collect();
    let found = values(&made, &places);
    let mut crossed = 0;
    for _ in 0..40_000 {
        let (a, b) = (random.below(places.len()), random.below(places.len()));
        if (found[a] < 0.0) != (found[b] < 0.0) {
            crossed += 1;
            let distance = apart(places[a], places[b]) * (1.0 + 1e-12) + 1e-12;
            assert!(found[a].abs() <= distance, "{text}: {} at {:?}", found[a], places[a]);
        }
    }
    // Near the surface, too.
    let steps = places.iter().zip(&found).map(|(p, value)| {
        let (step, far) = (random.direction::<3>(), value.abs() * (1.0 - 1e-9) - 1e-12);
        std::array::from_fn(|k| p[k] + step[k] * f64::max(far, 0.0))
    });
    let steps: Vec<[f64; 3]> = steps.collect();
    let beside = values(&made, &steps);
    for (k, value) in found.iter().enumerate().filter(|(_, value)| value.abs() > 1e-9) {
        assert_eq!(beside[k] <= 0.0, *value <= 0.0, "{text}: {value} at {:?}, {:?}", places[k], steps[k]);
    }
    assert!(crossed > 200, "{text}: {crossed}");
}

#[test]
fn a_path_is_filled_within_its_tolerance() {
    let mut random = Random::new(1);
    for _ in 0..20 {
        let control: Vec<[f64; 2]> = (0..7).map(|_| random.point_within(2.0)).collect();
        let tolerance = random.power(1e-4, 1e-1);
        let made = script(&format!("polygon(bezier({}), {tolerance})", shown(&control)));
        let dense = cubics(&control, 4000);
        let closing = (0..4000).map(|k| k as f64 / 4000.0);
        let ends = [control[6], control[0]];
        let closing = closing.map(|t| [0, 1].map(|k| ends[0][k] + t * (ends[1][k] - ends[0][k])));
        let outline: Vec<[f64; 2]> = dense.into_iter().chain(closing).collect();
        let places: Vec<[f64; 2]> = (0..100).map(|_| random.point_within(3.0)).collect();
        let found = values(&made, &places.iter().map(|[x, y]| [*x, *y, 0.0]).collect::<Vec<_>>());
        for (p, value) in places.into_iter().zip(found) {
            let distance = outline.iter().map(|q| apart(*q, p)).fold(f64::INFINITY, f64::min);
            // Samples are 0.004 apart at most, and the tolerance is what the script says.
            assert!(value.abs() <= distance + tolerance, "{value} {distance}");
            if distance > tolerance + 1e-2 {
                assert_eq!(value < 0.0, is_inside(&outline, p), "{p:?}");
            }
        }
    }
}

#[test]
fn a_circle_is_a_circle_within_what_the_script_says() {
    let made = script("polygon(arc(2, center=[1, 0]))");
    let said: Vec<&str> = made.said.iter().map(String::as_str).collect();
    let [line] = said[..] else { panic!("{said:?}") };
    let within: f64 = line.split("within ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(within > 0.0 && within <= 32.0_f64.sqrt() / 4096.0, "{line}");
    assert!(line.starts_with("polygon(): ") && line.ends_with("(proved)"), "{line}");
    // The shape carries it, for the bound of what is made of it.
    assert!(made.field.slack() <= within * 1.001 && made.field.slack() >= within * 0.999);
    for k in 0..100 {
        let angle = f64::from(k) / 7.0;
        let [x, y] = [1.0 + 3.0 * angle.cos(), 3.0 * angle.sin()];
        let value = values(&made, &[[x, y, 0.0]])[0];
        assert!((value - 1.0).abs() <= within * 1.001, "{value}");
    }
    // Straight lines are what they are, and nothing is said.
    assert!(script("polygon([[0, 0], [1, 0], [0, 1]])").said.is_empty());
}

#[test]
fn a_tube_is_within_its_tolerance_of_all_points_near_a_path() {
    let mut random = Random::new(2);
    for case in 0..12 {
        let control: Vec<[f64; 3]> = (0..7).map(|_| random.point_within(2.0)).collect();
        // The finest have more pieces than there are capsules.
        let tolerance = if case % 3 == 0 { 1e-7 } else { random.power(1e-4, 1e-1) };
        let made = script(&format!("sweep(bezier({}), 0.25, {tolerance})", shown(&control)));
        assert_eq!(made.field.distance().outside, DistanceQuality::Exact);
        let dense = cubics(&control, 2000);
        let places: Vec<[f64; 3]> = (0..60).map(|_| random.point_within(3.0)).collect();
        let found = values(&made, &places);
        for (p, value) in places.into_iter().zip(found) {
            let distance = dense.iter().map(|q| apart(*q, p)).fold(f64::INFINITY, f64::min);
            // Samples are less than 0.01 apart: off by the square of that over the distance.
            let room = tolerance + 1e-4 / (8.0 * distance);
            assert!((value - (distance - 0.25)).abs() <= room, "{value} {distance} {tolerance}");
        }
    }
}

#[test]
fn splines_pass_their_points() {
    let mut random = Random::new(3);
    for knots in ["centripetal", "chordal", "uniform"] {
        for closed in ["True", "False"] {
            let points: Vec<[f64; 3]> = (0..6).map(|_| random.point_within(2.0)).collect();
            let made = script(&format!("sweep(spline({}, {closed}, '{knots}'), 0.125)", shown(&points)));
            for value in values(&made, &points) {
                // On the path, within the tolerance: a 4096th of a diagonal of less than 16.
                assert!((value + 0.125).abs() < 16.0 / 4096.0, "{value}");
            }
        }
    }
    let text = "sweep(spline([[0, 0, 0], [1, 0, 0]], tangents=[[0, 3, 0], [0, -3, 0]], knots='uniform'), 0.125, 1e-6)";
    let top = values(&script(text), &[[0.5, 0.75, 0.0]])[0];
    assert!((top + 0.125).abs() < 1e-6, "{top}");
}

#[test]
fn fitted_paths_pass_noisy_points() {
    let mut random = Random::new(4);
    let points: Vec<[f64; 2]> = (0..400)
        .map(|k| {
            let angle = f64::from(k) * std::f64::consts::TAU / 400.0;
            let radius = 1.0 + 0.002 * random.signed();
            [radius * angle.cos(), radius * angle.sin()]
        })
        .collect();
    let made = script(&format!("polygon(fit({}, 0.01, closed=True, corners=90), 1e-4)", shown(&points)));
    assert!(made.said.iter().any(|line| line.starts_with("fit(): the path is within ")));
    for p in &points {
        assert!(values(&made, &[[p[0], p[1], 0.0]])[0].abs() < 0.0102);
    }
}

#[test]
fn a_nurbs_circle_is_one() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let text = format!(
        "polygon(nurbs([[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]], 2, \
         weights=[1, {half}, 1, {half}, 1, {half}, 1, {half}, 1], knots=[0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]), 1e-6)"
    );
    let made = script(&text);
    for k in 0..100 {
        let angle = f64::from(k) / 9.0;
        let value = values(&made, &[[2.0 * angle.cos(), 2.0 * angle.sin(), 0.0]])[0];
        assert!((value - 1.0).abs() < 1.1e-6, "{value}");
    }
}

#[test]
fn values_of_new_solids_are_bounds_of_the_distance() {
    let mut random = Random::new(5);
    for text in [
        "extrude(rectangle(2, 3), 2, bevel=0.4)",
        "extrude(polygon([[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]]), 1.5, bevel=0.3)",
        "extrude(circle(2) - rectangle(1, 1), 2, bevel=0.2)",
        "extrude(rectangle(2, 3), 2, rounded=0.4)",
        "extrude(polygon([[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]]), 1.5, rounded=0.3)",
        "extrude(circle(2) - rectangle(1, 1), 2, rounded=0.2)",
        "extrude(polygon(spline([[2, 0], [0, 2], [-2, 0], [0, -1]], closed=True)), 1, 0.25)",
        "sweep([[-3, 0, 0], [0, 0, 0], [0, 3, 0], [0, 3, 3]], rectangle(1, 0.5))",
        "sweep(spline([[-3, 0, 0], [0, 0, 1], [1, 3, 0]]), circle(0.5) - circle(0.25), tolerance=0.02)",
        "sweep(arc(2), polygon([[-0.5, -0.5], [0.5, -0.5], [0, 0.75]]))",
    ] {
        is_a_bound(text, 4.0, &mut random);
    }
}

#[test]
fn bevels_cut_what_they_say() {
    let made = script("extrude(rectangle(4, 2), 2, bevel=0.5)");
    let mut random = Random::new(6);
    let places: Vec<[f64; 3]> = (0..4000).map(|_| random.point_within(2.5)).collect();
    let found = values(&made, &places);
    for (p, value) in places.into_iter().zip(found) {
        let [x, y, z] = p.map(f64::abs);
        // Depths below the sides and the end.
        let (side, end) = (f64::min(2.0 - x, 1.0 - y), 1.0 - z);
        let is_solid = side > 0.0 && end > 0.0 && side + end > 0.5;
        assert_eq!(value < 0.0, is_solid, "{p:?}");
    }
}

/// The depth of a point below the sides of an outline, within it.
type Depth<'a> = &'a dyn Fn(f64, f64) -> f64;

#[test]
fn rounded_edges_are_quarters_of_circles() {
    let radius = 0.5;
    let mut random = Random::new(16);
    let rectangle = |x: f64, y: f64| f64::min(2.0 - x, 1.0 - y);
    let disc = |x: f64, y: f64| 1.5 - (x * x + y * y).sqrt();
    let depths: [(&str, Depth); 2] = [("rectangle(4, 2)", &rectangle), ("circle(1.5)", &disc)];
    for (outline, depth) in depths {
        let made = script(&format!("extrude({outline}, 2, rounded={radius})"));
        let places: Vec<[f64; 3]> = (0..8000).map(|_| random.point_within(2.5)).collect();
        let found = values(&made, &places);
        let mut n_rounded = 0;
        for (p, value) in places.into_iter().zip(found) {
            let [x, y, z] = p.map(f64::abs);
            let (side, end) = (depth(x, y), 1.0 - z);
            let is_corner = side > 0.0 && end > 0.0 && side < radius && end < radius;
            let off = ((radius - side) * (radius - side) + (radius - end) * (radius - end)).sqrt();
            let is_solid = side > 0.0 && end > 0.0 && (!is_corner || off < radius);
            assert_eq!(value < 0.0, is_solid, "{outline} {p:?}: {value}");
            n_rounded += usize::from(is_corner && !is_solid);
        }
        assert!(n_rounded > 20, "{n_rounded}");
    }
    // The volume of a tablet by Pappus' rule, against the part of a lattice that is inside.
    let (height, whole) = (1.0, 1.5);
    let inner = whole - radius / 2.0;
    let made = script(&format!("extrude(circle({whole}), {height}, rounded={})", radius / 2.0));
    let n = 60;
    let at = |k: i32, reach: f64| (f64::from(k) + 0.5) / f64::from(n) * 2.0 * reach - reach;
    let places: Vec<[f64; 3]> = (0..n * n * n)
        .map(|k| [at(k % n, whole), at(k / n % n, whole), at(k / n / n, height / 2.0)])
        .collect();
    let share = values(&made, &places).into_iter().filter(|value| *value < 0.0).count() as f64;
    let found = share / f64::from(n * n * n) * 4.0 * whole * whole * height;
    let (r, pi) = (radius / 2.0, std::f64::consts::PI);
    let ends = inner * inner * r + inner * r * r * pi / 2.0 + 2.0 / 3.0 * r * r * r;
    let truth = pi * (whole * whole * (height - 2.0 * r) + 2.0 * ends);
    // Measured: a lattice of this step is off by 1.1e-3, since so many of its points are in the disc.
    assert!((found / truth - 1.0).abs() < 2e-3, "{found}, not {truth}");
}

#[test]
fn a_swept_shape_is_itself_along_every_line() {
    let made = script("sweep([[0, 0, 0], [4, 0, 0], [4, 4, 0]], rectangle(1, 2))");
    let mut random = Random::new(7);
    let mut place = || [random.between(-1.0, 5.0), random.between(-1.0, 5.0), random.between(-1.5, 1.5)];
    let places: Vec<[f64; 3]> = (0..4000).map(|_| place()).collect();
    let found = values(&made, &places);
    for (p, value) in places.into_iter().zip(found) {
        let [x, y, z] = p;
        // Two beams that meet in a mitre: x − 4 and y are equal on it.
        let first = x > 0.0 && y.abs() < 0.5 && x - 4.0 <= -y;
        let second = y < 4.0 && (x - 4.0).abs() < 0.5 && x - 4.0 >= -y;
        let is_solid = (first || second) && z.abs() < 1.0;
        assert_eq!(value < 0.0, is_solid, "{p:?}");
    }
    // Along a circle it is the shape turned about the axis, within what the lines are off.
    let ring = script("sweep(arc(3), rectangle(1, 0.5), tolerance=1e-4)");
    let turned = script("revolve(move(rectangle(1, 0.5), 3, 0))");
    let places: Vec<[f64; 3]> = (0..2000).map(|_| random.point_within(4.0)).collect();
    let [found, true_ones] = [&ring, &turned].map(|shape| values(shape, &places));
    for ((p, a), b) in places.into_iter().zip(found).zip(true_ones) {
        assert!(b.abs() < 2e-4 || (a < 0.0) == (b < 0.0), "{p:?}: {a} {b}");
    }
}

#[test]
fn what_is_no_path_is_one_sentence() {
    for (text, part) in [
        ("spline([[0, 0], [1, 1]])", "must be a shape, but it is a path"),
        ("polygon(spline([[0, 0]]))", "spline() cannot make a path: the spline needs at least 2 points"),
        ("polygon(spline([[0, 0], [0, 0], [1, 1]]))", "point 0 and the next one are equal"),
        ("polygon(spline([[0, 0], [1]]))", "spline() needs 2 numbers for 'points', not 1"),
        ("polygon(spline([]))", "spline() needs points of 2 or 3 numbers for 'points', not an empty list"),
        ("polygon(spline([[0, 0], [1, 1]], knots='even'))", "'centripetal', 'chordal' or 'uniform' knots"),
        ("polygon(spline([[0, 0], [1, 1]], closed=1))", "True or False for 'closed', not a number"),
        ("polygon(spline([[0, 0], [1, 1], [2, 0]], tangents=[[1, 1]]))", "needs two tangents, not 1"),
        ("polygon(bezier([[0, 0], [1, 1], [2, 0]]))", "3n + 1 for a chain of n curves, not 3"),
        ("polygon(nurbs([[0, 0], [1, 1]], 0))", "nurbs() cannot make a path"),
        ("polygon(nurbs([[0, 0], [1, 1]], 1, weights=[1, -1]))", "nurbs() cannot make a path"),
        ("polygon(arc(-1))", "arc() needs a radius above 0, not -1"),
        ("polygon(arc(1, 0, 400))", "between -360 and 360"),
        ("polygon(bezier([[0, 0, 0], [1, 1, 0], [2, 0, 0], [3, 0, 0]]))", "a 2D path, not a 3D path"),
        ("polygon(arc(1), -1)", "polygon() cannot use this tolerance"),
        ("polygon([[0, 0], [1, 1], [2, 0]], 1)", "takes a tolerance only for paths"),
        (
            "polygon(bezier([[0, 0], [1, 0], [2, 0], [3, 0]]))",
            "polygon() refuses this input: no contour has three different corners",
        ),
        ("sweep([[0, 0, 0], [1, 0, 0]], 'a')", "a radius or a shape for 'profile', not a string"),
        ("sweep([[0, 0, 0], [1, 0, 0]], plane([1, 0, 0]))", "must be bounded on all sides"),
        ("sweep([[0, 0, 0]], circle(1))", "at least 2"),
        ("sweep([[0, 0, 0], [9, 0, 0], [0, 0, 0]], circle(1))", "turns back at its point 1"),
        ("sweep(arc(1), circle(1.5))", "bends too sharply at its piece 0"),
        (
            "sweep(spline([[2, 0, 0], [0, 2, 1], [-3, 0, 0.5], [0, -2, 3]], closed=True), circle(0.1))",
            "lies in no plane, and the shape comes back turned by",
        ),
        ("extrude(circle(1), 2, bevel=1)", "a bevel is 1, and must be less than half of the height, 1"),
        ("extrude(field(x * x + y * y - 1), 2, bevel=0.1)", "a bevel needs a distance"),
        ("extrude(circle(1), 2, rounded=1)", "a rounded edge's radius is 1, and must be less than half"),
        ("extrude(circle(1), 2, rounded=-1)", "a rounded edge's radius is -1"),
        ("extrude(field(x * x + y * y - 1), 2, rounded=0.1)", "a rounded edge's radius needs a distance"),
        ("extrude(circle(1), 2, 0.1, 0.1)", "extrude() takes a bevel or rounded edges, not both"),
        ("fit([[0, 0], [1, 1]], 0)", "fit() cannot use this tolerance"),
        ("-arc(1)", "'-' is not defined for a path"),
        ("arc(1) | arc(2)", "'|' is not defined for a path and a path"),
        ("sphere(True)", "sphere() needs a number for 'radius', not a boolean"),
        ("sphere(None)", "sphere() needs a number for 'radius', not None"),
    ] {
        let found = error(text);
        assert!(found.contains(part), "{text}: {found}");
    }
}
