//! Merges the parts of an OBJ in the order of the file. The result equals that of reading the whole file
//! statement by statement, to the last warning; that reader remains as the oracle of the tests.
use super::ObjReader;
use crate::ReadError;
use crate::grow::{extend, push, push_many};
use crate::obj::part::{ObjPart, ObjRun};
use crate::obj::statements::ObjStatements;
use crate::plain_text::parts_at_once;
use crate::text::LineTokens;
use chordal::Job;
use chordal::budget::par_map;

/// Splits the first `n` items off a list.
#[inline]
fn take<'a, T>(list: &mut &'a [T], n: u32) -> &'a [T] {
    let (first, rest) = list.split_at(n as usize);
    *list = rest;
    first
}

impl ObjReader<'_> {
    /// Parses parts on the threads of a job, and merges them.
    pub(super) fn parts(&mut self, parts: &[&[u8]], job: &Job) -> Result<(), ReadError> {
        for wave in parts.chunks(parts_at_once(job.threads)) {
            for part in par_map(job, wave, |_, part| ObjPart::read(part)) {
                self.part(&part?)?;
            }
        }
        Ok(())
    }

    /// Merges the next part of the file.
    fn part(&mut self, part: &ObjPart) -> Result<(), ReadError> {
        let first_line = self.n_lines + 1;
        let (mut positions, mut texcoords, mut normals) =
            (&part.positions[..], &part.texcoords[..], &part.normals[..]);
        let (mut faces, mut corners) = (&part.faces[..], &part.corners[..]);
        for run in &part.runs {
            match *run {
                ObjRun::Positions(n) => {
                    self.n_known += u64::from(n);
                    let own = take(&mut positions, n);
                    extend(&mut self.positions, own)?;
                    if !self.colors.is_empty() {
                        // Positions without a colour are white.
                        push_many(&mut self.colors, [1.0; 4], own.len())?;
                    }
                }
                ObjRun::Texcoords(n) => {
                    self.n_known += u64::from(n);
                    extend(&mut self.texcoords, take(&mut texcoords, n))?;
                }
                ObjRun::Normals(n) => {
                    self.n_known += u64::from(n);
                    extend(&mut self.normals, take(&mut normals, n))?;
                }
                ObjRun::Faces(n) => {
                    self.n_known += u64::from(n);
                    for face in take(&mut faces, n) {
                        let face_corners = take(&mut corners, face.n_corners);
                        self.part_face(part, face.line, face_corners)?;
                    }
                }
                ObjRun::Other { line, start, end } => {
                    let mut statements = ObjStatements::new(&part.text[start as usize..end as usize]);
                    while let Some((number, statement)) = statements.next() {
                        // Line numbers begin at 1.
                        self.statement(first_line + u64::from(line) + number - 1, statement)?;
                    }
                }
            }
        }
        self.n_lines += part.n_lines;
        Ok(())
    }

    /// Merges a face. An invalid one is parsed again from its statement, which reports the error.
    #[inline]
    fn part_face(&mut self, part: &ObjPart, line: u32, written: &[[i32; 3]]) -> Result<(), ReadError> {
        let number = self.n_lines + 1 + u64::from(line);
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        for indices in written {
            let Some(corner) = self.resolved(number, *indices) else {
                let statement = part.statement(line).unwrap_or_default();
                let mut tokens = LineTokens::new(&statement);
                tokens.next();
                return self.face(number, tokens);
            };
            match &mut self.cage {
                Some(cage) => cage.corner(corner)?,
                None => push(&mut corners, self.rows.row(corner)?)?,
            }
        }
        if let Some(cage) = &mut self.cage {
            return cage.end_face(number, &mut self.warnings);
        }
        self.end_face(number, corners)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{ObjRowCounts, read_parts};
    use super::*;
    use crate::obj::part::parts_of;
    use crate::{Conformance, Limits, PolygonSurface};
    use chordal::explicit::subdivision::Scheme;
    use chordal_testkit::Random;

    /// Reads statement by statement, on one thread.
    fn plain(text: &[u8], limits: &Limits) -> String {
        let read = || {
            let mut reader = ObjReader::new(ObjRowCounts::scan(text), limits)?;
            let mut statements = ObjStatements::new(text);
            while let Some((line, statement)) = statements.next() {
                reader.statement(line, statement)?;
            }
            reader.finish()
        };
        format!("{:?}", read())
    }

    /// Lines as programs, people and attackers write them; `#` stands for a digit, `%` for an index.
    const LINES: [&str; 60] = [
        "v # # #",
        "v -#.# #e-# .#",
        "v #.#### # -0",
        "v # # # #",
        "v # # # 0.# 0.# 0.#",
        "v # #",
        "v # # x",
        "v 0.10000000149011612 # 123456789012345678901",
        "v nan # #",
        "v 1e400 # #",
        "v # # # # # # # #",
        "  v # # #",
        "\tv\t# # #  ",
        "v # # \\\n#",
        "v # # #\\\n",
        "v # # # # #",
        "vt 0.#",
        "vt 0.# 0.#",
        "vt 0.# 0.# 0",
        "vt # # #",
        "vt",
        "vt a",
        "vn # # #",
        "vn 0 0 0",
        "vn # #",
        "f % % %",
        "f % % %",
        "f % % %",
        "f % % % %",
        "f %/% %/% %/%",
        "f %//% %//% %//%",
        "f %/%/% %/%/% %/%/%",
        "f %/%/% % %",
        "f %/ %/ %/",
        "f %// % %",
        "f % %",
        "f %",
        "f",
        "f % % %/%/%/%",
        "f % % 0",
        "f % % x",
        "f % % 4294967297",
        "f\t%\t% %",
        "fo % % %",
        "f % \\\n % %",
        "f % % % # c",
        "g a b",
        "g",
        "usemtl #",
        "usemtl",
        "o #",
        "s #",
        "s off",
        "s x",
        "# c \\",
        "#",
        "",
        "   ",
        "l % %",
        "junk #",
    ];

    fn random_text(random: &mut Random, tags: bool) -> Vec<u8> {
        let mut text = Vec::new();
        // A wrong line ends a file. Most files use few kinds of lines, so that many files are long.
        let kinds: Vec<&str> = (0..1 + random.below(8)).map(|_| LINES[random.below(LINES.len())]).collect();
        // Some files have no texture coordinates or no normals for their faces to refer to.
        let kinds_of_rows = ["v 0 1 2\nvt 0 1\nvn 0 0 1\n", "v 0 1 2\n", "v 0 1 2\nvn 0 0 1\n"];
        let rows = kinds_of_rows[random.below(4).saturating_sub(1)];
        for _ in 0..random.below(8) {
            text.extend_from_slice(rows.as_bytes());
        }
        for _ in 0..random.below(60) {
            let line = if tags && random.below(9) == 0 {
                "t crease 2/1/0 0 1 #"
            } else {
                kinds[random.below(kinds.len())]
            };
            for byte in line.bytes() {
                match byte {
                    b'#' if line.len() > 1 && !line.starts_with("# c") => {
                        text.push(b'0' + random.below(10) as u8)
                    }
                    b'%' => {
                        let index = random.below(12) as i64 - 5;
                        text.extend_from_slice(if index == 0 { 1 } else { index }.to_string().as_bytes());
                    }
                    _ => text.push(byte),
                }
            }
            text.extend_from_slice(["\n", "\n", "\n", "\r\n", "\r"][random.below(5)].as_bytes());
        }
        text
    }

    #[test]
    fn parts_on_any_number_of_threads_read_as_statement_by_statement() {
        let mut random = Random::new(5);
        let (mut n_read, mut n_refused) = (0, 0);
        for i in 0..6000_usize {
            let surface =
                [None, Some(Scheme::CatmullClark), Some(Scheme::Loop)][i % 3].map(PolygonSurface::Limit);
            let limits = Limits {
                surface,
                drop_nonfinite: i % 2 == 0,
                rows: [500, 20][i % 5 / 4],
                conformance: [Conformance::default(), Conformance::Strict][i % 11 / 6],
                ..Limits::default()
            };
            let text = random_text(&mut random, i % 7 == 0);
            let expected = plain(&text, &limits);
            for threads in [1, 2, 3] {
                let parts = parts_of(&text, 1 + random.below(90));
                let found = read_parts(&text, &parts, None, &Limits { threads, ..limits });
                n_read += usize::from(found.is_ok());
                n_refused += usize::from(found.is_err());
                let shown = text.escape_ascii();
                assert_eq!(
                    format!("{found:?}"),
                    expected,
                    "{threads} threads, {} parts: {shown}",
                    parts.len()
                );
            }
        }
        assert!(n_read > 2000 && n_refused > 2000, "{n_read} read, {n_refused} refused");
    }
}
