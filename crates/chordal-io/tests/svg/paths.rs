//! Path data: every command against pieces that were worked out by hand.
use super::{arc, count, cubic, line, load, near, path, pieces, svg};
use chordal::convert::{Spacing, curves_to_polylines};
use chordal::explicit::CurveSegment;
use chordal::{Budget, Failure, Job, Tolerance};
use chordal_testkit::Random;

#[test]
fn lines_in_all_their_spellings() {
    let triangle = [line([1.0, 2.0], [4.0, 2.0]), line([4.0, 2.0], [4.0, 6.0]), line([4.0, 6.0], [1.0, 2.0])];
    for d in [
        "M1 2L4 2L4 6Z",
        "m1,2l3,0l0,4z",
        "M 1 2 H 4 V 6 Z",
        "M1 2h3v4z",
        "M1 2 4 2 4 6z",
        "m1 2 3 0 0 4 Z",
        "\n M\t1\r\n2,4,2 , 4 6 \x0c z ",
        "M1e0+2.0L40e-1 .2e1L4 6z",
    ] {
        let all = path(d);
        assert_eq!(all.len(), 1, "{d}");
        assert_eq!((all[0].segments(), all[0].is_closed()), (&triangle[..], true), "{d}");
        assert_eq!(all[0].slack(), 0.0, "nothing is rounded in {d}");
    }
}

#[test]
fn compact_numbers_are_told_apart() {
    assert_eq!(pieces("M1.5.5-3e2-4"), [line([1.5, 0.5], [-300.0, -4.0])]);
    assert_eq!(pieces("M0 0l.5.5.5-.5"), [line([0.0, 0.0], [0.5, 0.5]), line([0.5, 0.5], [1.0, 0.0])]);
    assert_eq!(
        pieces("M0 0h1-2+3"),
        [line([0.0, 0.0], [1.0, 0.0]), line([1.0, 0.0], [-1.0, 0.0]), line([-1.0, 0.0], [2.0, 0.0])]
    );
}

#[test]
fn cubics_and_smooth_cubics() {
    let first = cubic([[0.0, 0.0], [0.0, 1.0], [1.0, 2.0], [2.0, 2.0]]);
    let second = cubic([[2.0, 2.0], [3.0, 2.0], [4.0, 1.0], [4.0, 0.0]]);
    for d in ["M0 0C0 1 1 2 2 2S4 1 4 0", "m0 0c0 1 1 2 2 2s2-1 2-2", "M0 0C0 1 1 2 2 2 3 2 4 1 4 0"] {
        assert_eq!(pieces(d), [first.clone(), second.clone()], "{d}");
    }
    // After anything but a cubic the first control point is where the pen is.
    let lone = cubic([[1.0, 1.0], [1.0, 1.0], [2.0, 2.0], [3.0, 1.0]]);
    assert_eq!(pieces("M1 1S2 2 3 1"), std::slice::from_ref(&lone));
    assert_eq!(pieces("M0 0L1 1S2 2 3 1")[1], lone);
    assert_eq!(pieces("M0 0Q0 1 1 1S2 2 3 1")[1], lone);
}

#[test]
fn quadratics_and_smooth_quadratics() {
    let quadratic = CurveSegment::quadratic;
    let first = quadratic([[0.0, 0.0], [1.0, 2.0], [2.0, 0.0]]);
    let second = quadratic([[2.0, 0.0], [3.0, -2.0], [4.0, 0.0]]);
    let third = quadratic([[4.0, 0.0], [5.0, 2.0], [6.0, 0.0]]);
    for d in ["M0 0Q1 2 2 0T4 0T6 0", "m0 0q1 2 2 0t2 0 2 0", "M0 0Q1 2 2 0 3-2 4 0T6 0"] {
        assert_eq!(pieces(d), [first.clone(), second.clone(), third.clone()], "{d}");
    }
    assert_eq!(pieces("M0 0L2 0T4 0")[1], quadratic([[2.0, 0.0], [2.0, 0.0], [4.0, 0.0]]));
    // A cubic that stands for a quadratic is rounded, and says so.
    let curve = &path("M0 0Q1 2 2 0")[0];
    assert!(curve.slack() > 0.0 && curve.slack() < 1e-14);
}

#[test]
fn arcs_are_arcs_of_the_ellipse_that_the_file_names() {
    // Three quarters of a circle about (10, 10), clockwise on the screen: angles grow.
    let all = pieces("M15 10A5 5 0 1 1 10 5");
    let round = arc(&all[0]);
    near(round.centre(), [10.0, 10.0]);
    near(round.axes()[0], [5.0, 0.0]);
    assert!((round.sweep_rad() - 1.5 * std::f64::consts::PI).abs() < 1e-14);
    assert_eq!(round.ends(), [[15.0, 10.0], [10.0, 5.0]]);
    // The small one the other way round, relative, with flags that need no spaces.
    let all = pieces("m15 10a5 5 0 00-5-5");
    near(arc(&all[0]).centre(), [10.0, 10.0]);
    assert!((arc(&all[0]).sweep_rad() + 0.5 * std::f64::consts::PI).abs() < 1e-14);
    // Every point of a turned ellipse satisfies its equation.
    let all = pieces("M 3 1 A 4 2 30 0 1 5 4");
    let turned = arc(&all[0]);
    let (sin, cos) = (0.5, 0.75_f64.sqrt());
    for i in 0..=16 {
        let p = turned.at(f64::from(i) / 16.0);
        let d = [p[0] - turned.centre()[0], p[1] - turned.centre()[1]];
        let (u, v) = ((d[0] * cos + d[1] * sin) / 4.0, (d[1] * cos - d[0] * sin) / 2.0);
        assert!((u * u + v * v - 1.0).abs() < 1e-12, "{i}");
    }
}

#[test]
fn arcs_that_are_none() {
    // To where the pen is: nothing. A radius of 0: a line. Radii that are too short: they grow. Negative:
    // their size.
    assert_eq!(pieces("M0 0A5 5 0 0 1 0 0L1 1"), [line([0.0, 0.0], [1.0, 1.0])]);
    assert_eq!(pieces("M0 0A0 5 0 0 1 4 4"), [line([0.0, 0.0], [4.0, 4.0])]);
    let all = pieces("M0 0A1 1 0 0 1 10 0");
    near(arc(&all[0]).centre(), [5.0, 0.0]);
    near(arc(&all[0]).axes()[0], [5.0, 0.0]);
    let all = pieces("M0 0A-5-5 0 0 1 10 0");
    near(arc(&all[0]).axes()[0], [5.0, 0.0]);
}

#[test]
fn a_quarter_turn_of_an_ellipse_swaps_its_axes_exactly() {
    let all = pieces("M0 0A4 2 90 0 1 4 0 2 4-450 0 1 8 0");
    assert_eq!(arc(&all[0]).axes(), [[2.0, 0.0], [0.0, 4.0]]);
    assert_eq!(arc(&all[1]).axes(), [[4.0, 0.0], [0.0, 2.0]]);
    assert_eq!(arc(&pieces("M0 0A4 3 180 0 1 8 0")[0]).axes(), [[4.0, 0.0], [0.0, 3.0]]);
}

#[test]
fn subpaths_follow_moves_and_closings() {
    let all = path("M0 0h1v1zM5 5h1m2 2h1v1");
    let starts: Vec<_> = all.iter().map(|curve| (curve.start(), curve.end(), curve.is_closed())).collect();
    assert_eq!(
        starts,
        [([0.0, 0.0], [0.0, 0.0], true), ([5.0, 5.0], [6.0, 5.0], false), ([8.0, 7.0], [9.0, 8.0], false)]
    );
    // What follows a closing starts where the subpath did; a move relative to it as well.
    let all = path("M1 1h2v2zl-1-1m4 5h1v1zm1 1h1");
    assert_eq!(all[1].segments(), [line([1.0, 1.0], [0.0, 0.0])]);
    assert_eq!((all[2].start(), all[3].start()), ([4.0, 5.0], [5.0, 6.0]));
    // Closing where it already is adds nothing, and closing a point leaves that point.
    assert_eq!(path("M0 0L1 0L0 0Z")[0].segments().len(), 2);
    let point = &path("M3 4z")[0];
    assert_eq!((point.start(), point.segments().len()), ([3.0, 4.0], 0));
}

#[test]
fn moves_that_draw_nothing_are_counted() {
    let (drawing, warnings) = load(&svg("<path d='M0 0M1 1L2 2M3 3'/>"));
    assert_eq!((drawing.lines.len(), count(&warnings, "lone-point")), (1, 2));
}

#[test]
fn a_path_is_drawn_up_to_the_error_and_the_error_has_a_place() {
    for (d, drawn, at, part) in [
        ("M0 0L1 1L2", 1, 10, "the end"),
        ("M0 0L1 1X2 2", 1, 8, "'X2'"),
        ("M0 0L1 1L2,,2", 1, 11, "','"),
        ("M0 0L1 1,", 1, 9, "the end"),
        ("M0 0A1 1 0 2 1 3 3", 0, 11, "a flag"),
        ("L1 1", 0, 0, "a move"),
        ("M0 0L1 1 2 2 3", 2, 14, "the end"),
        ("M0 0 L 1 1 - 2", 1, 11, "'-'"),
    ] {
        let text = svg(&format!("\n<path id='a' d='{d}'/>"));
        let (drawing, warnings) = load(&text);
        let n: usize = drawing.lines.iter().map(|curve| curve.segments().len()).sum();
        assert_eq!(n, drawn, "{d}: {warnings:?}");
        let warning = warnings.iter().find(|w| w.code == "path-error").unwrap_or_else(|| panic!("{d}"));
        assert_eq!(warning.place.to_string(), format!("line 2, column {}", 17 + at), "{d}");
        assert!(warning.message.contains(part), "{d}: {}", warning.message);
    }
}

#[test]
fn relative_sums_that_are_rounded_are_in_the_slack() {
    let steps = "l.1.1".repeat(1000);
    let curve = &path(&format!("M0 0{steps}"))[0];
    let exact = 100.0; // 1000 times 0.1, which is a little more than a tenth, by 5.6e-18 each
    let off = (curve.end()[0] - exact).abs();
    assert!(off > 0.0 && off <= curve.slack() && curve.slack() < 1e-9, "{off} {}", curve.slack());
    assert_eq!(path("M0 0l.5.25-.125 8")[0].slack(), 0.0);
}

/// A circle as most drawings write it: two half turns by relative steps that are not binary fractions.
#[test]
fn half_circles_by_rounded_steps_keep_their_centre() {
    let circle = &path("M12.3 4.7l.1.1a1.1 1.1 0 0 1 2.2 0a1.1 1.1 0 0 1-2.2 0")[0];
    let true_centre = [13.5, 4.8];
    for piece in &circle.segments()[1..] {
        let chordal::explicit::CurveSegment::Arc(arc) = piece else { panic!("two arcs") };
        let off = (arc.centre()[0] - true_centre[0]).hypot(arc.centre()[1] - true_centre[1]);
        assert!(off <= circle.slack() + arc.slack() && off < 1e-14, "{off}");
    }
    assert!(circle.slack() < 1e-13, "{}", circle.slack());
    // An absolute end after a relative start: the way between them is rounded, and the centre feels its root.
    let half = &path("M12.3 4.7l.1.1A1.1 1.1 0 0 1 14.6 4.8")[0];
    let chordal::explicit::CurveSegment::Arc(arc) = &half.segments()[1] else { panic!("one arc") };
    let off = (arc.centre()[0] - 13.5).hypot(arc.centre()[1] - 4.8);
    assert!(off <= half.slack() + arc.slack(), "{off} {}", half.slack());
    assert!(half.slack() > 1e-9 && half.slack() < 1e-6, "{}", half.slack());
}

#[test]
fn a_mirrored_control_point_is_off_by_twice_as_much_as_the_pen() {
    let plain = path("M.1.1l.2.2")[0].slack();
    let smooth = path("M.1.1l.2.2t.1.1t.1.1")[0].slack();
    assert!(plain > 0.0 && smooth >= 3.0 * plain, "{plain} {smooth}");
}

/// Arcs of sizes from 0.1 to 100: of flat and turned ellipses, of radii too short, and of radii of up to a million times
/// their chords.
#[test]
fn a_drawing_of_arcs_of_all_sizes_keeps_small_budgets() {
    let mut random = Random::new(150);
    let mut drawing = String::new();
    for i in 0..150 {
        let size = random.power(-1.0, 2.0);
        let step = random.direction::<2>().map(|x| x * size);
        let (radii, large) = if i % 2 == 0 {
            ([0; 2].map(|_| random.power(-1.0, 2.0)), random.below(2))
        } else {
            let radius = size * random.power(0.0, 6.0);
            ([radius, radius * random.power(-0.3, 0.3)], 0)
        };
        let from: [f64; 2] = random.point_within(200.0);
        let (deg, sweep) = (random.between(0.0, 180.0), random.below(2));
        // By relative steps and by absolute ends after them, which are rounded.
        let arc = format!("{:.4} {:.4} {deg:.2} {large} {sweep}", radii[0], radii[1]);
        let [x, y] = [0, 1].map(|k| from[k] + step[k] + 0.1);
        let end = if i % 3 == 0 {
            format!("A{arc} {x:.4} {y:.4}")
        } else {
            format!("a{arc} {:.4} {:.4}", step[0], step[1])
        };
        drawing += &format!("M{:.4} {:.4}l.1.1{end}", from[0], from[1]);
    }
    let curves = path(&drawing);
    assert_eq!(curves.len(), 150);
    for length in [1e-4, 1e-7] {
        let budget = Budget::length(Tolerance::new(length).unwrap());
        let made = curves_to_polylines(&curves, &budget, &Job::default(), Spacing::Fewest).unwrap();
        assert!(made.bound.at_most().unwrap() <= length);
    }
}

#[test]
fn a_budget_below_what_is_known_of_an_arc_is_refused_with_its_place() {
    // Half of a turned ellipse: the end of the long axis, to all digits.
    let half = path("M0 0A20 10 17 0 1 38.252190238521415 11.69486818890947");
    let budget = Budget::length(Tolerance::new(1e-9).unwrap());
    let Err(Failure::Refused(why)) = curves_to_polylines(&half, &budget, &Job::default(), Spacing::Fewest)
    else {
        panic!("an arc that nobody knows to a billionth")
    };
    assert_eq!(why.code.as_str(), "below-precision");
    assert!(why.message.contains("path 0") && !why.message.contains("origin"), "{}", &*why.message);
}
