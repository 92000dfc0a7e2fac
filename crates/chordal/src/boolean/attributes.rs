//! What the faces of a combined solid carry of the operands' attributes.
use super::BooleanMesh;
use crate::explicit::{Attribute, Domain, InvalidMesh, Mesh, Semantic, Triangle, corner_rows, interpolate};
use crate::math::dot;

impl BooleanMesh {
    /// The mesh with the attributes of `carrier`, which has the faces of all operands one after the other:
    /// face f of operand k is its face `first_face[k] + f`.
    ///
    /// What belongs to faces is copied. What belongs to vertices or corners becomes one row a corner, the linear
    /// interpolation over the face of the operand, exact at its corners; what cannot be blended (groups at
    /// corners) is that of the nearest corner. Normals and tangents are turned where the surface of an operand
    /// that was taken away is the inner wall of a cut.
    ///
    /// # Errors
    /// [`InvalidMesh`] where `carrier` has attributes of wrong lengths.
    ///
    /// # Panics
    /// Where `carrier` lacks a face.
    pub fn with_attributes(&self, carrier: &Mesh, first_face: &[u32]) -> Result<Mesh, InvalidMesh> {
        let faces: Vec<CarriedFace> = (0..self.mesh.faces().len())
            .map(|face| {
                let source = self.sources[face];
                let own = (first_face[source.operand as usize] + source.face) as usize;
                CarriedFace::new(self.mesh.corners(face), own, carrier)
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
                    values.extend_from_slice(attribute.row(face.own));
                    continue;
                }
                let rows = corner_rows(carrier, attribute, face.own);
                for weights in face.weights {
                    let first = values.len();
                    values.resize(first + width, 0.0);
                    let out = &mut values[first..];
                    if is_blended {
                        interpolate(rows, weights, out);
                    } else {
                        out.copy_from_slice(rows[largest(weights)]);
                    }
                    if turns {
                        renew_direction(&mut out[..3], face.is_turned);
                    }
                }
            }
            let domain = if attribute.domain == Domain::Face { Domain::Face } else { Domain::Corner };
            let semantic = attribute.semantic.clone();
            mesh = mesh.with_attribute(Attribute { semantic, domain, width, values })?;
        }
        Ok(mesh)
    }
}

/// Where the corners of a face are on the face that it was cut from.
struct CarriedFace {
    own: usize,
    /// Barycentric coordinates there.
    weights: [[f64; 3]; 3],
    is_turned: bool,
}

impl CarriedFace {
    fn new(corners: [[f64; 3]; 3], own: usize, carrier: &Mesh) -> Self {
        let triangle = Triangle { corners: carrier.corners(own) };
        let weights = corners.map(|p| {
            if let Some(corner) = triangle.corners.iter().position(|q| *q == p) {
                return std::array::from_fn(|k| f64::from(u8::from(k == corner)));
            }
            let inside = triangle.barycentric(p).unwrap_or([1.0, 0.0, 0.0]);
            // A rounded corner may be outside by its last bit.
            let kept = inside.map(|w| if w > 0.0 { w } else { 0.0 });
            let sum = kept[0] + kept[1] + kept[2];
            kept.map(|w| w / sum)
        });
        let normals = [Triangle { corners }.normal(), triangle.normal()];
        let is_turned = matches!(normals, [Some(a), Some(b)] if dot(a, b) < 0.0);
        Self { own, weights, is_turned }
    }
}

fn largest(weights: [f64; 3]) -> usize {
    (1..3).fold(0, |most, k| if weights[k] > weights[most] { k } else { most })
}

/// Gives a blended direction its length again, and turns it.
fn renew_direction(v: &mut [f64], is_turned: bool) {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 {
        let factor = if is_turned { -1.0 } else { 1.0 } / length;
        v.iter_mut().for_each(|x| *x *= factor);
    }
}
