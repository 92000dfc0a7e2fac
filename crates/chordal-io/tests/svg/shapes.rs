//! Basic shapes: the paths that the specification says they are.
use super::{arc, count, inside, line, load, near, svg};
use chordal::explicit::CurveSegment;
use std::f64::consts::PI;

#[test]
fn a_rect_runs_clockwise_on_the_screen_from_its_first_corner() {
    let drawing = inside("<rect x='1' y='2' width='3' height='4'/>");
    let curve = &drawing.lines[0];
    assert_eq!(
        curve.segments(),
        [
            line([1.0, 2.0], [4.0, 2.0]),
            line([4.0, 2.0], [4.0, 6.0]),
            line([4.0, 6.0], [1.0, 6.0]),
            line([1.0, 6.0], [1.0, 2.0])
        ]
    );
    assert!(curve.is_closed() && curve.slack() == 0.0);
}

#[test]
fn radii_of_a_rect_follow_each_other_and_stop_at_half_its_sides() {
    for (given, expected) in [
        ("rx='2'", [2.0, 2.0]),
        ("ry='1'", [1.0, 1.0]),
        ("rx='2' ry='1'", [2.0, 1.0]),
        ("rx='99' ry='1'", [5.0, 1.0]),
        ("rx='99'", [5.0, 3.0]),
        ("rx='auto' ry='1'", [1.0, 1.0]),
    ] {
        let drawing = inside(&format!("<rect width='10' height='6' {given}/>"));
        let curve = &drawing.lines[0];
        let arcs: Vec<_> =
            curve.segments().iter().filter(|p| matches!(p, CurveSegment::Arc(_))).map(arc).collect();
        assert_eq!(arcs.len(), 4, "{given}");
        let [rx, ry] = expected;
        let centres = [[10.0 - rx, ry], [10.0 - rx, 6.0 - ry], [rx, 6.0 - ry], [rx, ry]];
        for (arc, centre) in arcs.iter().zip(centres) {
            assert_eq!((arc.centre(), arc.axes()), (centre, [[rx, 0.0], [0.0, ry]]), "{given}");
            assert_eq!(arc.sweep_rad(), PI / 2.0);
        }
        assert_eq!(curve.start(), [rx, 0.0]);
        assert!(curve.is_closed());
    }
    assert_eq!(inside("<rect width='10' height='6' rx='0' ry='2'/>").lines[0].segments().len(), 4);
}

#[test]
fn circles_and_ellipses_are_one_arc() {
    let drawing = inside("<circle cx='3' cy='4' r='2'/><ellipse cx='1' rx='3' ry='2'/><ellipse ry='2'/>");
    let all: Vec<_> = drawing.lines.iter().map(|curve| arc(&curve.segments()[0])).collect();
    assert_eq!((all[0].centre(), all[0].axes()), ([3.0, 4.0], [[2.0, 0.0], [0.0, 2.0]]));
    assert_eq!((all[1].centre(), all[1].axes()), ([1.0, 0.0], [[3.0, 0.0], [0.0, 2.0]]));
    assert_eq!(all[2].axes(), [[2.0, 0.0], [0.0, 2.0]]);
    for curve in &drawing.lines {
        assert!(curve.is_closed() && curve.segments().len() == 1);
        assert!(curve.slack() < 1e-14);
    }
    near(drawing.lines[0].at(0.25), [3.0, 6.0]);
}

#[test]
fn lines_polylines_and_polygons() {
    let drawing =
        inside("<line x1='1' y2='2'/><polyline points='0,0 1,0 1,1'/><polygon points='0 0 1 0 1 1'/>");
    assert_eq!(drawing.lines[0].segments(), [line([1.0, 0.0], [0.0, 2.0])]);
    assert_eq!((drawing.lines[1].segments().len(), drawing.lines[1].is_closed()), (2, false));
    assert_eq!((drawing.lines[2].segments().len(), drawing.lines[2].is_closed()), (3, true));
    let filled: Vec<_> = drawing.elements.iter().map(|element| element.filled).collect();
    assert_eq!(filled, [false, true, true], "a line has no inside");
    let (drawing, warnings) = load(&svg("<polyline points='0 0 1 1 2'/><polygon points='0 0 1 0 x 1'/>"));
    assert_eq!(drawing.lines[0].segments().len(), 1);
    assert_eq!((count(&warnings, "bad-attribute"), count(&warnings, "path-error")), (1, 1));
}

#[test]
fn shapes_without_size_draw_nothing_and_negative_sizes_are_counted() {
    let none = "<rect width='0' height='1'/><circle r='0'/><ellipse rx='1' ry='0'/><path/><path d=''/><rect/>\
                <polygon points=''/><circle/>";
    let (drawing, warnings) = load(&svg(none));
    assert!(drawing.lines.is_empty() && count(&warnings, "nothing-drawn") == 1, "{drawing:?}");
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    let (drawing, warnings) =
        load(&svg("<rect width='-1' height='1'/><circle r='-1'/><circle r='1x'/><line/>"));
    assert_eq!((drawing.lines.len(), count(&warnings, "bad-attribute")), (1, 2));
    assert_eq!(count(&warnings, "unsupported-unit"), 1);
}

#[test]
fn lengths_have_units_and_percentages() {
    let text = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 200 100'>\
        <rect x='10%' y='10%' width='1in' height='2pc'/><circle cx='1cm' r='50%'/><circle r='1em'/></svg>";
    let (drawing, warnings) = load(text);
    assert_eq!(drawing.lines[0].start(), [20.0, 10.0]);
    near(drawing.lines[0].at(2.0), [116.0, 42.0]);
    let circle = arc(&drawing.lines[1].segments()[0]);
    near(circle.centre(), [96.0 / 2.54, 0.0]);
    near(circle.axes()[0], [0.5 * (12_500.0_f64 * 2.0).sqrt(), 0.0]);
    assert!(drawing.lines[0].slack() > 0.0 && drawing.lines[1].slack() > 0.0);
    let (closed, _) = load("<svg xmlns='http://www.w3.org/2000/svg'><rect width='1mm' height='1mm'/></svg>");
    assert!(
        closed.lines[0].slack() > 3.9e-16,
        "a millimetre is no number of pixels: {}",
        closed.lines[0].slack()
    );
    assert_eq!((drawing.lines.len(), count(&warnings, "unsupported-unit")), (2, 1));
}
