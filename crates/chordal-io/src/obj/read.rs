//! Reads Wavefront OBJ.
mod corner;
mod parts;

use super::CERTIFICATE;
use super::cage::CageBuilder;
use super::detect::{SKIPPED, escapes_folder, refuse_foreign};
use super::libraries::{LibraryRequest, read_libraries};
use super::part::parts_of;
use super::statements::ObjRowCounts;
use super::vertex_table::{ObjCorner, ObjVertexTable};
use crate::assemble::{self, RawMesh, too_many_rows};
use crate::certificate::CertificateComments;
use crate::faces::{Faces, SHORT_FACES};
use crate::groups::Groups;
use crate::grow::{push, push_many, with_room};
use crate::text::{LineTokens, integer, not_finite, number, number_error, show, text_of};
use crate::warnings::Warnings;
use crate::{
    Content, FileLocation, FileOpener, Frame, Limits, MATERIAL, PolygonSurface, ReadError, ReadOutcome,
    Scene, SceneAssets, TextureOrigin,
};
use chordal::Job;
use chordal::budget::par_map;
use chordal::explicit::subdivision::Scheme;
use chordal::explicit::{Attribute, Domain, Semantic};
use std::collections::BTreeMap;

/// Reads an OBJ file as one mesh part; or as one polygon cage, if it has subdivision tags or `limits.surface`
/// demands it.
///
/// The first rows of the mesh are the `v` lines in order. A position whose faces use several normals or
/// texture coordinates gets further rows after them, linked to it by `position_id`. Polygons are cut into
/// triangles. `usemtl`, `g`, `o` and `s` become face attributes [`Semantic::Group`] of the kinds
/// [`MATERIAL`], "g", "o" and "s", with their names in [`Scene::groups`]. Colours after a position become
/// [`Semantic::Color`]. The origin of texture coordinates is the lower left corner.
///
/// No other file is opened, so materials have only names. [`crate::read_with`] opens the libraries (`mtllib`)
/// below the folder of the OBJ, and their pictures; the materials become those of glTF, in [`Scene::assets`].
/// A missing library or picture is a warning.
///
/// If the file has no normals, or no texture coordinates, faces that refer to them are a warning, and their
/// corners have none. [`Conformance::Strict`](crate::Conformance) refuses them. An index beyond the existing
/// normals is always an error, since some normals are then missing and nobody knows which.
///
/// A cage has one row for each `v` line and one face for each polygon of three corners or more, both in the
/// order of the file. It keeps texture coordinates with their own indices, and no normals. Its tags are those
/// of OpenSubdiv's shapes, and those that [`super::write_polygons`] adds.
///
/// # Errors
/// [`ReadError`] at the line.
///
/// ```
/// use chordal_io::{Content, Limits, MATERIAL, obj};
/// let file = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl red\nf -4 -3 -2 -1\n";
/// let Content::Scene(scene) = obj::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2], [0, 2, 3]]);
/// assert_eq!(scene.groups[MATERIAL], ["", "red"]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    read_with(bytes, None, limits)
}

/// As [`read`], and opens material libraries and pictures if there is an opener.
pub(crate) fn read_with(
    bytes: &[u8],
    open: Option<&mut FileOpener<'_>>,
    limits: &Limits,
) -> Result<ReadOutcome, ReadError> {
    refuse_foreign(bytes)?;
    let text = text_of(bytes)?;
    read_parts(bytes, &parts_of(text, PART_BYTES), open, limits)
}

/// Reads a file whose text was cut into these parts.
fn read_parts(
    bytes: &[u8],
    parts: &[&[u8]],
    open: Option<&mut FileOpener<'_>>,
    limits: &Limits,
) -> Result<ReadOutcome, ReadError> {
    let job = Job::default().with_threads(limits.threads);
    let counts = par_map(&job, parts, |_, part| ObjRowCounts::scan(part));
    let counts = counts.into_iter().fold(ObjRowCounts::default(), ObjRowCounts::and);
    let mut reader = ObjReader::new(counts, limits)?;
    reader.libraries = open.is_some().then(Vec::new);
    reader.parts(parts, &job)?;
    reader.finish_file(bytes, open)
}

/// The bytes of a part. Chosen: long enough that starting one costs nothing, and short enough that its parsed
/// data is still in the cache when it is merged.
const PART_BYTES: usize = 256 << 10;

/// The coordinate frame of every OBJ.
const FRAME: Frame =
    Frame { up: None, metres_per_unit: None, texture_origin: Some(TextureOrigin::LowerLeft) };

/// The kinds of groups, in the order of `ObjReader::groups`.
const GROUPS: [&str; 4] = [MATERIAL, "g", "o", "s"];
/// The index of materials in it.
const MATERIALS: usize = 0;

/// The subdivision scheme of the polygons, if they are a cage.
fn scheme(counts: &ObjRowCounts, surface: Option<PolygonSurface>) -> Option<Scheme> {
    match surface {
        Some(PolygonSurface::Faceted) => None,
        Some(PolygonSurface::Limit(scheme)) => Some(scheme),
        None => (counts.tags > 0).then(|| counts.scheme.unwrap_or_default()),
    }
}

/// The group attributes of faces, and the group names by kind.
fn group_attributes(groups: [Groups; 4], n_faces: usize) -> Result<GroupedAttributes, ReadError> {
    let (mut attributes, mut names) = (Vec::new(), BTreeMap::new());
    for (kind, groups) in GROUPS.into_iter().zip(groups) {
        if let Some(attribute) = groups.attribute(kind, n_faces)? {
            attributes.push(attribute);
            if kind != "s" {
                names.insert(kind.to_owned(), groups.into_names());
            }
        }
    }
    Ok((attributes, names))
}

type GroupedAttributes = (Vec<Attribute>, BTreeMap<String, Vec<String>>);

struct ObjReader<'a> {
    limits: &'a Limits,
    counts: ObjRowCounts,
    warnings: Warnings,
    positions: Vec<[f64; 3]>,
    /// One entry for each position once any position has a colour; empty before.
    colors: Vec<[f64; 4]>,
    n_colored: usize,
    has_alpha: bool,
    texcoords: Vec<[f64; 2]>,
    normals: Vec<[f64; 3]>,
    rows: ObjVertexTable,
    faces: Faces,
    /// The builder of the cage, if the faces are read as one.
    cage: Option<CageBuilder>,
    groups: [Groups; 4],
    /// The text after each `mtllib`, if libraries are opened.
    libraries: Option<Vec<Box<[u8]>>>,
    corners: Vec<u32>,
    certificate: CertificateComments,
    n_known: u64,
    /// The number of lines of the parts so far.
    n_lines: u64,
}

impl<'a> ObjReader<'a> {
    fn new(counts: ObjRowCounts, limits: &'a Limits) -> Result<Self, ReadError> {
        counts.check(limits)?;
        let scheme = scheme(&counts, limits.surface);
        let of_triangles = |n: usize| if scheme.is_none() { n } else { 0 };
        Ok(Self {
            limits,
            counts,
            warnings: Warnings::default(),
            positions: with_room(counts.positions)?,
            colors: Vec::new(),
            n_colored: 0,
            has_alpha: false,
            texcoords: with_room(counts.texcoords)?,
            normals: with_room(counts.normals)?,
            rows: ObjVertexTable::new(of_triangles(counts.positions))?,
            faces: Faces::with_room(of_triangles(counts.faces))?,
            cage: scheme.map(|scheme| CageBuilder::new(scheme, counts.faces)).transpose()?,
            groups: Default::default(),
            libraries: None,
            corners: Vec::new(),
            certificate: CertificateComments::default(),
            n_known: 0,
            n_lines: 0,
        })
    }

    #[inline]
    fn statement(&mut self, line: u64, statement: &[u8]) -> Result<(), ReadError> {
        let mut tokens = LineTokens::new(statement);
        let Some(word) = tokens.next() else { return Ok(()) };
        if word.starts_with(b"#") {
            if let Some(piece) = statement.strip_prefix(CERTIFICATE.as_bytes()) {
                // A scene without content has only this statement.
                self.n_known += 1;
                self.certificate.take(piece, FileLocation::Line(line));
            }
            return Ok(());
        }
        self.n_known += 1;
        if let (b"t", Some(cage)) = (word, &mut self.cage) {
            return cage.tags.read(line, tokens, &self.counts, &mut self.warnings);
        }
        match word {
            b"v" => self.position(line, tokens),
            b"vt" => self.texcoord(line, tokens),
            b"vn" => self.normal(line, tokens),
            b"f" | b"fo" => self.face(line, tokens),
            b"usemtl" => self.group(MATERIALS, line, tokens.rest()),
            b"mtllib" => self.library(line, tokens.rest()),
            b"g" => self.group(1, line, tokens.rest()),
            b"o" => self.group(2, line, tokens.rest()),
            b"s" => self.smoothing(line, tokens.rest()),
            _ => {
                self.other(line, word);
                Ok(())
            }
        }
    }

    /// Parses up to `N` numbers, and returns how many there are.
    #[inline]
    fn numbers<const N: usize>(
        line: u64,
        what: &str,
        tokens: LineTokens,
    ) -> Result<([f64; N], usize), ReadError> {
        let (mut values, mut n) = ([0.0; N], 0);
        for token in tokens {
            if n == N {
                let message = format!("{what} has more than {N} numbers");
                return Err(ReadError::new("wrong-width", FileLocation::Line(line), message));
            }
            values[n] = number(token).ok_or_else(|| {
                ReadError::new("not-a-number", FileLocation::Line(line), number_error(token))
            })?;
            n += 1;
        }
        Ok((values, n))
    }

    #[inline]
    fn position(&mut self, line: u64, tokens: LineTokens) -> Result<(), ReadError> {
        let (values, n) = Self::numbers::<7>(line, "v", tokens.clone())?;
        if !matches!(n, 3 | 4 | 6 | 7) {
            let message = format!("v has {n} numbers; 3 are needed, 4 with a weight, 6 or 7 with a colour");
            return Err(ReadError::new("wrong-width", FileLocation::Line(line), message));
        }
        let [x, y, z, r, g, b, a] = values;
        if let Some(k) = values[..3].iter().position(|x| !x.is_finite())
            && !self.limits.drop_nonfinite
        {
            return Err(not_finite(tokens.clone().nth(k).unwrap_or_default(), FileLocation::Line(line)));
        }
        if n == 4 && values[3] != 1.0 {
            self.warnings.count("weights-skipped", || {
                (
                    FileLocation::Line(line),
                    "weights of vertices were skipped; they matter to free-form shapes only",
                )
            });
        }
        if n >= 6 || !self.colors.is_empty() {
            // Positions without a colour are white.
            let n_missing = self.positions.len() - self.colors.len();
            push_many(&mut self.colors, [1.0; 4], n_missing)?;
            let color = if n < 6 { [1.0; 4] } else { [r, g, b, if n == 7 { a } else { 1.0 }] };
            push(&mut self.colors, color)?;
            self.n_colored += usize::from(n >= 6);
            self.has_alpha |= n == 7;
        }
        push(&mut self.positions, [x, y, z])
    }

    fn texcoord(&mut self, line: u64, tokens: LineTokens) -> Result<(), ReadError> {
        let ([u, v, w], n) = Self::numbers::<3>(line, "vt", tokens)?;
        if n == 0 {
            return Err(ReadError::new(
                "wrong-width",
                FileLocation::Line(line),
                "vt has no numbers; 1 to 3 are needed",
            ));
        }
        if w != 0.0 {
            let message = "third texture coordinates were skipped";
            self.warnings.count("texcoord-w-skipped", || (FileLocation::Line(line), message.to_owned()));
        }
        push(&mut self.texcoords, [u, v])
    }

    fn normal(&mut self, line: u64, tokens: LineTokens) -> Result<(), ReadError> {
        let (normal, n) = Self::numbers::<3>(line, "vn", tokens)?;
        if n != 3 {
            let message = format!("vn has {n} numbers where 3 are needed");
            return Err(ReadError::new("wrong-width", FileLocation::Line(line), message));
        }
        push(&mut self.normals, normal)
    }

    #[inline]
    fn face(&mut self, line: u64, tokens: LineTokens) -> Result<(), ReadError> {
        if self.cage.is_some() {
            return self.polygon(line, tokens);
        }
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        for token in tokens {
            let corner = self.corner(line, token)?;
            push(&mut corners, self.rows.row(corner)?)?;
        }
        self.end_face(line, corners)
    }

    #[inline]
    fn end_face(&mut self, line: u64, corners: Vec<u32>) -> Result<(), ReadError> {
        match corners.len() {
            0 => {
                return Err(ReadError::new(
                    "too-few-corners",
                    FileLocation::Line(line),
                    "a face has no corners",
                ));
            }
            1 | 2 => {
                self.warnings.count("short-faces", || (FileLocation::Line(line), SHORT_FACES.to_owned()))
            }
            _ => self.faces.push(&corners, line)?,
        }
        self.corners = corners;
        let n = self.faces.n_triangles() as u64;
        if n > self.limits.rows {
            return Err(too_many_rows(FileLocation::Line(line), "triangles", n, self.limits.rows));
        }
        Ok(())
    }

    /// Reads a face of a cage.
    fn polygon(&mut self, line: u64, tokens: LineTokens) -> Result<(), ReadError> {
        for token in tokens {
            let corner = self.corner(line, token)?;
            self.cage.iter_mut().try_for_each(|cage| cage.corner(corner))?;
        }
        self.cage.iter_mut().try_for_each(|cage| cage.end_face(line, &mut self.warnings))
    }

    /// The number of triangles so far, or of faces of the cage.
    fn n_faces(&self) -> usize {
        self.cage.as_ref().map_or(self.faces.n_triangles(), CageBuilder::n_faces)
    }

    fn group(&mut self, kind: usize, line: u64, name: &[u8]) -> Result<(), ReadError> {
        let text = String::from_utf8_lossy(name);
        if matches!(text, std::borrow::Cow::Owned(_)) {
            self.warnings.count("name-not-utf8", || {
                (
                    FileLocation::Line(line),
                    format!("names that are not UTF-8 were changed, {} first", show(name)),
                )
            });
        }
        let n_faces = self.n_faces();
        self.groups[kind].name(&text, n_faces)
    }

    /// Stores the libraries of a statement, or counts that they are not opened.
    fn library(&mut self, line: u64, rest: &[u8]) -> Result<(), ReadError> {
        if let Some(libraries) = &mut self.libraries {
            // Exporters that join files repeat the statement.
            return match libraries.last().is_some_and(|last| **last == *rest) {
                true => Ok(()),
                false => push(libraries, rest.into()),
            };
        }
        let (code, message) = match escapes_folder(rest) {
            true => ("mtllib-outside", "material libraries outside the folder were skipped"),
            false => ("mtllib-skipped", "material libraries were not opened; materials keep their names"),
        };
        self.warnings.count(code, || (FileLocation::Line(line), message));
        Ok(())
    }

    fn smoothing(&mut self, line: u64, text: &[u8]) -> Result<(), ReadError> {
        let number = match integer(text) {
            _ if text == b"off" => 0,
            Ok(number) if u32::try_from(number).is_ok() => number as u32,
            _ => {
                self.warnings.count("smoothing-group", || {
                    (
                        FileLocation::Line(line),
                        format!(
                            "smoothing groups that are no number were taken as off, {} first",
                            show(text)
                        ),
                    )
                });
                0
            }
        };
        let n_faces = self.n_faces();
        self.groups[3].number(number, n_faces)
    }

    /// Counts and skips a statement.
    fn other(&mut self, line: u64, word: &[u8]) {
        let place = FileLocation::Line(line);
        let count = |code, message: &str| self.warnings.count(code, || (place, message.to_owned()));
        match word {
            b"l" => count("lines-skipped", "lines (l) were skipped"),
            b"p" => count("points-skipped", "points (p) were skipped"),
            b"t" => count("tags-skipped", "subdivision tags (t) were skipped: the faces are taken as flat"),
            _ => {
                let contains_word = |list: &[&str]| list.iter().any(|name| name.as_bytes() == word);
                match SKIPPED.iter().position(|(_, list)| contains_word(list)) {
                    Some(i) => {
                        count(["free-form-skipped", "display-skipped", "scripts-skipped"][i], SKIPPED[i].0)
                    }
                    None => {
                        self.n_known -= 1;
                        let message = format!(
                            "lines that start with no known statement were skipped, {} first",
                            show(word)
                        );
                        count("unknown-statement", &message);
                    }
                }
            }
        }
    }

    /// Opens the libraries if requested, and finishes.
    fn finish_file(
        mut self,
        bytes: &[u8],
        open: Option<&mut FileOpener<'_>>,
    ) -> Result<ReadOutcome, ReadError> {
        let mut assets = Box::<SceneAssets>::default();
        if let (Some(open), Some(statements)) = (open, self.libraries.take()) {
            let names = self.groups[MATERIALS].names();
            let request = LibraryRequest { statements: &statements, names, n_bytes: bytes.len() as u64 };
            *assets = read_libraries(&request, open, self.limits, &mut self.warnings);
        }
        let mut outcome = self.finish()?;
        match &mut outcome.content {
            Content::Scene(scene) if scene.groups.contains_key(MATERIAL) => scene.assets = assets,
            Content::Polygons(polygons) if polygons.groups.contains_key(MATERIAL) => polygons.assets = assets,
            _ => {}
        }
        Ok(outcome)
    }

    fn finish(mut self) -> Result<ReadOutcome, ReadError> {
        if self.n_known == 0 {
            let message = "not Wavefront OBJ: there is no v, f or any other of its statements";
            return Err(ReadError::new("not-wavefront", FileLocation::File, message));
        }
        // Other languages have one-letter words, too.
        if self.positions.is_empty() && self.warnings.has("unknown-statement") {
            let message =
                "not Wavefront OBJ: there is no vertex (v), and lines that start with no known statement";
            return Err(ReadError::new("not-wavefront", FileLocation::File, message));
        }
        if let Some(cage) = self.cage.take() {
            return self.finish_cage(cage);
        }
        let mut raw = RawMesh { attributes: self.vertex_attributes()?, ..RawMesh::default() };
        if self.rows.has_splits() {
            let mut id = with_room(self.rows.len())?;
            id.extend(self.rows.corners().map(|corner| corner.position));
            raw.position_id = Some(id);
            self.positions
                .try_reserve_exact(self.rows.len() - self.positions.len())
                .map_err(|_| crate::grow::out_of_memory(self.rows.len()))?;
            // The first rows are the file's vertices themselves; the rows after them repeat a
            // position with another normal or texture coordinate.
            for corner in self.rows.corners().skip(self.positions.len()) {
                let position = self.positions[corner.position as usize];
                self.positions.push(position);
            }
        }
        raw.positions = self.positions;
        // Before the faces are cut, so that the memory of both is never held at once.
        drop((self.corners, self.rows));
        raw.faces = self.faces.cut(&raw.positions, FileLocation::Line, &mut self.warnings);
        let (groups, names) = group_attributes(self.groups, raw.faces.len())?;
        raw.attributes.extend(groups);
        let mesh = assemble::mesh(raw, self.limits, &mut self.warnings)?;
        let mut scene = Scene::from_mesh("", mesh, FRAME);
        scene.certificate = self.certificate.finish(&mut self.warnings);
        scene.groups = names;
        Ok(ReadOutcome { content: Content::Scene(scene), warnings: self.warnings.into_list() })
    }

    fn finish_cage(mut self, cage: CageBuilder) -> Result<ReadOutcome, ReadError> {
        let n_faces = cage.n_faces();
        let (positions, texcoords) =
            (std::mem::take(&mut self.positions), std::mem::take(&mut self.texcoords));
        let n_positions = positions.len();
        let mut polygons = cage.finish(positions, texcoords, &mut self.warnings)?;
        polygons.attributes.extend(self.color(n_positions, |row| row)?);
        let (groups, names) = group_attributes(self.groups, n_faces)?;
        polygons.attributes.extend(groups);
        for attribute in &mut polygons.attributes {
            assemble::clean(attribute, &mut self.warnings);
        }
        polygons.groups = names;
        polygons.frame = FRAME;
        polygons.certificate = self.certificate.finish(&mut self.warnings);
        Ok(ReadOutcome { content: Content::Polygons(polygons), warnings: self.warnings.into_list() })
    }

    fn vertex_attributes(&mut self) -> Result<Vec<Attribute>, ReadError> {
        let mut attributes = Vec::new();
        let texcoords = std::mem::take(&mut self.texcoords);
        let normals = std::mem::take(&mut self.normals);
        let texcoord = self.stream(&texcoords, "texcoords", |corner| corner.texcoord)?;
        let normal = self.stream(&normals, "normals", |corner| corner.normal)?;
        let vertex = |semantic, width, values| Attribute { semantic, domain: Domain::Vertex, width, values };
        attributes.extend(normal.map(|values| vertex(Semantic::Normal, 3, values)));
        attributes.extend(texcoord.map(|values| vertex(Semantic::TexCoord(0), 2, values)));
        if self.n_colored > 0 {
            let rows: Vec<u32> = self.rows.corners().map(|corner| corner.position).collect();
            attributes.extend(self.color(rows.len(), |row| rows[row] as usize)?);
        }
        Ok(attributes)
    }

    /// The colours of the rows, from their positions; `None` if no position has one.
    fn color(
        &mut self,
        n_rows: usize,
        position: impl Fn(usize) -> usize,
    ) -> Result<Option<Attribute>, ReadError> {
        if self.n_colored == 0 {
            return Ok(None);
        }
        let white = (self.colors.len() - self.n_colored) as u64;
        self.warnings.count_all("colors-missing", white, "vertices without a colour are white");
        let width = if self.has_alpha { 4 } else { 3 };
        let mut values = with_room(n_rows * width)?;
        for row in 0..n_rows {
            values.extend_from_slice(&self.colors[position(row)][..width]);
        }
        Ok(Some(Attribute { semantic: Semantic::Color(0), domain: Domain::Vertex, width, values }))
    }

    /// One value for each row, zeros for corners without one; `None` if no corner has one.
    fn stream<const N: usize>(
        &mut self,
        list: &[[f64; N]],
        what: &'static str,
        pick: fn(ObjCorner) -> u32,
    ) -> Result<Option<Vec<f64>>, ReadError> {
        let mut used = vec![false; list.len()];
        // 0 stands for a corner without one.
        self.rows.corners().filter_map(|c| pick(c).checked_sub(1)).for_each(|i| used[i as usize] = true);
        let n_unused = used.iter().filter(|u| !**u).count() as u64;
        let [unused, missing] = match what {
            "normals" => ["normals-unused", "normals-missing"],
            _ => ["texcoords-unused", "texcoords-missing"],
        };
        self.warnings.count_all(unused, n_unused, &format!("{what} that no face names were dropped"));
        if n_unused == list.len() as u64 {
            return Ok(None);
        }
        let (mut values, mut n_missing) = (with_room(self.rows.len() * N)?, 0);
        for (row, corner) in self.rows.corners().enumerate() {
            let value = pick(corner).checked_sub(1).map(|i| list[i as usize]);
            n_missing += u64::from(value.is_none() && self.rows.is_used(row));
            values.extend_from_slice(&value.unwrap_or([0.0; N]));
        }
        self.warnings.count_all(
            missing,
            n_missing,
            &format!("vertices of faces have no {what}: theirs are 0"),
        );
        Ok(Some(values))
    }
}
