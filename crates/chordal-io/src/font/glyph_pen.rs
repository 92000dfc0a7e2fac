//! `GlyphPen`: outlines of glyphs as curves, placed and scaled to the length of the em.
use chordal::explicit::{Bezier, Curve, CurveEnds, CurveSegment, InvalidCurve};
use chordal::math::{greater, mul_up};
use harfrust::font::glyph::outline::PathSink;

/// Draws glyphs, contour by contour.
pub(super) struct GlyphPen {
    /// The length of the em, and its number of font units.
    em: f64,
    units: f64,
    /// The position of the glyph, in font units.
    at: [f64; 2],
    pieces: Vec<CurveSegment<2>>,
    start: [f64; 2],
    current: [f64; 2],
    curves: Vec<Curve<2>>,
    n_pieces: usize,
    /// The first invalid contour.
    invalid: Option<InvalidCurve>,
}

impl GlyphPen {
    pub fn new(em: f64, units_per_em: u16) -> Self {
        Self {
            em,
            units: f64::from(units_per_em),
            at: [0.0; 2],
            pieces: Vec::new(),
            start: [0.0; 2],
            current: [0.0; 2],
            curves: Vec::new(),
            n_pieces: 0,
            invalid: None,
        }
    }

    /// Sets the position of the next glyph, in font units.
    pub fn place(&mut self, at: [f64; 2]) {
        self.end_contour();
        self.at = at;
    }

    /// The number of pieces so far.
    pub fn n_pieces(&self) -> usize {
        self.n_pieces
    }

    /// All contours.
    pub fn finish(mut self) -> Result<Vec<Curve<2>>, InvalidCurve> {
        self.end_contour();
        self.invalid.map_or(Ok(self.curves), Err)
    }

    fn point(&self, x: f32, y: f32) -> [f64; 2] {
        [f64::from(x) + self.at[0], f64::from(y) + self.at[1]].map(|unit| unit * self.em / self.units)
    }

    fn piece(&mut self, piece: CurveSegment<2>) {
        self.current = piece.end();
        self.n_pieces += 1;
        self.pieces.push(piece);
    }

    fn end_contour(&mut self) {
        if self.current != self.start {
            self.piece(CurveSegment::Line([self.current, self.start]));
        }
        if self.pieces.is_empty() {
            return;
        }
        match Curve::new(std::mem::take(&mut self.pieces), CurveEnds::Closed) {
            Ok(curve) => {
                let reach = curve.bounds().iter().flatten().fold(0.0, |most: f64, x| greater(x.abs(), most));
                // A coordinate is a sum, a product and a quotient of half a step each, and conversion to a
                // cubic moves a quadratic curve by two steps: less than four steps for each of two
                // coordinates.
                self.curves.push(curve.with_slack(mul_up(8.0 * f64::EPSILON, reach)));
            }
            Err(error) => self.invalid = self.invalid.or(Some(error)),
        }
    }
}

impl PathSink for GlyphPen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.end_contour();
        self.start = self.point(x, y);
        self.current = self.start;
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let to = self.point(x, y);
        if to != self.current {
            self.piece(CurveSegment::Line([self.current, to]));
        }
    }

    fn quad_to(&mut self, cx0: f32, cy0: f32, x: f32, y: f32) {
        let (through, to) = (self.point(cx0, cy0), self.point(x, y));
        self.piece(CurveSegment::quadratic([self.current, through, to]));
    }

    fn curve_to(&mut self, cx0: f32, cy0: f32, cx1: f32, cy1: f32, x: f32, y: f32) {
        let control = [self.current, self.point(cx0, cy0), self.point(cx1, cy1), self.point(x, y)];
        self.piece(CurveSegment::Cubic(Bezier { control }));
    }

    fn close(&mut self) {
        self.end_contour();
        self.start = self.current;
    }
}
