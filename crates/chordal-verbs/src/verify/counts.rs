//! The counts that a certificate claims, counted again.
use super::claims::ClaimList;
use crate::output::file_rows::to_file_rows;
use crate::report::{CountedTriangles, Output, PolygonFacts, PolylineFacts, to_value};
use crate::{Input, MeshFailure, Shape};
use chordal_io::VertexRows;
use serde_json::Value;

/// Counts the content of the file, and compares every count in the certificate.
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
    let stated = certificate.get("valid").unwrap_or(&Value::Null);
    let has_other = stated.get("other").is_some_and(|other| !other.is_null());
    let mut valid = valid;
    if let Shape::Scene(scene) = &out.shape
        && has_other
        && out.format.vertex_rows() == VertexRows::Soup
    {
        // Such a file has no indices, so that each triangle would stand alone: its reader ties corners at one position.
        let rows = to_file_rows(scene.clone(), out.format)?;
        valid["other"] = to_value(&CountedTriangles::from_scene(&rows, out.format)?.valid.other);
    }
    compare(certificate, ("valid", &valid), claims);
    Ok(())
}

/// Compares one group of counts, with nested groups: each value in the certificate has to be the counted one.
fn compare(certificate: &Value, (group, counted): (&str, &Value), claims: &mut ClaimList) {
    compare_with(certificate, (group, counted), (group, claims));
}

/// As [`compare`], with a name for the claim.
pub(super) fn compare_with(
    certificate: &Value,
    (group, counted): (&str, &Value),
    (name, claims): (&str, &mut ClaimList),
) {
    let Some(stated) = certificate.get(group).filter(|stated| !stated.is_null()) else { return };
    let mut wrong = Vec::new();
    differences(name, stated, Some(counted), &mut wrong);
    if wrong.is_empty() {
        claims.prove(name);
    }
    for CountDifference { claim, stated, actual } in wrong {
        match actual {
            Some(actual) => {
                claims.refute(&claim, format!("the certificate says {stated}, and the file has {actual}"));
            }
            None => claims.open(&claim, "nothing of the kind was counted in the file"),
        }
    }
}

/// A count that is not what the certificate states.
struct CountDifference<'a> {
    claim: String,
    stated: &'a Value,
    actual: Option<&'a Value>,
}

fn differences<'a>(
    path: &str,
    stated: &'a Value,
    counted: Option<&'a Value>,
    wrong: &mut Vec<CountDifference<'a>>,
) {
    if let Some(members) = stated.as_object() {
        for (key, value) in members {
            differences(&format!("{path}/{key}"), value, counted.and_then(|group| group.get(key)), wrong);
        }
    } else if counted != Some(stated) {
        wrong.push(CountDifference { claim: path.to_owned(), stated, actual: counted });
    }
}
