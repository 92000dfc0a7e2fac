//! The counts that a certificate claims, counted again.
use super::claims::ClaimList;
use crate::file_rows::to_file_rows;
use crate::report::{CountedTriangles, Output, PolygonFacts, PolylineFacts, to_value};
use crate::{Input, MeshFailure, Shape};
use chordal_io::VertexRows;
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
    let said = certificate.get("valid").unwrap_or(&Value::Null);
    let says_other = said.get("other").is_some_and(|other| !other.is_null());
    let mut valid = valid;
    if let Shape::Scene(scene) = &out.shape
        && says_other
        && out.format.vertex_rows() == VertexRows::Soup
    {
        // By indices each triangle of such a file stands alone: its reader ties corners at one position.
        let rows = to_file_rows(scene.clone(), out.format)?;
        valid["other"] = to_value(&CountedTriangles::from_scene(&rows, out.format)?.valid.other);
    }
    compare(certificate, ("valid", &valid), claims);
    Ok(())
}

/// Compares one group of counts, with the groups in it: each value that is claimed has to be what was counted.
fn compare(certificate: &Value, (group, counted): (&str, &Value), claims: &mut ClaimList) {
    compare_with(certificate, (group, counted), (group, claims));
}

/// The same, with a name for the claim.
pub(super) fn compare_with(
    certificate: &Value,
    (group, counted): (&str, &Value),
    (name, claims): (&str, &mut ClaimList),
) {
    let Some(said) = certificate.get(group).filter(|said| !said.is_null()) else { return };
    let mut wrong = Vec::new();
    differences(name, said, Some(counted), &mut wrong);
    if wrong.is_empty() {
        claims.prove(name);
    }
    for CountDifference { claim, said, found } in wrong {
        match found {
            Some(found) => {
                claims.refute(&claim, format!("the certificate says {said}, and the file has {found}"));
            }
            None => claims.open(&claim, "nothing of the kind was counted in the file"),
        }
    }
}

/// A count that is not what was counted.
struct CountDifference<'a> {
    claim: String,
    said: &'a Value,
    found: Option<&'a Value>,
}

fn differences<'a>(
    path: &str,
    said: &'a Value,
    counted: Option<&'a Value>,
    wrong: &mut Vec<CountDifference<'a>>,
) {
    if let Some(members) = said.as_object() {
        for (key, value) in members {
            differences(&format!("{path}/{key}"), value, counted.and_then(|all| all.get(key)), wrong);
        }
    } else if counted != Some(said) {
        wrong.push(CountDifference { claim: path.to_owned(), said, found: counted });
    }
}
