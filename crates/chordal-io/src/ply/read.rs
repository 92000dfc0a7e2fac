//! Reads PLY.
use super::body::PlyBody;
use super::faces::PlyFaceReader;
use super::header::PlyHeader;
use super::text_rows::PART_BYTES;
use super::vertices::PlyVertices;
use crate::assemble::{self, RawMesh, too_many_rows};
use crate::text::grouped;
use crate::warnings::Warnings;
use crate::{Content, FileLocation, Frame, Limits, ReadError, ReadOutcome, Scene};

/// Reads the mesh of a PLY file as one part: text or binary, either byte order.
///
/// `nx ny nz`, texture coordinates and colours of vertices become attributes, by the property names that
/// tools use. Other numbers become [`chordal::explicit::Semantic::Custom`]; colours in bytes are divided by
/// 255. Polygons and `tristrips` are cut into triangles. Other elements and properties are skipped and
/// counted.
///
/// # Errors
/// [`ReadError`] at the line, or for a binary body at the byte with the row.
///
/// ```
/// use chordal_io::{Content, Limits, ply};
/// let file = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
///              element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
/// let Content::Scene(scene) = ply::read(file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(scene.parts[0].mesh.faces(), [[0, 1, 2]]);
/// # Ok::<(), chordal_io::ReadError>(())
/// ```
pub fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    read_in_parts(bytes, limits, Some(PART_BYTES))
}

/// The same, with texts parsed in parts of about so many bytes, or row by row.
pub(super) fn read_in_parts(
    bytes: &[u8],
    limits: &Limits,
    part_bytes: Option<usize>,
) -> Result<ReadOutcome, ReadError> {
    let mut warnings = Warnings::default();
    let header = PlyHeader::read(bytes, limits, &mut warnings)?;
    let n_vertices = header.elements.iter().find(|e| e.name == "vertex").map_or(0, |e| e.rows);
    let most = u64::from(u32::MAX) - 1;
    if n_vertices > most {
        return Err(too_many_rows(FileLocation::File, "vertices", n_vertices, most));
    }
    let mut body = PlyBody::new(bytes, &header, part_bytes);
    let mut vertices = PlyVertices::default();
    let mut faces = PlyFaceReader::new(n_vertices, limits);
    for element in header.elements.iter().filter(|e| e.rows > 0) {
        body.check_size(element)?;
        match element.name.as_str() {
            "vertex" => vertices = PlyVertices::read(&mut body, element, limits, &mut warnings)?,
            "face" => faces.polygons(&mut body, element, &mut warnings)?,
            "tristrips" => faces.strips(&mut body, element, &mut warnings)?,
            name => {
                warnings.count_many("element-skipped", element.rows, || {
                    let message =
                        format!("rows of unknown elements were skipped, '{}' first", name.escape_default());
                    (FileLocation::Line(element.line), message)
                });
                body.skip_element(element)?;
            }
        }
    }
    if let Some((place, n)) = body.rest() {
        warnings.count_many("trailing-data", n, || {
            (place, format!("bytes or lines after the last element were skipped, {} in all", grouped(n)))
        });
    }
    let place = |row| FileLocation::Row { list: "face", row };
    // Only now, since the element of faces may come before that of vertices.
    let faces = faces.faces.cut(&vertices.positions, place, &mut warnings);
    let PlyVertices { positions, position_id, attributes } = vertices;
    let mesh = assemble::mesh(RawMesh { positions, position_id, faces, attributes }, limits, &mut warnings)?;
    let mut scene = Scene::from_mesh("", mesh, Frame::default());
    scene.certificate = header.certificate;
    Ok(ReadOutcome { content: Content::Scene(scene), warnings: warnings.into_list() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_testkit::Random;

    const HEAD: &str = "ply\nformat ascii 1.0\nelement vertex 40\nproperty float x\nproperty uchar c\n\
                        property double y\nproperty float z\nelement face 30\nproperty list uchar int vertex_indices\nend_header\n";

    fn random_text(random: &mut Random, n_odd: usize) -> Vec<u8> {
        let mut lines: Vec<String> = Vec::new();
        for _ in 0..40 {
            lines.push(format!(
                "{} {} {:e} {:.3}",
                random.below(9),
                random.below(256),
                random.signed(),
                random.signed()
            ));
        }
        for _ in 0..30 {
            let n = 3 + random.below(2);
            let corners: Vec<String> = (0..n).map(|_| random.below(40).to_string()).collect();
            lines.push(format!("{n} {}", corners.join(" ")));
        }
        let odd = [
            "",
            " ",
            "1 2 3",
            "1 2 3 4 5",
            "nan 1 2 3",
            "1 256 2 3",
            "1 -1 2 3",
            "x 1 2 3",
            "3 0 1 40",
            "3 0 1 -1",
            "2 0 1",
            "3 0 1 2 3",
            "4 0 1 2",
            "  3 0 1\t2 ",
            "+1 +2 3 4",
            "1e999 1 1 1",
            "3 0 1 2.0",
            "300 1 2",
        ];
        for _ in 0..n_odd {
            let at = random.below(lines.len());
            lines[at] = odd[random.below(odd.len())].to_owned();
        }
        let end = ["\n", "\r\n", "\r"][random.below(3)];
        let mut text = HEAD.as_bytes().to_vec();
        text.extend_from_slice((lines.join(end) + ["", end][random.below(2)]).as_bytes());
        text
    }

    #[test]
    fn plain_rows_read_as_row_by_row() {
        let mut random = Random::new(11);
        let (mut n_read, mut n_refused) = (0, 0);
        for i in 0..3000_usize {
            let text = random_text(&mut random, i % 4);
            let limits =
                Limits { drop_nonfinite: i % 2 == 0, rows: [500, 45][i % 9 / 8], ..Limits::default() };
            let plain = format!("{:?}", read_in_parts(&text, &limits, None));
            let size = 1 + random.below(200);
            let in_parts = Limits { threads: 1 + i % 3, ..limits };
            let fast = format!("{:?}", read_in_parts(&text, &in_parts, Some(size)));
            assert_eq!(fast, plain, "{size} bytes a part: {}", text.escape_ascii());
            n_read += usize::from(fast.starts_with("Ok"));
            n_refused += usize::from(!fast.starts_with("Ok"));
        }
        assert!(n_read > 500 && n_refused > 500, "{n_read} read, {n_refused} refused");
    }
}
