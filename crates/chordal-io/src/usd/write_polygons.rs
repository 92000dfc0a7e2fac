//! Writes a cage as a subdivided mesh of USD.
use super::cage::{BOUNDARIES, CHAIKIN, CREASING, LINEAR, REFINED, scheme_name};
use super::write::{header, picture_prefix};
use super::write_material::UsdMaterialWriter;
use super::write_mesh::UsdSubsets;
use super::write_text::UsdaWriter;
use crate::{FileSet, Polygons, SceneAssets, TextureOrigin, WriteError};
use chordal::explicit::subdivision::{CornerTexcoords, CreasingMethod, LinearTexcoords};
use chordal::explicit::{Domain, Semantic};
use serde_json::Value;
use std::io::Write;

/// Writes a cage as USDA, so that the file reads back as the same cage: its points and polygons in their
/// order, its scheme, creases, corners, holes and boundary, texture coordinates with their own indices,
/// colours and groups.
///
/// Properties without a counterpart in USD are in Chordal's own attributes, `chordal:creasing` and
/// `chordal:refined`.
///
/// # Errors
/// If the sink fails.
///
/// ```
/// use chordal::explicit::Cage;
/// use chordal_io::{Content, Frame, Limits, Polygons, usd};
/// let square = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let cage = Cage::new(square, [[0, 1, 2, 3]])?.with_creases(&[([0, 1], 2.5)])?;
/// let mut file = Vec::new();
/// usd::write_polygons(&Polygons::from_cage(cage.clone(), Frame::default()), None, &mut file)?;
/// let Content::Polygons(read) = usd::read(&file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(read.cage, cage);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_polygons(
    polygons: &Polygons,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    cage(polygons, &polygons.assets, certificate, out)
}

/// Writes a cage, and its pictures beside it.
///
/// # Errors
/// As for [`write_polygons`].
pub(crate) fn write_polygons_files<'a>(
    polygons: &'a Polygons,
    certificate: Option<&Value>,
    stem: &str,
) -> Result<FileSet<'a>, WriteError> {
    let prefix = picture_prefix(stem);
    let assets = polygons.assets.with_pictures_beside(&prefix);
    let mut document = Vec::new();
    cage(polygons, &assets, certificate, &mut document)?;
    Ok(FileSet { document, beside: polygons.assets.picture_files(&prefix) })
}

fn cage(
    polygons: &Polygons,
    assets: &SceneAssets,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let mut writer = UsdaWriter::new(out);
    header(&polygons.frame, "Scene", certificate, &mut writer)?;
    writer.open("Xform", "Scene", &[])?;
    let mut materials = UsdMaterialWriter::new(assets, "/Scene/Materials".to_owned());
    if !materials.names.is_empty() {
        writer.open("Scope", "Materials", &[])?;
        materials.write(&mut writer)?;
        writer.close()?;
    }
    let subsets = UsdSubsets::new(&polygons.attributes, &polygons.groups, &materials);
    let about: Vec<String> = subsets.about().into_iter().collect();
    writer.open("Mesh", "Cage", &about)?;
    shape(polygons, &mut writer)?;
    texcoords(polygons, &mut writer)?;
    colors(polygons, &mut writer)?;
    subsets.write(&materials, &mut writer)?;
    writer.close()?;
    writer.close()?;
    Ok(writer.out.flush()?)
}

/// Points, faces and tags.
fn shape(polygons: &Polygons, writer: &mut UsdaWriter<'_>) -> Result<(), WriteError> {
    let cage = &polygons.cage;
    let word = |name: &str, word: &str| format!("uniform token {name} = \"{word}\"");
    writer.line(&word("subdivisionScheme", scheme_name(cage.scheme())))?;
    if let Some((_, rule)) = BOUNDARIES.iter().find(|(boundary, _)| *boundary == cage.boundary()) {
        writer.line(&word("interpolateBoundary", rule))?;
    }
    if cage.creasing() == CreasingMethod::Chaikin {
        writer.line(&format!("custom {}", word(CREASING, CHAIKIN)))?;
    }
    if cage.lists_corners() {
        writer.line(&format!("custom uniform bool {REFINED} = 1"))?;
    }
    writer.rows("point3f[] points", 3, cage.positions().as_flattened().iter().copied(), "")?;
    writer.rows("int[] faceVertexCounts", 1, cage.faces().map(|face| face.len() as f64), "")?;
    let corners = cage.faces().flatten().map(|point| f64::from(*point));
    writer.rows("int[] faceVertexIndices", 1, corners, "")?;
    if !cage.holes().is_empty() {
        writer.rows("int[] holeIndices", 1, cage.holes().iter().map(|face| f64::from(*face)), "")?;
    }
    let sharp = cage.sharp_vertices();
    if !sharp.is_empty() {
        writer.rows("int[] cornerIndices", 1, sharp.iter().map(|(point, _)| f64::from(*point)), "")?;
        writer.rows("float[] cornerSharpnesses", 1, sharp.iter().map(|(_, sharp)| *sharp), "")?;
    }
    let creases = cage.creases();
    if !creases.is_empty() {
        let ends = creases.iter().flat_map(|(ends, _)| ends.map(f64::from));
        writer.rows("int[] creaseIndices", 1, ends, "")?;
        // Each crease is one edge.
        writer.rows("int[] creaseLengths", 1, creases.iter().map(|_| 2.0), "")?;
        writer.rows("float[] creaseSharpnesses", 1, creases.iter().map(|(_, sharp)| *sharp), "")?;
    }
    Ok(())
}

/// Texture coordinates of corners. A corner without any refers to an extra row of zeros, since USD cannot
/// leave a corner out.
fn texcoords(polygons: &Polygons, writer: &mut UsdaWriter<'_>) -> Result<(), WriteError> {
    let Some(texcoords) = polygons.cage.texcoords() else { return Ok(()) };
    let rule = LinearTexcoords::ALL.iter().position(|rule| *rule == texcoords.linear).unwrap_or_default();
    writer.line(&format!("uniform token faceVaryingLinearInterpolation = \"{}\"", LINEAR[rule]))?;
    let turns = polygons.frame.turns_v(TextureOrigin::LowerLeft);
    let turned = |p: &[f64; 2]| [p[0], if turns { 1.0 - p[1] } else { p[1] }];
    let has_none = texcoords.corners.contains(&CornerTexcoords::NONE);
    let extra = has_none.then_some([0.0; 2]);
    let values = texcoords.values.iter().map(turned).chain(extra).flatten();
    writer.rows("texCoord2f[] primvars:st", 2, values, " (interpolation = \"faceVarying\")")?;
    let none = texcoords.values.len();
    let row = |row: &u32| if *row == CornerTexcoords::NONE { none as f64 } else { f64::from(*row) };
    writer.rows("int[] primvars:st:indices", 1, texcoords.corners.iter().map(row), "")
}

fn colors(polygons: &Polygons, writer: &mut UsdaWriter<'_>) -> Result<(), WriteError> {
    let n = polygons.cage.positions().len();
    let color = polygons.attributes.iter().find(|color| {
        let is_color = color.semantic == Semantic::Color(0) && color.domain == Domain::Vertex;
        is_color && color.width >= 3 && color.values.len() == n * color.width
    });
    let Some(color) = color else { return Ok(()) };
    let rows = color.values.chunks_exact(color.width);
    let end = " (interpolation = \"vertex\")";
    writer.rows("color3f[] primvars:displayColor", 3, rows.flat_map(|row| row[..3].iter().copied()), end)
}
