//! The corners of faces: the rows that their indices refer to, and the handling of indices into lists that
//! the file does not have.
use super::{ObjCorner, ObjReader};
use crate::obj::index::index;
use crate::text::{integer, show};
use crate::{Conformance, FileLocation, ReadError};

/// The lists that a face can do without.
#[derive(Clone, Copy)]
enum CornerList {
    Texcoords,
    Normals,
}

impl ObjReader<'_> {
    /// Parses `v`, `v/vt`, `v//vn` or `v/vt/vn`; an empty field means none.
    #[inline]
    pub(super) fn corner(&mut self, line: u64, token: &[u8]) -> Result<ObjCorner, ReadError> {
        let mut parts = token.split(|b| *b == b'/');
        let position = parts.next().unwrap_or_default();
        let texcoord = parts.next().unwrap_or_default();
        let normal = parts.next().unwrap_or_default();
        if parts.next().is_some() {
            let message = format!("{} has more than three indices", show(token));
            return Err(ReadError::new("not-an-index", FileLocation::Line(line), message));
        }
        let (before, total) = (self.positions.len(), self.counts.positions);
        let position = index(line, position, ["vertex", "vertices"], before, total)?;
        let texcoord = self.optional(line, texcoord, CornerList::Texcoords)?;
        let normal = self.optional(line, normal, CornerList::Normals)?;
        Ok(ObjCorner { position, texcoord, normal })
    }

    /// The row, from 1, of a field; 0 if it is empty or refers to a missing list.
    #[inline]
    fn optional(&mut self, line: u64, token: &[u8], list: CornerList) -> Result<u32, ReadError> {
        if token.is_empty() {
            return Ok(0);
        }
        // An index of 0 is always wrong.
        if self.may_be_absent(list) && integer(token).is_ok_and(|index| index != 0) {
            self.count_absent(line, list);
            return Ok(0);
        }
        let (names, before, total) = match list {
            CornerList::Texcoords => {
                (["texture coordinate", "texture coordinates"], self.texcoords.len(), self.counts.texcoords)
            }
            CornerList::Normals => (["normal", "normals"], self.normals.len(), self.counts.normals),
        };
        Ok(index(line, token, names, before, total)? + 1)
    }

    /// The rows of the written indices, which are not 0; `None` if one is out of range.
    #[inline]
    pub(super) fn resolved(
        &mut self,
        line: u64,
        [position, texcoord, normal]: [i32; 3],
    ) -> Option<ObjCorner> {
        // The row, counted from 1.
        let row = |index: i32, before: usize, total: usize| {
            let row = if index < 0 { before as i64 + 1 + i64::from(index) } else { i64::from(index) };
            (1..=total as i64).contains(&row).then_some(row as u32)
        };
        let position = row(position, self.positions.len(), self.counts.positions)? - 1;
        let mut optional = |index: i32, list: CornerList| {
            if index == 0 {
                return Some(0);
            }
            if self.may_be_absent(list) {
                self.count_absent(line, list);
                return Some(0);
            }
            match list {
                CornerList::Texcoords => row(index, self.texcoords.len(), self.counts.texcoords),
                CornerList::Normals => row(index, self.normals.len(), self.counts.normals),
            }
        };
        let texcoord = optional(texcoord, CornerList::Texcoords)?;
        let normal = optional(normal, CornerList::Normals)?;
        Some(ObjCorner { position, texcoord, normal })
    }

    /// Whether indices into this list are a warning, because the list is missing. A list that is only too
    /// short is an error: it is unknown which of its rows was meant, and whether positions are missing too.
    #[inline]
    fn may_be_absent(&self, list: CornerList) -> bool {
        let total = match list {
            CornerList::Texcoords => self.counts.texcoords,
            CornerList::Normals => self.counts.normals,
        };
        total == 0 && self.limits.conformance != Conformance::Strict
    }

    #[cold]
    fn count_absent(&mut self, line: u64, list: CornerList) {
        let (code, what) = match list {
            CornerList::Texcoords => ("texcoords-absent", "texture coordinates"),
            CornerList::Normals => ("normals-absent", "normals"),
        };
        self.warnings.count(code, || {
            let message = format!("corners of faces name {what}, and the file has none: they are without");
            (FileLocation::Line(line), message)
        });
    }
}
