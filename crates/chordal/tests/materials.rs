//! Materials of fields: which faces have which, and where their borders run. Closed forms judge, not the library's
//! own functions.
use chordal::budget::{Bounded, Evidence, RequiredEvidence};
use chordal::explicit::{Semantic, Topology};
use chordal::implicit::materials::SurfaceMaterial;
use chordal::implicit::shapes::{circle, cuboid, cylinder, rectangle, sphere};
use chordal::implicit::{Expr, Field, Repeat, Seam};
use chordal::math::Box3;
use chordal::{Budget, Job, Mesh, Tolerance, check, convert};
use chordal_testkit::{Random, some};
use std::collections::BTreeMap;

fn material(name: &str) -> SurfaceMaterial {
    SurfaceMaterial { name: name.to_owned(), color: [0.5, 0.25, 0.75, 1.0], metallic: 0.0, roughness: 0.5 }
}

fn of(field: &Field, name: &str) -> Field {
    field.with_material(material(name))
}

fn moved(field: &Field, x: f64, y: f64, z: f64) -> Field {
    field.moved([x, y, z]).unwrap()
}

fn meshed(field: &Field, tol: f64) -> Bounded<Mesh> {
    let budget = Budget::length(Tolerance::new(tol).unwrap());
    let made = convert::field_to_mesh(field, &budget, &Job::default()).unwrap();
    assert_eq!(*made.bound.evidence(), Evidence::Proved);
    assert!(made.bound.at_most().unwrap() <= tol);
    assert!(check::validity(&made.shape, Topology::Indices).closed);
    made
}

/// The names of the faces' materials; empty for none.
fn names(field: &Field, mesh: &Mesh) -> Vec<String> {
    let materials = field.materials();
    let numbers = mesh.attribute(&Semantic::Group("material".to_owned())).expect("one for each face");
    let name = |x: &f64| if *x == 0.0 { String::new() } else { materials[*x as usize - 1].name.clone() };
    numbers.values.iter().map(name).collect()
}

fn area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    let side = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let ([x, y, z], [u, v, w]) = (side(b), side(c));
    0.5 * ((y * w - z * v).powi(2) + (z * u - x * w).powi(2) + (x * v - y * u).powi(2)).sqrt()
}

fn areas(field: &Field, mesh: &Mesh) -> BTreeMap<String, f64> {
    let mut all = BTreeMap::new();
    for (face, name) in names(field, mesh).into_iter().enumerate() {
        *all.entry(name).or_insert(0.0) += area(mesh.corners(face));
    }
    all
}

/// The edges between two materials, by both names.
fn borders(field: &Field, mesh: &Mesh) -> Vec<([[f64; 3]; 2], [String; 2])> {
    let names = names(field, mesh);
    let mut sides: BTreeMap<(u32, u32), usize> = BTreeMap::new();
    for (number, face) in mesh.faces().iter().enumerate() {
        (0..3).for_each(|k| assert_eq!(sides.insert((face[k], face[(k + 1) % 3]), number), None));
    }
    let mut found = Vec::new();
    for (&(a, b), &face) in sides.iter().filter(|((a, b), _)| a < b) {
        let other = sides[&(b, a)];
        if names[face] != names[other] {
            let ends = [a, b].map(|v| mesh.positions()[v as usize]);
            found.push((ends, [names[face].clone(), names[other].clone()]));
        }
    }
    found
}

fn mid([a, b]: [[f64; 3]; 2]) -> [f64; 3] {
    [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]))
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn borders_of_balls_run_where_both_vanish() {
    let mut random = Random::new(20_261_126);
    for round in 0..4 {
        let tol = 0.02;
        let balls: Vec<([f64; 3], f64)> =
            (0..5).map(|_| ([0; 3].map(|_| random.between(-1.0, 1.0)), random.between(0.5, 1.1))).collect();
        let ball = |k: usize| {
            let ([x, y, z], radius) = balls[k];
            of(&moved(&sphere(radius).unwrap(), x, y, z), &k.to_string())
        };
        let all = Field::union_of(&[ball(0), ball(1), ball(2)]).difference(&ball(3));
        let made = meshed(&all, tol);
        let most = made.bound.at_most().unwrap();
        let off = |name: &str, p: [f64; 3]| {
            let (middle, radius) = balls[name.parse::<usize>().unwrap()];
            (distance(p, middle) - radius).abs()
        };
        for (face, name) in names(&all, &made.shape).iter().enumerate() {
            for corner in made.shape.corners(face) {
                let off = off(name, corner);
                assert!(off <= most, "round {round}: a face of ball {name} is {off} off it, bound {most}");
            }
        }
        let borders = borders(&all, &made.shape);
        assert!(!borders.is_empty(), "round {round}");
        for (ends, names) in borders {
            for p in [ends[0], ends[1], mid(ends)] {
                for name in &names {
                    let off = off(name, p);
                    assert!(off <= most, "round {round}: a border of {name} is {off} off, bound {most}");
                }
            }
        }
    }
}

#[test]
fn two_balls_have_the_areas_of_their_caps_and_one_circle_between_them() {
    let both = of(&sphere(1.0).unwrap(), "a").union(&of(&moved(&sphere(1.0).unwrap(), 1.0, 0.0, 0.0), "b"));
    let made = meshed(&both, 0.002);
    let areas = areas(&both, &made.shape);
    // Of a unit ball cut off at half its radius the cap of height 3/2 is left: 2πrh.
    for name in ["a", "b"] {
        assert!((areas[name] - 3.0 * std::f64::consts::PI).abs() < 0.05, "{areas:?}");
    }
    let borders = borders(&both, &made.shape);
    let length: f64 = borders.iter().map(|(ends, _)| distance(ends[0], ends[1])).sum();
    let circle = 3.0_f64.sqrt() * std::f64::consts::PI;
    assert!(length < 1.0001 * circle && length > 0.99 * circle, "{length} of {circle}");
}

#[test]
fn a_flush_inlay_ends_at_its_own_edge() {
    let plate = cuboid([40.0, 30.0, 4.0]).unwrap();
    let disc = moved(&cylinder(8.0, 2.0).unwrap(), 5.0, 3.0, 1.0);
    let square = moved(&cuboid([6.0, 4.0, 2.0]).unwrap(), -10.0, -4.0, 1.0);
    let tol = 0.01;
    let all = Field::union_of(&[of(&disc, "disc"), of(&square, "square"), of(&plate, "plate")]);
    let made = meshed(&all, tol);
    let areas = areas(&all, &made.shape);
    let round = 64.0 * std::f64::consts::PI;
    // The border is within the length of the circle, which is 16π long.
    assert!((areas["disc"] - round).abs() < tol * 16.0 * std::f64::consts::PI, "{areas:?}");
    assert!((areas["square"] - 24.0).abs() < 1e-9, "{areas:?}");
    let whole: f64 = areas.values().sum();
    assert!((whole - (2.0 * 1200.0 + 2.0 * 4.0 * 70.0)).abs() < 1e-6, "{areas:?}");
    for (ends, names) in borders(&all, &made.shape) {
        for [x, y, z] in [ends[0], ends[1], mid(ends)] {
            assert!((z - 2.0).abs() < 1e-9);
            let off = if names.contains(&"disc".to_owned()) {
                ((x - 5.0).hypot(y - 3.0) - 8.0).abs()
            } else {
                let [u, v] = [(x + 10.0).abs() - 3.0, (y + 4.0).abs() - 2.0];
                assert!(u < 1e-9 && v < 1e-9);
                u.abs().min(v.abs())
            };
            assert!(off <= tol, "a border of {names:?} at ({x}, {y}) is {off} off");
        }
    }
}

#[test]
fn halves_that_touch_flush_meet_in_the_plane_between() {
    let half = cuboid([10.0; 3]).unwrap();
    let all = of(&moved(&half, -5.0, 0.0, 0.0), "left").union(&of(&moved(&half, 5.0, 0.0, 0.0), "right"));
    let made = meshed(&all, 0.01);
    let areas = areas(&all, &made.shape);
    assert!((areas["left"] - 500.0).abs() < 1e-6 && (areas["right"] - 500.0).abs() < 1e-6, "{areas:?}");
    for (ends, _) in borders(&all, &made.shape) {
        assert!(ends[0][0].abs() < 1e-9 && ends[1][0].abs() < 1e-9, "{ends:?}");
    }
}

/// Whether a face is one of the wall of a hole of radius 3/8 around (`middle`, 0.1), and no sliver of the flat face along
/// its rim.
fn is_on_wall(corners: [[f64; 3]; 3], middle: f64) -> bool {
    let is_upright = corners.iter().any(|corner| (corner[2] - corners[0][2]).abs() > 1e-6);
    is_upright && corners.iter().all(|[x, y, _]| ((x - middle).hypot(y - 0.1) - 0.375).abs() < 0.01)
}

#[test]
fn a_cut_shows_the_tool_or_else_what_was_cut() {
    let body = of(&cuboid([4.0, 4.0, 2.0]).unwrap(), "left");
    let other = of(&moved(&cuboid([4.0, 4.0, 2.0]).unwrap(), 3.0, 0.0, 0.0), "right");
    let drill = cylinder(0.375, 4.0).unwrap();
    // Half the wall of the hole, which is 2 high.
    let half = 0.75 * std::f64::consts::PI;
    let wall = |field: &Field| {
        let made = meshed(field, 0.005);
        let mut areas: BTreeMap<String, f64> = BTreeMap::new();
        for (face, name) in names(field, &made.shape).into_iter().enumerate() {
            let corners = made.shape.corners(face);
            if is_on_wall(corners, 1.5) {
                *areas.entry(name).or_insert(0.0) += area(corners);
            }
        }
        areas
            .into_iter()
            .map(|(name, area)| (name, (area * 100.0 / (2.0 * half)).round()))
            .collect::<Vec<_>>()
    };
    let drill = moved(&drill, 1.5, 0.1, 0.0);
    let own = |name: &str, share: f64| vec![(name.to_owned(), share)];
    // In percent of the wall.
    assert_eq!(wall(&body.difference(&of(&drill, "drill"))), own("drill", 100.0));
    assert_eq!(wall(&body.difference(&drill)), own("left", 100.0));
    let plain = cuboid([4.0, 4.0, 2.0]).unwrap();
    assert_eq!(wall(&plain.difference(&of(&drill, "drill"))), own("drill", 100.0));
    let names_of = |field: &Field| areas(field, &meshed(field, 0.01).shape).into_keys().collect::<Vec<_>>();
    assert_eq!(names_of(&plain.difference(&of(&drill, "drill"))), ["", "drill"]);
    // Of two parts the first fills what both fill: it ends at x = 2, the hole in the middle of what is left.
    let both = body.union(&other);
    assert_eq!(wall(&both.difference(&drill)), own("left", 100.0));
    let across = moved(&drill, 0.5, 0.0, 0.0);
    let made = meshed(&both.difference(&across), 0.005);
    let mut halves = BTreeMap::new();
    for (face, name) in names(&both, &made.shape).into_iter().enumerate() {
        let corners = made.shape.corners(face);
        if is_on_wall(corners, 2.0) {
            *halves.entry(name).or_insert(0.0) += area(corners);
        }
    }
    assert!((halves["left"] - half).abs() < 0.02 && (halves["right"] - half).abs() < 0.02, "{halves:?}");
}

#[test]
fn the_outermost_material_counts() {
    let both = of(&sphere(1.0).unwrap(), "a").union(&of(&moved(&sphere(1.0).unwrap(), 1.0, 0.0, 0.0), "b"));
    let all = of(&both, "c");
    assert_eq!(all.materials(), [material("c")]);
    assert!(names(&all, &meshed(&all, 0.05).shape).iter().all(|name| name == "c"));
}

fn check_kept(fields: Vec<(&str, Field)>) {
    for (what, field) in some(fields, 4) {
        assert_eq!(field.materials(), [material("a"), material("b")], "{what}");
        // Proofs take the most of the time, and borders need none.
        let budget =
            Budget { require: RequiredEvidence::Measured, ..Budget::length(Tolerance::new(0.04).unwrap()) };
        let made = convert::field_to_mesh(&field, &budget, &Job::default());
        let made = made.or_else(|failure| failure.best_effort()).unwrap();
        let areas = areas(&field, &made.shape);
        assert_eq!(areas.keys().collect::<Vec<_>>(), ["a", "b"], "{what}: {areas:?}");
        let least = areas.values().fold(f64::INFINITY, |least, x| least.min(*x));
        assert!(least > 0.05, "{what}: {areas:?}");
    }
}

#[test]
fn operations_keep_materials() {
    let ring = |field: &Field| field.repeated([Repeat::Times(3, 3.0), Repeat::Once, Repeat::Once]).unwrap();
    let ball = of(&sphere(1.0).unwrap(), "a");
    let block = of(&cuboid([1.0, 2.0, 0.5]).unwrap(), "a");
    let slab = Box3 { min: [-9.0, -9.0, -0.2], max: [9.0, 9.0, 0.2] };
    let b = |field: &Field| field.union(&of(&moved(&sphere(0.5).unwrap(), 0.0, 1.2, 0.0), "b"));
    check_kept(vec![
        ("repeated", ring(&b(&ball))),
        ("rotated", b(&block).rotated_deg([1.0, 2.0, 3.0], 40.0).unwrap()),
        ("scaled", b(&block).scaled([2.0, 1.0, 0.5]).unwrap()),
        ("mirrored", b(&block).mirrored([1.0, 1.0, 0.0]).unwrap()),
        ("offset", b(&block).offset(0.1).unwrap()),
        ("shell", b(&block).shell(0.1).unwrap()),
        ("twisted", b(&block).twisted(0.5).unwrap()),
        ("clipped", b(&block).clipped(slab)),
    ]);
}

#[test]
fn operations_on_planes_and_blends_keep_materials() {
    let ball = of(&sphere(1.0).unwrap(), "a");
    let block = of(&cuboid([1.0, 2.0, 0.5]).unwrap(), "a");
    let flat = of(&rectangle([1.0, 2.0]).unwrap(), "a")
        .union(&of(&moved(&circle(1.0).unwrap(), 1.0, 0.0, 0.0), "b"));
    let b = |field: &Field| field.union(&of(&moved(&sphere(0.5).unwrap(), 0.0, 1.2, 0.0), "b"));
    check_kept(vec![
        ("extruded", flat.extruded(1.0).unwrap()),
        ("revolved", moved(&flat, 0.5, 0.0, 0.0).revolved()),
        ("tapered", flat.tapered(0.5, 1.0).unwrap()),
        ("section", b(&block).section(0.0).unwrap().extruded(1.0).unwrap()),
        ("displaced", b(&ball).displaced(&((Expr::axes()[0].clone() * 3.0).sin() * 0.05), 0.05).unwrap()),
        (
            "fillet",
            block
                .union_with(&of(&moved(&cylinder(0.2, 2.0).unwrap(), 0.0, 0.0, 1.0), "b"), Seam::Fillet(0.1))
                .unwrap(),
        ),
        ("smooth", ball.smooth_union(&of(&moved(&sphere(0.5).unwrap(), 0.0, 1.2, 0.0), "b"), 0.3).unwrap()),
        ("cut", ball.smooth_difference(&of(&moved(&sphere(0.5).unwrap(), 0.0, 1.2, 0.0), "b"), 0.3).unwrap()),
    ]);
}

#[test]
fn one_material_changes_no_triangle_and_no_value() {
    let block = cuboid([2.0, 3.0, 1.0]).unwrap().difference(&cylinder(0.4, 2.0).unwrap());
    let turned = |field: &Field| field.rotated_deg([1.0, 2.0, 3.0], 40.0).unwrap().offset(0.05).unwrap();
    let (plain, painted) = (turned(&block), turned(&of(&block, "a")));
    let length = if chordal_testkit::is_long() { 0.03 } else { 0.1 };
    let (bare, own) = (meshed(&plain, length), meshed(&painted, length));
    assert_eq!(bare.shape.attributes(), []);
    assert_eq!((bare.shape.positions(), bare.shape.faces()), (own.shape.positions(), own.shape.faces()));
    assert_eq!(bare.bound, own.bound);
    let mut random = Random::new(7);
    for _ in 0..200 {
        let p = [0; 3].map(|_| random.between(-3.0, 3.0));
        let [a, b] = [&plain, &painted].map(|field| field.expr().at(p).unwrap().to_bits());
        assert_eq!(a, b);
    }
}

#[test]
fn threads_change_nothing() {
    let plate = of(&cuboid([4.0, 3.0, 0.5]).unwrap(), "a");
    let all = of(&moved(&cylinder(0.8, 0.5).unwrap(), 0.3, 0.2, 0.0), "b").union(&plate);
    let budget = Budget::length(Tolerance::new(0.01).unwrap());
    let on = |threads: usize| {
        convert::field_to_mesh(&all, &budget, &Job::default().with_threads(threads)).unwrap().shape
    };
    assert_eq!(on(1), on(4));
}
