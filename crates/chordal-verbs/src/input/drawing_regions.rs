//! `FilledRegions`: the outlines of the filled regions of a drawing.
use crate::formats::extensions_where;
use chordal::budget::advice::Message;
use chordal::budget::{Refusal, RefusalCode};
use chordal::explicit::parametric::AffineMap;
use chordal::explicit::{Curve, Outline};
use chordal::math::Box3;
use chordal_io::{Axis, Drawing, Format, Frame};

const TURNED: &str = "y grows downwards in the drawing and upwards in space: every y is negated";
const MEANING: &str = "the bound is for the distance between each outline and its polyline; a point that is inside \
 only the drawing or only the triangles is no farther than that from an outline";

/// The outlines of a drawing's filled regions, with y up, in their order.
pub(crate) struct FilledRegions {
    pub outlines: Vec<Outline>,
    pub frame: Frame,
    /// Their bounding box.
    pub bounds: Box3,
}

impl FilledRegions {
    /// # Errors
    /// If nothing is filled.
    pub fn from_drawing(drawing: &Drawing, notes: &mut Vec<Message>) -> Result<Self, Refusal> {
        let mut outlines: Vec<Outline> = drawing.filled().collect();
        if outlines.iter().all(|outline| outline.contours.is_empty()) {
            let message = format!(
                "the drawing fills nothing: its lines can be written as polylines, to {}",
                extensions_where(Format::holds_polylines, "or")
            );
            return Err(Refusal::new(RefusalCode::Empty, message));
        }
        let mut frame = drawing.frame;
        if drawing.y_down {
            notes.push(TURNED.into());
            frame.up = frame.up.or(Some(Axis::Y));
            outlines.iter_mut().flat_map(|outline| &mut outline.contours).for_each(flip_y);
        }
        let left_out = drawing.elements.iter().filter(|element| !element.filled).count();
        if left_out > 0 {
            notes.push(format!("elements that are not filled were left out ({left_out}x)").into());
        }
        let open = outlines
            .iter()
            .flat_map(|outline| &outline.contours)
            .filter(|contour| !contour.is_closed())
            .count();
        if open > 0 {
            notes.push(
                format!("open subpaths were closed by a straight line, as SVG fills them ({open}x)").into(),
            );
        }
        notes.push(MEANING.into());
        let contours = outlines.iter().flat_map(|outline| &outline.contours);
        let bounds = contours.fold(Box3::EMPTY, |hull, contour| {
            let [[x, y], [right, top]] = contour.bounds();
            hull.union(Box3 { min: [x, y, 0.0], max: [right, top, 0.0] })
        });
        Ok(Self { outlines, frame, bounds })
    }
}

/// The paths of a drawing, with y up.
pub(crate) fn upright(drawing: &Drawing) -> Vec<Curve<2>> {
    let mut paths = drawing.lines.clone();
    if drawing.y_down {
        paths.iter_mut().for_each(flip_y);
    }
    paths
}

/// Negates every y, which is exact.
fn flip_y(contour: &mut Curve<2>) {
    let mirror = AffineMap { columns: [[1.0, 0.0], [0.0, -1.0]], offset: [0.0; 2] };
    let pieces: Vec<_> = contour.segments().iter().map(|piece| piece.transformed(&mirror)).collect();
    let turned = if pieces.is_empty() {
        Curve::point(mirror.point(contour.start()))
    } else {
        Curve::new(pieces, contour.is_closed().into())
    };
    // Negation keeps numbers finite and joints connected.
    if let Ok(turned) = turned {
        *contour = turned.with_slack(contour.slack());
    }
}
