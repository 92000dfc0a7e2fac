//! Reads OFF.
use super::faces::OffFaceReader;
use super::header::OffHeader;
use super::rows::OffRowReader;
use super::vertices::OffVertices;
use crate::assemble::{self, RawMesh};
use crate::text::grouped;
use crate::warnings::Warnings;
use crate::{Content, FileLocation, Frame, Limits, ReadError, ReadOutcome, Scene};
use chordal::explicit::Domain;

/// Reads the mesh of an OFF file as one part: text, or binary in Geomview's big-endian form.
///
/// The keyword is `[ST][C][N][4][n]OFF`: texture coordinates, colours and normals of vertices become
/// attributes, homogeneous positions are divided, positions of two coordinates get a third. Without a keyword
/// the file starts with its counts. The number of edges is not used. Polygons are cut into triangles, each
/// with the colour of its face, a [`chordal::explicit::Semantic::Color`] of faces. Colours are fractions, or
/// whole numbers up to 255, which are divided by 255; whole numbers up to 1 are interpreted like the other
/// rows of their list. In a text each vertex and each face begins on a new line.
///
/// # Errors
/// [`ReadError`] at the line, or in a binary file at the byte, with the row.
///
/// ```
/// use chordal_io::{Content, Limits, off};
/// let file = b"OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 51\n";
/// let Content::Scene(scene) = off::read(file, &Limits::default())?.content else { unreachable!() };
/// let mesh = &scene.parts[0].mesh;
/// assert_eq!(mesh.faces(), [[0, 1, 2], [0, 2, 3]]);
/// assert_eq!(mesh.attributes()[0].row(1), [1.0, 0.0, 0.2]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let mut warnings = Warnings::default();
    let header = OffHeader::read(bytes, limits, &mut warnings)?;
    let is_binary = header.keyword.is_binary;
    let mut rows = OffRowReader::new(bytes, &header);
    let vertices = OffVertices::read(&mut rows, &header, limits)?;
    let mut faces = OffFaceReader::new(header.n_vertices, limits);
    faces.read(&mut rows, header.n_faces, is_binary, &mut warnings)?;
    if let Some((place, n)) = rows.rest() {
        warnings.count_many("trailing-data", n, || {
            (place, format!("bytes or lines after the last face were skipped, {} in all", grouped(n)))
        });
    }
    let (positions, mut attributes) = vertices.into_attributes(&mut warnings);
    let OffFaceReader { faces, colors, .. } = faces;
    let place = if is_binary { |row| FileLocation::Row { list: "face", row } } else { FileLocation::Line };
    let faces = faces.cut(&positions, place, &mut warnings);
    attributes.extend(colors.finish(Domain::Face, &mut warnings));
    let mesh =
        assemble::mesh(RawMesh { positions, position_id: None, faces, attributes }, limits, &mut warnings)?;
    let mut scene = Scene::from_mesh("", mesh, Frame::default());
    scene.certificate = header.certificate;
    Ok(ReadOutcome { content: Content::Scene(scene), warnings: warnings.into_list() })
}
