//! `CageBuilder`: builds a cage from the polygons of an OBJ.
use super::tags::SubdivTags;
use super::vertex_table::ObjCorner;
use crate::assemble::check_extent;
use crate::faces::SHORT_FACES;
use crate::grow::{push, with_room};
use crate::polygons::Polygons;
use crate::text::{grouped, not_finite};
use crate::warnings::Warnings;
use crate::{FileLocation, Frame, ReadError};
use chordal::budget::advice::{Message, Setting};
use chordal::explicit::subdivision::{CornerTexcoords, Scheme};
use chordal::explicit::{Cage, InvalidCage};

/// The polygons so far.
#[derive(Debug)]
pub(super) struct CageBuilder {
    scheme: Scheme,
    pub(super) tags: SubdivTags,
    /// The end of each face's corners.
    ends: Vec<u32>,
    corners: Vec<u32>,
    /// One entry for each corner once any corner has texture coordinates; empty before.
    texcoords: Vec<u32>,
    n_normals: u64,
    /// Faces of fewer than three corners, as face indices of the file.
    short: Vec<u32>,
    /// The vertices of a face, sorted, to detect duplicates.
    sorted: Vec<u32>,
}

impl CageBuilder {
    pub(super) fn new(scheme: Scheme, n_faces: usize) -> Result<Self, ReadError> {
        Ok(Self {
            scheme,
            tags: SubdivTags::default(),
            ends: with_room(n_faces)?,
            corners: Vec::new(),
            texcoords: Vec::new(),
            n_normals: 0,
            short: Vec::new(),
            sorted: Vec::new(),
        })
    }

    /// The number of faces so far.
    pub(super) fn n_faces(&self) -> usize {
        self.ends.len()
    }

    /// Adds a corner to the current face.
    #[inline]
    pub(super) fn corner(&mut self, corner: ObjCorner) -> Result<(), ReadError> {
        if corner.texcoord > 0 && self.texcoords.is_empty() {
            self.texcoords = with_room(self.corners.len())?;
            self.texcoords.resize(self.corners.len(), CornerTexcoords::NONE);
        }
        push(&mut self.corners, corner.position)?;
        if corner.texcoord > 0 || !self.texcoords.is_empty() {
            // Rows are counted from 1; 0, for none, becomes `CornerTexcoords::NONE`.
            push(&mut self.texcoords, corner.texcoord.wrapping_sub(1))?;
        }
        self.n_normals += u64::from(corner.normal > 0);
        Ok(())
    }

    /// Ends the current face.
    pub(super) fn end_face(&mut self, line: u64, warnings: &mut Warnings) -> Result<(), ReadError> {
        let start = self.ends.last().map_or(0, |end| *end as usize);
        let place = FileLocation::Line(line);
        let Ok(end) = u32::try_from(self.corners.len()) else {
            return Err(crate::grow::out_of_memory(self.corners.len()));
        };
        let n = self.corners.len() - start;
        if n == 0 {
            return Err(ReadError::new("too-few-corners", place, "a face has no corners"));
        }
        if n < 3 {
            // The number of this face in the file, by which tags of holes name faces: the skipped
            // ones count.
            let number = self.ends.len() + self.short.len();
            push(&mut self.short, number as u32)?;
            self.corners.truncate(start);
            self.texcoords.truncate(start);
            warnings.count("short-faces", || (place, SHORT_FACES.to_owned()));
            return Ok(());
        }
        if self.scheme == Scheme::Loop && n != 3 {
            let message = format!("Loop subdivision takes triangles alone, and this face has {n} corners: ");
            let message = Message::from(message).value(Setting::Surface, "catmull-clark").words(" takes any");
            return Err(ReadError::new("not-triangles", place, message));
        }
        self.sorted.clear();
        self.sorted.extend_from_slice(&self.corners[start..]);
        self.sorted.sort_unstable();
        if let Some(pair) = self.sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            let message = format!("a face uses vertex {} twice, which no cage can refine: ", pair[0] + 1);
            let message =
                Message::from(message).value(Setting::Surface, "faceted").words(" takes it as triangles");
            return Err(ReadError::new("vertex-twice", place, message));
        }
        push(&mut self.ends, end)
    }

    /// Builds the cage, with the texture coordinates of its corners.
    pub(super) fn finish(
        self,
        positions: Vec<[f64; 3]>,
        texcoords: Vec<[f64; 2]>,
        warnings: &mut Warnings,
    ) -> Result<Polygons, ReadError> {
        if let Some(row) = positions.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            let error = not_finite(b"of a cage", FileLocation::Row { list: "vertex", row: row as u64 });
            let message = error.message.words(": only triangles are taken apart, with ");
            return Err(ReadError { message: message.value(Setting::Surface, "faceted"), ..error });
        }
        check_extent(&positions)?;
        self.count_oddities(positions.len(), warnings)?;
        let Self { tags, ends, corners, texcoords: rows, short, scheme, .. } = self;
        let holes = kept_holes(&tags.holes, &short, warnings)?;
        let starts = std::iter::once(0).chain(ends.iter().copied());
        let faces = starts.zip(&ends).map(|(start, end)| &corners[start as usize..*end as usize]);
        let built = Cage::new(positions, faces)
            .and_then(|cage| cage.with_scheme(scheme))
            .map(|cage| cage.with_boundary(tags.boundary).with_creasing(tags.creasing))
            .and_then(
                |cage| if tags.creases.is_empty() { Ok(cage) } else { cage.with_creases(&tags.creases) },
            )
            .and_then(|cage| cage.with_sharp_vertices(&tags.corners))
            .and_then(|cage| cage.with_holes(&holes))
            .map(|cage| if tags.is_refined { cage.with_corners_listed() } else { cage });
        let cage = built.map_err(|error| invalid(&error, &tags))?;
        if rows.iter().all(|row| *row == CornerTexcoords::NONE) {
            let message = "texcoords that no face names were dropped";
            warnings.count_all("texcoords-unused", texcoords.len() as u64, message);
            return Ok(Polygons::from_cage(cage, Frame::default()));
        }
        let texcoords =
            finite(CornerTexcoords { values: texcoords, corners: rows, linear: tags.linear }, warnings);
        let cage = cage.with_texcoords(texcoords).map_err(|error| invalid(&error, &tags))?;
        Ok(Polygons::from_cage(cage, Frame::default()))
    }

    /// Counts properties that are legal but rarely intended, and data that a cage does not use. Changes
    /// nothing.
    fn count_oddities(&self, n_vertices: usize, warnings: &mut Warnings) -> Result<(), ReadError> {
        warnings.count_all("no-vertices", u64::from(n_vertices == 0), "the file has no vertices");
        warnings.count_all("no-faces", u64::from(self.ends.is_empty()), "the file has no faces");
        let mut used = with_room(n_vertices)?;
        used.resize(n_vertices, false);
        self.corners.iter().for_each(|vertex| used[*vertex as usize] = true);
        let isolated = used.iter().filter(|used| !**used).count() as u64;
        if !self.ends.is_empty() {
            warnings.count_all("isolated-vertices", isolated, "vertices belong to no face");
        }
        let message = "normals at corners of a cage were skipped: its surface has its own";
        warnings.count_all("normals-skipped", self.n_normals, message);
        Ok(())
    }
}

/// Removes texture coordinates that are not finite, so that their corners have none.
fn finite(mut texcoords: CornerTexcoords, warnings: &mut Warnings) -> CornerTexcoords {
    let is_finite = |p: &[f64; 2]| p.iter().all(|x| x.is_finite());
    if texcoords.values.iter().all(is_finite) {
        return texcoords;
    }
    let values = &texcoords.values;
    let is_wrong = |row: &&mut u32| values.get(**row as usize).is_some_and(|p| !is_finite(p));
    let mut n_corners = 0;
    for row in texcoords.corners.iter_mut().filter(is_wrong) {
        *row = CornerTexcoords::NONE;
        n_corners += 1;
    }
    // The rows stay, so that other corners keep their indices; but a cage refuses numbers that are
    // not finite, even if no corner uses them.
    texcoords.values.iter_mut().filter(|p| !is_finite(p)).for_each(|p| *p = [0.0; 2]);
    let message = "corners whose texture coordinates are not finite have none";
    warnings.count_all("attribute-not-finite", n_corners, message);
    texcoords
}

/// The holes, renumbered for the kept faces.
fn kept_holes(holes: &[u32], short: &[u32], warnings: &mut Warnings) -> Result<Vec<u32>, ReadError> {
    let mut kept = with_room(holes.len())?;
    for hole in holes {
        // The index at which the hole would stand in the sorted list is the number of skipped faces
        // before it.
        match short.binary_search(hole) {
            Ok(_) => {
                warnings.count_all("holes-skipped", 1, "holes in faces that were skipped were skipped too")
            }
            Err(before) => kept.push(hole - before as u32),
        }
    }
    Ok(kept)
}

/// The error for a cage whose rows are valid but whose tags are not: a crease along a pair that is no edge.
fn invalid(error: &InvalidCage, tags: &SubdivTags) -> ReadError {
    match error {
        InvalidCage::NoSuchEdge { ends: [a, b] } => {
            let crease = tags.creases.iter().position(|(ends, _)| ends == &[*a, *b]);
            let line = tags.line_of(crease.unwrap_or_default());
            let message = format!(
                "there is no edge between vertices {} and {}, counted from 0, to be sharp",
                grouped(u64::from(*a)),
                grouped(u64::from(*b))
            );
            ReadError::new("no-such-edge", FileLocation::Line(line), message)
        }
        other => ReadError::new("invalid-cage", FileLocation::File, other.to_string()),
    }
}
