//! `assemble`: builds a mesh from the lists that a reader filled, and counts its oddities.
use crate::grow::with_room;
use crate::text::grouped;
use crate::warnings::Warnings;
use crate::{FileLocation, Limits, ReadError};
use chordal::budget::par_map;
use chordal::explicit::nurbs::TrimmedSurface;
use chordal::explicit::{Attribute, Domain, Semantic, face_normal};
use chordal::math::{Box3, greater};
use chordal::{Job, Mesh, Patch};

/// The lists that a reader filled, before they are validated as a mesh.
#[derive(Debug, Default)]
pub(crate) struct RawMesh {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) position_id: Option<Vec<u32>>,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) attributes: Vec<Attribute>,
}

/// Builds the mesh. Vertices that are not finite are dropped with their faces; readers pass such vertices
/// only if the limits allow dropping.
///
/// # Errors
/// `extent-overflow` if the size of the bounding box is not finite.
pub(crate) fn mesh(mut raw: RawMesh, limits: &Limits, warnings: &mut Warnings) -> Result<Mesh, ReadError> {
    drop_nonfinite(&mut raw, warnings)?;
    check_extent(&raw.positions)?;
    let invalid = |error| ReadError::new("invalid-mesh", FileLocation::File, format!("{error}"));
    let mut mesh = Mesh::new(raw.positions, raw.faces).map_err(invalid)?;
    if let Some(id) = raw.position_id {
        mesh = mesh.with_position_id(id).map_err(invalid)?;
    }
    for mut attribute in raw.attributes {
        clean(&mut attribute, warnings);
        mesh = mesh.with_attribute(attribute).map_err(invalid)?;
    }
    count_oddities(&mesh, limits.threads, warnings)?;
    Ok(mesh)
}

/// The new index of a dropped row.
const GONE: u32 = u32::MAX;

fn drop_nonfinite(raw: &mut RawMesh, warnings: &mut Warnings) -> Result<(), ReadError> {
    let is_bad = |p: &[f64; 3]| p.iter().any(|x| !x.is_finite());
    if !raw.positions.iter().any(is_bad) {
        return Ok(());
    }
    let mut new_index = with_room(raw.positions.len())?;
    let mut kept = 0;
    for position in &raw.positions {
        new_index.push(if is_bad(position) { GONE } else { kept });
        kept += u32::from(!is_bad(position));
    }
    let keep_vertex: Vec<bool> = new_index.iter().map(|i| *i != GONE).collect();
    let keep_face: Vec<bool> = raw.faces.iter().map(|f| f.iter().all(|i| keep_vertex[*i as usize])).collect();
    // Before the positions and faces themselves: what is kept is decided by the old rows.
    for attribute in &mut raw.attributes {
        let keep = |row: usize| match attribute.domain {
            Domain::Vertex => keep_vertex[row],
            Domain::Corner => keep_face[row / 3],
            Domain::Face => keep_face[row],
        };
        let (width, mut at) = (attribute.width, 0);
        // `retain` visits the numbers in order, so their row is a count.
        attribute.values.retain(|_| {
            at += 1;
            keep((at - 1) / width)
        });
    }
    // Rows with the same position id are equal, so all of them are kept or all are dropped.
    if let Some(id) = &mut raw.position_id {
        *id = id.iter().map(|i| new_index[*i as usize]).filter(|i| *i != GONE).collect();
    }
    let dropped = |keep: &[bool]| keep.iter().filter(|k| !**k).count() as u64;
    warnings.count_all(
        "vertices-dropped",
        dropped(&keep_vertex),
        "vertices that are not finite were dropped",
    );
    warnings.count_all(
        "faces-dropped",
        dropped(&keep_face),
        "faces at vertices that are not finite were dropped",
    );
    raw.positions.retain(|p| !is_bad(p));
    let mut face = keep_face.iter();
    raw.faces.retain(|_| *face.next().unwrap_or(&true));
    raw.faces.iter_mut().flatten().for_each(|i| *i = new_index[*i as usize]);
    Ok(())
}

pub(crate) fn check_extent<'a>(positions: impl IntoIterator<Item = &'a [f64; 3]>) -> Result<(), ReadError> {
    let Box3 { min, max } = Box3::from_points(positions);
    let Some(k) = (0..3).find(|k| max[*k] - min[*k] == f64::INFINITY) else { return Ok(()) };
    let message = format!(
        "the {} coordinates reach from {:e} to {:e}: the distance is over the limit of 1.8e308",
        ["x", "y", "z"][k],
        min[k],
        max[k]
    );
    Err(ReadError::new("extent-overflow", FileLocation::File, message))
}

/// How far the length of a normal may be from 1 before it is scaled. Derived: two decimals per coordinate,
/// the fewest that writers print, cost 0.005·√3 ≈ 0.0087.
const UNIT_SLACK: f64 = 0.01;

pub(crate) fn clean(attribute: &mut Attribute, warnings: &mut Warnings) {
    let mut bad = 0;
    for value in attribute.values.iter_mut().filter(|v| !v.is_finite()) {
        *value = 0.0;
        bad += 1;
    }
    let sentence = "attribute values that are not finite were set to 0";
    warnings.count_all("attribute-not-finite", bad, sentence);
    if attribute.semantic != Semantic::Normal || attribute.width != 3 {
        return;
    }
    let (mut scaled, mut missing) = (0, 0);
    for normal in attribute.values.chunks_exact_mut(3) {
        let largest = normal.iter().fold(0.0_f64, |m, x| greater(x.abs(), m));
        if largest == 0.0 {
            missing += 1;
            continue;
        }
        // If the square is this near to 1, the length is nearer: most normals skip the square root.
        if (normal.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < UNIT_SLACK {
            continue;
        }
        // Dividing first keeps the squares from overflowing or vanishing.
        let length = largest * normal.iter().map(|x| (x / largest) * (x / largest)).sum::<f64>().sqrt();
        if (length - 1.0).abs() > UNIT_SLACK {
            let relative = length / largest;
            normal.iter_mut().for_each(|x| *x = *x / largest / relative);
            scaled += 1;
        }
    }
    warnings.count_all("normals-scaled", scaled, "normals were scaled to length 1");
    warnings.count_all("normals-zero", missing, "vertices have a normal of length 0, which is none");
}

/// The number of faces from which threads pay off. Measured: one thread counts 4096 faces in a tenth of a
/// millisecond.
const MANY_FACES: usize = 4096;

/// Counts one kind of oddity, or two that are found together.
type OddityCount = fn(&Mesh, &mut Warnings) -> Result<(), ReadError>;

/// The checks, in the order in which their warnings are reported.
const ODDITIES: [OddityCount; 4] =
    [count_isolated_vertices, count_flat_faces, count_duplicate_vertices, count_duplicate_faces];

/// Counts properties that are legal but rarely intended. Changes nothing.
fn count_oddities(mesh: &Mesh, threads: usize, warnings: &mut Warnings) -> Result<(), ReadError> {
    let (n_vertices, n_faces) = (mesh.positions().len(), mesh.faces().len());
    if n_vertices == 0 {
        warnings.count_all("no-vertices", 1, "the file has no vertices");
    }
    if n_faces == 0 {
        warnings.count_all("no-faces", 1, "the file has no faces");
        return Ok(());
    }
    // With few faces, the counts are done before a thread has started.
    let threads = if n_faces < MANY_FACES { 1 } else { threads };
    let counts = par_map(&Job::default().with_threads(threads), &ODDITIES, |_, count| {
        let mut counts = Warnings::default();
        count(mesh, &mut counts).map(|()| counts)
    });
    counts.into_iter().try_for_each(|counts| counts.map(|counts| warnings.append(counts)))
}

fn count_isolated_vertices(mesh: &Mesh, warnings: &mut Warnings) -> Result<(), ReadError> {
    let n_vertices = mesh.positions().len();
    let mut used: Vec<bool> = with_room(n_vertices)?;
    used.resize(n_vertices, false);
    mesh.faces().iter().flatten().for_each(|i| used[mesh.position_of(*i) as usize] = true);
    let isolated = (0..n_vertices as u32).filter(|i| !used[mesh.position_of(*i) as usize]).count();
    warnings.count_all("isolated-vertices", isolated as u64, "vertices belong to no face");
    Ok(())
}

fn count_flat_faces(mesh: &Mesh, warnings: &mut Warnings) -> Result<(), ReadError> {
    let flat = (0..mesh.faces().len()).filter(|f| is_flat(mesh.corners(*f))).count();
    warnings.count_all("zero-area-faces", flat as u64, "faces have no area");
    Ok(())
}

/// Whether a triangle has no normal.
fn is_flat(corners: [[f64; 3]; 3]) -> bool {
    let [a, b, c] = corners;
    let from_a = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let (ab, ac) = (from_a(b), from_a(c));
    // Far above the loss of a product that underflows (2⁻¹⁰⁷⁴): a cross product above it is distinguished
    // from zero without scaling.
    const CLEAR: f64 = f64::from_bits((1023 - 900) << 52);
    let is_clear = |i: usize, j: usize| {
        let component = (ab[i] * ac[j] - ab[j] * ac[i]).abs();
        component > CLEAR && component.is_finite()
    };
    let clear = is_clear(1, 2) || is_clear(2, 0) || is_clear(0, 1);
    !clear && face_normal(corners).is_none()
}

/// Counts vertices at bit-identical positions to which the file gives different position ids. Compares hashes
/// instead of positions: a collision, one in 10¹⁹, would count one too many.
fn count_duplicate_vertices(mesh: &Mesh, warnings: &mut Warnings) -> Result<(), ReadError> {
    let mut hashes = with_room(mesh.positions().len())?;
    for (i, position) in mesh.positions().iter().enumerate() {
        if mesh.position_of(i as u32) as usize == i {
            hashes.push(position.iter().fold(0x9E37_79B9_7F4A_7C15, |hash: u64, x| {
                // The finaliser of SplitMix64 (G. Steele, D. Lea, C. Flood, 2014).
                let mut mixed = hash.rotate_left(23) ^ x.to_bits();
                mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
                mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
                mixed ^ (mixed >> 31)
            }));
        }
    }
    hashes.sort_unstable();
    let repeats = hashes.windows(2).filter(|w| w[0] == w[1]).count();
    let sentence = "vertices repeat the position of another one; they were not merged";
    warnings.count_all("duplicate-vertices", repeats as u64, sentence);
    Ok(())
}

/// Counts faces over the same three positions, with the same or the opposite orientation.
fn count_duplicate_faces(mesh: &Mesh, warnings: &mut Warnings) -> Result<(), ReadError> {
    // A counting sort by the lowest position, in linear time. Few faces share a lowest position, so the sorts
    // inside the buckets are short.
    let mut ends: Vec<u32> = with_room(mesh.positions().len())?;
    ends.resize(mesh.positions().len(), 0);
    let key =
        |[a, b, c]: &[u32; 3]| face_key([mesh.position_of(*a), mesh.position_of(*b), mesh.position_of(*c)]);
    let keys = || mesh.faces().iter().filter_map(key);
    keys().for_each(|(lowest, _)| ends[lowest as usize] += 1);
    let mut n_keys = 0;
    for end in &mut ends {
        n_keys += *end;
        *end = n_keys - *end;
    }
    let mut sorted: Vec<u128> = with_room(n_keys as usize)?;
    sorted.resize(n_keys as usize, 0);
    for (lowest, key) in keys() {
        let end = &mut ends[lowest as usize];
        sorted[*end as usize] = key;
        *end += 1;
    }
    let (mut start, mut same, mut opposite) = (0, 0, 0);
    for end in ends {
        let of_position = &mut sorted[start..end as usize];
        start = end as usize;
        of_position.sort_unstable();
        // Keys end with the orientation: equal but for the last bit are faces of opposite
        // orientation, and sorted they are neighbours.
        for pair in of_position.windows(2) {
            same += u64::from(pair[0] == pair[1]);
            opposite += u64::from(pair[0] != pair[1] && pair[0] >> 1 == pair[1] >> 1);
        }
    }
    warnings.count_all("duplicate-faces", same, "faces repeat another one; they were not merged");
    warnings.count_all(
        "opposite-faces",
        opposite,
        "faces cover another one the other way round; both were kept",
    );
    Ok(())
}

/// The lowest position of a face, and a number for the other two and the orientation; `None` if two corners
/// share a position.
#[inline]
fn face_key([a, b, c]: [u32; 3]) -> Option<(u32, u128)> {
    if a == b || b == c || c == a {
        return None;
    }
    let mut sorted = [a, b, c];
    sorted.sort_unstable();
    // A rotation of the sorted triple is even; the other three orders are odd.
    let odd = (a < b) as u8 + (b < c) as u8 + (c < a) as u8 == 1;
    let [_, b, c] = sorted.map(u128::from);
    Some((sorted[0], (b << 33) | (c << 1) | u128::from(odd)))
}

/// The error for a list with more rows than the limits allow or 32-bit indices can address.
pub(crate) fn too_many_rows(place: FileLocation, what: &str, rows: u64, limit: u64) -> ReadError {
    let message = format!("{} {what} are over the limit of {}", grouped(rows), grouped(limit));
    ReadError::new("too-many-rows", place, message)
}

/// Counts oddities of patches, and refuses patches whose bounding box is not finite.
pub(crate) fn check_patches(patches: &[Patch], warnings: &mut Warnings) -> Result<(), ReadError> {
    check_extent(patches.iter().flat_map(|p| p.control.as_flattened()))?;
    warnings.count_all("no-patches", u64::from(patches.is_empty()), "the file has no patches");
    let is_point = |p: &&Patch| p.control.as_flattened().iter().all(|c| *c == p.control[0][0]);
    let points = patches.iter().filter(is_point).count();
    warnings.count_all("point-patches", points as u64, "patches have all their control points in one place");
    Ok(())
}

pub(crate) fn check_surfaces(surfaces: &[TrimmedSurface], warnings: &mut Warnings) -> Result<(), ReadError> {
    check_extent(surfaces.iter().flat_map(|face| face.surface().control()))?;
    warnings.count_all("no-surfaces", u64::from(surfaces.is_empty()), "the file has no surfaces");
    Ok(())
}

/// The position ids, if each names a vertex at the same position.
pub(crate) fn checked_position_ids(
    ids: &[i64],
    positions: &[[f64; 3]],
    warnings: &mut Warnings,
) -> Result<Option<Vec<u32>>, ReadError> {
    let mut checked = with_room(ids.len())?;
    for (row, &id) in ids.iter().enumerate() {
        let other = usize::try_from(id).ok().and_then(|i| positions.get(i));
        if other.map(|p| p.map(f64::to_bits)) != Some(positions[row].map(f64::to_bits)) {
            warnings.count("position-id-skipped", || {
                let message = format!("position_id {id} names no vertex at the same position; none was used");
                (FileLocation::Row { list: "vertex", row: row as u64 }, message)
            });
            return Ok(None);
        }
        checked.push(id as u32);
    }
    Ok(Some(checked))
}
