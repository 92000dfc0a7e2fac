//! `field_shader`: a field as functions for a graphics processor.
use crate::report::{Certificate, VerbFacts};
use crate::{Input, MeshFailure, Shape};
use chordal::budget::RefusalCode;
use chordal::convert::shader::{FieldShader, ShaderRefusal, field_to_shader};

/// A field as the text of a shader.
#[derive(Clone, Debug, PartialEq)]
pub struct ShaderOutcome {
    /// The text and the facts about it.
    pub shader: FieldShader,
    /// The certificate for the report; the text holds none.
    pub certificate: Certificate,
}

/// Writes a field, clipped to its region, as functions of GLSL ES 3.00; `name` is that of the main one. Notes state how many
/// terms it has, and how its Lipschitz constant is known.
///
/// # Errors
/// If the shape is not a field, has no finite box, or has a part that is no expression.
pub fn field_shader(input: &Input, name: &str) -> Result<ShaderOutcome, MeshFailure> {
    let refused = |message: String| MeshFailure::refused(RefusalCode::Unsupported, message);
    let Shape::Field(shape) = &input.shape else {
        return Err(refused(format!("glsl holds fields alone, and the input holds {}", input.shape.kind())));
    };
    let shader = field_to_shader(&shape.clip_to_region(), name).map_err(|refusal| match refusal {
        ShaderRefusal::Leaf(error) => refused(error.message),
        other => refused(other.to_string()),
    })?;
    let mut certificate = Certificate::from_input(input);
    certificate.verb = VerbFacts::Converted {};
    let known = shader.slope_evidence.as_str();
    certificate.notes.push(
        format!("a value takes {} terms; its slope is at most {}, {known}", shader.n_terms, shader.slope)
            .into(),
    );
    Ok(ShaderOutcome { shader, certificate })
}
