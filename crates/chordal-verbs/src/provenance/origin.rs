//! The origin of an input: the history that its own certificate proves.
use super::composed::Composed;
use super::geometry_digest::digest_in_frame;
use super::seal::seal_of;
use crate::input::carried::carried_sources;
use crate::input::volume::reaches_border;
use crate::report::{HistoryFacts, HistoryStart, SourceFacts, StepFacts};
use crate::{Input, Shape};
use chordal::convert::Inside;
use chordal_io::{Axis, Frame};
use serde_json::Value;
use std::sync::Arc;

/// The steps that led to an input, or the reason why none of them count.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct InputOrigin {
    /// The steps, in order.
    pub steps: Vec<StepFacts>,
    /// The reason why there are no earlier steps.
    pub begins: HistoryStart,
    /// The inputs that the input was put together from, with their histories.
    pub composed: Option<Arc<Composed>>,
    /// The scripts that it was made from: the input itself, or those that its file carries.
    pub sources: Vec<SourceFacts>,
}

impl InputOrigin {
    /// Reads the certificate of an input, and checks that it is for this geometry.
    pub fn from_input(input: &Input) -> Self {
        if let Some(composed) = &input.composed {
            let reason = "the input was put together from parts, which have histories of their own";
            let begins = HistoryStart::new("composed", reason);
            let composed = Some(Arc::clone(composed));
            return Self { steps: Vec::new(), begins, composed, sources: Vec::new() };
        }
        match history_of(input) {
            Ok(HistoryFacts { begins, steps, .. }) => {
                Self { steps, begins, composed: None, sources: carried_sources(input) }
            }
            Err(begins) => {
                let sources = input.source.as_deref().cloned().into_iter().collect();
                Self { steps: Vec::new(), begins, composed: None, sources }
            }
        }
    }
}

/// The certificate that a shape carries.
pub(crate) fn embedded_certificate(shape: &Shape) -> Option<&Value> {
    match shape {
        Shape::Scene(scene) => scene.certificate.as_ref(),
        Shape::Cage(polygons) => polygons.certificate.as_ref(),
        Shape::Drawing(drawing) => drawing.certificate.as_ref(),
        Shape::Curves(curves) => curves.certificate.as_ref(),
        Shape::Volume(sampled) => sampled.volume.certificate.as_ref(),
        Shape::Patches { .. } | Shape::Surfaces { .. } | Shape::Field(_) => None,
    }
}

/// The frame that a certificate states.
pub(crate) fn stated_frame(certificate: &Value) -> Frame {
    let up = match certificate.pointer("/frame/up").and_then(Value::as_str) {
        Some("y") => Some(Axis::Y),
        Some("z") => Some(Axis::Z),
        _ => None,
    };
    let metres_per_unit = certificate.pointer("/frame/metres_per_unit").and_then(Value::as_f64);
    Frame { up, metres_per_unit, ..Frame::default() }
}

fn history_of(input: &Input) -> Result<HistoryFacts, HistoryStart> {
    let Some(certificate) = embedded_certificate(&input.shape) else {
        return Err(HistoryStart::new("no-certificate", "the input carries no certificate"));
    };
    let stop = |code: &str, reason: &str| Err(HistoryStart::new(code, reason));
    let Some(history) = certificate.get("history").filter(|history| !history.is_null()) else {
        return stop("no-history", "the certificate of the input is of a version without histories");
    };
    // First the seal: all that follows believes what the certificate says.
    if certificate.get("seal").and_then(Value::as_str) != Some(&seal_of(certificate)) {
        return stop("seal", "the certificate of the input was edited: its seal does not match");
    }
    let Ok(history) = serde_json::from_value::<HistoryFacts>(history.clone()) else {
        return stop("unreadable", "the history in the certificate of the input cannot be read");
    };
    let Some(last) = history.steps.last() else {
        return stop("unreadable", "the history in the certificate of the input has no step");
    };
    // A history with contradictory numbers proves nothing.
    if history.flaw().is_some() {
        return stop("unreadable", "the bounds in the history of the input do not add up");
    }
    let frame = stated_frame(certificate);
    let digest = digest_in_frame(&input.shape, input.format, &frame).ok().flatten();
    if digest.is_none() || digest != last.output.geometry {
        return stop(
            "geometry",
            "the certificate of the input is for another geometry: the file was changed",
        );
    }
    // Coordinates read from a glTF are in metres, and the bounds are in units of the frame.
    let is_scaled = input.format.is_gltf() && frame.metres_per_unit.is_some_and(|metres| metres != 1.0);
    let (was, is) = (frame.metres_per_unit, input.shape.frame().metres_per_unit);
    if is_scaled || was.zip(is).is_some_and(|(was, is)| was != is) {
        let now = is.map_or("another".to_owned(), |metres| format!("{metres} m"));
        let reason = format!(
            "the bounds of the input are in units of {} m, and its coordinates in units of {now}",
            was.unwrap_or(1.0)
        );
        return Err(HistoryStart::new("unit", reason));
    }
    if let Shape::Volume(sampled) = &input.shape {
        let surface = &sampled.surface;
        let is_zero_set = surface.level.is_none_or(|level| level == 0.0)
            && surface.inside.is_none_or(|inside| inside == Inside::Low)
            && surface.labels.is_none()
            && surface.smooth.is_none();
        if !is_zero_set || reaches_border(&sampled.volume.grid, 0.0, Inside::Low) {
            let reason =
                "the bounds of the input are for the zero set of its samples, and another surface was chosen";
            return stop("surface", reason);
        }
    }
    Ok(history)
}
