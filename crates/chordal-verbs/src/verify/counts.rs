//! The counts that a certificate claims, counted again.
use super::claims::ClaimList;
use crate::report::{CountedTriangles, Output, PolygonFacts, PolylineFacts, to_value};
use crate::{Input, MeshFailure, Shape};
use serde_json::Value;

/// Counts what the file holds, and compares every count that the certificate has.
pub(super) fn check(out: &Input, certificate: &Value, claims: &mut ClaimList) -> Result<(), MeshFailure> {
    let (output, valid) = match &out.shape {
        Shape::Scene(scene) => {
            let counted = CountedTriangles::from_scene(scene, out.format)?;
            (Some(Output::Triangles(counted.output)), to_value(&counted.valid))
        }
        Shape::Cage(polygons) => {
            (Some(Output::Polygons(PolygonFacts::from_cage(&polygons.cage))), Value::Null)
        }
        Shape::Drawing(drawing) => {
            (PolylineFacts::from_straight_curves(&drawing.lines).map(Output::Polylines), Value::Null)
        }
        Shape::Curves(curves) => {
            (PolylineFacts::from_straight_curves(&curves.lines).map(Output::Polylines), Value::Null)
        }
        Shape::Volume(_) | Shape::Patches { .. } | Shape::Surfaces { .. } | Shape::Field(_) => {
            (None, Value::Null)
        }
    };
    compare(certificate, ("output", &to_value(&output)), claims);
    compare(certificate, ("valid", &valid), claims);
    Ok(())
}

/// Compares one group of counts: each plain value that is claimed has to be what was counted.
fn compare(certificate: &Value, (group, counted): (&str, &Value), claims: &mut ClaimList) {
    let Some(said) = certificate.get(group).and_then(Value::as_object) else { return };
    let mut all_hold = true;
    for (key, value) in said.iter().filter(|(_, value)| !value.is_object() && !value.is_array()) {
        match counted.get(key) {
            Some(found) if found == value => {}
            Some(found) => {
                all_hold = false;
                let claim = format!("{group}/{key}");
                claims.refute(&claim, format!("the certificate says {value}, and the file has {found}"));
            }
            None => {
                all_hold = false;
                let claim = format!("{group}/{key}");
                claims.open(&claim, "nothing of the kind was counted in the file");
            }
        }
    }
    if all_hold {
        claims.prove(group);
    }
}
