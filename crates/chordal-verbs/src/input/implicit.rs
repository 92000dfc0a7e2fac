//! `ImplicitShape`: a field with the region that clips it.
use chordal::implicit::Field;
use chordal::math::Box3;
use chordal_io::Frame;
use serde::Serialize;
use std::collections::BTreeMap;

/// A field with a region of space.
#[derive(Clone, Debug)]
pub struct ImplicitShape {
    /// The field.
    pub field: Field,
    /// The box that clips the shape, if the user gave one.
    pub region: Option<Box3>,
    /// The frame of its coordinates.
    pub frame: Frame,
    /// The parameters of its script, if it has one.
    pub parameters: Vec<Parameter>,
    /// The shapes of which it is the union, if a script returns several; each becomes a part of its own.
    pub bodies: Vec<ShapeBody>,
    /// The shapes that the calls of its script returned, in the order of evaluation, for messages about places of the shape.
    pub lines: Vec<ShapeLine>,
}

/// A shape that a line of a script returned.
#[derive(Clone, Debug)]
pub struct ShapeLine {
    /// The number of the line, from 1.
    pub line: u64,
    /// A part of the shape, or all of it, at that time.
    pub field: Field,
}

/// The last shape that the calls of a script's line returned; operators between shapes are not counted as calls.
#[derive(Clone, Debug)]
pub struct LineShape {
    /// The number of the line, from 1.
    pub line: u64,
    /// How often the line ran.
    pub times: usize,
    /// The shape that it returned the last time.
    pub field: Field,
}

/// One of several shapes of an input.
#[derive(Clone, Debug)]
pub struct ShapeBody {
    /// Its name.
    pub name: String,
    /// The shape.
    pub field: Field,
}

/// A numeric input of a script.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its default value.
    pub default: f64,
    /// Its value.
    pub value: f64,
}

impl ImplicitShape {
    /// A single shape without a script.
    #[must_use]
    pub fn new(field: Field, region: Option<Box3>, frame: Frame) -> Self {
        Self { field, region, frame, parameters: Vec::new(), bodies: Vec::new(), lines: Vec::new() }
    }

    /// The last shape that the calls of each line of its script returned, in the order of the lines.
    ///
    /// ```
    /// use chordal_verbs::{FormatHint, Shape, load};
    /// let script = b"arm = move(box(9, 2, 2), 5, 0, 0)\nunion([rotate_z(arm, 90 * k) for k in range(4)])\n";
    /// let hint = FormatHint { name: Some("cross.star"), ..FormatHint::default() };
    /// let Shape::Field(field) = load(script, hint, &Default::default())?.shape else { panic!("a field") };
    /// let lines = field.shapes_by_line();
    /// assert_eq!(lines.iter().map(|one| one.line).collect::<Vec<_>>(), [1, 2]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn shapes_by_line(&self) -> Vec<LineShape> {
        let mut by_line: BTreeMap<u64, LineShape> = BTreeMap::new();
        // Calls in a row are one run of their line, which may have several calls, or a loop within it.
        for run in self.lines.chunk_by(|a, b| a.line == b.line) {
            let Some(ShapeLine { line, field }) = run.last() else { continue };
            let field = field.clone();
            let times = by_line.get(line).map_or(1, |before| before.times + 1);
            by_line.insert(*line, LineShape { line: *line, times, field });
        }
        by_line.into_values().collect()
    }

    /// One of its bodies by itself, in the same region and frame.
    #[must_use]
    pub fn of_body(&self, body: &ShapeBody) -> Self {
        Self { field: body.field.clone(), parameters: Vec::new(), bodies: Vec::new(), ..self.clone() }
    }

    /// A bounding box of the shape: the known extent of the field, clipped to the region. Infinite if both are.
    #[must_use]
    pub fn bounds(&self) -> Box3 {
        let extent = self.field.bounds();
        let Some(region) = self.region else { return extent };
        let pick = |a: [f64; 3], b: [f64; 3], first: fn(f64, f64) -> bool| {
            std::array::from_fn(|k| if first(a[k], b[k]) { a[k] } else { b[k] })
        };
        Box3 {
            min: pick(extent.min, region.min, |a, b| a > b),
            max: pick(extent.max, region.max, |a, b| a < b),
        }
    }

    /// The field clipped to the region and closed by its sides; a plane shape stays a plane shape.
    #[must_use]
    pub fn clip_to_region(&self) -> Field {
        let Some(region) = self.region else { return self.field.clone() };
        let is_flat = !self.field.tape().axes()[2];
        if is_flat { self.field.cropped(region) } else { self.field.clipped(region) }
    }

    /// As [`Self::clip_to_region`], but as a solid: a plane shape is extruded over the height of the region.
    #[must_use]
    pub fn solid(&self) -> Field {
        self.region.map_or_else(|| self.field.clone(), |region| self.field.clipped(region))
    }
}
