//! Rays and fields: hits against closed forms and dense marching, fields that lie, nearest places, and
//! pictures.
use chordal::Job;
use chordal::implicit::evaluation::{Binary, Tape, Unary};
use chordal::implicit::query::{
    Beam, BeamCounts, BeamRecord, FieldOctree, FieldTracer, closest_points, contains, normals,
};
use chordal::implicit::{Distance, Expr, Field};
use chordal::math::Box3;
use chordal::render::fields::render_field;
use chordal::render::{Background, RenderOptions, RenderStyle};
use chordal_testkit::Fingerprint;
use chordal_testkit::Random;

fn cube(half: f64) -> Box3 {
    Box3 { min: [-half; 3], max: [half; 3] }
}

fn ball() -> Expr {
    let [x, y, z] = Expr::axes();
    (x.square() + y.square() + z.square()).sqrt() - 1.0
}

/// Beams from a sphere of radius 3 to places in a box of half that side.
fn beams(n: usize, aim: f64) -> Vec<Beam> {
    let mut random = Random::new(11);
    (0..n)
        .map(|_| {
            let from: [f64; 3] = random.point();
            let length = from.iter().map(|x| x * x).sum::<f64>().sqrt();
            let origin = from.map(|x| 3.0 * x / length);
            let to: [f64; 3] = random.point_within(aim);
            let direction = [0, 1, 2].map(|k| to[k] - origin[k]);
            Beam { origin, direction, from: 0.0, to: f64::INFINITY, cone: [1e-4, 0.0] } // measured: 1/60000 of the scene
        })
        .collect()
}

fn meet(field: &Field, beams: &[Beam]) -> Vec<BeamRecord> {
    let cells = FieldOctree::build(field, &Job::default()).expect("a finite box");
    FieldTracer::new(&cells).intersect(beams).expect("no leaf fails")
}

fn at(beam: &Beam, t: f64) -> [f64; 3] {
    [0, 1, 2].map(|k| beam.origin[k] + t * beam.direction[k])
}

/// The first place along a beam that is inside, by small steps and halving.
fn march(tape: &Tape, beam: &Beam, steps: u32) -> Option<f64> {
    let ts: Vec<f64> = (0..=steps).map(|i| 3.0 * f64::from(i) / f64::from(steps)).collect();
    let points: Vec<[f64; 3]> = ts.iter().map(|t| at(beam, *t)).collect();
    let inside = contains(tape, &points).unwrap();
    let first = inside.iter().position(|inside| *inside)?;
    let (mut low, mut high) = (ts[first.max(1) - 1], ts[first]);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if contains(tape, &[at(beam, middle)]).unwrap()[0] { high = middle } else { low = middle }
    }
    Some(high)
}

#[test]
fn hits_a_ball_where_it_is() {
    let field = Field::new(ball()).with_distance(Distance::EXACT).with_bounds(cube(1.0));
    let beams = beams(5000, 1.0);
    let mut hits = 0;
    for (beam, record) in beams.iter().zip(meet(&field, &beams)) {
        let (o, d) = (beam.origin, beam.direction);
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (a, b, c) = (dot(d, d), dot(o, d), dot(o, o) - 1.0);
        let root = b * b - a * c;
        if root.abs() < 1e-3 * a {
            // measured: so close to the outline anything may be right
            continue;
        }
        match record.hit {
            Some(met) => {
                let truth = (-b - root.sqrt()) / a;
                assert!(met.entering && (met.t - truth).abs() < 1e-9, "{} {truth}", met.t); // measured: 1e-12
                hits += 1;
            }
            None => assert!(root < 0.0),
        }
        assert!(!record.uncertain && !record.capped);
    }
    assert!(hits > 1000, "{hits}");
}

#[test]
fn hits_a_torus_and_a_box_where_marching_does() {
    let [x, y, z] = Expr::axes();
    let ring = (x.square() + y.square()).sqrt() - 0.7;
    let torus = Field::new((ring.square() + z.square()).sqrt() - 0.25).with_distance(Distance::EXACT);
    let slab = |e: &Expr, h: f64| e.abs() - h;
    let block = slab(&x, 0.5).max(&slab(&y, 0.8)).max(&slab(&z, 0.3));
    let block = Field::new(block).with_distance(Distance::BOUND);
    // Its gradient is up to 40 long: with steps of the value most of it would be overlooked.
    let quartic = x.square().square() + y.square().square() + z.square().square()
        - (x.square() + y.square() + z.square()) * 1.1
        + 0.3;
    let steep = Field::new(quartic * 9.0);
    for field in [torus, block, steep] {
        let field = field.with_bounds(cube(1.25));
        let beams = beams(400, 1.0);
        for (beam, record) in beams.iter().zip(meet(&field, &beams)) {
            let truth = march(&field.tape(), beam, 6000);
            match (record.hit, truth) {
                (Some(met), Some(truth)) => {
                    // Marching may miss a sliver that the tracer sees, never the other way round.
                    assert!(met.t < truth + 1e-9, "{} {truth} {field:?}", met.t); // measured: 1e-12
                    let values = contains(&field.tape(), &[at(beam, met.t + 1e-9)]).unwrap(); // derived: the bracket
                    assert!(values[0] || (met.t - truth).abs() < 1e-9); // measured: 1e-12
                }
                (None, Some(truth)) => panic!("overlooked at {truth}: {field:?} {beam:?}"),
                (_, None) => {}
            }
        }
    }
}

#[test]
fn thin_shells_of_fields_that_are_signs_are_not_overstepped() {
    let [x, y, z] = Expr::axes();
    let r = x.square() + y.square() + z.square();
    // A shell a thousandth thick, as a product whose value says nothing of distances.
    let shell = (r.clone() - 0.64) * (r - 0.641) * 1000.0;
    let field = Field::new(shell).with_bounds(cube(0.9));
    // The corners of the box that is aimed at are √3 · 0.46 < 0.8 from the middle: inside the shell.
    let beams = beams(3000, 0.46);
    for record in meet(&field, &beams) {
        let met = record.hit.expect("every beam meets the shell");
        let radius = met.point.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((radius - 0.641_f64.sqrt()).abs() < 1e-9, "{radius}"); // measured: 1e-12
    }
}

#[test]
fn beams_from_inside_look_for_the_way_out() {
    let field = Field::new(ball()).with_bounds(cube(1.0));
    let beam = |from: f64| Beam {
        origin: [from, 0.0, 0.0],
        direction: [2.0, 0.0, 0.0],
        from: 0.0,
        to: 9.0,
        cone: [1e-3, 0.0],
    }; // measured: a pixel
    let records = meet(&field, &[beam(0.0), beam(0.9), beam(1.5), beam(-3.0)]);
    let found: Vec<Option<(bool, bool)>> = records
        .iter()
        .zip([0.5, 0.05, 0.0, 1.0])
        .map(|(record, t)| record.hit.map(|met| (met.entering, (met.t - t).abs() < 1e-9))) // measured: 1e-12
        .collect();
    assert_eq!(found, [Some((false, true)), Some((false, true)), None, Some((true, true))]);
}

/// HOSTILE row 67: nothing is overlooked and nothing hangs; what no slope clears is counted.
#[test]
fn h67_fields_that_lie() {
    let [x, y, z] = Expr::axes();
    let sigmoid =
        Expr::constant(0.5) - Expr::constant(1.0) / (Expr::unary(Unary::Exp, &(ball() * 30.0)) + 1.0);
    // NaN where x is negative: outside by agreement.
    let nan = ball() + x.sqrt() * 0.0;
    let jump = Expr::unary(Unary::Floor, &(ball() * 4.0)) + 0.5;
    let compare = Expr::binary(Binary::Compare, &ball(), &Expr::constant(0.0));
    let tiny = ball() * 1e-300; // exact: a scale at the end of the numbers
    let steep = (x.square() + y.square() + z.square() - 1.0) * 1e6;
    for (name, expr) in [
        ("sigmoid", sigmoid),
        ("nan", nan),
        ("jump", jump),
        ("compare", compare),
        ("tiny", tiny),
        ("steep", steep),
    ] {
        let field = Field::new(expr).with_bounds(cube(1.0));
        let beams = beams(300, 1.0);
        let records = meet(&field, &beams);
        let counts = records.iter().fold(BeamCounts::default(), BeamCounts::add_record);
        assert!(counts.hits > 60 && counts.capped < 30, "{name}: {counts:?}");
        for (beam, record) in beams.iter().zip(&records) {
            let truth = march(&field.tape(), beam, 3000);
            let overlooked = truth.is_some() && record.hit.is_none();
            assert!(!overlooked || record.uncertain || record.capped, "{name}: {beam:?}");
            if let Some(met) = record.hit {
                assert!(met.point.iter().all(|x| x.is_finite()), "{name}");
            }
        }
    }
    let constant = Field::new(Expr::constant(f64::NAN)).with_bounds(cube(1.0));
    assert!(meet(&constant, &beams(50, 1.0)).iter().all(|record| record.hit.is_none()));
    assert!(FieldOctree::build(&Field::new(ball()), &Job::default()).is_err());
}

#[test]
fn sides_and_normals_of_odd_places() {
    let tape = Tape::new(&ball());
    let odd = [[1.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0], [0.5, 0.0, 0.0], [f64::INFINITY, 0.0, 0.0]];
    assert_eq!(contains(&tape, &odd).unwrap(), [false, false, true, false]);
    let found = normals(&tape, &[[0.0, -2.0, 0.0], [0.0; 3], [f64::NAN; 3]]).unwrap();
    assert_eq!(found, [Some([0.0, -1.0, 0.0]), None, None]);
}

#[test]
fn nearest_places_are_enclosed() {
    let field = Field::new(ball()).with_distance(Distance::EXACT).with_bounds(cube(1.0));
    let cells = FieldOctree::build(&field, &Job::default()).unwrap();
    let mut random = Random::new(5);
    let points: Vec<[f64; 3]> = (0..40).map(|_| random.point_within(2.0)).collect();
    let found = closest_points(&cells, &points, 5e-3, &Job::default()).unwrap(); // measured: 1e-3 needs more parts than a search has
    for (p, found) in points.iter().zip(found) {
        let found = found.expect("there is a surface");
        let truth = (p.iter().map(|x| x * x).sum::<f64>().sqrt() - 1.0).abs();
        assert!(found.at_least <= truth && truth <= found.at_most, "{found:?} {truth}");
        assert!(found.at_most - found.at_least <= 5e-3 * found.at_most, "{found:?} {truth}"); // derived: what was asked
    }
    // A block, whose value is not the distance beyond its edges.
    let [x, y, z] = Expr::axes();
    let halves = [0.5, 0.75, 0.25];
    let block = (x.abs() - halves[0]).max(&(y.abs() - halves[1])).max(&(z.abs() - halves[2]));
    let cells = FieldOctree::build(&Field::new(block).with_bounds(cube(0.75)), &Job::default()).unwrap();
    let found = closest_points(&cells, &points, 5e-3, &Job::default()).unwrap(); // measured: as above
    for (p, found) in points.iter().zip(found) {
        let found = found.expect("there is a surface");
        let beyond = [0, 1, 2].map(|k| p[k].abs() - halves[k]);
        let inside = beyond.iter().fold(f64::NEG_INFINITY, |a, b| a.max(*b));
        let outside = beyond.iter().map(|x| x.max(0.0).powi(2)).sum::<f64>().sqrt();
        let truth = if inside < 0.0 { -inside } else { outside };
        assert!(found.at_least <= truth * (1.0 + 1e-15), "{p:?} {found:?} {truth}"); // rounding of the truth
        assert!(truth <= found.at_most * (1.0 + 1e-15), "{p:?} {found:?} {truth}"); // rounding of the truth
        assert!(found.at_most - found.at_least <= 0.05 * found.at_most, "{p:?} {found:?} {truth}");
    }
}

#[test]
fn pictures_are_the_same_on_any_number_of_threads() {
    let [x, y, z] = Expr::axes();
    let hole = (x.square() + y.square()).sqrt() - 0.4;
    let drilled = ball().max(&-hole);
    let in_space = Field::new(drilled).with_bounds(cube(1.0));
    let in_plane =
        Field::new((x.square() + y.square() - 0.5).max(&-(x.clone() * y + 0.1))).with_bounds(cube(1.0));
    let _ = z;
    for field in [in_space, in_plane] {
        for show in [RenderStyle::Shaded, RenderStyle::Normals] {
            let options = RenderOptions { show, ..RenderOptions::sized(60, 44) };
            let on = |n| render_field(&field, &options, &Job::default().with_threads(n)).unwrap();
            let (one, three) = (on(1), on(3));
            assert_eq!(Fingerprint::of(&one.picture.rgba), Fingerprint::of(&three.picture.rgba));
            assert_eq!(one.counts, three.counts);
            assert!(one.counts.hits > 300 && one.counts.certified_share() > 0.99, "{:?}", one.counts);
        }
    }
}

#[test]
fn pictures_show_the_shape_and_refuse_what_they_cannot() {
    let field = Field::new(ball()).with_distance(Distance::EXACT).with_bounds(cube(1.0));
    let options = RenderOptions { background: Background::Transparent, ..RenderOptions::sized(80, 60) };
    let drawn = render_field(&field, &options, &Job::default()).unwrap();
    let solid = drawn.picture.rgba.chunks_exact(4).filter(|p| p[3] == 255).count();
    // Measured: a disc that fills 80 % of 60 pixels' height, less its border.
    let disc = std::f64::consts::PI * (0.4_f64 * 60.0).powi(2);
    assert!((solid as f64) < disc && solid as f64 > 0.85 * disc, "{solid} {disc}");
    let wire = RenderOptions { show: RenderStyle::Wire, ..options };
    assert!(render_field(&field, &wire, &Job::default()).unwrap_err().to_string().contains("wire"));
    let endless = render_field(&Field::new(ball()), &options, &Job::default()).unwrap_err();
    assert!(endless.to_string().contains("region"), "{endless}");
    let [x, y, _] = Expr::axes();
    let half = Field::new(x + y * 0.0).with_bounds(cube(1.0));
    let drawn = render_field(&half, &RenderOptions::sized(40, 40), &Job::default()).unwrap();
    assert!(drawn.picture.pixel(3, 20)[0] < 60 && drawn.picture.pixel(36, 20)[0] > 200);
}
