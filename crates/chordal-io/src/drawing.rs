//! `PathSet`: the curves or polylines of a file in order, and the elements that they belong to.
use crate::Frame;
use chordal::explicit::{Curve, FillRule, Outline, Polyline};
use serde_json::Value;

/// One drawn element of a file: a path, a circle, a curve of a list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DrawingElement {
    /// Its kind in the file, as in "path" or "circle".
    pub kind: &'static str,
    /// Its name in the file (the id in SVG), or empty.
    pub name: Box<str>,
    /// Identifies the element in a list of polylines: its index among the drawn elements of its file.
    pub source: u64,
    /// The fill rule, which decides the points that its lines enclose.
    pub rule: FillRule,
    /// Whether the element is filled in the file.
    pub filled: bool,
}

/// Lines of one kind in the file's order, with the elements that they belong to.
#[derive(Clone, Debug, PartialEq)]
pub struct PathSet<T> {
    /// The lines: one for each subpath.
    pub lines: Vec<T>,
    /// For each line the index of its element. Non-decreasing: the lines of an element are consecutive.
    pub owners: Vec<u32>,
    /// The elements, in the file's order.
    pub elements: Vec<DrawingElement>,
    /// The lowest x and y, the width and the height of the picture, if the file gives them.
    pub view_box: Option<[f64; 4]>,
    /// Whether y grows downwards, as in SVG.
    pub y_down: bool,
    /// The coordinate frame.
    pub frame: Frame,
    /// The certificate in the file, if it carries one.
    pub certificate: Option<Value>,
}

/// Curves in the plane.
pub type Drawing = PathSet<Curve<2>>;
/// Curves in space.
pub type Curves = PathSet<Curve<3>>;

/// Polylines in the plane or in space.
#[derive(Clone, Debug, PartialEq)]
pub enum Polylines {
    /// In the plane.
    Plane(PathSet<Polyline<2>>),
    /// In space.
    Space(PathSet<Polyline<3>>),
}

impl<T> Default for PathSet<T> {
    fn default() -> Self {
        Self {
            lines: Vec::new(),
            owners: Vec::new(),
            elements: Vec::new(),
            view_box: None,
            y_down: false,
            frame: Frame::default(),
            certificate: None,
        }
    }
}

impl<T> PathSet<T> {
    /// Splits off the lines; the second value has an empty list of lines.
    #[must_use]
    pub fn take_lines(self) -> (Vec<T>, PathSet<T>) {
        (self.lines, Self { lines: Vec::new(), ..self })
    }

    /// The same drawing with each line replaced by a new one.
    #[must_use]
    pub fn with_lines<U>(self, lines: Vec<U>) -> PathSet<U> {
        PathSet {
            lines,
            owners: self.owners,
            elements: self.elements,
            view_box: self.view_box,
            y_down: self.y_down,
            frame: self.frame,
            certificate: self.certificate,
        }
    }

    /// The element of a line.
    #[must_use]
    pub fn element_of(&self, line: usize) -> Option<&DrawingElement> {
        self.owners.get(line).and_then(|owner| self.elements.get(*owner as usize))
    }

    /// The elements that have lines, each with its lines.
    pub fn groups(&self) -> impl Iterator<Item = (&DrawingElement, &[T])> {
        let mut from = 0;
        std::iter::from_fn(move || {
            let owner = *self.owners.get(from)?;
            let len = self.owners[from..].iter().take_while(|other| **other == owner).count();
            let group = (self.elements.get(owner as usize)?, self.lines.get(from..from + len)?);
            from += len;
            Some(group)
        })
    }
}

impl Drawing {
    /// The outline of each filled element, with the index of the element.
    pub fn filled(&self) -> impl Iterator<Item = Outline> {
        self.groups()
            .filter(|(element, _)| element.filled)
            .map(|(element, lines)| Outline { contours: lines.to_vec(), rule: element.rule })
    }
}

impl Polylines {
    /// The number of polylines.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Plane(all) => all.lines.len(),
            Self::Space(all) => all.lines.len(),
        }
    }

    /// Whether there are no polylines.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The total numbers of points and segments.
    #[must_use]
    pub fn counts(&self) -> [u64; 2] {
        fn sum<const D: usize>(lines: &[Polyline<D>]) -> [u64; 2] {
            let add =
                |[p, s]: [u64; 2], l: &Polyline<D>| [p + l.points.len() as u64, s + l.n_segments() as u64];
            lines.iter().fold([0, 0], add)
        }
        match self {
            Self::Plane(all) => sum(&all.lines),
            Self::Space(all) => sum(&all.lines),
        }
    }
}
