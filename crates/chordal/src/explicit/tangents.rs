//! Tangents for normal maps by MikkTSpace, the method of the programs that bake or render such maps.
use super::{Attribute, Domain, InvalidMesh, Mesh, Semantic};
use crate::math::greater;
use bevy_mikktspace::{Geometry, Ops, TangentSpace};

/// The mesh with MikkTSpace tangents for a set of texture coordinates; they replace existing tangents. `None`
/// if it has no such coordinates (2 wide) or no normals (3 wide), of vertices, corners or faces.
///
/// Four numbers for each *corner*: the unit tangent, and the sign of the bitangent
/// `sign · (normal × tangent)`. Corners of one vertex can differ, for example where mirrored halves of a
/// texture meet; one tangent per vertex would be wrong there. Formats with vertex attributes only, such as
/// GLB, duplicate such vertices. A corner without a defined tangent, as on faces without area or without
/// extent in the texture, takes the tangent of a neighbour or, without one, (1, 0, 0, 1).
///
/// The computation is in single precision, relative to the centre of the mesh and in units of its extent,
/// because the method is defined on floats and baked maps rely on it. The order of faces does not matter.
/// Square root and arc cosine are `libm`'s, so that the result is the same on every machine. Texture
/// coordinates have v upwards, as in OBJ; for glTF's, which run down, the sign is the opposite.
///
/// About 1 µs per face.
///
/// # Errors
/// None for a valid mesh: [`InvalidMesh`] is passed on from building the result.
///
/// ```
/// use chordal::Mesh;
/// use chordal::explicit::{Attribute, Domain, Semantic, Shading, Topology, with_normals, with_tangents};
/// let square = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let looks = Attribute {
///     semantic: Semantic::TexCoord(0),
///     domain: Domain::Vertex,
///     width: 2,
///     values: vec![0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0],
/// };
/// let mesh = Mesh::new(square, vec![[0, 1, 2], [0, 2, 3]])?.with_attribute(looks)?;
/// let mesh = with_normals(&mesh, Topology::Indices, Shading::Flat)?;
/// let tangents = with_tangents(&mesh, 0).expect("normals and coordinates")?;
/// assert_eq!(tangents.attribute(&Semantic::Tangent).unwrap().row(5), [1.0, 0.0, 0.0, 1.0]);
/// # Ok::<(), chordal::explicit::InvalidMesh>(())
/// ```
///
/// Source: M. S. Mikkelsen, *Simulation of wrinkled surfaces revisited*, 2008; crate `bevy_mikktspace`, with
/// both of its corrections of the sorting in the original.
#[must_use]
pub fn with_tangents(mesh: &Mesh, set: u32) -> Option<Result<Mesh, InvalidMesh>> {
    let normals = mesh.attribute(&Semantic::Normal).filter(|rows| rows.width == 3)?;
    let texture = mesh.attribute(&Semantic::TexCoord(set)).filter(|rows| rows.width == 2)?;
    let bounds = mesh.bounds();
    let half = (0..3).map(|k| 0.5 * bounds.max[k] - 0.5 * bounds.min[k]);
    let extent = half.fold(0.0, |largest: f64, x| greater(x, largest));
    let mut corners = MikktGeometry {
        mesh,
        normals,
        texture,
        centre: if mesh.positions().is_empty() { [0.0; 3] } else { bounds.centre() },
        extent: if extent > 0.0 { extent } else { 1.0 },
        values: [1.0, 0.0, 0.0, 1.0].repeat(3 * mesh.faces().len()),
    };
    // The method cannot fail: its error type has no value.
    let _ = bevy_mikktspace::generate_tangents::<_, Libm>(&mut corners);
    let values = corners.values;
    Some(rebuilt(mesh, values))
}

fn rebuilt(mesh: &Mesh, values: Vec<f64>) -> Result<Mesh, InvalidMesh> {
    let mut rebuilt_mesh = Mesh::new(mesh.positions().to_vec(), mesh.faces().to_vec())?;
    if let Some(ids) = mesh.position_id() {
        rebuilt_mesh = rebuilt_mesh.with_position_id(ids.to_vec())?;
    }
    for attribute in mesh.attributes().iter().filter(|attribute| attribute.semantic != Semantic::Tangent) {
        rebuilt_mesh = rebuilt_mesh.with_attribute(attribute.clone())?;
    }
    rebuilt_mesh.with_attribute(Attribute {
        semantic: Semantic::Tangent,
        domain: Domain::Corner,
        width: 4,
        values,
    })
}

/// Functions with the same results on every machine.
struct Libm;

impl Ops for Libm {
    fn sqrt(x: f32) -> f32 {
        libm::sqrtf(x)
    }

    #[allow(clippy::cast_possible_truncation)]
    fn acos(x: f32) -> f32 {
        libm::acos(f64::from(x)) as f32
    }
}

/// Adapter that gives the method access to a mesh.
struct MikktGeometry<'a> {
    mesh: &'a Mesh,
    normals: &'a Attribute,
    texture: &'a Attribute,
    centre: [f64; 3],
    extent: f64,
    /// The output, four numbers per corner.
    values: Vec<f64>,
}

impl MikktGeometry<'_> {
    fn row<'a>(&self, attribute: &'a Attribute, face: usize, corner: usize) -> &'a [f64] {
        attribute.row(match attribute.domain {
            Domain::Vertex => self.mesh.faces()[face][corner] as usize,
            Domain::Corner => 3 * face + corner,
            Domain::Face => face,
        })
    }
}

/// The number in single precision, clamped so that its square is finite.
#[allow(clippy::cast_possible_truncation)]
fn single(x: f64) -> f32 {
    // Texture coordinates in a file may be any number; past 2^40 they have no meaning any more, and NaN has
    // none at all.
    const MOST: f64 = (1_u64 << 40) as f64;
    if x > MOST {
        MOST as f32
    } else if x < -MOST {
        -MOST as f32
    } else if x.is_nan() {
        0.0
    } else {
        x as f32
    }
}

impl Geometry<Libm> for MikktGeometry<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.faces().len()
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        let p = self.mesh.corners(face)[corner];
        std::array::from_fn(|k| single((0.5 * p[k] - 0.5 * self.centre[k]) / self.extent))
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        let row = self.row(self.normals, face, corner);
        std::array::from_fn(|k| single(row[k]))
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let row = self.row(self.texture, face, corner);
        std::array::from_fn(|k| single(row[k]))
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let tangent = space.map(|space| space.tangent_encoded().map(f64::from));
        if let Some(tangent) = tangent.filter(|tangent| is_unit(*tangent)) {
            self.values[4 * (3 * face + corner)..][..4].copy_from_slice(&tangent);
        }
    }
}

fn is_unit([x, y, z, _]: [f64; 4]) -> bool {
    // Three single-precision numbers rounded from a unit vector: 2^-20 is eight of their steps.
    ((x * x + y * y + z * z) - 1.0).abs() < f64::from(1.0_f32 / 1_048_576.0)
}
