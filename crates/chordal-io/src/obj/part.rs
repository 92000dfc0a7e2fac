//! `ObjPart`: a part of an OBJ of whole statements, read by itself: the fast half of the reader, which any
//! number of threads do at once. What it holds is taken over in the order of the file, see `read.rs`.
//!
//! Only statements spelled as programs spell them are read here. All others are kept as they stand, and so is
//! every decision that depends on what stands before: which row a negative index names, which colour a vertex
//! gets, where a group begins.
use super::CERTIFICATE;
use super::statements::ObjStatements;
use crate::ReadError;
use crate::grow::{out_of_memory, push};
use crate::plain_text::{PlainCursor, parts_of_lines};

/// The most bytes of a part that is read by itself, 1 MiB. A longer one is a single huge line, which one thread reads
/// anyhow, and whose corners would be held twice.
const LONGEST: usize = 1 << 20;

/// The statements of a part, in lists by kind.
#[derive(Debug, Default)]
pub(super) struct ObjPart<'a> {
    pub text: &'a [u8],
    /// What follows on what.
    pub runs: Vec<ObjRun>,
    pub positions: Vec<[f64; 3]>,
    pub texcoords: Vec<[f64; 2]>,
    pub normals: Vec<[f64; 3]>,
    pub faces: Vec<ObjPartFace>,
    /// The indices of the corners of all faces as they are written, 0 where there is none.
    pub corners: Vec<[i32; 3]>,
    pub n_lines: u64,
}

/// How many statements of one kind follow on each other.
#[derive(Clone, Copy, Debug)]
pub(super) enum ObjRun {
    Positions(u32),
    Texcoords(u32),
    Normals(u32),
    Faces(u32),
    /// Statements of any kind: the line in the part, from 0, and the bytes that they are.
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

/// The parts of a text: a line that ends in a backslash goes on in the next.
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
            // One line of 4 GiB.
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
            let mut statements = ObjStatements::new(&text[start..]);
            statements.next();
            cursor.at = start + statements.offset();
            part.other(start, cursor.at)?;
            part.n_lines += statements.n_lines();
        }
        Ok(part)
    }

    /// Reads a line of `v`, `vt` or `vn`. Returns whether it was taken.
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
        // Both are below the bytes of the part, which fit.
        push(&mut self.faces, ObjPartFace { n_corners: n_corners as u32, line: self.n_lines as u32 })?;
        self.count(ObjRun::Faces(1))?;
        Ok(true)
    }

    /// Keeps a statement as it stands.
    fn other(&mut self, start: usize, end: usize) -> Result<(), ReadError> {
        // All are at most the bytes of the part.
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

    /// Counts a statement in the last run, or begins another.
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

/// `v`, `v/vt`, `v//vn` or `v/vt/vn`, with a blank or the end of the line after it. An index of 0 is wrong
/// wherever it is written.
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
    cursor.whole().filter(|index| *index != 0)
}
