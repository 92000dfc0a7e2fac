//! `Groups`: named groups of faces, from statements that apply to the faces after them.
use crate::ReadError;
use crate::grow::{push, with_room};
use chordal::explicit::{Attribute, Domain, Semantic};
use std::collections::HashMap;

/// The groups of one kind ("material", "g", …): names in order of appearance, and the face where each begins.
/// Number 0 is for faces before any statement, or after a statement that ended the group.
#[derive(Debug, Default)]
pub(crate) struct Groups {
    names: Vec<String>,
    /// Only for lookups: numbers follow the order of the file, not of the map.
    index: HashMap<String, u32>,
    current: u32,
    /// First triangle and number of each run.
    runs: Vec<(usize, u32)>,
}

impl Groups {
    /// Faces from index `triangle` on belong to the group `name`, or to none if the name is empty.
    pub(crate) fn name(&mut self, name: &str, triangle: usize) -> Result<(), ReadError> {
        if name.is_empty() {
            return self.number(0, triangle);
        }
        if let Some(number) = self.index.get(name) {
            return self.number(*number, triangle);
        }
        self.begin(name, triangle)?;
        self.index.insert(name.to_owned(), self.current);
        Ok(())
    }

    /// Faces from index `triangle` on belong to a new group, even if its name was used before.
    pub(crate) fn begin(&mut self, name: &str, triangle: usize) -> Result<(), ReadError> {
        push(&mut self.names, name.to_owned())?;
        // There are fewer names than bytes in the file, and more than 2^32 of them would exceed the memory
        // limit.
        self.number(u32::try_from(self.names.len()).unwrap_or(u32::MAX), triangle)
    }

    /// Faces from index `triangle` on belong to group `number`, which needs no name.
    pub(crate) fn number(&mut self, number: u32, triangle: usize) -> Result<(), ReadError> {
        if number == self.current {
            return Ok(());
        }
        self.current = number;
        match self.runs.last_mut() {
            // No faces followed the last statement.
            Some(last) if last.0 == triangle => last.1 = number,
            _ => push(&mut self.runs, (triangle, number))?,
        }
        Ok(())
    }

    /// One number for each of `n_triangles` triangles, or `None` if no triangle belongs to a group.
    pub(crate) fn attribute(&self, kind: &str, n_triangles: usize) -> Result<Option<Attribute>, ReadError> {
        if !self.runs.iter().any(|(from, number)| *number > 0 && *from < n_triangles) {
            return Ok(None);
        }
        let mut values = with_room(n_triangles)?;
        let ends = self.runs.iter().skip(1).map(|(from, _)| *from).chain([n_triangles]);
        // Triangles before the first statement belong to no group.
        values.resize(self.runs.first().map_or(0, |(from, _)| *from), 0.0);
        for ((_, number), end) in self.runs.iter().zip(ends) {
            values.resize(end, f64::from(*number));
        }
        Ok(Some(Attribute {
            semantic: Semantic::Group(kind.to_owned()),
            domain: Domain::Face,
            width: 1,
            values,
        }))
    }

    /// The names from number 1 on.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// The names by number; number 0 has the empty name.
    pub(crate) fn into_names(self) -> Vec<String> {
        std::iter::once(String::new()).chain(self.names).collect()
    }
}
