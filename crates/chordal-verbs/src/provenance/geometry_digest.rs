//! The digest of a geometry: it ties a certificate to a file, whatever else is in the file.
use super::digest::Sha256Stream;
use crate::Shape;
use crate::scene::frame_nodes::without_frame_nodes;
use chordal::Mesh;
use chordal::explicit::{Cage, Curve, CurveSegment, Semantic};
use chordal::implicit::evaluation::SampleGrid;
use chordal_io::{
    Format, Frame, Limits, Polygons, Polylines, Scene, Volume, WriteError, read, write, write_polygons,
};

/// The SHA-256 of the geometry of a shape as a reader of its file gets it; `None` for patches, fields and bent curves, which
/// no verb writes.
///
/// Triangles: the world coordinates of the corners of all faces in their order, each face from its least corner on. So
/// winding matters, but not how vertices are shared or ordered. Samples: the lattice and every value. Polylines: the points.
/// Polygons: the corners of each, and the sharpness of creases and corners. Zeros have no sign. Attributes, names and
/// materials are not included.
///
/// # Errors
/// If the nodes of a scene are not a tree, or take coordinates out of range.
///
/// ```
/// use chordal_verbs::{FormatHint, geometry_digest, load};
/// let digest = |obj: &str| {
///     let hint = FormatHint { name: Some("a.obj"), ..FormatHint::default() };
///     geometry_digest(&load(obj.as_bytes(), hint, &Default::default()).unwrap().shape).unwrap()
/// };
/// let one = digest("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
/// assert_eq!(one, digest("v 0 1 0\nv 0 0 0\nv 1 0 0\nf 1 2 3\n")); // the same corners in other rows
/// assert_ne!(one, digest("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\n")); // wound the other way
/// ```
pub fn geometry_digest(shape: &Shape) -> Result<Option<String>, WriteError> {
    match shape {
        Shape::Scene(scene) => scene_digest(scene).map(Some),
        Shape::Cage(polygons) => Ok(Some(cage_digest(&polygons.cage))),
        Shape::Drawing(drawing) => Ok(straight_digest(&drawing.lines)),
        Shape::Curves(curves) => Ok(straight_digest(&curves.lines)),
        Shape::Volume(sampled) => Ok(Some(volume_digest(&sampled.volume))),
        Shape::Patches { .. } | Shape::Surfaces { .. } | Shape::Field(_) => Ok(None),
    }
}

/// The digest of a shape in the frame that its certificate states: glTF rotates and scales its content.
pub(crate) fn digest_in_frame(
    shape: &Shape,
    format: Format,
    frame: &Frame,
) -> Result<Option<String>, WriteError> {
    match shape {
        Shape::Scene(scene) => scene_digest(&without_frame_nodes(scene, format, frame)).map(Some),
        other => geometry_digest(other),
    }
}

/// The digest of a scene that is about to be written. If its file will not hold the same faces in the same order with the
/// same coordinates, it is written to memory and read; `None` if that takes other files.
pub(crate) fn written_digest(scene: &Scene, to: Format) -> Option<String> {
    if is_kept_as_it_is(scene, to) {
        return scene_digest(scene).ok();
    }
    let mut bytes = Vec::new();
    write(scene, None, to, &mut bytes).ok()?;
    read_digest(&bytes, to, &scene.frame)
}

/// The same for polygons, which many readers cut into triangles.
pub(crate) fn written_polygons_digest(polygons: &Polygons, to: Format) -> Option<String> {
    let mut bytes = Vec::new();
    write_polygons(polygons, None, to, &mut bytes).ok()?;
    read_digest(&bytes, to, &polygons.frame)
}

/// The digest of the content of a file.
fn read_digest(bytes: &[u8], to: Format, frame: &Frame) -> Option<String> {
    let content = read(bytes, to, &Limits::default()).ok()?.content;
    digest_in_frame(&content.into(), to, frame).ok().flatten()
}

/// Whether readers get the faces of a scene in the same order with the same coordinates: no face is transformed, stored in
/// fewer bits, or grouped.
fn is_kept_as_it_is(scene: &Scene, to: Format) -> bool {
    let is_plain = |part: &chordal_io::Part| {
        // Some writers put faces of one group together, and so in another order.
        let is_grouped =
            |attribute: &chordal::explicit::Attribute| matches!(attribute.semantic, Semantic::Group(_));
        part.storage.is_none() && !part.is_deformed() && !part.mesh.attributes().iter().any(is_grouped)
    };
    let unplaced = crate::scene::placements::is_untransformed(scene);
    // Without draco, meshopt and instancing: these put faces in an order of their own.
    let plain = scene.packing == chordal_io::glb::GltfPacking::default() || !to.has_nodes();
    unplaced && plain && scene.parts.iter().all(is_plain)
}

fn scene_digest(scene: &Scene) -> Result<String, WriteError> {
    let mut digest = Sha256Stream::new("triangles");
    for (_, mesh) in scene.world_meshes()? {
        add_mesh(&mut digest, &mesh);
    }
    Ok(digest.finish())
}

fn add_mesh(digest: &mut Sha256Stream, mesh: &Mesh) {
    for face in 0..mesh.faces().len() {
        let corners = mesh.corners(face).map(|corner| corner.map(bits));
        let [a, b, c] = corners;
        let least = [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap_or(corners);
        digest.add(least.as_flattened());
    }
}

/// The digest of samples and their lattice.
pub(crate) fn volume_digest(volume: &Volume) -> String {
    samples_digest(&volume.grid)
}

/// The same for samples of any storage.
pub(crate) fn samples_digest<G: SampleGrid>(grid: &G) -> String {
    let mut digest = Sha256Stream::new("volume");
    digest.add(&grid.size().map(|n| n as u64));
    grid.affine().rows().iter().for_each(|row| digest.add(&row.map(bits)));
    let [nx, ny, nz] = grid.size();
    let mut row = Vec::with_capacity(nx);
    for k in 0..nz {
        for j in 0..ny {
            row.clear();
            row.extend((0..nx).map(|i| bits(grid.sample([i, j, k]))));
            digest.add(&row);
        }
    }
    digest.finish()
}

/// The digest of polylines.
pub(crate) fn polylines_digest(polylines: &Polylines) -> String {
    let mut digest = Sha256Stream::new("polylines");
    match polylines {
        Polylines::Plane(polylines) => {
            polylines.lines.iter().for_each(|line| add_line(&mut digest, &line.points, line.closed));
        }
        Polylines::Space(polylines) => {
            polylines.lines.iter().for_each(|line| add_line(&mut digest, &line.points, line.closed));
        }
    }
    digest.finish()
}

/// The same for curves that are all straight, as they read back.
fn straight_digest<const D: usize>(curves: &[Curve<D>]) -> Option<String> {
    let mut digest = Sha256Stream::new("polylines");
    for curve in curves {
        if !curve.segments().iter().all(|piece| matches!(piece, CurveSegment::Line(_))) {
            return None;
        }
        let mut points = vec![curve.start()];
        points.extend(curve.segments().iter().map(|piece| piece.end()));
        if curve.is_closed() && points.len() > 1 {
            // A closed curve ends where it starts, and a polyline names that point once.
            points.pop();
        }
        add_line(&mut digest, &points, curve.is_closed());
    }
    Some(digest.finish())
}

fn add_line<const D: usize>(digest: &mut Sha256Stream, points: &[[f64; D]], closed: bool) {
    digest.add(&[points.len() as u64, u64::from(closed), D as u64]);
    points.iter().for_each(|point| digest.add(&point.map(bits)));
}

/// The digest of polygons and their tags.
pub(crate) fn cage_digest(cage: &Cage) -> String {
    let mut digest = Sha256Stream::new("polygons");
    let at = |row: u32| cage.positions()[row as usize].map(bits);
    for face in cage.faces() {
        digest.add(&[face.len() as u64]);
        face.iter().for_each(|row| digest.add(&at(*row)));
    }
    for ([a, b], sharpness) in cage.creases() {
        digest.add(&[at(*a), at(*b)].concat());
        digest.add(&[bits(*sharpness)]);
    }
    digest.finish()
}

/// The bits of a number; equal for both zeros.
fn bits(x: f64) -> u64 {
    if x == 0.0 { 0 } else { x.to_bits() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use chordal_io::Node;

    fn scene(faces: &[[u32; 3]]) -> Scene {
        let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.5]];
        Scene::from_mesh("a", Mesh::new(corners, faces.to_vec()).unwrap(), Frame::default())
    }

    #[test]
    fn a_face_counts_with_its_winding_and_not_with_its_first_corner() {
        let digest = |faces: &[[u32; 3]]| scene_digest(&scene(faces)).unwrap();
        let plain = digest(&[[0, 1, 2], [1, 3, 2]]);
        assert_eq!(plain, digest(&[[2, 0, 1], [3, 2, 1]]));
        for other in [&[[0, 2, 1], [1, 3, 2]][..], &[[0, 1, 2]], &[[0, 1, 2], [1, 3, 2], [0, 1, 2]]] {
            assert_ne!(plain, digest(other));
        }
    }

    #[test]
    fn one_step_of_one_coordinate_is_another_geometry() {
        let plain = scene(&[[0, 1, 2]]);
        for (row, axis) in [(0, 0), (1, 1), (2, 2)] {
            let mut positions = plain.parts[0].mesh.positions().to_vec();
            positions[row][axis] = positions[row][axis].next_up();
            let moved = Mesh::new(positions, vec![[0, 1, 2]]).unwrap();
            let moved = Scene::from_mesh("a", moved, Frame::default());
            assert_ne!(scene_digest(&plain).unwrap(), scene_digest(&moved).unwrap());
        }
    }

    #[test]
    fn what_is_said_before_writing_is_what_is_read_afterwards() {
        let mut placed = scene(&[[0, 1, 2], [1, 3, 2]]);
        let mut matrix = crate::scene::placements::IDENTITY;
        (matrix[0], matrix[12]) = (0.3, 7.1);
        placed.nodes = vec![Node { matrix: matrix.into(), part: Some(0), ..Node::default() }];
        let frames = [
            Frame::default(),
            Frame { up: Some(chordal_io::Axis::Z), metres_per_unit: Some(0.001), ..Frame::default() },
        ];
        for frame in frames {
            for mut scene in [scene(&[[0, 1, 2], [1, 3, 2]]), placed.clone()] {
                scene.frame = frame;
                let said = written_digest(&scene, Format::Glb);
                let mut bytes = Vec::new();
                write(&scene, None, Format::Glb, &mut bytes).unwrap();
                let read = read(&bytes, Format::Glb, &Limits::default()).unwrap().content.into();
                assert_eq!(digest_in_frame(&read, Format::Glb, &frame).unwrap(), said);
                assert!(said.is_some());
            }
        }
    }
}
