//! Triangles of a mesh, with its normals, colours, texture coordinates and materials.
use super::primvar::{Interpolation, Primvar, row_numbers, row_place};
use super::stage::{StagePrim, UsdStage};
use super::topology::UsdTopology;
use super::vertex_table::{STREAMS, UsdCorner, UsdVertexTable};
use crate::assemble::{self, RawMesh};
use crate::faces::{Faces, SHORT_FACES};
use crate::grow::{push, push_many, with_room};
use crate::warnings::Warnings;
use crate::{MATERIAL, ReadError};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use std::collections::BTreeMap;

/// A mesh as given by one prim, with the state that it inherits.
#[derive(Clone, Debug)]
pub(super) struct UsdMeshRequest {
    pub prim: StagePrim,
    /// The number of its material, from 1 on; 0 for none.
    pub material: u32,
    pub subsets: Vec<UsdFaceSubset>,
    /// The primary texture coordinates of its materials.
    pub texcoords: Option<String>,
}

/// A subset of faces with its own material or group.
#[derive(Clone, Debug)]
pub(super) struct UsdFaceSubset {
    pub prim: StagePrim,
    pub material: u32,
    /// The group of a subset that has no material.
    pub group: Option<UsdFaceGroup>,
}

/// A group: its kind, and its number from 1 on.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct UsdFaceGroup {
    pub kind: String,
    pub number: u32,
}

/// Normals, colours, texture coordinates: streams of a vertex table.
struct VertexStream<'s> {
    semantic: Semantic,
    primvar: Primvar<'s>,
}

/// Creates the triangles. `None` if the mesh has no points.
///
/// # Errors
/// If the mesh is damaged.
pub(super) fn triangles(
    stage: &UsdStage<'_, '_>,
    request: &UsdMeshRequest,
    warnings: &mut Warnings,
) -> Result<Option<Mesh>, ReadError> {
    let Some(topology) = UsdTopology::read(stage, &request.prim)? else { return Ok(None) };
    let groups = face_groups(stage, request, topology.counts.len())?;
    let names = stream_names(stage, request);
    let mut streams = streams(stage, request, &topology, &names)?;
    let opacity = opacity(stage, request, &topology, &streams)?;
    let mut table = UsdVertexTable::new(topology.points.len())?;
    let mut faces = Faces::with_room(0)?;
    let (mut of_triangles, mut rows) = (Vec::new(), Vec::new());
    let is_hole = holes(stage, request, topology.counts.len())?;
    // Without shared rows, every corner would be a vertex of its own, even where all values agree.
    for stream in &mut streams {
        if stream.primvar.interpolation == Interpolation::FaceVarying {
            stream.primvar.share_rows()?;
        }
    }
    for (face_idx, face) in topology.faces().enumerate() {
        if face.n < 3 {
            warnings
                .count("short-faces", || (row_place("faceVertexCounts", face_idx), SHORT_FACES.to_owned()));
            continue;
        }
        if is_hole.get(face_idx) == Some(&true) {
            continue;
        }
        rows.clear();
        for corner in face.corners() {
            let mut vertex = UsdCorner { point: topology.corners[corner], rows: [0; STREAMS] };
            for (stream, row) in streams.iter().zip(&mut vertex.rows) {
                // Colours of faces become a face attribute; other values of faces split the vertices.
                *row = match stream.primvar.interpolation {
                    Interpolation::FaceVarying => stream.primvar.row(corner),
                    Interpolation::Uniform if !is_color(stream) => stream.primvar.row(face_idx),
                    _ => 0,
                };
            }
            push(&mut rows, table.row(vertex)?)?;
        }
        faces.push(&rows, face_idx as u64)?;
        // A face of n corners is cut into n - 2 triangles.
        push_many(&mut of_triangles, face_idx as u32, face.n - 2)?;
    }
    let mut positions = with_room(table.rows().len())?;
    positions.extend(table.rows().iter().map(|row| topology.points[row.point as usize]));
    let mut raw = RawMesh { positions, ..RawMesh::default() };
    if table.has_splits() {
        let mut ids = with_room(table.rows().len())?;
        ids.extend(table.rows().iter().map(|row| row.point));
        raw.position_id = Some(ids);
    }
    raw.faces = faces.cut(&raw.positions, |face| row_place("faceVertexCounts", face as usize), warnings);
    for (at, stream) in streams.iter().enumerate() {
        let opacity = if is_color(stream) { opacity.as_ref() } else { None };
        raw.attributes.push(match stream.primvar.interpolation {
            Interpolation::Uniform if is_color(stream) => color_of_faces(stream, opacity, &of_triangles)?,
            _ => of_vertices(stream, opacity, &table, at)?,
        });
    }
    for (kind, numbers) in groups {
        let mut values = with_room(of_triangles.len())?;
        values.extend(of_triangles.iter().map(|face| f64::from(numbers[*face as usize])));
        raw.attributes.push(Attribute {
            semantic: Semantic::Group(kind),
            domain: Domain::Face,
            width: 1,
            values,
        });
    }
    assemble::mesh(raw, &stage.limits, warnings).map(Some).map_err(|error| {
        let message = format!("{}: {}", request.prim.path, &*error.message);
        ReadError { message: message.into(), ..error }
    })
}

fn is_color(stream: &VertexStream<'_>) -> bool {
    stream.semantic == Semantic::Color(0)
}

/// The name of a stream with its semantic.
struct StreamName {
    name: String,
    semantic: Semantic,
    width: usize,
}

/// The normals, colours and texture coordinates of a mesh. Other values are reported.
fn stream_names(stage: &UsdStage<'_, '_>, request: &UsdMeshRequest) -> Vec<StreamName> {
    let prim = &request.prim;
    let properties = stage.property_names(prim, "primvars:");
    let normals = if properties.contains("primvars:normals") { "primvars:normals" } else { "normals" };
    let mut names = vec![
        StreamName { name: normals.to_owned(), semantic: Semantic::Normal, width: 3 },
        StreamName { name: "primvars:displayColor".to_owned(), semantic: Semantic::Color(0), width: 3 },
    ];
    // The primary set of the materials comes first, then the default set of most programs.
    let wanted = request.texcoords.as_ref().map(|name| format!("primvars:{name}"));
    let order = |name: &String| [Some(name) != wanted.as_ref(), name != "primvars:st"];
    let is_texcoord = |name: &&String| {
        let attribute = stage.attribute(prim, name).ok().flatten();
        let is_named = wanted.as_ref() == Some(*name) || **name == "primvars:st";
        attribute
            .is_some_and(|attribute| attribute.kind.is_texcoord || (is_named && attribute.kind.width == 2))
    };
    let mut texcoords: Vec<&String> = properties.iter().filter(is_texcoord).collect();
    texcoords.sort_by_key(|name| order(name));
    for (set, name) in (0..).zip(texcoords.into_iter().take(STREAMS - names.len())) {
        names.push(StreamName { name: name.clone(), semantic: Semantic::TexCoord(set), width: 2 });
    }
    for name in &properties {
        let is_known = names.iter().any(|known| known.name == *name)
            || name.ends_with(":indices")
            || name == "primvars:displayOpacity";
        if !is_known {
            let what = "values of meshes that are not read were left out";
            stage.note("primvars-unread", what, name);
        }
    }
    names
}

fn streams<'s>(
    stage: &'s UsdStage<'_, '_>,
    request: &'s UsdMeshRequest,
    topology: &UsdTopology,
    names: &'s [StreamName],
) -> Result<Vec<VertexStream<'s>>, ReadError> {
    let mut streams = Vec::new();
    for StreamName { name, semantic, width } in names {
        let primvar = stage.primvar(&request.prim, name, *width, topology.size())?;
        streams.extend(primvar.map(|primvar| VertexStream { semantic: semantic.clone(), primvar }));
    }
    Ok(streams)
}

/// The opacity that accompanies colours, if it is not trivial.
fn opacity<'s>(
    stage: &'s UsdStage<'_, '_>,
    request: &'s UsdMeshRequest,
    topology: &UsdTopology,
    streams: &[VertexStream<'_>],
) -> Result<Option<Primvar<'s>>, ReadError> {
    let opacity = stage.primvar(&request.prim, "primvars:displayOpacity", 1, topology.size())?;
    let Some(opacity) = opacity else { return Ok(None) };
    let color = streams.iter().find(|stream| is_color(stream));
    let fits = color.is_some_and(|color| {
        let is_same = color.primvar.interpolation == opacity.interpolation
            && color.primvar.indices == opacity.indices
            && color.primvar.numbers.n_rows() == opacity.numbers.n_rows();
        opacity.interpolation == Interpolation::Constant || is_same
    });
    if fits {
        return Ok(Some(opacity));
    }
    let what = "opacities that are not where colours are were left out";
    stage.note("opacity-skipped", what, &request.prim.path);
    Ok(None)
}

/// Appends a row of a stream, with its opacity.
fn push_row(
    values: &mut Vec<f64>,
    stream: &VertexStream<'_>,
    opacity: Option<&Primvar<'_>>,
    row: Option<u32>,
) -> Result<(), ReadError> {
    let numbers = &stream.primvar.numbers;
    let source_row =
        row.and_then(|row| numbers.values.get(row as usize * numbers.width..)?.get(..numbers.width));
    for k in 0..numbers.width {
        push(values, source_row.map_or(0.0, |row| row[k]))?;
    }
    if let Some(opacity) = opacity {
        let is_one = opacity.interpolation == Interpolation::Constant;
        let row = row.map(|row| if is_one { opacity.row(0) } else { row });
        push(values, row.and_then(|row| opacity.numbers.values.get(row as usize).copied()).unwrap_or(1.0))?;
    }
    Ok(())
}

/// A stream as a vertex attribute.
fn of_vertices(
    stream: &VertexStream<'_>,
    opacity: Option<&Primvar<'_>>,
    table: &UsdVertexTable,
    at: usize,
) -> Result<Attribute, ReadError> {
    let width = stream.primvar.numbers.width + usize::from(opacity.is_some());
    let mut values = with_room(table.rows().len() * width)?;
    for corner in table.rows() {
        let row = match stream.primvar.interpolation {
            Interpolation::Constant => Some(stream.primvar.row(0)),
            Interpolation::Vertex => Some(stream.primvar.row(corner.point as usize)),
            // A point that no face uses has no row.
            _ => Some(corner.rows[at]).filter(|row| *row != u32::MAX),
        };
        push_row(&mut values, stream, opacity, row)?;
    }
    Ok(Attribute { semantic: stream.semantic.clone(), domain: Domain::Vertex, width, values })
}

fn color_of_faces(
    stream: &VertexStream<'_>,
    opacity: Option<&Primvar<'_>>,
    of_triangles: &[u32],
) -> Result<Attribute, ReadError> {
    let width = stream.primvar.numbers.width + usize::from(opacity.is_some());
    let mut values = with_room(of_triangles.len() * width)?;
    for face in of_triangles {
        push_row(&mut values, stream, opacity, Some(stream.primvar.row(*face as usize)))?;
    }
    Ok(Attribute { semantic: stream.semantic.clone(), domain: Domain::Face, width, values })
}

/// The face groups of all kinds; materials come first.
///
/// # Errors
/// If a subset refers to a missing face.
pub(super) fn face_groups(
    stage: &UsdStage<'_, '_>,
    request: &UsdMeshRequest,
    n_faces: usize,
) -> Result<BTreeMap<String, Vec<u32>>, ReadError> {
    let mut groups: BTreeMap<String, Vec<u32>> = BTreeMap::new();
    if request.material > 0 {
        push_many(groups.entry(MATERIAL.to_owned()).or_default(), request.material, n_faces)?;
    }
    for subset in &request.subsets {
        let material = Some((MATERIAL, subset.material)).filter(|(_, number)| *number > 0);
        let group = subset.group.as_ref().map(|group| (&*group.kind, group.number));
        let Some((kind, number)) = material.or(group) else { continue };
        let Some(faces) = stage.numbers(&subset.prim, "indices")? else { continue };
        let faces = row_numbers(&faces.values, n_faces, |row| {
            let message = format!(
                "{}: face {} is not below their number, {n_faces}",
                subset.prim.path, faces.values[row]
            );
            ReadError::new("index-out-of-range", row_place("indices", row), message)
        })?;
        let of_faces = groups.entry(kind.to_owned()).or_default();
        if of_faces.is_empty() {
            push_many(of_faces, 0, n_faces)?;
        }
        faces.into_iter().for_each(|face| of_faces[face as usize] = number);
    }
    Ok(groups)
}

/// The faces that are holes; empty for plain polygons.
///
/// # Errors
/// If a hole is not a face.
pub(super) fn holes(
    stage: &UsdStage<'_, '_>,
    request: &UsdMeshRequest,
    n_faces: usize,
) -> Result<Vec<bool>, ReadError> {
    let prim = &request.prim;
    let mut is_hole = Vec::new();
    let Some(listed) = stage.numbers(prim, "holeIndices")?.filter(|listed| !listed.values.is_empty()) else {
        return Ok(is_hole);
    };
    if stage.word(prim, "subdivisionScheme")?.is_some_and(|scheme| scheme == "none") {
        stage.note("holes-skipped", "holes of polygons that are not subdivided were ignored", &prim.path);
        return Ok(is_hole);
    }
    push_many(&mut is_hole, false, n_faces)?;
    let rows = row_numbers(&listed.values, n_faces, |row| {
        let message = format!("{}: face {} is no hole: there are {n_faces}", prim.path, listed.values[row]);
        ReadError::new("index-out-of-range", row_place("holeIndices", row), message)
    })?;
    rows.into_iter().for_each(|face| is_hole[face as usize] = true);
    Ok(is_hole)
}
