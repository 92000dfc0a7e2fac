//! `ObjPart`: a part of an OBJ, made of whole statements and parsed separately. This is the fast half of the
//! reader, which runs on many threads at once. The parsed parts are merged in the order of the file, see
//! `read.rs`.
//!
//! Only statements in the usual spelling are parsed here. All others are kept as text, and so is every
//! decision that depends on earlier lines: which row a negative index refers to, which colour a vertex gets,
//! where a group begins.
use super::CERTIFICATE;
use super::statements::ObjStatements;
use crate::ReadError;
use crate::grow::{out_of_memory, push};
use crate::plain_text::{PlainCursor, parts_of_lines};

/// The most bytes of a part that is parsed separately, 1 MiB. Chosen: a longer part is a single huge line,
/// which one thread reads anyway, and whose corners would be held twice.
const LONGEST: usize = 1 << 20;

/// The statements of a part, in lists by kind.
#[derive(Debug, Default)]
pub(super) struct ObjPart<'a> {
    pub text: &'a [u8],
    /// The order of the statements.
    pub runs: Vec<ObjRun>,
    pub positions: Vec<[f64; 3]>,
    pub texcoords: Vec<[f64; 2]>,
    pub normals: Vec<[f64; 3]>,
    pub faces: Vec<ObjPartFace>,
    /// The indices of the corners of all faces as written, 0 for a missing one.
    pub corners: Vec<[i32; 3]>,
    pub n_lines: u64,
}

/// A run of consecutive statements of one kind.
#[derive(Clone, Copy, Debug)]
pub(super) enum ObjRun {
    Positions(u32),
    Texcoords(u32),
    Normals(u32),
    Faces(u32),
    /// Statements of any kind: the line in the part, from 0, and their range of bytes.
    Other {
        line: u32,
        start: u32,
        end: u32,
    },
}

/// A face of three corners or more.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjPartFace {
    pub n_corners: u32,
    /// The line in the part, from 0.
    pub line: u32,
}

/// Cuts a text into parts; a line that ends in a backslash stays with the next.
pub(super) fn parts_of(text: &[u8], size: usize) -> Vec<&[u8]> {
    parts_of_lines(text, size, |lines| lines.ends_with(b"\\"))
}

impl<'a> ObjPart<'a> {
    /// Reads a part.
    ///
    /// # Errors
    /// `out-of-memory`.
    pub(super) fn read(text: &'a [u8]) -> Result<Self, ReadError> {
        let mut part = Self { text, ..Self::default() };
        if u32::try_from(text.len()).is_err() {
            // Possible only for a line of 4 GiB.
            return Err(out_of_memory(text.len()));
        }
        if text.len() > LONGEST {
            part.other(0, text.len())?;
            let mut statements = ObjStatements::new(text);
            while statements.next().is_some() {}
            part.n_lines = statements.n_lines();
            return Ok(part);
        }
        let mut cursor = PlainCursor { text, at: 0 };
        while let Some(first) = text.get(cursor.at) {
            let start = cursor.at;
            let taken = match first {
                b'v' => part.vertex(&mut cursor)?,
                b'f' => part.face(&mut cursor)?,
                b'\n' | b'\r' => {
                    cursor.end_line();
                    true
                }
                b'#' if !text[start..].starts_with(CERTIFICATE.as_bytes()) => {
                    cursor.skip_line();
                    true
                }
                _ => false,
            };
            if taken {
                part.n_lines += 1;
                continue;
            }
            // Only this reader knows where a statement of any spelling ends: it may go on in
            // further lines.
            let mut statements = ObjStatements::new(&text[start..]);
            statements.next();
            cursor.at = start + statements.offset();
            part.other(start, cursor.at)?;
            part.n_lines += statements.n_lines();
        }
        Ok(part)
    }

    /// Parses a line of `v`, `vt` or `vn`. Returns whether it was accepted.
    #[inline]
    fn vertex(&mut self, cursor: &mut PlainCursor) -> Result<bool, ReadError> {
        let run = match cursor.text.get(cursor.at + 1) {
            Some(b't') => {
                let Some(texcoord) = texcoord(cursor) else { return Ok(false) };
                push(&mut self.texcoords, texcoord)?;
                ObjRun::Texcoords(1)
            }
            Some(b'n') => {
                let Some(normal) = triple(cursor, b"vn") else { return Ok(false) };
                push(&mut self.normals, normal)?;
                ObjRun::Normals(1)
            }
            _ => {
                let position = triple(cursor, b"v").filter(|p| p.iter().all(|x| x.is_finite()));
                let Some(position) = position else { return Ok(false) };
                push(&mut self.positions, position)?;
                ObjRun::Positions(1)
            }
        };
        self.count(run)?;
        Ok(true)
    }

    #[inline]
    fn face(&mut self, cursor: &mut PlainCursor) -> Result<bool, ReadError> {
        let before = self.corners.len();
        if cursor.word(b"f").is_none() {
            return Ok(false);
        }
        while cursor.goes_on() {
            let Some(corner) = corner(cursor) else {
                self.corners.truncate(before);
                return Ok(false);
            };
            push(&mut self.corners, corner)?;
        }
        let n_corners = self.corners.len() - before;
        if n_corners < 3 {
            self.corners.truncate(before);
            return Ok(false);
        }
        cursor.end_line();
        // Both are below the number of bytes of the part, which fits.
        push(&mut self.faces, ObjPartFace { n_corners: n_corners as u32, line: self.n_lines as u32 })?;
        self.count(ObjRun::Faces(1))?;
        Ok(true)
    }

    /// Keeps a statement as text.
    fn other(&mut self, start: usize, end: usize) -> Result<(), ReadError> {
        // All are at most the number of bytes of the part.
        let [from, to] = [start as u32, end as u32];
        match self.runs.last_mut() {
            Some(ObjRun::Other { end, .. }) if *end == from => {
                *end = to;
                Ok(())
            }
            _ => push(&mut self.runs, ObjRun::Other { line: self.n_lines as u32, start: from, end: to }),
        }
    }

    /// The statement that begins at a line of the part.
    pub(super) fn statement(&self, line: u32) -> Option<Vec<u8>> {
        let mut statements = ObjStatements::new(self.text);
        while let Some((number, statement)) = statements.next() {
            if number == u64::from(line) + 1 {
                return Some(statement.to_vec());
            }
        }
        None
    }

    /// Counts a statement in the last run, or begins another run.
    #[inline]
    fn count(&mut self, run: ObjRun) -> Result<(), ReadError> {
        match (self.runs.last_mut(), run) {
            (Some(ObjRun::Positions(n)), ObjRun::Positions(_))
            | (Some(ObjRun::Texcoords(n)), ObjRun::Texcoords(_))
            | (Some(ObjRun::Normals(n)), ObjRun::Normals(_))
            | (Some(ObjRun::Faces(n)), ObjRun::Faces(_)) => {
                *n += 1;
                Ok(())
            }
            _ => push(&mut self.runs, run),
        }
    }
}

#[inline]
fn triple(cursor: &mut PlainCursor, word: &[u8]) -> Option<[f64; 3]> {
    cursor.word(word)?;
    let numbers = [cursor.number()?, cursor.number()?, cursor.number()?];
    cursor.end_line()?;
    Some(numbers)
}

/// Two numbers; a third is 0.
#[inline]
fn texcoord(cursor: &mut PlainCursor) -> Option<[f64; 2]> {
    cursor.word(b"vt")?;
    let numbers = [cursor.number()?, cursor.number()?];
    if cursor.goes_on() && cursor.number()? != 0.0 {
        return None;
    }
    cursor.end_line()?;
    Some(numbers)
}

/// `v`, `v/vt`, `v//vn` or `v/vt/vn`, followed by a blank or the end of the line. A written index of 0 is
/// always wrong.
#[inline]
fn corner(cursor: &mut PlainCursor) -> Option<[i32; 3]> {
    let mut indices = [written(cursor)?, 0, 0];
    if cursor.passes(b'/') {
        if cursor.passes(b'/') {
            indices[2] = written(cursor)?;
        } else {
            indices[1] = written(cursor)?;
            if cursor.passes(b'/') {
                indices[2] = written(cursor)?;
            }
        }
    }
    cursor.is_at_end().then_some(indices)
}

#[inline]
fn written(cursor: &mut PlainCursor) -> Option<i32> {
    cursor.integer().filter(|index| *index != 0)
}
