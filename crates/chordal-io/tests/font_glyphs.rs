//! Every letter of fonts of others: its filled area against its outline's own integral, and solids over it.
use chordal::check::findings::measure;
use chordal::check::validity;
use chordal::explicit::{Curve, CurveSegment, Outline, Topology};
use chordal::{Budget, Job, Tolerance, convert};
use chordal_io::font::{Letters, read_letters};
use chordal_io::{Content, Limits};
use chordal_testkit::corpus;

/// Latin, Greek and Cyrillic with what belongs to them, signs, and ligatures.
const RANGES: [(u32, u32); 5] =
    [(0x21, 0x250), (0x370, 0x530), (0x1E00, 0x2000), (0x2000, 0x2700), (0xFB00, 0xFB07)];
const TOLERANCE: f64 = 1e-3;

/// The corners of a closed curve and points of its pieces between them.
fn sampled(curve: &Curve<2>) -> Vec<[f64; 2]> {
    let steps = |piece: &CurveSegment<2>| if matches!(piece, CurveSegment::Line(_)) { 1 } else { 8 };
    let points = |piece: &CurveSegment<2>| {
        let n = steps(piece);
        (0..n).map(|i| piece.at(f64::from(i) / f64::from(n))).collect::<Vec<_>>()
    };
    curve.segments().iter().flat_map(points).collect()
}

fn cross(o: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
}

fn sides(points: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> + Clone + '_ {
    points.iter().zip(points.iter().cycle().skip(1)).map(|(a, b)| [*a, *b])
}

/// Whether two sides cross, or touch.
fn meet_sides([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> bool {
    let apart = |a: f64, b: f64| a > 0.0 && b > 0.0 || a < 0.0 && b < 0.0;
    // In one line they meet only where their boxes do.
    (0..2).all(|k| a[k].min(b[k]) <= c[k].max(d[k]) && c[k].min(d[k]) <= a[k].max(b[k]))
        && !apart(cross(a, b, c), cross(a, b, d))
        && !apart(cross(c, d, a), cross(c, d, b))
}

/// Whether sides of two polygons do.
fn meet(one: &[[f64; 2]], other: &[[f64; 2]]) -> bool {
    sides(one).any(|side| sides(other).any(|other| meet_sides(side, other)))
}

fn winding(points: &[[f64; 2]], at: [f64; 2]) -> i32 {
    sides(points)
        .map(|[a, b]| match (a[1] <= at[1], b[1] <= at[1]) {
            (true, false) if cross(a, b, at) > 0.0 => 1,
            (false, true) if cross(a, b, at) < 0.0 => -1,
            _ => 0,
        })
        .sum()
}

/// Whether sides of a polygon meet that are no neighbours.
fn meets_itself(points: &[[f64; 2]]) -> bool {
    let all: Vec<_> = sides(points).collect();
    let n = all.len();
    (0..n).any(|i| (i + 2..n).any(|j| (i, j) != (0, n - 1) && meet_sides(all[i], all[j])))
}

/// The area of what contours wind around, where none meets itself or another and none winds around another in the same sense;
/// and the length of all.
fn plain_area(contours: &[Curve<2>]) -> Option<(f64, f64)> {
    let polygons: Vec<_> = contours.iter().map(sampled).collect();
    for (i, one) in polygons.iter().enumerate() {
        if meets_itself(one) || polygons[i + 1..].iter().any(|other| meet(one, other)) {
            return None;
        }
        // Alone it winds once around what it fills; a hole takes that back.
        let around: i32 = polygons
            .iter()
            .enumerate()
            .filter(|(j, _)| *j != i)
            .map(|(_, other)| winding(other, one[0]))
            .sum();
        let own = if green(std::slice::from_ref(&contours[i])) > 0.0 { 1 } else { -1 };
        if around * own > 0 || around.abs() > 1 {
            return None;
        }
    }
    let length =
        polygons.iter().flat_map(|points| sides(points)).map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
    Some((green(contours).abs(), length))
}

/// The integral of Green's theorem, by Gauss' quadrature of three points: exact for cubics.
fn green(contours: &[Curve<2>]) -> f64 {
    let nodes = [(0.5 - 0.15_f64.sqrt(), 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + 0.15_f64.sqrt(), 5.0 / 18.0)];
    let pieces = contours.iter().flat_map(Curve::segments);
    pieces
        .map(|piece| {
            let parts = nodes.map(|(t, weight)| {
                let ([x, y], [dx, dy]) = (piece.at(t), piece.tangent(t));
                weight * (x * dy - y * dx) / 2.0
            });
            parts.iter().sum::<f64>()
        })
        .sum()
}

#[test]
fn every_letter_is_filled_to_its_own_area_and_raised_to_a_solid() {
    for (file, least) in [("roboto/Roboto-Regular.ttf", 700), ("inconsolata/Inconsolata.ttf", 300)] {
        let Some(path) = corpus::find(&format!("outline/vello/examples/assets/{file}")) else { return };
        let font = std::fs::read(path).unwrap();
        let (mut n_letters, mut n_compared) = (0, 0);
        for c in RANGES.into_iter().flat_map(|(from, end)| from..end).filter_map(char::from_u32) {
            let read = match read_letters(&font, &Letters::new(&c.to_string()), &Limits::default()) {
                Ok(read) => read,
                Err(error) => {
                    assert!(matches!(error.code, "no-glyph" | "no-text" | "nothing-drawn"), "{c}: {error}");
                    continue;
                }
            };
            let Content::Drawing(drawing) = read.content else { panic!("letters are a drawing") };
            let outlines: Vec<Outline> = drawing.filled().collect();
            let budget = Budget::length(Tolerance::new(TOLERANCE).unwrap());
            let made = convert::outlines_to_solid(&outlines, 0.25, &budget, &Job::default())
                .unwrap_or_else(|error| panic!("{c}: {error}"));
            let found = validity(&made.shape, Topology::Indices);
            assert!(
                found.closed && found.edge_manifold && found.vertex_manifold && found.oriented,
                "{c}: {found:?}"
            );
            let bound = made.bound.at_most().unwrap();
            assert!(bound <= TOLERANCE, "{c}: {bound}");
            let area = measure(&made.shape).signed_volume / 0.25;
            n_letters += 1;
            let Some((truth, length)) = plain_area(&drawing.lines) else {
                // Where contours overlap, what they wind around twice counts once.
                let both = green(&drawing.lines).abs();
                assert!(area > 0.0 && area < both + 4.0 * TOLERANCE, "{c}: {area}, of {both}");
                continue;
            };
            n_compared += 1;
            assert!((area - truth).abs() <= bound * length, "{c}: {area}, not {truth}");
        }
        println!("{file}: {n_letters} letters, {n_compared} compared by area");
        assert!(n_letters >= least && 10 * n_compared >= 7 * n_letters, "{file}: {n_letters}, {n_compared}");
    }
}

#[test]
fn letters_with_bevels_are_solids_too() {
    for file in ["roboto/Roboto-Regular.ttf", "inconsolata/Inconsolata.ttf"] {
        let Some(path) = corpus::find(&format!("outline/vello/examples/assets/{file}")) else { return };
        let font = std::fs::read(path).unwrap();
        // Narrow strokes, curves that meet in corners, holes, dots.
        for text in ["Words", "&@ß8Q", "gjkM%"] {
            let read = read_letters(&font, &Letters::new(text), &Limits::default()).unwrap();
            let Content::Drawing(drawing) = read.content else { panic!("letters are a drawing") };
            let outlines: Vec<Outline> = drawing.filled().collect();
            // A fifth of a stroke, and more than half of one.
            for width in [0.02, 0.09] {
                let budget = Budget::length(Tolerance::new(TOLERANCE).unwrap());
                let bevel = convert::bevels::Bevel { height: 0.25, width };
                let made = convert::outlines_to_bevelled_solid(&outlines, bevel, &budget, &Job::default())
                    .unwrap_or_else(|error| panic!("{text}: {error}"));
                let found = validity(&made.shape, Topology::Indices);
                assert!(
                    found.closed && found.edge_manifold && found.vertex_manifold && found.oriented,
                    "{text}: {found:?}"
                );
                assert!(made.bound.at_most().unwrap() <= TOLERANCE);
                let plain = convert::outlines_to_solid(&outlines, 0.25, &budget, &Job::default()).unwrap();
                let [bevelled, plain] = [&made, &plain].map(|made| measure(&made.shape).signed_volume);
                assert!(bevelled > 0.3 * plain && bevelled < plain, "{text}: {bevelled} of {plain}");
            }
        }
    }
}
