//! `convert`: the same shape in another format, with a note on everything that the format does not hold.
pub(crate) mod certified;
mod curve_forms;
mod shader;
use crate::formats::{in_words, names_where};
use crate::mesh::request::MeshRequest;
use crate::output::finish::finish_triangles;
use crate::output::pass_through::pass_through;
use crate::provenance::geometry_digest::{
    polylines_digest, volume_digest, written_digest, written_polygons_digest,
};
use crate::report::{BoundFacts, Certificate, Output, PolygonFacts, PolylineFacts, VerbFacts};
use crate::{Input, MeshFailure, OutputForm, Shape, Tessellation, formats};
use chordal::budget::advice::{Message, Setting};
use chordal::budget::{Bound, Budget, Length, Reference, RefusalCode};
use chordal::explicit::Semantic;
use chordal::implicit::Affine3;
use chordal::{Job, Mesh, Tolerance};
use chordal_io::{
    Drawing, FileSet, Format, Node, Polygons, Polylines, Scene, VertexRows, Volume, Warning, WriteError,
    losses, losses_of_polygons, polygon_rounding, svg, write, write_files, write_polygons,
    write_polygons_files, write_polylines, write_volume,
};
use curve_forms::cubic_paths;
use curve_forms::{line_losses, straight_lines};
use serde_json::Value;
pub use shader::{ShaderOutcome, field_shader};
use std::io::Write;

/// A shape in the form in which its format holds it.
#[derive(Clone, Debug, PartialEq)]
pub enum ConvertedShape {
    /// Triangles.
    Triangles(Scene),
    /// Polygons of any number of corners.
    Polygons(Polygons),
    /// Polylines.
    Polylines(Polylines),
    /// Lines and cubics.
    Paths(Drawing),
    /// Samples on a lattice.
    Volume(Volume),
}

/// A converted shape with its bound and certificate.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvertOutcome {
    /// The shape to write.
    pub made: ConvertedShape,
    /// The output format.
    pub format: Format,
    /// The distance to the input's shape: the rounding to the format.
    pub bound: Bound,
    /// The bound and more, for the file and the report.
    pub certificate: Certificate,
}

impl ConvertOutcome {
    /// Writes the shape, with the certificate if the format can carry it. Samples keep the certificate that they had: they
    /// are the same to the bit, so that it still holds.
    ///
    /// # Errors
    /// If the sink fails.
    pub fn write(&self, out: &mut dyn Write) -> Result<(), WriteError> {
        let certificate = self.certificate.to_value();
        match &self.made {
            ConvertedShape::Triangles(scene) => write(scene, Some(&certificate), self.format, out),
            ConvertedShape::Polygons(polygons) => {
                write_polygons(polygons, Some(&certificate), self.format, out)
            }
            ConvertedShape::Polylines(polylines) => {
                write_polylines(polylines, Some(&certificate), self.format, out)
            }
            ConvertedShape::Paths(drawing) => svg::write_paths(drawing, Some(&certificate), out),
            ConvertedShape::Volume(volume) => {
                let kept = volume.certificate.as_ref();
                write_volume(volume, Some(kept.unwrap_or(&certificate)), self.format, out)
            }
        }
    }

    /// Writes the same as a document with files beside it, whose names begin with `stem`, if the format has such files.
    ///
    /// # Errors
    /// As for [`Self::write`].
    pub fn write_files(&self, stem: &str) -> Result<FileSet<'_>, WriteError> {
        let certificate = Some(self.certificate.to_value());
        match &self.made {
            ConvertedShape::Triangles(scene) => write_files(scene, certificate.as_ref(), self.format, stem),
            ConvertedShape::Polygons(polygons) => {
                write_polygons_files(polygons, certificate.as_ref(), self.format, stem)
            }
            _ => {
                let mut document = Vec::new();
                self.write(&mut document)?;
                Ok(FileSet { document, beside: Vec::new() })
            }
        }
    }

    /// Whether the document names other files for attributes of the shape: an OBJ names its materials.
    #[must_use]
    pub fn names_files(&self) -> bool {
        match &self.made {
            ConvertedShape::Triangles(scene) => self.format.names_files(&scene.assets),
            ConvertedShape::Polygons(polygons) => self.format.names_files(&polygons.assets),
            _ => false,
        }
    }
}

/// The same shape in another format: triangles, polygons, straight lines or samples, as they are. Nothing is simplified,
/// merged or repaired, and no normals are added.
///
/// The bound is the rounding to the format, including that of transforms if the format has no nodes; 0 if it keeps every
/// digit. [`Certificate::notes`] lists the data that the format does not hold. Time is linear in the shape.
///
/// # Errors
/// If the format does not hold the shape, or could hold only a mesh of it, which takes a budget; see [`needs_mesh`]. If a
/// coordinate does not fit the format.
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::{FormatHint, convert, load};
/// let obj = b"v 0 0 0\nv 1 0 0\nv 0 0.1 0\nf 1 2 3\n";
/// let input = load(obj, FormatHint { name: Some("triangle.obj"), ..FormatHint::default() }, &Default::default())?;
/// let outcome = convert(input, Format::Stl)?;
/// assert!((1e-10..1e-8).contains(&outcome.bound.at_most().unwrap())); // 0.1 in single precision
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn convert(input: Input, to: impl Into<OutputForm>) -> Result<ConvertOutcome, MeshFailure> {
    convert_within(input, to, None, &Job::default())
}

/// As [`convert`]; arcs and rational curves of a drawing become cubics within a length if the format holds cubics, which
/// only SVG does. The bound is the distance of the cubics.
///
/// # Errors
/// As for [`convert`]; if the length has a unit and the shape has none, or it is below rounding.
pub fn convert_within(
    mut input: Input,
    to: impl Into<OutputForm>,
    length: Option<Length>,
    job: &Job,
) -> Result<ConvertOutcome, MeshFailure> {
    let form: OutputForm = to.into();
    let to = form.format;
    check_format(&input.shape, to).map_err(MeshFailure::Usage)?;
    let mut certificate = Certificate::from_input(&input);
    certificate.verb = VerbFacts::Converted {};
    certificate.notes.extend(polygons_note(&input, to));
    // After the history was taken from the certificate: from here on the shape has none.
    let left_out = left_out_certificate(&mut input.shape);
    // A history that is continued has the bound of the old certificate in its sum, so that nothing is lost.
    certificate.notes.extend(left_out.filter(|_| !certificate.has_earlier_steps()));
    let bounds = input.shape.bounds()?;
    let length = length.map(|length| resolved(length, &input.shape)).transpose()?;
    let (converted, bound) = match input.shape {
        Shape::Scene(scene) => {
            refuse_points_alone(&scene, to)?;
            certificate.notes.extend(frame_losses(&scene, to));
            certificate.notes.extend(structure_losses(&scene, to));
            let (scene, bound) = pass_through(scene, form, &mut certificate.notes)?;
            let request = MeshRequest::new(Budget::default(), form, bounds);
            let outcome = finish_triangles(scene, bound, &request, certificate)?;
            let Tessellation::Triangles(scene) = outcome.made else {
                return Err(MeshFailure::Usage(needs_mesh_message("triangles")));
            };
            let (bound, certificate) = (outcome.bound, outcome.certificate);
            return Ok(ConvertOutcome {
                made: ConvertedShape::Triangles(scene),
                format: to,
                bound,
                certificate,
            });
        }
        Shape::Cage(polygons) => {
            let lost = losses_of_polygons(&polygons, to);
            certificate.notes.extend(lost.iter().map(Warning::counted));
            certificate.output = Some(Output::Polygons(PolygonFacts::from_cage(&polygons.cage)));
            let moved = polygon_rounding(&polygons, to)?;
            let bound = match moved {
                0.0 => Bound::exact(Reference::InputTriangles),
                _ => Bound::proved(0.0, moved, Reference::InputTriangles),
            };
            (ConvertedShape::Polygons(polygons), bound)
        }
        Shape::Drawing(drawing) if to.holds_cubics() && straight_lines(&drawing.lines).is_none() => {
            certificate.notes.extend(line_losses(&drawing, to));
            let (drawing, bound, [n_lines, n_cubics]) = cubic_paths(drawing, length, job)?;
            let n_paths = drawing.lines.len();
            certificate
                .notes
                .push(format!("paths: {n_paths}, of {n_lines} lines and {n_cubics} cubics").into());
            (ConvertedShape::Paths(drawing), bound)
        }
        Shape::Drawing(drawing) => {
            certificate.notes.extend(line_losses(&drawing, to));
            let (lines, slack) = straight_lines(&drawing.lines).ok_or_else(needs_polylines)?;
            let polylines = Polylines::Plane(drawing.with_lines(lines));
            (ConvertedShape::Polylines(polylines), Bound::proved(0.0, slack, Reference::Curves))
        }
        Shape::Curves(curves) => {
            certificate.notes.extend(line_losses(&curves, to));
            let (lines, slack) = straight_lines(&curves.lines).ok_or_else(needs_polylines)?;
            let polylines = Polylines::Space(curves.with_lines(lines));
            (ConvertedShape::Polylines(polylines), Bound::proved(0.0, slack, Reference::Curves))
        }
        Shape::Volume(sampled) => {
            certificate.notes.extend(volume_losses(&sampled.volume, to));
            (ConvertedShape::Volume(sampled.volume), Bound::exact(Reference::Trilinear))
        }
        Shape::Patches { .. } | Shape::Surfaces { .. } | Shape::Field(_) => {
            return Err(MeshFailure::Usage(needs_mesh_message(input.shape.kind())));
        }
    };
    if let ConvertedShape::Polylines(polylines) = &converted {
        certificate.output = Some(Output::Polylines(PolylineFacts::from_polylines(polylines)));
    }
    certificate.bound = Some(BoundFacts::new(&bound));
    let (kind, geometry) = match &converted {
        ConvertedShape::Triangles(scene) => ("triangles", written_digest(scene, to)),
        ConvertedShape::Polygons(polygons) => ("cage", written_polygons_digest(polygons, to)),
        ConvertedShape::Polylines(lines @ Polylines::Plane(_)) => ("drawing", Some(polylines_digest(lines))),
        ConvertedShape::Polylines(lines) => ("curves", Some(polylines_digest(lines))),
        ConvertedShape::Paths(_) => ("drawing", None),
        // An array does not hold the origin and the step of the lattice.
        ConvertedShape::Volume(volume) => ("volume", (!to.is_array()).then(|| volume_digest(volume))),
    };
    certificate.conclude((kind, to), geometry);
    Ok(ConvertOutcome { made: converted, format: to, bound, certificate })
}

/// The length in units of the shape.
fn resolved(length: Length, shape: &Shape) -> Result<Tolerance, MeshFailure> {
    let diagonal = if matches!(length, Length::Percent(_)) { shape.diagonal()? } else { 0.0 };
    length.resolve(diagonal, shape.frame().metres_per_unit).map_err(MeshFailure::Length)
}

/// Refuses points without triangles if the format holds only triangles: the file would be empty. Writers of formats that
/// need triangles in every part refuse parts without them.
fn refuse_points_alone(scene: &Scene, to: Format) -> Result<(), MeshFailure> {
    let n_points: usize = scene.parts.iter().map(|part| part.mesh.positions().len()).sum();
    if to.vertex_rows() != VertexRows::Soup
        || n_points == 0
        || scene.parts.iter().any(|part| !part.mesh.faces().is_empty())
    {
        return Ok(());
    }
    let message = format!(
        "nothing was written: there are {n_points} points and no triangle, and {to} holds triangles alone; {} hold \
         points",
        in_words(&names_where(Format::holds_points), "and")
    );
    Err(MeshFailure::refused(RefusalCode::Empty, message))
}

/// Whether the format holds the shape only after `mesh`: triangles of patches, fields, cages, volumes and outlines, and
/// polylines of bent curves unless the format holds cubics, as SVG does.
///
/// ```
/// use chordal_io::Format;
/// use chordal_verbs::{FormatHint, load, needs_mesh};
/// let svg = b"<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0L1 0L1 1Z'/></svg>";
/// let drawing = load(svg, FormatHint::default(), &Default::default())?.shape;
/// assert!(!needs_mesh(&drawing, Format::Json) && needs_mesh(&drawing, Format::Glb));
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
#[must_use]
pub fn needs_mesh(shape: &Shape, to: Format) -> bool {
    match shape {
        Shape::Scene(_) => false,
        Shape::Patches { .. } | Shape::Surfaces { .. } | Shape::Volume(_) => to.holds_triangles(),
        Shape::Field(implicit) => {
            // Only a field that does not depend on z has an outline in the plane.
            to.holds_triangles() || to.holds_polylines() && !implicit.field.tape().axes()[2]
        }
        Shape::Cage(_) => to.holds_triangles() && !to.holds_polygons(),
        Shape::Drawing(drawing) => {
            let bends = || straight_lines(&drawing.lines).is_none();
            to.holds_triangles() || to.holds_polylines() && !to.holds_cubics() && bends()
        }
        Shape::Curves(curves) => to.holds_polylines() && straight_lines(&curves.lines).is_none(),
    }
}

/// Whether polygons in a file of the format lose no more than the triangles into which a reader cut them. `polygons` and
/// `triangles` are the same file, read as a cage and as triangles.
///
/// In an OBJ or USDA they would lose more: its tags would turn plain polygons into a cage for readers.
#[must_use]
pub fn polygons_lose_no_more(polygons: &Input, triangles: &Input, to: Format) -> bool {
    let (Shape::Cage(cage), Shape::Scene(scene)) = (&polygons.shape, &triangles.shape) else { return false };
    if !to.holds_polygons() || to.may_hold_cages() {
        return false;
    }
    // A cage has no normals of its own.
    let has_normals = scene.parts.iter().any(|part| part.mesh.attribute(&Semantic::Normal).is_some());
    let lost = losses_of_polygons(cage, to).len() + usize::from(has_normals);
    losses(scene, to).is_ok_and(|of_triangles| lost <= of_triangles.len())
}

/// The message for a shape that has to be meshed first.
fn needs_mesh_message(kinds: &str) -> Message {
    format!("{kinds} become triangles or polylines within a budget, and a conversion has none: mesh them")
        .into()
}

fn needs_polylines() -> MeshFailure {
    MeshFailure::Usage(
        "curves that bend become polylines within a budget, and a conversion has none: mesh them".into(),
    )
}

/// The names of the formats in which the shape can be written as it is; if there are none, the formats of triangles.
#[must_use]
pub fn written_names(shape: &Shape) -> Vec<String> {
    let is_writable = |to: &Format| to.holds_triangles() || to.holds_polylines() || to.holds_volumes();
    let holds = |to: &Format| is_writable(to) && check_format(shape, *to).is_ok();
    let names: Vec<String> = Format::all().filter(holds).map(|format| format.to_string()).collect();
    if names.is_empty() {
        return Format::all()
            .filter(|format| format.holds_triangles())
            .map(|format| format.to_string())
            .collect();
    }
    names
}

/// Refuses a format that cannot hold the shape as it is.
fn check_format(shape: &Shape, to: Format) -> Result<(), Message> {
    if !to.holds_triangles() && !to.holds_polylines() && !to.holds_volumes() {
        return Err(
            format!("{to} is only read; what can be written is {}", written_names(shape).join(", ")).into()
        );
    }
    if needs_mesh(shape, to) {
        return Err(needs_mesh_message(shape.kinds()));
    }
    let (what, holds): (_, fn(Format) -> bool) = match shape {
        Shape::Scene(_) => ("triangles", Format::holds_triangles),
        Shape::Cage(_) => ("polygons", Format::holds_polygons),
        Shape::Volume(_) => ("volumes", Format::holds_volumes),
        Shape::Curves(_) if to.holds_polylines() && !to.holds_space_curves() => {
            let names = in_words(&names_where(Format::holds_space_curves), "or");
            return Err(format!("these curves are in space, which {to} cannot hold: write {names}").into());
        }
        Shape::Drawing(_) | Shape::Curves(_) => ("polylines", Format::holds_polylines),
        Shape::Patches { .. } | Shape::Surfaces { .. } | Shape::Field(_) => {
            let kind = shape.kind();
            return Err(format!(
                "{to} does not hold {kind}, and no other output format does: mesh them to one of {}",
                formats::mesh_names()
            )
            .into());
        }
    };
    if holds(to) {
        return Ok(());
    }
    let names: Vec<String> = Format::all().filter(|format| holds(*format)).map(|f| f.to_string()).collect();
    Err(format!("{to} does not hold {what}; {} do", names.join(", ")).into())
}

/// A note if a reader cut polygons that the format could have held.
fn polygons_note(input: &Input, to: Format) -> Option<Message> {
    let was_cut = input.warnings.iter().any(|warning| warning.code == "polygons-cut");
    (was_cut && input.format.may_hold_cages() && to.holds_polygons()).then(|| {
        Message::from("polygons were cut into triangles, which keep their attributes: ")
            .value(Setting::Surface, "catmull-clark")
            .words(" keeps the polygons")
    })
}

/// Takes the certificate out of the input, and returns a note with its bound: the new certificate starts from the
/// coordinates of the input. Samples keep their certificate.
fn left_out_certificate(shape: &mut Shape) -> Option<Message> {
    let certificate = match shape {
        Shape::Scene(scene) => scene.certificate.take(),
        Shape::Cage(polygons) => polygons.certificate.take(),
        Shape::Drawing(drawing) => drawing.certificate.take(),
        Shape::Curves(curves) => curves.certificate.take(),
        Shape::Patches { .. } | Shape::Surfaces { .. } | Shape::Field(_) | Shape::Volume(_) => None,
    }?;
    let at_most = certificate.pointer("/bound/at_most").and_then(Value::as_f64);
    let promised = at_most.map_or(String::new(), |most| format!(", of a bound of at most {most},"));
    Some(
        format!("the certificate of the input{promised} was left out: this one begins at its numbers").into(),
    )
}

/// Notes on the unit and the axes of a scene that a format without nodes does not hold.
fn frame_losses(scene: &Scene, to: Format) -> Vec<Message> {
    if to.has_nodes() {
        return Vec::new();
    }
    let unit = scene.frame.metres_per_unit.map(|metres| format!("{to} holds no unit: one is {metres} m"));
    let up = scene.frame.up.map(|up| format!("{to} does not say which axis is up: it is {}", up.letter()));
    unit.into_iter().chain(up).map(Message::from).collect()
}

/// Notes on nodes, parts and unused vertices of a scene that a format does not hold.
fn structure_losses(scene: &Scene, to: Format) -> Vec<Message> {
    let mut lost = Vec::new();
    let mut count = |n: usize, what: String| {
        if n > 0 {
            lost.push(Message::from(format!("{what} ({n}x)")));
        }
    };
    let plain = Node::default();
    let says_more = |node: &&Node| {
        let part = node.part.and_then(|part| scene.parts.get(part));
        node.matrix != plain.matrix
            || !node.children.is_empty()
            || !node.properties.is_empty()
            || part.is_none_or(|part| part.name != node.name)
    };
    if !to.has_nodes() {
        let n = scene.nodes.iter().filter(says_more).count();
        count(
            n,
            format!("{to} holds no nodes or their names: the triangles were moved to the places of these"),
        );
    }
    if !to.has_parts() {
        let n = scene.parts.iter().filter(|part| !part.name.is_empty()).count();
        count(n, format!("{to} holds no names of parts"));
    }
    if to.vertex_rows() == VertexRows::Soup {
        let n = scene.parts.iter().map(|part| n_unused(&part.mesh)).sum();
        count(n, format!("{to} holds no vertices beside those of its triangles"));
    }
    lost
}

/// Vertices that no face names.
fn n_unused(mesh: &Mesh) -> usize {
    let mut used = vec![false; mesh.positions().len()];
    mesh.faces().as_flattened().iter().for_each(|vertex| used[*vertex as usize] = true);
    used.iter().filter(|used| !**used).count()
}

/// Notes on the data of a volume that a format does not hold.
fn volume_losses(volume: &Volume, to: Format) -> Vec<Message> {
    let mut lost = Vec::new();
    let mut add = |is_lost: bool, what: String| {
        if is_lost {
            lost.push(Message::from(what));
        }
    };
    let frame = volume.frame;
    if to.is_array() {
        let affine = volume.grid.affine();
        let is_plain = *affine == Affine3::IDENTITY || is_reversed(affine);
        add(
            !is_plain,
            format!("{to} holds no origin and no step of a lattice: those of the input were left out"),
        );
        add(!volume.name.is_empty(), format!("{to} holds no name"));
        add(!volume.labels.is_empty(), format!("{to} holds no names and no colours of labels"));
        add(volume.space.is_some(), format!("{to} does not say what the axes of space are"));
        add(
            volume.certificate.is_some(),
            format!("{to} holds no certificate: that of the input was left out"),
        );
    }
    if let Some(metres) = frame.metres_per_unit {
        add(!to.names_unit(metres), format!("{to} does not hold the unit: one is {metres} m"));
    }
    if let Some(up) = frame.up {
        add(true, format!("{to} does not say which axis is up: it is {}", up.letter()));
    }
    lost
}

/// Whether lattice index (k, j, i) is the point (i, j, k), as for arrays whose last index runs fastest.
fn is_reversed(affine: &Affine3) -> bool {
    let rows = [[0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]];
    Affine3::new(rows).is_ok_and(|reversed| *affine == reversed)
}
