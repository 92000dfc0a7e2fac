//! `ObjStatements`: the lines of an OBJ as statements, and their counts by kind.
use super::tag_names::{is_tag, scheme_of};
use crate::assemble::too_many_rows;
use crate::text::{LineTokens, TextLines};
use crate::{FileLocation, Limits, ReadError};
use chordal::explicit::subdivision::Scheme;

/// An iterator of statements: lines, joined with the next one if they end in a backslash.
pub(super) struct ObjStatements<'a> {
    lines: TextLines<'a>,
    joined: Vec<u8>,
}

impl<'a> ObjStatements<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { lines: TextLines::new(text), joined: Vec::new() }
    }

    /// The byte offset of the next statement.
    pub(super) fn offset(&self) -> usize {
        self.lines.offset()
    }

    /// The number of lines so far.
    pub(super) fn n_lines(&self) -> u64 {
        self.lines.n_lines()
    }

    /// The next statement, with the number of its first line.
    #[inline]
    pub(super) fn next(&mut self) -> Option<(u64, &[u8])> {
        let (number, mut line) = self.lines.next()?;
        if line.last() != Some(&b'\\') || line.first() == Some(&b'#') {
            return Some((number, line));
        }
        self.joined.clear();
        while let [part @ .., b'\\'] = line {
            self.joined.extend_from_slice(part);
            self.joined.push(b' ');
            line = self.lines.next().map_or(&[], |(_, next)| next);
        }
        self.joined.extend_from_slice(line);
        Some((number, &self.joined))
    }
}

/// The numbers of rows in the file, counted in advance, so that lists get their exact length, and an index
/// out of range is reported at its line.
#[derive(Clone, Copy, Default)]
pub(super) struct ObjRowCounts {
    pub(super) positions: usize,
    pub(super) texcoords: usize,
    pub(super) normals: usize,
    pub(super) faces: usize,
    /// The number of subdivision tags.
    pub(super) tags: usize,
    /// The scheme of the last scheme tag.
    pub(super) scheme: Option<Scheme>,
}

impl ObjRowCounts {
    pub(super) fn scan(text: &[u8]) -> Self {
        let mut counts = Self::default();
        let mut statements = ObjStatements::new(text);
        while let Some((_, statement)) = statements.next() {
            let mut words = LineTokens::new(statement);
            match words.next() {
                Some(b"v") => counts.positions += 1,
                Some(b"vt") => counts.texcoords += 1,
                Some(b"vn") => counts.normals += 1,
                Some(b"f" | b"fo") => counts.faces += 1,
                Some(b"t") if is_tag(words.clone()) => {
                    counts.tags += 1;
                    counts.scheme = scheme_of(words).or(counts.scheme);
                }
                _ => {}
            }
        }
        counts
    }

    /// The counts of this text followed by another one.
    pub(super) fn and(self, next: Self) -> Self {
        Self {
            positions: self.positions + next.positions,
            texcoords: self.texcoords + next.texcoords,
            normals: self.normals + next.normals,
            faces: self.faces + next.faces,
            tags: self.tags + next.tags,
            scheme: next.scheme.or(self.scheme),
        }
    }

    pub(super) fn check(self, limits: &Limits) -> Result<(), ReadError> {
        let most = limits.rows.min(u64::from(u32::MAX) - 1);
        let lists = [
            ("vertices", self.positions),
            ("texture coordinates", self.texcoords),
            ("normals", self.normals),
            ("faces", self.faces),
        ];
        match lists.iter().find(|(_, rows)| *rows as u64 > most) {
            Some((what, rows)) => Err(too_many_rows(FileLocation::File, what, *rows as u64, most)),
            None => Ok(()),
        }
    }
}
