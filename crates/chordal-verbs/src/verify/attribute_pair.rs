//! `AttributePair`: the triangles of a file and those that it was built from, to compare the attributes of their corners.
use crate::MeshFailure;
use crate::output::file_rows::unsupported;
use crate::report::AttributeFacts;
use crate::scene::flatten;
use crate::scene::merge::merge;
use crate::scene::placements::distance_up;
use chordal::budget::{JobError, Tolerance};
use chordal::check::findings::attribute_deviation;
use chordal::explicit::{Attribute, Domain, InvalidMesh, Semantic};
use chordal::math::elementary::atan2;
use chordal::math::{greater, lesser};
use chordal::{Job, Mesh};
use chordal_io::Scene;
use std::cell::OnceCell;

/// The way in which two scenes are compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PairForm {
    /// Whether v of the input is flipped: formats count it from different corners of a picture.
    pub turns_v: bool,
    /// Whether all triangles are one mesh on both sides: some formats join parts.
    pub is_whole: bool,
    /// Whether parts stay in their own coordinates: parts that a skin poses are measured there.
    pub is_unplaced: bool,
}

/// Corresponding meshes of both sides, in the same order, with attributes in one form: none at faces, colours of one width.
pub(super) struct AttributePair {
    read: Vec<Mesh>,
    written: Vec<Mesh>,
    /// The triangles that are the same on both sides: matched by their order, and by their positions.
    matched: OnceCell<Option<Vec<[MatchedFace; 2]>>>,
    matched_by_places: OnceCell<Option<Vec<[MatchedFace; 2]>>>,
}

/// A face of one side.
#[derive(Clone, Copy)]
struct MatchedFace {
    mesh: usize,
    face: usize,
    /// Its corners in the order of the corresponding corners of the other face.
    corners: [usize; 3],
}

/// The differences of the values at corners.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CornerDifferences {
    /// Corners that have a value on both sides.
    pub compared: usize,
    /// Compared corners with different values.
    pub different: usize,
    /// Corners with a value in the file and none in the input.
    pub missing: usize,
}

/// The least and the largest value of each component.
pub(super) struct ValueBox {
    pub min: Vec<f64>,
    pub max: Vec<f64>,
}

impl AttributePair {
    /// Both scenes in one form; `None` if they have different numbers of meshes.
    pub fn new([read, written]: [&Scene; 2], form: PairForm) -> Result<Option<Self>, MeshFailure> {
        let [mut read, mut written] = [meshes_of(read, form)?, meshes_of(written, form)?];
        if read.len() != written.len() {
            return Ok(None);
        }
        let colors = read.iter().chain(&written).flat_map(Mesh::attributes);
        let colors = colors.filter(|attribute| matches!(attribute.semantic, Semantic::Color(_)));
        // Formats add an opaque alpha, or leave it out: only the channels that all have are compared.
        let color_width = colors.map(|attribute| attribute.width).min().unwrap_or(0);
        for (side, turns_v) in [(&mut read, form.turns_v), (&mut written, false)] {
            for mesh in side {
                *mesh = in_one_form(mesh, color_width, turns_v).map_err(unsupported)?;
            }
        }
        Ok(Some(Self { read, written, matched: OnceCell::new(), matched_by_places: OnceCell::new() }))
    }

    /// The deviations from the values at the nearest places, over all meshes; `None` if the measurement is refused.
    pub fn measure(&self, moved: f64, job: &Job) -> Result<Option<Vec<AttributeFacts>>, MeshFailure> {
        let moved = Tolerance::new(moved).ok();
        let mut facts = Vec::new();
        for (read, written) in self.read.iter().zip(&self.written) {
            match attribute_deviation(read, written, moved, job) {
                Ok(deviations) => {
                    deviations.iter().for_each(|deviation| AttributeFacts::add(&mut facts, deviation));
                }
                Err(JobError::Cancelled) => return Err(MeshFailure::Cancelled),
                Err(JobError::Refused(_)) => return Ok(None),
            }
        }
        Ok(Some(facts))
    }

    /// Compares the values of corners if both sides have the same triangles; triangles in the same order match if their
    /// corners moved no farther than `moved`. `None` if there are different triangles. Values are different if they are
    /// farther apart than `tolerance`.
    pub fn by_corners(
        &self,
        semantic: &Semantic,
        (moved, tolerance): (f64, f64),
    ) -> Option<CornerDifferences> {
        let matched = self.matched.get_or_init(|| in_order(&self.read, &self.written, moved));
        let matched = matched.as_ref().or_else(|| {
            let by_places = self.matched_by_places.get_or_init(|| by_places(&self.read, &self.written));
            by_places.as_ref()
        })?;
        let mut differences = CornerDifferences::default();
        for [was, is] in matched {
            let [read, written] = [&self.read[was.mesh], &self.written[is.mesh]];
            let Some(has) = written.attribute(semantic) else { continue };
            let had = read.attribute(semantic);
            for (at, k) in was.corners.into_iter().zip(is.corners) {
                let Some(had) = had else {
                    differences.missing += 1;
                    continue;
                };
                let rows = [row_at(read, had, was.face, at), row_at(written, has, is.face, k)];
                differences.compared += 1;
                differences.different += usize::from(!is_within(semantic, rows, tolerance));
            }
        }
        Some(differences)
    }

    /// The range of an attribute's values on either side; `None` if there are none.
    pub fn boxes(&self, semantic: &Semantic) -> [Option<ValueBox>; 2] {
        [&self.read, &self.written].map(|side| {
            let attributes = side.iter().filter_map(|mesh| mesh.attribute(semantic));
            ValueBox::of_rows(
                attributes.flat_map(|attribute| attribute.values.chunks(attribute.width.max(1))),
            )
        })
    }
}

impl ValueBox {
    /// The box of some rows; `None` without rows.
    pub fn of_rows<'r>(mut rows: impl Iterator<Item = &'r [f64]>) -> Option<Self> {
        let first = rows.next()?;
        let mut values = Self { min: first.to_vec(), max: first.to_vec() };
        for row in rows {
            for (k, x) in row.iter().enumerate().take(values.min.len()) {
                values.min[k] = lesser(*x, values.min[k]);
                values.max[k] = greater(*x, values.max[k]);
            }
        }
        Some(values)
    }

    /// The length of its diagonal.
    pub fn diagonal(&self) -> f64 {
        self.sides().fold(0.0, |sum, side| sum + side * side).sqrt()
    }

    /// The largest absolute value in it.
    pub fn largest(&self) -> f64 {
        self.min.iter().chain(&self.max).fold(0.0, |most, x| greater(x.abs(), most))
    }

    /// Whether these values may be some of the values in another box: they lie in it, and fill a part of it along each axis.
    pub fn may_be_of(&self, other: &Self, tolerance: f64) -> bool {
        /// The share of the other box by which values may lie outside of it. Chosen: new vertices may lie beside old ones.
        const BESIDE: f64 = 0.125;
        /// The least share of the other box that values fill. Chosen: so that it holds even if few triangles are left.
        const FILLED: f64 = 0.25;
        if self.min.len() != other.min.len() {
            return false;
        }
        let sides = self.sides().zip(other.sides()).enumerate();
        sides.into_iter().all(|(k, (side, other_side))| {
            let beside = BESIDE * other_side + tolerance;
            side >= FILLED * other_side - tolerance
                && self.min[k] >= other.min[k] - beside
                && self.max[k] <= other.max[k] + beside
        })
    }

    fn sides(&self) -> impl Iterator<Item = f64> {
        self.min.iter().zip(&self.max).map(|(min, max)| max - min)
    }
}

/// Matches faces one by one, if they are in the same order.
fn in_order(read: &[Mesh], written: &[Mesh], moved: f64) -> Option<Vec<[MatchedFace; 2]>> {
    let mut matched = Vec::new();
    for (mesh, (a, b)) in read.iter().zip(written).enumerate() {
        if a.faces().len() != b.faces().len() {
            return None;
        }
        for face in 0..a.faces().len() {
            if a.corners(face).into_iter().zip(b.corners(face)).any(|(p, q)| distance_up(p, q) > moved) {
                return None;
            }
            matched.push([MatchedFace { mesh, face, corners: [0, 1, 2] }; 2]);
        }
    }
    Some(matched)
}

/// Matches equal faces by their positions in single precision, in whatever order they are.
fn by_places(read: &[Mesh], written: &[Mesh]) -> Option<Vec<[MatchedFace; 2]>> {
    let sides = [read, written].map(placed_faces);
    let [read, written] = &sides;
    if read.len() != written.len() || read.iter().zip(written).any(|(a, b)| a.0 != b.0) {
        return None;
    }
    Some(read.iter().zip(written).map(|(a, b)| [a.1, b.1]).collect())
}

/// A face by its corners in the order of their positions.
type PlacedFace = ([[u32; 3]; 3], MatchedFace);

/// All faces in the order of their positions.
fn placed_faces(meshes: &[Mesh]) -> Vec<PlacedFace> {
    /// The largest coordinate that counts as 0, as a share of the largest of all. Chosen: products of matrices turn 0 into
    /// less.
    const NOTHING: f64 = 1e-9;
    let reach = meshes.iter().flat_map(Mesh::positions).flatten().fold(0.0, |most, x| greater(x.abs(), most));
    let bits = |x: f64| if x.abs() <= NOTHING * reach { 0 } else { (x as f32).to_bits() };
    let mut faces = Vec::new();
    for (mesh, geometry) in meshes.iter().enumerate() {
        for face in 0..geometry.faces().len() {
            let places = geometry.corners(face).map(|corner| corner.map(bits));
            let mut corners = [0, 1, 2];
            corners.sort_by_key(|k| places[*k]);
            faces.push((corners.map(|k| places[k]), MatchedFace { mesh, face, corners }));
        }
    }
    // A stable sort: faces that occur twice stay in their order.
    faces.sort_by_key(|(places, _)| *places);
    faces
}

/// The meshes of a scene in its placements, or those of its parts.
fn meshes_of(scene: &Scene, form: PairForm) -> Result<Vec<Mesh>, MeshFailure> {
    let parts =
        if form.is_unplaced { scene.parts.clone() } else { flatten::flatten(scene.clone())?.scene.parts };
    let mut meshes: Vec<Mesh> = parts.into_iter().map(|part| part.mesh).collect();
    meshes.retain(|mesh| !mesh.faces().is_empty());
    if form.is_whole && meshes.len() > 1 {
        let parts: Vec<&Mesh> = meshes.iter().collect();
        return Ok(vec![merge(&parts)?.mesh]);
    }
    Ok(meshes)
}

/// The mesh without groups, with values at faces moved to their corners.
fn in_one_form(mesh: &Mesh, color_width: usize, turns_v: bool) -> Result<Mesh, InvalidMesh> {
    let is_kept = |attribute: &&Attribute| !matches!(attribute.semantic, Semantic::Group(_));
    let kept = mesh.attributes().iter().filter(is_kept).map(|attribute| {
        let is_color = matches!(attribute.semantic, Semantic::Color(_));
        let is_texture = matches!(attribute.semantic, Semantic::TexCoord(_));
        let width = if is_color { color_width } else { attribute.width };
        let n_rows = attribute.values.len() / attribute.width.max(1);
        let times = if attribute.domain == Domain::Face { 3 } else { 1 };
        let mut values = Vec::with_capacity(times * n_rows * width);
        for row in (0..n_rows).flat_map(|row| std::iter::repeat_n(row, times)) {
            values.extend_from_slice(&attribute.row(row)[..width]);
        }
        if turns_v && is_texture && width > 1 {
            values.chunks_mut(width).for_each(|row| row[1] = 1.0 - row[1]);
        }
        let domain = if times > 1 { Domain::Corner } else { attribute.domain };
        Attribute { semantic: attribute.semantic.clone(), domain, width, values }
    });
    mesh.with_only(kept)
}

/// The value of an attribute at a corner of a face.
pub(super) fn row_at<'a>(mesh: &Mesh, attribute: &'a Attribute, face: usize, k: usize) -> &'a [f64] {
    attribute.row(match attribute.domain {
        Domain::Vertex => mesh.faces()[face][k] as usize,
        Domain::Corner => 3 * face + k,
        Domain::Face => face,
    })
}

/// Whether an attribute is a direction, whose differences are angles.
pub(super) fn is_direction(semantic: &Semantic) -> bool {
    matches!(semantic, Semantic::Normal | Semantic::Tangent)
}

/// Whether a value is no farther from the expected one than `tolerance`: in degrees for directions.
fn is_within(semantic: &Semantic, [a, b]: [&[f64]; 2], tolerance: f64) -> bool {
    if a.len() != b.len() {
        return false;
    }
    if is_direction(semantic) && a.len() >= 3 {
        // The fourth number of a tangent says on which side its bitangent is.
        let is_mirrored = a.len() > 3 && a[3] * b[3] < 0.0;
        return !is_mirrored && degrees_off([a, b].map(|v| [v[0], v[1], v[2]])) <= tolerance;
    }
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.fold(0.0, |sum, x| sum + x).sqrt() <= tolerance
}

/// The angle between a direction and the expected one: 0 if none is expected, 180 if there is none.
pub(super) fn degrees_off([expected, actual]: [[f64; 3]; 2]) -> f64 {
    /// The largest possible angle.
    const OPPOSITE: f64 = 180.0;
    if expected == [0.0; 3] {
        return 0.0;
    }
    if actual == [0.0; 3] {
        return OPPOSITE;
    }
    // By both products: an arc cosine would lose half of the digits at small angles.
    let turned = cross(expected, actual);
    atan2(dot(turned, turned).sqrt(), dot(expected, actual)).to_degrees()
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
