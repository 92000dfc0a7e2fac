//! Cages: their limit surface within a budget, and their refined control meshes.
use super::request::MeshRequest;
use crate::formats::extensions_where;
use crate::output::file_rows::to_file_rows;
use crate::output::format_rounding::{RoundingTarget, single_precision_note};
use crate::provenance::geometry_digest::{written_digest, written_polygons_digest};
use crate::report::{
    Certificate, CountedTriangles, Output, PolygonFacts, RefinementFacts, VerbFacts, linear_name,
};
use crate::{Input, MeshFailure, Normals, OutputForm, Shape, formats};
use chordal::budget::advice::{Message, Setting};
use chordal::budget::{Bound, Reference, RefusalCode};
use chordal::check;
use chordal::convert::cage_to_mesh;
use chordal::explicit::subdivision::CornerTexcoords;
use chordal::explicit::triangulate::Triangulator;
use chordal::explicit::{Attribute, Cage, Domain, Semantic};
use chordal::{Bounded, Job, Mesh};
use chordal_io::glb::VertexStorage;
use chordal_io::{
    FileSet, Format, Polygons, Scene, Warning, WriteError, losses, losses_of_polygons, polygon_rounding,
    write, write_files, write_polygons, write_polygons_files,
};
use std::io::Write;

/// The bound of a refined cage's polygons against its limit surface; `None` if it is unknown.
fn bound_to_limit(cage: &Cage, job: &Job) -> Option<Bound> {
    check::limit_deviation(cage, job).ok()
}

/// The limit surface at the precision of the format, with its bound.
pub(crate) fn limit_surface(
    polygons: &Polygons,
    request: &MeshRequest,
    job: &Job,
) -> Result<(Scene, Bound), MeshFailure> {
    let Bounded { shape: mesh, bound } =
        request.run(job, |budget| cage_to_mesh(&polygons.cage, budget, job))?;
    // A descriptive name; a file name would make the bytes depend on a path.
    Ok((Scene::from_mesh("cage", mesh, polygons.frame), bound))
}

/// Notes on the data of a cage that meshing drops or converts.
pub(crate) fn notes_of_mesh(polygons: &Polygons) -> Vec<Message> {
    let mut notes: Vec<Message> = Vec::new();
    if let Some(texcoords) = polygons.cage.texcoords() {
        notes.push(format!(
            "texture coordinates are those of their own limit surface (linear: {}); the bound does not cover them",
            linear_name(texcoords.linear)
        ).into());
        notes.extend(missing_texcoords_note(&polygons.cage));
    }
    if !polygons.attributes.is_empty() {
        let message = "colours and groups of the cage were left out: its surface has none in this version";
        notes.push(message.into());
    }
    notes
}

/// A note if faces of a cage lack texture coordinates.
fn missing_texcoords_note(cage: &Cage) -> Option<Message> {
    let texcoords = cage.texcoords()?;
    let mut remaining = &texcoords.corners[..];
    let n = cage.faces().filter(|face| {
        let (corners, after) = remaining.split_at(face.len());
        remaining = after;
        corners.contains(&CornerTexcoords::NONE)
    });
    let n = n.count();
    (n > 0)
        .then(|| format!("faces without texture coordinates at all of their corners have 0, 0 ({n}x)").into())
}

/// Polygons, or their triangulation, for a file.
#[derive(Clone, Debug, PartialEq)]
pub enum ControlMesh {
    /// The polygons, for formats that hold them.
    Polygons(Polygons),
    /// The triangulated polygons, for formats that hold only triangles.
    Triangles(Scene),
}

/// The refined control mesh of a cage, with its certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct RefineOutcome {
    /// The mesh to write.
    pub made: ControlMesh,
    /// The output format.
    pub format: Format,
    /// The facts about the mesh, for the file and the report.
    pub certificate: Certificate,
}

impl RefineOutcome {
    /// Writes the mesh, with the certificate if the format can carry it.
    ///
    /// # Errors
    /// If the sink fails.
    pub fn write(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        let certificate = self.certificate.to_value();
        match &self.made {
            ControlMesh::Polygons(polygons) => write_polygons(polygons, Some(&certificate), self.format, out),
            ControlMesh::Triangles(scene) => write(scene, Some(&certificate), self.format, out),
        }
    }

    /// Writes the same as a document called `stem`, with the files that it names, if the format has such files: see
    /// [`write_files`].
    ///
    /// # Errors
    /// If the format cannot hold it.
    pub fn write_files(&self, stem: &str) -> Result<FileSet<'_>, WriteError> {
        match &self.made {
            ControlMesh::Triangles(scene) => {
                write_files(scene, Some(&self.certificate.to_value()), self.format, stem)
            }
            ControlMesh::Polygons(polygons) => {
                write_polygons_files(polygons, Some(&self.certificate.to_value()), self.format, stem)
            }
        }
    }

    /// Whether the document names other files: an OBJ names its materials.
    #[must_use]
    pub fn names_files(&self) -> bool {
        let assets = match &self.made {
            ControlMesh::Triangles(scene) => &scene.assets,
            ControlMesh::Polygons(polygons) => &polygons.assets,
        };
        self.format.names_files(assets)
    }
}

/// Refines a cage by some levels, in the order of [`Cage::refined_times`]; 0 levels keep it as it is.
///
/// OBJ, PLY and OFF hold its polygons; OBJ also the remaining creases, so that the file has the same limit surface. For
/// other formats quads are cut into triangles, along the same diagonal as by the readers of polygons, and get `normals`.
/// The parts of a face keep its groups, and texture coordinates are refined by their own rule. Colours are kept only at 0
/// levels; otherwise a note says that they were dropped.
///
/// Cost: as for [`Cage::refined_times`]; four times as much a level.
///
/// # Errors
/// If the shape is not a cage or the format holds no triangles; before the work, if the faces or their memory exceed the
/// limits of the job; if a coordinate overflows or does not fit the format.
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::{FormatHint, Normals, load, refine};
/// let obj = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nt interpolateboundary 1/0/0 1\n";
/// let input = load(obj, FormatHint { name: Some("square.obj"), ..FormatHint::default() }, &Default::default())?;
/// let outcome = refine(input, (2, Normals::Auto), Format::Obj, &Default::default())?;
/// assert_eq!(outcome.certificate.output.unwrap().polygons().unwrap().faces, 16);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn refine(
    input: Input,
    (levels, normals): (u32, Normals),
    to: impl Into<OutputForm>,
    job: &Job,
) -> Result<RefineOutcome, MeshFailure> {
    let form: OutputForm = to.into();
    let to = form.format;
    formats::check_output(&input.shape, to).map_err(MeshFailure::Usage)?;
    let mut certificate = Certificate::from_input(&input);
    let Shape::Cage(polygons) = input.shape else {
        return Err(MeshFailure::Usage(not_a_cage_message(&input.shape, input.format)));
    };
    let as_polygons = to.holds_polygons();
    if as_polygons && !matches!(normals, Normals::Auto | Normals::Keep) {
        let message = "polygons are written without normals: the smooth surface has its own";
        return Err(MeshFailure::Usage(message.into()));
    }
    check_size(&polygons.cage, levels, to, job)?;
    let refined = refined(polygons, levels, &mut certificate.notes)?;
    if job.is_cancelled() {
        return Err(MeshFailure::Cancelled);
    }
    certificate.verb = VerbFacts::Refined { refined: RefinementFacts::new(&refined.cage, levels) };
    if as_polygons {
        let moved = polygon_rounding(&refined, to)?;
        let rounded = Bound::proved(0.0, moved, Reference::InputTriangles);
        let bound = bound_to_limit(&refined.cage, job);
        let bound = bound.map(|bound| if moved > 0.0 { bound.then(&rounded) } else { bound });
        certificate.bound = bound.map(|bound| crate::report::BoundFacts::new(&bound));
        certificate.notes.extend(losses_of_polygons(&refined, to).iter().map(Warning::counted));
        certificate.output = Some(Output::Polygons(PolygonFacts::from_cage(&refined.cage)));
        certificate.conclude(("cage", to), written_polygons_digest(&refined, to));
        return Ok(RefineOutcome { made: ControlMesh::Polygons(refined), format: to, certificate });
    }
    certificate.notes.push(format!("{to} holds triangles alone: polygons were cut into them").into());
    let scene = triangles(&refined, (input.format, form), normals, &mut certificate.notes)?;
    let counted = CountedTriangles::from_scene(&scene, to)?;
    certificate.output = Some(Output::Triangles(counted.output));
    certificate.valid = Some(counted.valid);
    certificate.conclude(("triangles", to), written_digest(&scene, to));
    Ok(RefineOutcome { made: ControlMesh::Triangles(scene), format: to, certificate })
}

/// The cage after some levels of refinement, in the order of [`Cage::refined_times`].
///
/// # Errors
/// As for [`refine`].
///
/// ```
/// use chordal::explicit::Cage;
/// let square = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let cage = Cage::new(square, [[0, 1, 2, 3]])?;
/// let refined = chordal_verbs::refined_cage(&cage, 3, &Default::default())?;
/// assert_eq!((refined.n_faces(), refined.positions().len()), (64, 81));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn refined_cage(cage: &Cage, levels: u32, job: &Job) -> Result<Cage, MeshFailure> {
    check_size(cage, levels, Format::Obj, job)?;
    let refined = cage
        .refined_times(levels)
        .map_err(|error| MeshFailure::refused(RefusalCode::NotFinite, error.to_string()))?;
    if job.is_cancelled() { Err(MeshFailure::Cancelled) } else { Ok(refined) }
}

fn not_a_cage_message(shape: &Shape, format: Format) -> Message {
    if format.may_hold_cages() {
        Message::from("the polygons were read as triangles, and only those of a cage are refined: ")
            .value(Setting::Surface, "catmull-clark")
            .words(" makes them one")
    } else {
        let names = extensions_where(Format::may_hold_cages, "or");
        Message::default()
            .setting(Setting::Level)
            .words(format_args!(" is for polygon cages ({names}), and the input holds {}", shape.kind()))
    }
}

/// The most bytes for a face of the result while it is refined and written. Measured for a cube and a tetrahedron of a
/// million faces, and rounded up: 72 for quads, 82 for triangles of Loop's scheme.
const BYTES_A_QUAD: u64 = 96;
const BYTES_A_TRIANGLE: u64 = 112;

/// Additional bytes a face for texture coordinates. Derived: four rows of 4 bytes, two numbers of 8, a third of these for
/// the round before; rounded up.
const BYTES_OF_TEXCOORDS: u64 = 48;

/// Refuses results that would be too large, before the work.
fn check_size(cage: &Cage, levels: u32, to: Format, job: &Job) -> Result<(), MeshFailure> {
    let n_corners: usize = cage.faces().map(<[u32]>::len).sum();
    let is_for_triangles = cage.scheme().is_for_triangles();
    // The first round makes a quad of each corner, and each later one four of a quad; triangles become four in every
    // round.
    let first = if is_for_triangles { 4 * cage.n_faces() as u64 } else { n_corners as u64 };
    let parts_after = |rounds: u32| 4_u64.checked_pow(rounds).and_then(|parts| first.checked_mul(parts));
    let n_faces = if levels == 0 { Some(cage.n_faces() as u64) } else { parts_after(levels - 1) };
    let Some(n_faces) = n_faces else {
        let message = format!("{levels} rounds would give more faces than can be counted");
        return Err(MeshFailure::refused(RefusalCode::TooManyTriangles, message));
    };
    let bytes_a_face = if is_for_triangles { BYTES_A_TRIANGLE } else { BYTES_A_QUAD };
    let texcoord_bytes = if cage.texcoords().is_some() { BYTES_OF_TEXCOORDS } else { 0 };
    let bytes = n_faces.saturating_mul(bytes_a_face + texcoord_bytes);
    let cut = !to.holds_polygons() && !is_for_triangles;
    let n_triangles = n_faces.saturating_mul(if cut { 2 } else { 1 });
    if n_triangles > job.triangle_limit {
        let message = format!(
            "{levels} rounds would give {n_faces} faces; the limit is {} triangles",
            job.triangle_limit
        );
        return Err(MeshFailure::refused(RefusalCode::TooManyTriangles, message));
    }
    if bytes > job.memory_limit {
        let message = format!(
            "{levels} rounds would give {n_faces} faces, which take {bytes} bytes; the limit is {} (",
            job.memory_limit
        );
        let message = Message::from(message).setting(Setting::MaxMemory).words(")");
        return Err(MeshFailure::refused(RefusalCode::TooMuchMemory, message));
    }
    Ok(())
}

/// The refined cage with its face groups.
fn refined(polygons: Polygons, levels: u32, notes: &mut Vec<Message>) -> Result<Polygons, MeshFailure> {
    if levels == 0 {
        return Ok(Polygons { certificate: None, ..polygons });
    }
    let cage = polygons
        .cage
        .refined_times(levels)
        .map_err(|error| MeshFailure::refused(RefusalCode::NotFinite, error.to_string()))?;
    let mut refined = Polygons {
        groups: polygons.groups,
        assets: polygons.assets,
        ..Polygons::from_cage(cage, polygons.frame)
    };
    let parts = parts_of_faces(&polygons.cage, levels);
    for attribute in polygons.attributes {
        if attribute.domain != Domain::Face {
            notes.push("colours of the cage's vertices were left out: they are not refined".into());
            continue;
        }
        let rows = attribute.values.chunks_exact(attribute.width).zip(&parts);
        let values = rows.flat_map(|(row, n)| std::iter::repeat_n(row, *n).flatten().copied()).collect();
        refined.attributes.push(Attribute { values, ..attribute });
    }
    Ok(refined)
}

/// The number of faces that each face of the cage becomes; they are consecutive.
fn parts_of_faces(cage: &Cage, levels: u32) -> Vec<usize> {
    let parts_after = |rounds: u32| 4_usize.saturating_pow(rounds);
    let is_for_triangles = cage.scheme().is_for_triangles();
    let parts = |face: &[u32]| {
        if is_for_triangles { parts_after(levels) } else { face.len() * parts_after(levels - 1) }
    };
    cage.faces().map(parts).collect()
}

/// Triangulates the polygons at the precision of the format. Holes have no triangles.
fn triangles(
    polygons: &Polygons,
    (from, form): (Format, OutputForm),
    normals: Normals,
    notes: &mut Vec<Message>,
) -> Result<Scene, MeshFailure> {
    let cage = &polygons.cage;
    let (mut faces, mut points, mut cut) = (Vec::new(), Vec::new(), Vec::new());
    let mut triangulator = Triangulator::default();
    let mut rows = cage.texcoords().map(|texcoords| (texcoords, &texcoords.corners[..]));
    let mut texcoords = Vec::new();
    for (number, face) in cage.faces().enumerate() {
        // Before holes are left out, since their corners have rows as well.
        let face_texcoords = rows.as_mut().map(|(texcoords, remaining)| {
            let (corners, after) = remaining.split_at(face.len());
            *remaining = after;
            (*texcoords, corners)
        });
        if cage.holes().binary_search(&(number as u32)).is_ok() {
            continue;
        }
        points.clear();
        points.extend(face.iter().map(|vertex| cage.positions()[*vertex as usize]));
        cut.clear();
        triangulator.polygon(&points, &mut cut);
        faces.extend(cut.iter().map(|local| local.map(|corner| face[corner as usize])));
        if let Some((values, corners)) = face_texcoords {
            // A corner without a value gets 0, 0; a note counts such faces.
            let value = |corner: &u32| values.values.get(corners[*corner as usize] as usize).copied();
            texcoords.extend(cut.as_flattened().iter().flat_map(|corner| value(corner).unwrap_or_default()));
        }
    }
    let n_holes = cage.holes().len();
    if n_holes > 0 {
        notes.push(format!("holes of the cage have no triangles ({n_holes}x)").into());
    }
    if !polygons.attributes.is_empty() {
        notes.push("colours and groups are written with polygons alone: to .obj".into());
    }
    let mut mesh =
        Mesh::new(cage.positions().to_vec(), faces).map_err(crate::output::file_rows::unsupported)?;
    if cage.texcoords().is_some() {
        let (semantic, domain) = (Semantic::TexCoord(0), Domain::Corner);
        let attribute = Attribute { semantic, domain, width: 2, values: texcoords };
        mesh = mesh.with_attribute(attribute).map_err(crate::output::file_rows::unsupported)?;
        notes.extend(missing_texcoords_note(cage));
    }
    let formats = [from, form.format];
    let storage = form.is_quantized().then(|| VertexStorage::of(&mesh));
    let lattice = storage.and_then(|storage| storage.lattice);
    let snapped = RoundingTarget::new(form.format, lattice).snap(&mesh)?;
    if snapped.moved_at_most > 0.0 {
        notes.push(
            format!("rounding to {} moved no vertex further than {}", formats[1], snapped.moved_at_most)
                .into(),
        );
    }
    let mut scene = Scene::from_mesh("cage", snapped.mesh, polygons.frame);
    normals.apply(&mut scene, formats, notes)?;
    scene.packing = form.packing;
    if let (Some(storage), Some(part)) = (storage, scene.parts.first_mut()) {
        part.storage = Some(Box::new(storage));
        part.mesh = storage.round_attributes(&part.mesh).map_err(crate::output::file_rows::unsupported)?;
        notes.extend(single_precision_note(&scene.parts));
    }
    notes.extend(losses(&scene, formats[1])?.iter().map(Warning::counted));
    Ok(to_file_rows(scene, formats[1])?)
}
