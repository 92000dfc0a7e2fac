//! Curves that consist of straight lines, as polylines, and the data that files of polylines do not hold.
use chordal::budget::advice::Message;
use chordal::explicit::{Curve, CurveSegment, FillRule, Polyline};
use chordal::math::greater;
use chordal_io::{Axis, Format, PathSet};
use std::collections::BTreeSet;

/// Straight curves as polylines, with the largest distance of the exact curves from them; `None` if a piece is bent.
pub(crate) fn straight_lines<const D: usize>(curves: &[Curve<D>]) -> Option<(Vec<Polyline<D>>, f64)> {
    let slack = curves.iter().fold(0.0, |most, curve| greater(curve.slack(), most));
    let lines: Option<Vec<_>> = curves.iter().map(straight_line).collect();
    Some((lines?, slack))
}

fn straight_line<const D: usize>(curve: &Curve<D>) -> Option<Polyline<D>> {
    let mut points = vec![curve.start()];
    for piece in curve.segments() {
        let CurveSegment::Line([_, end]) = piece else { return None };
        points.push(*end);
    }
    if curve.is_closed() && points.len() > 1 {
        // The end of the last piece is the start.
        points.pop();
    }
    Some(Polyline { points, places: Vec::new(), closed: curve.is_closed() })
}

/// Notes on the data of elements that a file of polylines does not hold.
pub(crate) fn line_losses<T>(drawn: &PathSet<T>, to: Format) -> Vec<Message> {
    let mut lost = Vec::new();
    let mut count = |n: usize, what: &str| {
        if n > 0 {
            lost.push(Message::from(format!("{to} {what} ({n}x)")));
        }
    };
    let elements = &drawn.elements;
    if to == Format::Json {
        count(elements.iter().filter(|e| !e.name.is_empty()).count(), "is written without names of elements");
        let even_odd = |e: &&chordal_io::DrawingElement| e.rule == FillRule::EvenOdd;
        count(elements.iter().filter(even_odd).count(), "is written without the rule evenodd");
        count(elements.iter().filter(|e| !e.filled).count(), "does not say that an element is not filled");
        count(usize::from(drawn.view_box.is_some()), "holds no box of view");
        count(usize::from(drawn.y_down), "does not say that y grows downwards");
        count(usize::from(drawn.frame.metres_per_unit.is_some()), "is written without the unit");
    }
    if to == Format::Svg {
        let named: Vec<&str> = elements.iter().map(|e| &*e.name).filter(|name| !name.is_empty()).collect();
        let distinct: BTreeSet<&&str> = named.iter().collect();
        count(named.len() - distinct.len(), "allows a name once: that of further elements was left out");
        count(usize::from(!drawn.y_down), "shows y growing downwards: the numbers are as they were");
    }
    let up = drawn.frame.up.map(Axis::letter);
    lost.extend(up.map(|up| format!("{to} does not say which axis is up: it is {up}").into()));
    lost
}
