//! `UsdCageBuilder`: one cage of all meshes of a shape, which are subdivided by the same rules.
//!
//! Source: Pixar Animation Studios, *UsdGeomMesh*, openusd.org, 2024.
use super::mesh::{UsdMeshRequest, face_groups, holes};
use super::primvar::{Interpolation, row_numbers, row_place};
use super::stage::{StagePrim, UsdStage};
use super::topology::UsdTopology;
use crate::assemble::check_extent;
use crate::faces::SHORT_FACES;
use crate::grow::{push, push_many, with_room};
use crate::matrix::IDENTITY;
use crate::warnings::Warnings;
use crate::{Frame, Polygons, ReadError};
use chordal::budget::advice::{Message, Setting};
use chordal::explicit::subdivision::{Boundary, CornerTexcoords, CreasingMethod, LinearTexcoords, Scheme};
use chordal::explicit::{Attribute, Cage, Domain, Semantic};
use chordal::math::greater;
use std::collections::BTreeMap;

/// Names of boundary rules, and of rules for texture coordinates, in the order of their numbers.
pub(super) const BOUNDARIES: [(Boundary, &str); 3] =
    [(Boundary::None, "none"), (Boundary::EdgeOnly, "edgeOnly"), (Boundary::EdgeAndCorner, "edgeAndCorner")];
pub(super) const LINEAR: [&str; 6] =
    ["none", "cornersOnly", "cornersPlus1", "cornersPlus2", "boundaries", "all"];
/// Chordal's own properties: the decay of creases' sharpness, and whether implicit corners are listed.
pub(super) const CREASING: &str = "chordal:creasing";
pub(super) const CHAIKIN: &str = "chaikin";
pub(super) const REFINED: &str = "chordal:refined";

/// The name of a scheme in USD.
pub(super) fn scheme_name(scheme: Scheme) -> &'static str {
    match scheme {
        Scheme::CatmullClark => "catmullClark",
        Scheme::Loop => "loop",
        Scheme::Bilinear => "bilinear",
    }
}

/// The rules by which a mesh is subdivided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UsdCageRules {
    /// `None` for plain polygons.
    pub scheme: Option<Scheme>,
    pub boundary: Boundary,
    pub linear: LinearTexcoords,
    pub creasing: CreasingMethod,
    pub is_refined: bool,
}

/// The rules of a mesh.
pub(super) fn rules(stage: &UsdStage<'_, '_>, prim: &StagePrim) -> Result<UsdCageRules, ReadError> {
    let unknown = |name: &str, word: &str| {
        let what = "rules of subdivision that are not known were ignored";
        stage.note("rules-skipped", what, &format!("{word} of {}.{name}", prim.path));
    };
    // Where nothing is said, the fallbacks of UsdGeomMesh hold: catmullClark, edgeAndCorner and
    // cornersPlus1.
    let name = "subdivisionScheme";
    let scheme = match stage.word(prim, name)?.as_deref() {
        Some("none") => None,
        None => Some(Scheme::CatmullClark),
        Some(word) => {
            let scheme = Scheme::ALL.into_iter().find(|scheme| scheme_name(*scheme) == word);
            if scheme.is_none() {
                unknown(name, word);
            }
            scheme
        }
    };
    let name = "interpolateBoundary";
    let boundary = match stage.word(prim, name)? {
        None => Boundary::EdgeAndCorner,
        Some(word) => BOUNDARIES.iter().find(|(_, known)| *known == word).map_or_else(
            || {
                unknown(name, &word);
                Boundary::EdgeAndCorner
            },
            |(boundary, _)| *boundary,
        ),
    };
    let name = "faceVaryingLinearInterpolation";
    let linear = match stage.word(prim, name)? {
        None => LinearTexcoords::CornersPlus1,
        Some(word) => LINEAR.iter().position(|known| *known == word).map_or_else(
            || {
                unknown(name, &word);
                LinearTexcoords::CornersPlus1
            },
            |at| LinearTexcoords::ALL[at],
        ),
    };
    let name = "triangleSubdivisionRule";
    if let Some(word) = stage.word(prim, name)?.filter(|word| word != "catmullClark") {
        unknown(name, &word);
    }
    let is_chaikin = stage.word(prim, CREASING)?.is_some_and(|word| word == CHAIKIN);
    let creasing = if is_chaikin { CreasingMethod::Chaikin } else { CreasingMethod::Uniform };
    let is_refined = stage.numbers(prim, REFINED)?.is_some_and(|flag| flag.first() == Some([1.0]));
    Ok(UsdCageRules { scheme, boundary, linear, creasing, is_refined })
}

/// A mesh of the cage, as a node places it.
pub(super) struct UsdCageMesh<'s> {
    pub request: &'s UsdMeshRequest,
    pub matrix: [f64; 16],
}

/// All meshes so far.
pub(super) struct UsdCageBuilder {
    rules: UsdCageRules,
    positions: Vec<[f64; 3]>,
    ends: Vec<u32>,
    corners: Vec<u32>,
    texcoords: Vec<[f64; 2]>,
    /// For each corner a row of texture coordinates.
    rows: Vec<u32>,
    creases: Vec<([u32; 2], f64)>,
    sharp: Vec<(u32, f64)>,
    holes: Vec<u32>,
    /// For each kind of group a number for each face; the list may end early.
    groups: BTreeMap<String, Vec<f64>>,
    /// The number of each face's mesh, and their names.
    meshes: Vec<f64>,
    names: Vec<String>,
    colors: Vec<f64>,
    n_colored: usize,
}

impl UsdCageBuilder {
    pub(super) fn new(rules: UsdCageRules) -> Self {
        Self {
            rules,
            positions: Vec::new(),
            ends: Vec::new(),
            corners: Vec::new(),
            texcoords: Vec::new(),
            rows: Vec::new(),
            creases: Vec::new(),
            sharp: Vec::new(),
            holes: Vec::new(),
            groups: BTreeMap::new(),
            meshes: Vec::new(),
            names: vec![String::new()],
            colors: Vec::new(),
            n_colored: 0,
        }
    }

    /// Adds a mesh.
    ///
    /// # Errors
    /// If it is damaged, or not a cage.
    pub(super) fn add(
        &mut self,
        stage: &UsdStage<'_, '_>,
        mesh: &UsdCageMesh<'_>,
        warnings: &mut Warnings,
    ) -> Result<(), ReadError> {
        let request = mesh.request;
        let prim = &request.prim;
        let Some(mut topology) = UsdTopology::read(stage, prim)? else { return Ok(()) };
        topology.check_finite(prim)?;
        let first = self.positions.len() as u32;
        // A mirror turns faces inside out.
        if determinant(&mesh.matrix) < 0.0 {
            topology.is_left_handed = !topology.is_left_handed;
        }
        for point in &topology.points {
            push(&mut self.positions, moved(&mesh.matrix, *point))?;
        }
        self.names.push(stage.name(prim));
        let numbers = self.faces(stage, request, &topology, warnings)?;
        self.tags(stage, prim, first, topology.points.len())?;
        let is_hole = holes(stage, request, topology.counts.len())?;
        for (is_hole, number) in is_hole.into_iter().zip(numbers) {
            if let (true, Some(number)) = (is_hole, number) {
                push(&mut self.holes, number)?;
            }
        }
        self.colors(stage, prim, &topology)?;
        for name in ["normals", "primvars:normals"] {
            if stage.attribute(prim, name)?.is_some() {
                let what = "normals of meshes that are subdivided were skipped: the surface has its own";
                stage.note("normals-skipped", what, &prim.path);
            }
        }
        Ok(())
    }

    /// Adds the faces; returns the new index of each kept face.
    fn faces(
        &mut self,
        stage: &UsdStage<'_, '_>,
        request: &UsdMeshRequest,
        topology: &UsdTopology,
        warnings: &mut Warnings,
    ) -> Result<Vec<Option<u32>>, ReadError> {
        let prim = &request.prim;
        let name =
            request.texcoords.as_ref().map_or("primvars:st".to_owned(), |name| format!("primvars:{name}"));
        let mut texcoords = stage.primvar(prim, &name, 2, topology.size())?;
        if let Some(texcoords) =
            texcoords.as_mut().filter(|st| st.interpolation == Interpolation::FaceVarying)
        {
            texcoords.share_rows()?;
        }
        for other in stage.property_names(prim, "primvars:") {
            let is_read = [&*name, "primvars:displayColor", "primvars:normals"].contains(&&*other);
            if !is_read && !other.ends_with(":indices") {
                stage.note("primvars-unread", "values of meshes that are not read were left out", &other);
            }
        }
        let groups = face_groups(stage, request, topology.counts.len())?;
        // The points of this mesh are already in the list, as the last ones.
        let (first, first_row) =
            ((self.positions.len() - topology.points.len()) as u32, self.texcoords.len() as u32);
        if let Some(texcoords) = &texcoords {
            for row in texcoords.numbers.values.chunks_exact(2) {
                push(&mut self.texcoords, [row[0], row[1]])?;
            }
        }
        let mut numbers = with_room(topology.counts.len())?;
        let mut sorted = Vec::new();
        for (face_idx, face) in topology.faces().enumerate() {
            if face.n < 3 {
                let place = || (row_place("faceVertexCounts", face_idx), SHORT_FACES.to_owned());
                warnings.count("short-faces", place);
                numbers.push(None);
                continue;
            }
            sorted.clear();
            for corner in face.corners() {
                let point = topology.corners[corner];
                push(&mut sorted, point)?;
                push(&mut self.corners, first + point)?;
                let row = texcoords.as_ref().map(|texcoords| match texcoords.interpolation {
                    Interpolation::Constant => texcoords.row(0),
                    Interpolation::Uniform => texcoords.row(face_idx),
                    Interpolation::Vertex => texcoords.row(point as usize),
                    Interpolation::FaceVarying => texcoords.row(corner),
                });
                push(&mut self.rows, row.map_or(CornerTexcoords::NONE, |row| first_row + row))?;
            }
            self.check_face(prim, face_idx, &mut sorted)?;
            numbers.push(Some(self.ends.len() as u32));
            push(&mut self.ends, self.corners.len() as u32)?;
            for (kind, numbers) in &groups {
                if !self.groups.contains_key(kind) {
                    self.groups.insert(kind.clone(), Vec::new());
                }
                let Some(values) = self.groups.get_mut(kind) else { continue };
                // Faces of earlier meshes without groups of this kind belong to none.
                let n_more = (self.ends.len() - 1).saturating_sub(values.len());
                push_many(values, 0.0, n_more)?;
                push(values, f64::from(numbers[face_idx]))?;
            }
            push(&mut self.meshes, (self.names.len() - 1) as f64)?;
        }
        Ok(numbers)
    }

    fn check_face(&self, prim: &StagePrim, face_idx: usize, sorted: &mut [u32]) -> Result<(), ReadError> {
        let place = row_place("faceVertexCounts", face_idx);
        if self.rules.scheme == Some(Scheme::Loop) && sorted.len() != 3 {
            let message = format!("{}: Loop subdivision takes triangles alone: ", prim.path);
            let message = Message::from(message).value(Setting::Surface, "catmull-clark").words(" takes any");
            return Err(ReadError::new("not-triangles", place, message));
        }
        sorted.sort_unstable();
        let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) else { return Ok(()) };
        let message =
            format!("{}: a face uses point {} twice, which no cage can refine: ", prim.path, pair[0]);
        let message =
            Message::from(message).value(Setting::Surface, "faceted").words(" takes it as triangles");
        Err(ReadError::new("vertex-twice", place, message))
    }

    /// Adds creases and corners.
    fn tags(
        &mut self,
        stage: &UsdStage<'_, '_>,
        prim: &StagePrim,
        first: u32,
        n: usize,
    ) -> Result<(), ReadError> {
        let list = |name: &'static str| {
            Ok::<_, ReadError>(
                stage.numbers(prim, name)?.map(|found| found.into_owned().values).unwrap_or_default(),
            )
        };
        let points = |name: &'static str, values: &[f64]| {
            row_numbers(values, n, |row| {
                let message = format!("{}: point {} is not below their number, {n}", prim.path, values[row]);
                ReadError::new("index-out-of-range", row_place(name, row), message)
            })
        };
        let mismatch = |name: &'static str, actual: usize, needed: usize| {
            let message = format!("{}.{name} has {actual} values where {needed} are needed", prim.path);
            ReadError::new("count-mismatch", stage.place(prim), message)
        };
        let corners = points("cornerIndices", &list("cornerIndices")?)?;
        let sharp = list("cornerSharpnesses")?;
        if sharp.len() != corners.len() {
            return Err(mismatch("cornerSharpnesses", sharp.len(), corners.len()));
        }
        for (point, sharp) in corners.into_iter().zip(sharp) {
            push(&mut self.sharp, (first + point, sharp))?;
        }
        let along = points("creaseIndices", &list("creaseIndices")?)?;
        let lengths = list("creaseLengths")?;
        let lengths = row_numbers(&lengths, along.len() + 1, |row| {
            mismatch("creaseLengths", greater(lengths[row], 0.0) as usize, along.len())
        })?;
        let total: u64 = lengths.iter().map(|n| u64::from(*n)).sum();
        if total != along.len() as u64 {
            return Err(mismatch("creaseIndices", along.len(), total as usize));
        }
        let sharp = list("creaseSharpnesses")?;
        let n_edges: usize = lengths.iter().map(|n| (*n as usize).saturating_sub(1)).sum();
        // Only the count tells which of the two was meant; if both are the same, it is one for each
        // crease.
        let is_by_edge = sharp.len() == n_edges && n_edges != lengths.len();
        if !is_by_edge && sharp.len() != lengths.len() {
            return Err(mismatch("creaseSharpnesses", sharp.len(), lengths.len()));
        }
        let (mut at, mut edge) = (0, 0);
        for (crease, n) in lengths.into_iter().enumerate() {
            for pair in along[at..at + n as usize].windows(2) {
                let sharp = if is_by_edge { sharp[edge] } else { sharp[crease] };
                push(&mut self.creases, ([first + pair[0], first + pair[1]], sharp))?;
                edge += 1;
            }
            at += n as usize;
        }
        Ok(())
    }

    /// Adds colours of points. A mesh without colours is white if others have some.
    fn colors(
        &mut self,
        stage: &UsdStage<'_, '_>,
        prim: &StagePrim,
        topology: &UsdTopology,
    ) -> Result<(), ReadError> {
        let color = stage.primvar(prim, "primvars:displayColor", 3, topology.size())?;
        let is_held = |held: Interpolation| matches!(held, Interpolation::Constant | Interpolation::Vertex);
        let color = color.filter(|color| {
            let is_held = is_held(color.interpolation);
            if !is_held {
                let what = "colours of faces and corners of meshes that are subdivided were left out";
                stage.note("colors-skipped", what, &prim.path);
            }
            is_held
        });
        self.n_colored += usize::from(color.is_some());
        for point in 0..topology.points.len() {
            let row = color.as_ref().map(|color| match color.interpolation {
                Interpolation::Constant => color.row(0),
                _ => color.row(point),
            });
            let color_row = row.and_then(|row| color.as_ref()?.numbers.row::<3>(row as usize));
            for x in color_row.unwrap_or([1.0; 3]) {
                push(&mut self.colors, if x.is_finite() { x } else { 0.0 })?;
            }
        }
        Ok(())
    }

    /// The cage of all meshes.
    ///
    /// # Errors
    /// If a crease is not an edge, or the bounding box is not finite.
    pub(super) fn finish(self, warnings: &mut Warnings) -> Result<Polygons, ReadError> {
        check_extent(&self.positions)?;
        warnings.count_all("no-vertices", u64::from(self.positions.is_empty()), "the file has no vertices");
        warnings.count_all("no-faces", u64::from(self.ends.is_empty()), "the file has no faces");
        let Self { rules, positions, ends, corners, holes, creases, sharp, .. } = self;
        let (n_points, n_faces) = (positions.len(), ends.len());
        let starts = std::iter::once(0).chain(ends.iter().copied());
        let faces = starts.zip(&ends).map(|(start, end)| &corners[start as usize..*end as usize]);
        let built = Cage::new(positions, faces)
            .and_then(|cage| cage.with_scheme(rules.scheme.unwrap_or_default()))
            .map(|cage| cage.with_boundary(rules.boundary).with_creasing(rules.creasing))
            .and_then(|cage| if creases.is_empty() { Ok(cage) } else { cage.with_creases(&creases) })
            .and_then(|cage| cage.with_sharp_vertices(&sharp))
            .and_then(|cage| cage.with_holes(&holes))
            .map(|cage| if rules.is_refined { cage.with_corners_listed() } else { cage })
            .and_then(|cage| {
                if self.rows.iter().all(|row| *row == CornerTexcoords::NONE) {
                    return Ok(cage);
                }
                cage.with_texcoords(CornerTexcoords {
                    values: self.texcoords,
                    corners: self.rows,
                    linear: rules.linear,
                })
            });
        let cage = built
            .map_err(|error| ReadError::new("invalid-cage", crate::FileLocation::File, error.to_string()))?;
        let mut polygons = Polygons::from_cage(cage, Frame::default());
        if self.n_colored > 0 && self.colors.len() == 3 * n_points {
            let semantic = Semantic::Color(0);
            let color = Attribute { semantic, domain: Domain::Vertex, width: 3, values: self.colors };
            polygons.attributes.push(color);
        }
        let mut group = |kind: &str, values: Vec<f64>| {
            let semantic = Semantic::Group(kind.to_owned());
            polygons.attributes.push(Attribute { semantic, domain: Domain::Face, width: 1, values });
        };
        let has_objects = self.groups.contains_key("o");
        for (kind, mut values) in self.groups {
            let n_more = n_faces.saturating_sub(values.len());
            push_many(&mut values, 0.0, n_more)?;
            group(&kind, values);
        }
        // The first name is that of no mesh. One mesh alone needs no group.
        if self.names.len() > 2 && !has_objects {
            group("o", self.meshes);
            polygons.groups.insert("o".to_owned(), self.names);
        }
        Ok(polygons)
    }
}

pub(super) fn moved(matrix: &[f64; 16], point: [f64; 3]) -> [f64; 3] {
    if *matrix == IDENTITY {
        return point;
    }
    let [x, y, z] = point;
    let row = |r: usize| matrix[r] * x + matrix[4 + r] * y + matrix[8 + r] * z + matrix[12 + r];
    [row(0), row(1), row(2)]
}

/// The determinant of the linear part.
pub(super) fn determinant(m: &[f64; 16]) -> f64 {
    m[0] * (m[5] * m[10] - m[6] * m[9]) - m[4] * (m[1] * m[10] - m[2] * m[9])
        + m[8] * (m[1] * m[6] - m[2] * m[5])
}
