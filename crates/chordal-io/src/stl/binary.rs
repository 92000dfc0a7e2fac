//! Reads binary STL.
use super::facets::StlFacets;
use crate::text::grouped;
use crate::{Content, FileLocation, Frame, Limits, ReadError, ReadOutcome, Scene};

/// The bytes before the first facet of a binary file: 80 of header and a count.
pub(super) const HEAD: usize = 84;
/// The bytes of one binary facet: a normal and three corners of three f32 each, and two bytes for free use.
pub(super) const FACET: usize = 50;

/// Reads the facets of a file of at least 84 bytes.
pub(super) fn read(bytes: &[u8], limits: &Limits) -> Result<ReadOutcome, ReadError> {
    let n_facets = declared(bytes).unwrap_or(0);
    if size_of(n_facets) > bytes.len() as u64 {
        return Err(too_short(bytes, n_facets));
    }
    let mut facets = StlFacets::with_room(n_facets as usize)?;
    let (records, rest) = bytes[HEAD..].split_at(FACET * n_facets as usize);
    for (row, record) in records.as_chunks::<FACET>().0.iter().enumerate() {
        let mut triples = [[0.0; 3]; 4];
        for (x, bytes) in triples.as_flattened_mut().iter_mut().zip(record.as_chunks().0) {
            *x = f64::from(f32::from_le_bytes(*bytes));
        }
        let [normal, corners @ ..] = triples;
        let place = || FileLocation::Row { list: "facet", row: row as u64 };
        facets.push(corners, normal, place, limits)?;
        if record[48..] != [0, 0] {
            let message = "attribute bytes of facets (colours, in some tools) were skipped";
            facets.warnings.count("attributes-skipped", || (place(), message.to_owned()));
        }
    }
    facets.warnings.count_many("trailing-bytes", u64::from(!rest.is_empty()), || {
        let place = FileLocation::Byte((bytes.len() - rest.len()) as u64);
        (place, format!("{} extra bytes after the last facet were skipped", grouped(rest.len() as u64)))
    });
    let (mesh, warnings) = facets.into_mesh(None, limits)?;
    let scene = Scene::from_triangle_soup("", mesh, Frame::default());
    Ok(ReadOutcome { content: Content::Scene(scene), warnings: warnings.into_list() })
}

/// The number of facets that a binary header declares.
pub(super) fn declared(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(HEAD - 4..HEAD)?;
    Some(u64::from(u32::from_le_bytes(count.try_into().ok()?)))
}

/// The size of a binary file with that many facets.
pub(super) fn size_of(facets: u64) -> u64 {
    HEAD as u64 + FACET as u64 * facets
}

/// The error for a binary file that is shorter than it declares.
pub(super) fn too_short(bytes: &[u8], facets: u64) -> ReadError {
    let size = bytes.len() as u64;
    let n_complete = (size - HEAD as u64) / FACET as u64;
    let message = format!(
        "{} bytes, header says {} facets: that needs {} bytes, and facet {} is cut off",
        grouped(size),
        grouped(facets),
        grouped(size_of(facets)),
        grouped(n_complete)
    );
    ReadError::new("truncated", FileLocation::Byte(size_of(n_complete)), message)
}
