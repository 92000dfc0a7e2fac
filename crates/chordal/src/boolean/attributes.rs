//! The attributes that the faces of a combined solid inherit from the operands.
use super::BooleanMesh;
use crate::explicit::{Attribute, Domain, InvalidMesh, Mesh, Semantic, Triangle, corner_rows, interpolate};
use crate::math::dot;

impl BooleanMesh {
    /// The mesh with the attributes of `carrier`, which has the faces of all operands one after the other:
    /// face f of operand k is its face `first_face[k] + f`.
    ///
    /// Attributes of faces are copied. Attributes of vertices or corners become one row a corner, the linear
    /// interpolation over the face of the operand, exact at its corners; attributes that cannot be blended
    /// (groups at corners) are those of the nearest corner. Normals and tangents are turned if the surface of
    /// an operand that was subtracted is the inner wall of a cut.
    ///
    /// # Errors
    /// [`InvalidMesh`] if `carrier` has attributes of wrong lengths.
    ///
    /// # Panics
    /// If `carrier` lacks a face.
    pub fn with_attributes(&self, carrier: &Mesh, first_face: &[u32]) -> Result<Mesh, InvalidMesh> {
        let faces: Vec<CarriedFace> = (0..self.mesh.faces().len())
            .map(|face| {
                let source = self.sources[face];
                let carrier_face = (first_face[source.operand as usize] + source.face) as usize;
                CarriedFace::new(self.mesh.corners(face), carrier_face, carrier)
            })
            .collect();
        let mut mesh = self.mesh.clone();
        for attribute in carrier.attributes() {
            let width = attribute.width;
            let turns = matches!(attribute.semantic, Semantic::Normal | Semantic::Tangent);
            let is_blended = !matches!(attribute.semantic, Semantic::Group(_));
            let mut values = Vec::with_capacity(3 * width * faces.len());
            for face in &faces {
                if attribute.domain == Domain::Face {
                    values.extend_from_slice(attribute.row(face.source_face));
                    continue;
                }
                let rows = corner_rows(carrier, attribute, face.source_face);
                for weights in face.weights {
                    let first = values.len();
                    values.resize(first + width, 0.0);
                    let row_values = &mut values[first..];
                    if is_blended {
                        interpolate(rows, weights, row_values);
                    } else {
                        row_values.copy_from_slice(rows[largest(weights)]);
                    }
                    if turns {
                        renew_direction(&mut row_values[..3], face.is_turned);
                    }
                }
            }
            // A vertex on a cut belongs to faces of both operands, so values of vertices become
            // values of corners.
            let domain = if attribute.domain == Domain::Face { Domain::Face } else { Domain::Corner };
            let semantic = attribute.semantic.clone();
            mesh = mesh.with_attribute(Attribute { semantic, domain, width, values })?;
        }
        Ok(mesh)
    }
}

/// The positions of a face's corners on the face from which it was cut.
struct CarriedFace {
    source_face: usize,
    /// Their barycentric coordinates there.
    weights: [[f64; 3]; 3],
    is_turned: bool,
}

impl CarriedFace {
    fn new(corners: [[f64; 3]; 3], source_face: usize, carrier: &Mesh) -> Self {
        let triangle = Triangle { corners: carrier.corners(source_face) };
        let weights = corners.map(|p| {
            // Equality first: rounded barycentric coordinates of a corner would blend in a little
            // of the others.
            if let Some(corner) = triangle.corners.iter().position(|q| *q == p) {
                return std::array::from_fn(|k| f64::from(u8::from(k == corner)));
            }
            // A face without area has no such coordinates.
            let inside = triangle.barycentric(p).unwrap_or([1.0, 0.0, 0.0]);
            // Rounding may put a corner outside by its last bit.
            let clamped = inside.map(|w| if w > 0.0 { w } else { 0.0 });
            let sum = clamped[0] + clamped[1] + clamped[2];
            clamped.map(|w| w / sum)
        });
        let normals = [Triangle { corners }.normal(), triangle.normal()];
        // A piece lies in the plane of its face, so its normal is that of the face or, on the wall
        // of a cut, the opposite one.
        let is_turned = matches!(normals, [Some(a), Some(b)] if dot(a, b) < 0.0);
        Self { source_face, weights, is_turned }
    }
}

fn largest(weights: [f64; 3]) -> usize {
    (1..3).fold(0, |most, k| if weights[k] > weights[most] { k } else { most })
}

/// Restores the length of a blended direction, and turns it if necessary.
fn renew_direction(v: &mut [f64], is_turned: bool) {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 {
        let factor = if is_turned { -1.0 } else { 1.0 } / length;
        v.iter_mut().for_each(|x| *x *= factor);
    }
}
