//! `SubdivTags`: the subdivision tags of an OBJ, in the format of OpenSubdiv's shapes.
//!
//! `t NAME INTS/FLOATS/STRINGS …`, then as many words of each kind. Vertices and faces are counted from 0
//! over the whole file, unlike the indices of faces.
use super::statements::ObjRowCounts;
use super::tag_names::{BOUNDARIES, KNOWN, REFINED, SCHEME, scheme_named};
use crate::grow::push;
use crate::text::{LineTokens, grouped, integer, number, number_error, show};
use crate::warnings::Warnings;
use crate::{FileLocation, ReadError};
use chordal::explicit::subdivision::{Boundary, CreasingMethod, LinearTexcoords};

/// The content of the tags; all vertices and faces exist.
#[derive(Debug, Default)]
pub(super) struct SubdivTags {
    pub(super) creases: Vec<([u32; 2], f64)>,
    /// The first crease and the line of each tag.
    lines: Vec<(usize, u64)>,
    pub(super) corners: Vec<(u32, f64)>,
    /// Faces, as face indices of the file.
    pub(super) holes: Vec<u32>,
    pub(super) boundary: Boundary,
    pub(super) creasing: CreasingMethod,
    pub(super) linear: LinearTexcoords,
    pub(super) is_refined: bool,
}

/// One parsed tag.
struct SubdivTag<'a> {
    line: u64,
    name: &'a str,
    ints: Vec<u32>,
    floats: Vec<f64>,
    strings: Vec<&'a [u8]>,
}

impl SubdivTags {
    /// Reads the tag that follows `t` on a line.
    pub(super) fn read(
        &mut self,
        line: u64,
        mut words: LineTokens,
        counts: &ObjRowCounts,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        let name = words.next().unwrap_or_default();
        let Some(name) = KNOWN.into_iter().find(|known| known.as_bytes() == name) else {
            warnings.count("tags-skipped", || {
                (
                    FileLocation::Line(line),
                    format!("tags (t) of no known name were skipped, {} first", show(name)),
                )
            });
            return Ok(());
        };
        if name.ends_with("edit") {
            warnings.count("edits-skipped", || {
                let message = format!(
                    "hierarchical edits were skipped, {name} first: the cage is refined without them"
                );
                (FileLocation::Line(line), message)
            });
            return Ok(());
        }
        let tag = SubdivTag::parse(line, name, words)?;
        match name {
            "crease" => self.crease(&tag, counts, warnings),
            "corner" => {
                for (i, vertex) in tag.ints.iter().enumerate() {
                    let vertex = tag.checked_index(*vertex, counts.positions, ["vertex", "vertices"])?;
                    push(&mut self.corners, (vertex, tag.sharpness(i, tag.ints.len(), warnings)?))?;
                }
                Ok(())
            }
            "hole" => tag.ints.iter().try_for_each(|face| {
                push(&mut self.holes, tag.checked_index(*face, counts.faces, ["face", "faces"])?)
            }),
            _ => {
                if !self.rule(&tag) {
                    warnings.count("tag-values-skipped", || {
                        (
                            FileLocation::Line(line),
                            format!("tags whose value means nothing were skipped, {name} first"),
                        )
                    });
                }
                Ok(())
            }
        }
    }

    /// The line number of a crease.
    pub(super) fn line_of(&self, crease: usize) -> u64 {
        let after = self.lines.partition_point(|(first, _)| *first <= crease);
        self.lines.get(after.wrapping_sub(1)).map_or(0, |(_, line)| *line)
    }

    /// Reads pairs of vertices.
    fn crease(
        &mut self,
        tag: &SubdivTag,
        counts: &ObjRowCounts,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        if !tag.ints.len().is_multiple_of(2) {
            let message = format!("a crease names pairs of vertices, not {}", tag.ints.len());
            return Err(tag.error(message));
        }
        push(&mut self.lines, (self.creases.len(), tag.line))?;
        for (i, pair) in tag.ints.chunks_exact(2).enumerate() {
            let vertex = |k: usize| tag.checked_index(pair[k], counts.positions, ["vertex", "vertices"]);
            let ends = [vertex(0)?, vertex(1)?];
            push(&mut self.creases, (ends, tag.sharpness(i, tag.ints.len() / 2, warnings)?))?;
        }
        Ok(())
    }

    /// Applies a tag of the whole cage. Returns false if its value is not valid.
    fn rule(&mut self, tag: &SubdivTag) -> bool {
        match (tag.name, &tag.ints[..], &tag.strings[..]) {
            ("interpolateboundary", [rule], _) => {
                let entry = BOUNDARIES.iter().find(|(_, number)| number == rule);
                entry.inspect(|(boundary, _)| self.boundary = *boundary).is_some()
            }
            ("creasemethod", _, [b"normal"]) => {
                self.creasing = CreasingMethod::Uniform;
                true
            }
            ("creasemethod", _, [b"chaikin"]) => {
                self.creasing = CreasingMethod::Chaikin;
                true
            }
            ("facevaryinginterpolateboundary", [rule], _) => {
                let linear_rule = LinearTexcoords::ALL.get(*rule as usize);
                linear_rule.inspect(|linear| self.linear = **linear).is_some()
            }
            // Catmull–Clark cages already treat triangles by their own rules.
            ("smoothtriangles", _, [b"catmark"]) => true,
            // The scheme was read with the counts of the file, before its faces.
            (SCHEME, _, [name]) => scheme_named(name).is_some(),
            (REFINED, [], []) => {
                self.is_refined = true;
                true
            }
            _ => false,
        }
    }
}

impl<'a> SubdivTag<'a> {
    fn parse(line: u64, name: &'a str, mut words: LineTokens<'a>) -> Result<Self, ReadError> {
        let mut tag = Self { line, name, ints: Vec::new(), floats: Vec::new(), strings: Vec::new() };
        let counts = words.next().unwrap_or_default();
        let mut parts = counts.split(|b| *b == b'/');
        let mut count = || match parts.next() {
            // Some writers give only the counts of ints and floats.
            None => Some(0),
            Some(part) => integer(part).ok().and_then(|n| u64::try_from(n).ok()),
        };
        let (ints, floats, strings) = (count(), count(), count());
        let (Some(ints), Some(floats), Some(strings), None) = (ints, floats, strings, parts.next()) else {
            let message = format!("{name} says how many words follow as in 2/1/0, not {}", show(counts));
            return Err(tag.error(message));
        };
        let (declared, actual) =
            (ints.saturating_add(floats).saturating_add(strings), words.clone().count() as u64);
        if declared != actual {
            let message = format!(
                "{name} says that {} words follow, and there are {}",
                grouped(declared),
                grouped(actual)
            );
            return Err(tag.error(message));
        }
        // At most the number of words on the line.
        for word in words.by_ref().take(ints as usize) {
            let value = integer(word).ok().and_then(|value| u32::try_from(value).ok());
            let value = value.ok_or_else(|| {
                let message = format!("{} is no number of {name}, which are counted from 0", show(word));
                ReadError::new("index-out-of-range", FileLocation::Line(line), message)
            })?;
            push(&mut tag.ints, value)?;
        }
        for word in words.by_ref().take(floats as usize) {
            let value = number(word).filter(|value| !value.is_nan());
            let value = value.ok_or_else(|| {
                ReadError::new("not-a-number", FileLocation::Line(line), number_error(word))
            })?;
            push(&mut tag.floats, value)?;
        }
        for word in words {
            push(&mut tag.strings, word)?;
        }
        Ok(tag)
    }

    fn error(&self, message: String) -> ReadError {
        ReadError::new("bad-tag", FileLocation::Line(self.line), message)
    }

    /// The index, if it is below `n`.
    fn checked_index(&self, index: u32, n: usize, [one, many]: [&str; 2]) -> Result<u32, ReadError> {
        if (index as usize) < n {
            return Ok(index);
        }
        let message = format!(
            "{} names {one} {index}, counted from 0, and the file has {} {many}",
            self.name,
            grouped(n as u64)
        );
        Err(ReadError::new("index-out-of-range", FileLocation::Line(self.line), message))
    }

    /// The sharpness of item `i` of `n`: the tag has one number for all or one for each.
    fn sharpness(&self, i: usize, n: usize, warnings: &mut Warnings) -> Result<f64, ReadError> {
        let sharp = match &self.floats[..] {
            [all] => *all,
            each if each.len() == n => each[i],
            other => {
                let message = format!(
                    "{} has {} numbers for {n}: one for all or one for each is needed",
                    self.name,
                    other.len()
                );
                return Err(self.error(message));
            }
        };
        if sharp < 0.0 {
            warnings.count("sharpness-negative", || {
                (FileLocation::Line(self.line), "negative sharpnesses were taken as 0".to_owned())
            });
            return Ok(0.0);
        }
        Ok(sharp)
    }
}
