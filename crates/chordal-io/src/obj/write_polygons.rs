//! Writes polygons with their subdivision tags as Wavefront OBJ.
use super::CERTIFICATE;
use super::names::ObjNames;
use super::tag_names::{BOUNDARIES, REFINED, SCHEME};
use super::write::{GROUPS, ObjWriter};
use crate::certificate::write_comments;
use crate::number::put_double;
use crate::{Polygons, WriteError};
use chordal::explicit::subdivision::{CornerTexcoords, CreasingMethod, LinearTexcoords, Scheme};
use chordal::explicit::{Attribute, Domain, Semantic};
use serde_json::Value;
use std::io::{BufWriter, Write};

/// Writes a cage as OBJ, so that the file reads back as the same cage: vertices and polygons in their order,
/// texture coordinates with their own indices, colours, groups, and everything that defines its surface as
/// subdivision tags.
///
/// The boundary rule is always written, so the file has a tag and every reader treats it as a cage. A scheme
/// other than Catmull–Clark is the tag `t scheme 0/0/1 loop`, or `bilinear`. A cage after a round of
/// refinement has `t refined 0/0/0`. Both are Chordal's own. Numbers are the shortest decimals that read back
/// to the same f64. [`crate::losses_of_polygons`] lists the data that OBJ cannot hold.
///
/// # Errors
/// [`WriteError`] if the sink fails, or the certificate is too long.
///
/// ```
/// use chordal::explicit::Cage;
/// use chordal_io::{Content, Frame, Limits, Polygons, obj};
/// let square = vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let cage = Cage::new(square, [[0, 1, 2, 3]])?.with_creases(&[([0, 1], 2.5)])?;
/// let mut file = Vec::new();
/// obj::write_polygons(&Polygons::from_cage(cage.clone(), Frame::default()), None, &mut file)?;
/// assert!(file.ends_with(b"f 1 2 3 4\nt interpolateboundary 1/0/0 2\nt crease 2/1/0 0 1 2.5\n"));
/// let Content::Polygons(read) = obj::read(&file, &Limits::default())?.content else { unreachable!() };
/// assert_eq!(read.cage, cage);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_polygons(
    polygons: &Polygons,
    certificate: Option<&Value>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    write_polygons_with_library(polygons, certificate, None, out)
}

/// As [`write_polygons`], and refers to a material library, which [`super::side_files_of_polygons`] creates.
///
/// # Errors
/// As for [`write_polygons`].
pub fn write_polygons_with_library(
    polygons: &Polygons,
    certificate: Option<&Value>,
    library: Option<&str>,
    out: &mut dyn Write,
) -> Result<(), WriteError> {
    let mut writer = ObjWriter { out: BufWriter::new(out), line: Vec::new(), written: [0; 3] };
    write_comments(CERTIFICATE, certificate, &mut writer.out)?;
    if let Some(library) = library {
        writer.statement("mtllib", library)?;
    }
    vertices(&mut writer, polygons)?;
    faces(&mut writer, polygons)?;
    tags(&mut writer, polygons)?;
    writer.out.flush()?;
    Ok(())
}

fn vertices(writer: &mut ObjWriter, polygons: &Polygons) -> Result<(), WriteError> {
    let n = polygons.cage.positions().len();
    let is_color =
        |a: &&Attribute| a.semantic == Semantic::Color(0) && a.domain == Domain::Vertex && a.width >= 3;
    let color = polygons.attributes.iter().find(is_color).filter(|a| a.values.len() == n * a.width);
    for (vertex, position) in polygons.cage.positions().iter().enumerate() {
        let color = color.map_or(&[][..], |a| &a.row(vertex)[..a.width.min(4)]);
        writer.numbers("v", position.iter().chain(color).copied())?;
    }
    let texcoords = polygons.cage.texcoords().into_iter().flat_map(|texcoords| &texcoords.values);
    texcoords.into_iter().try_for_each(|texcoord| writer.texcoord(*texcoord, &polygons.frame))
}

fn faces(writer: &mut ObjWriter, polygons: &Polygons) -> Result<(), WriteError> {
    let rows = polygons.cage.texcoords().map(|texcoords| &texcoords.corners[..]);
    let of_kind = |kind: &str| {
        let semantic = Semantic::Group(kind.to_owned());
        polygons
            .attributes
            .iter()
            .find(|a| a.semantic == semantic && a.domain == Domain::Face && a.width == 1)
    };
    let mut groups: Vec<(&Attribute, &str, &str, f64)> = Vec::new();
    let names = ObjNames::new(&polygons.groups, &polygons.assets);
    for (kind, keyword) in GROUPS {
        if groups.iter().any(|(_, _, other, _)| *other == keyword) {
            continue;
        }
        groups.extend(of_kind(kind).map(|attribute| (attribute, kind, keyword, 0.0)));
    }
    let mut corner = 0;
    for (face, of) in polygons.cage.faces().enumerate() {
        for (attribute, kind, keyword, current) in &mut groups {
            let value = attribute.values.get(face).copied().unwrap_or(0.0);
            if value != *current {
                *current = value;
                writer.statement(keyword, &names.name(kind, value))?;
            }
        }
        writer.line.clear();
        writer.line.push(b'f');
        for vertex in of {
            write!(writer.line, " {}", u64::from(*vertex) + 1)?;
            let row = rows.and_then(|rows| rows.get(corner)).filter(|row| **row != CornerTexcoords::NONE);
            if let Some(row) = row {
                write!(writer.line, "/{}", u64::from(*row) + 1)?;
            }
            corner += 1;
        }
        writer.end_line()?;
    }
    Ok(())
}

/// The most holes in one tag. Chosen: few enough for readers with lines of 256 bytes.
const HOLES: usize = 16;

fn tags(writer: &mut ObjWriter, polygons: &Polygons) -> Result<(), WriteError> {
    let cage = &polygons.cage;
    // After a tag's name are the numbers of its integers, reals and words, and then these. Vertices
    // and faces count from 0, unlike in faces.
    let boundary = BOUNDARIES.iter().find(|(rule, _)| *rule == cage.boundary());
    if let Some((_, number)) = boundary {
        writeln!(writer.out, "t interpolateboundary 1/0/0 {number}")?;
    }
    if cage.scheme() != Scheme::CatmullClark {
        writeln!(writer.out, "t {SCHEME} 0/0/1 {}", cage.scheme().name())?;
    }
    if cage.lists_corners() {
        writeln!(writer.out, "t {REFINED} 0/0/0")?;
    }
    if cage.creasing() == CreasingMethod::Chaikin {
        writeln!(writer.out, "t creasemethod 0/0/1 chaikin")?;
    }
    let linear = cage.texcoords().map_or(LinearTexcoords::default(), |texcoords| texcoords.linear);
    if linear != LinearTexcoords::default()
        && let Some(number) = LinearTexcoords::ALL.iter().position(|rule| *rule == linear)
    {
        writeln!(writer.out, "t facevaryinginterpolateboundary 1/0/0 {number}")?;
    }
    for ([a, b], sharp) in cage.creases() {
        writer.line.clear();
        write!(writer.line, "t crease 2/1/0 {a} {b} ")?;
        put_double(&mut writer.line, *sharp);
        writer.end_line()?;
    }
    for (vertex, sharp) in cage.sharp_vertices() {
        writer.line.clear();
        write!(writer.line, "t corner 1/1/0 {vertex} ")?;
        put_double(&mut writer.line, *sharp);
        writer.end_line()?;
    }
    for some in cage.holes().chunks(HOLES) {
        write!(writer.out, "t hole {}/0/0", some.len())?;
        some.iter().try_for_each(|face| write!(writer.out, " {face}"))?;
        writeln!(writer.out)?;
    }
    Ok(())
}
