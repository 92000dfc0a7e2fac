//! `Drawn`: what a file of curves or polylines says: lines in order, and the elements that they belong to.
use crate::Frame;
use chordal::explicit::{Curve, FillRule, Outline, Polyline};
use serde_json::Value;

/// One drawn element of a file: a path, a circle, a curve of a list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Element {
    /// What it is in the file, as in "path" or "circle".
    pub kind: &'static str,
    /// Its name in the file (the id in SVG), or empty.
    pub name: Box<str>,
    /// The number that stands for it in a list of polylines: its place among the drawn elements of its file.
    pub source: u64,
    /// Which points its lines enclose.
    pub rule: FillRule,
    /// Whether the file fills what its lines enclose.
    pub filled: bool,
}

/// Lines of one kind in the file's order, and the elements that they belong to.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawn<T> {
    /// The lines: one for each subpath.
    pub lines: Vec<T>,
    /// For each line the index of its element. Never falls: the lines of an element stand together.
    pub owners: Vec<u32>,
    /// The elements, in the file's order.
    pub elements: Vec<Element>,
    /// The lowest x and y, the width and the height of the picture, where the file says.
    pub view_box: Option<[f64; 4]>,
    /// Whether y grows downwards, as in SVG.
    pub y_down: bool,
    /// The space.
    pub frame: Frame,
    /// The certificate that travels in the file, if it carries one.
    pub certificate: Option<Value>,
}

/// Curves in the plane.
pub type Drawing = Drawn<Curve<2>>;
/// Curves in space.
pub type Curves = Drawn<Curve<3>>;

/// Polylines of the plane or of space.
#[derive(Clone, Debug, PartialEq)]
pub enum Polylines {
    /// In the plane.
    Plane(Drawn<Polyline<2>>),
    /// In space.
    Space(Drawn<Polyline<3>>),
}

impl<T> Default for Drawn<T> {
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

impl<T> Drawn<T> {
    /// The lines, and everything else with no line.
    #[must_use]
    pub fn take_lines(self) -> (Vec<T>, Drawn<T>) {
        (self.lines, Self { lines: Vec::new(), ..self })
    }

    /// The same drawing with other lines, one for each of those that were there.
    #[must_use]
    pub fn with_lines<U>(self, lines: Vec<U>) -> Drawn<U> {
        Drawn {
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
    pub fn element_of(&self, line: usize) -> Option<&Element> {
        self.owners.get(line).and_then(|owner| self.elements.get(*owner as usize))
    }

    /// The lines of each element that has some, together.
    pub fn groups(&self) -> impl Iterator<Item = (&Element, &[T])> {
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
    /// The outline of each element that is filled, with its index.
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

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Points and segments of all together.
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
