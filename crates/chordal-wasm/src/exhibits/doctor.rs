//! The mesh doctor: six defective meshes, their findings, and the effects of cures.
use super::answer::ExhibitAnswer;
use super::request::ExhibitRequest;
use super::shapes::{CUBE, ball, cube, from_quads, mesh_from};
use chordal::budget::advice::Cure;
use chordal::check::findings::{Finding, MeshLocation, Severity, Witness};
use chordal::check::{
    Defect, components, duplicate_vertices, inside_out, outward, self_intersections, t_junctions, validity,
};
use chordal::explicit::Topology;
use chordal::mend::{MendedMesh, apply, drop_unused};
use chordal::{Job, Mesh};
use serde_json::{Value, json};

/// The most cures in a row. Chosen: twice as many as there are.
const MOST_CURES: usize = 16;
/// Vertices are identified by index, as in files with indices.
const ROWS: Topology = Topology::Indices;

/// Answers `{"patient": "hole", "cures": ["fill-holes", …]}`: the mesh after these cures, its findings with
/// their first places and helpful cures, and the cure to apply next.
pub(super) fn doctor(request: &ExhibitRequest) -> Result<ExhibitAnswer, String> {
    request.only(&["patient", "cures"])?;
    let names = ["hole", "seam", "crack", "flipped", "branch", "double"];
    let mut mesh = patient(request.word("patient", &names)?)?;
    let mut done = Vec::new();
    for name in request.words("cures", MOST_CURES)? {
        let cure = Cure::ALL.into_iter().find(|cure| cure.name() == name);
        let cure = cure.ok_or_else(|| format!("there is no cure '{name}'"))?;
        let mended = applied(cure, &mesh)?;
        let changes = mended.changes.iter().map(|change| json!([change.what, change.finding.count]));
        done.push(json!({
            "cure": name, "changes": changes.collect::<Vec<_>>(), "moved_at_most": mended.bound.at_most(),
        }));
        mesh = mended.mesh;
    }
    let mut answer = ExhibitAnswer::default();
    let shown = answer.mesh(&mesh);
    let valid = validity(&mesh, ROWS);
    let parts = components(&mesh, ROWS);
    let findings = findings(&mesh)?;
    let faults = faults(&findings);
    let mut next: Option<Cure> = None;
    let mut finding_facts = Vec::new();
    for (defect, finding) in &findings {
        let cure = helping_cure(&mesh, *defect, faults)?;
        // The first of all helpful cures, since later ones rely on it.
        next = match (next, cure) {
            (Some(a), Some(b)) => Some(if b < a { b } else { a }),
            (a, b) => a.or(b),
        };
        finding_facts.push(json!({
            "defect": defect.name(),
            "is_fault": defect.severity() == Severity::Fault,
            "count": finding.count,
            "cure": cure.map(Cure::name),
            "places": finding.witnesses.iter().map(|witness| place(&mesh, witness)).collect::<Vec<_>>(),
        }));
    }
    answer.facts = json!({
        "mesh": shown,
        "findings": finding_facts,
        "faults": faults,
        "next": next.map(Cure::name),
        "done": done,
        "triangles": valid.triangles,
        "vertices": valid.vertices,
        "components": valid.components,
        "closed": valid.closed,
        "manifold": valid.manifold(),
        "oriented": valid.oriented,
        "outward": outward(&parts),
        // Defined only for a closed, oriented surface.
        "volume": (valid.closed && valid.oriented).then_some(valid.measure.signed_volume),
    });
    Ok(answer)
}

/// All findings, the most severe first.
fn findings(mesh: &Mesh) -> Result<Vec<(Defect, Finding)>, String> {
    let valid = validity(mesh, ROWS);
    let crossing = self_intersections(mesh, &Job::default()).map_err(|error| error.to_string())?;
    let finding = |defect: Defect| match defect {
        Defect::BoundaryEdges => valid.boundary_edges.clone(),
        Defect::NonManifoldEdges => valid.non_manifold_edges.clone(),
        Defect::NonManifoldVertices => valid.non_manifold_vertices.clone(),
        Defect::TJunctions => t_junctions(mesh, ROWS, None),
        Defect::InconsistentEdges => valid.inconsistent_edges.clone(),
        Defect::InsideOut => inside_out(mesh, &components(mesh, ROWS)),
        Defect::SelfIntersections => crossing.clone(),
        Defect::DuplicateFaces => valid.duplicate_faces.clone(),
        Defect::DuplicateVertices => duplicate_vertices(mesh),
        Defect::CollapsedFaces => valid.collapsed_faces.clone(),
        Defect::ZeroAreaFaces => valid.zero_area_faces.clone(),
        Defect::Slivers => valid.slivers.clone(),
        Defect::UnusedVertices => valid.unused_vertices.clone(),
    };
    let list = Defect::ALL.map(|defect| (defect, finding(defect)));
    Ok(list.into_iter().filter(|(_, finding)| !finding.is_none()).collect())
}

/// The number of kinds of faults among findings.
fn faults(findings: &[(Defect, Finding)]) -> usize {
    findings.iter().filter(|(defect, _)| defect.severity() == Severity::Fault).count()
}

/// The first cure of a defect that changes the mesh without adding faults; later ones are for what it leaves.
fn helping_cure(mesh: &Mesh, defect: Defect, faults_before: usize) -> Result<Option<Cure>, String> {
    for cure in defect.cures() {
        let mended = applied(*cure, mesh)?;
        if !mended.is_unchanged() && faults(&findings(&mended.mesh)?) <= faults_before {
            return Ok(Some(*cure));
        }
    }
    Ok(None)
}

/// The corners of a place: one for a vertex, two for an edge, three for a face.
fn place(mesh: &Mesh, witness: &Witness) -> Value {
    let at = |rows: &[u32]| rows.iter().map(|row| mesh.positions()[*row as usize]).collect::<Vec<_>>();
    let corners = match &witness.place {
        MeshLocation::Vertex(row) | MeshLocation::RepeatedVertex { vertex: row, .. } => at(&[*row]),
        MeshLocation::Edge { vertices, .. } => at(vertices),
        MeshLocation::OnEdge { vertex, .. } => at(&[*vertex]),
        MeshLocation::Face(face) | MeshLocation::Repeated { face, .. } | MeshLocation::Faces([face, _]) => {
            at(&mesh.faces()[*face as usize])
        }
        _ => vec![witness.at],
    };
    json!(corners)
}

fn applied(cure: Cure, mesh: &Mesh) -> Result<MendedMesh, String> {
    apply(cure, mesh, ROWS, &Job::default()).map_err(|error| error.to_string())
}

/// A defective mesh: a sound one with one change.
fn patient(name: &str) -> Result<Mesh, String> {
    match name {
        // A vertex is missing with the triangles around it.
        "hole" => {
            let ball = ball(1)?;
            let faces = ball.faces().iter().filter(|face| !face.contains(&2));
            let mesh = mesh_from(ball.positions().to_vec(), faces.copied().collect())?;
            drop_unused(&mesh, &Job::default()).map(|mended| mended.mesh).map_err(|error| error.to_string())
        }
        // Every triangle has its own vertices, as in an STL file.
        "seam" => {
            let ball = ball(1)?;
            let corners = (0..ball.faces().len()).flat_map(|face| ball.corners(face));
            mesh_from(corners.collect(), (0..80).map(|face| [0, 1, 2].map(|k| 3 * face + k)).collect())
        }
        // One face of a cube is finer than its neighbours: the midpoints of its four edges are vertices only
        // there.
        "crack" => {
            let cube = cube()?;
            let mut positions = cube.positions().to_vec();
            let top = CUBE[1];
            let first = positions.len() as u32;
            for k in 0..4 {
                let [p, q] = [top[k], top[(k + 1) % 4]].map(|row| cube.positions()[row as usize]);
                positions.push(std::array::from_fn(|i| 0.5 * (p[i] + q[i])));
            }
            positions.push([0.0, 0.0, 1.0]);
            let others: Vec<_> = CUBE.into_iter().filter(|quad| *quad != top).collect();
            let mut faces = from_quads(&others);
            for k in 0..4 {
                let (before, after) = (first + (k + 3) % 4, first + k);
                faces.extend(from_quads(&[[top[k as usize], after, first + 4, before]]));
            }
            mesh_from(positions, faces)
        }
        // Some triangles are flipped.
        "flipped" => {
            let ball = ball(1)?;
            let mut faces = ball.faces().to_vec();
            [3, 17, 18, 19, 42, 61].into_iter().for_each(|face: usize| faces[face].swap(1, 2));
            mesh_from(ball.positions().to_vec(), faces)
        }
        // Two cubes share an edge: four triangles meet there.
        "branch" => {
            let cube = cube()?;
            let mut positions = cube.positions().to_vec();
            // The second cube's corner i is the first's moved by 2 along x and y; its edge 0–4 is the first's
            // 3–7.
            let row = |i: u32| match i {
                0 => 3,
                4 => 7,
                1..4 => 7 + i,
                _ => 6 + i,
            };
            for i in [1, 2, 3, 5, 6, 7] {
                let p = cube.positions()[i];
                positions.push([p[0] + 2.0, p[1] + 2.0, p[2]]);
            }
            let mut faces = cube.faces().to_vec();
            faces.extend(cube.faces().iter().map(|face| face.map(row)));
            mesh_from(positions, faces)
        }
        // Some triangles are duplicated, one has no area, and a vertex is unused.
        _ => {
            let ball = ball(1)?;
            let mut positions = ball.positions().to_vec();
            let mut faces = ball.faces().to_vec();
            faces.extend([5, 6, 40].map(|face: usize| ball.faces()[face]));
            let [a, b, _] = ball.faces()[30];
            faces.push([a, b, a]);
            positions.push([1.4, 0.0, 0.0]);
            mesh_from(positions, faces)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts_of(patient: &str, cures: &[String]) -> Value {
        let question = json!({"exhibit": "doctor", "patient": patient, "cures": cures}).to_string();
        doctor(&ExhibitRequest::parse(question.as_bytes()).unwrap().1).unwrap().facts
    }

    #[test]
    fn every_patient_is_sick_and_the_advised_cures_mend_it() {
        for (name, defect) in [
            ("hole", "boundary_edges"),
            ("seam", "duplicate_vertices"),
            ("crack", "t_junctions"),
            ("flipped", "inconsistent_edges"),
            ("branch", "non_manifold_edges"),
            ("double", "duplicate_faces"),
        ] {
            let mut cures = Vec::new();
            let sick = facts_of(name, &cures);
            let has =
                |found: &Value| found["findings"].as_array().unwrap().iter().any(|f| f["defect"] == defect);
            assert!(has(&sick) && sick["faults"].as_u64().unwrap() > 0, "{name}: {sick}");
            while let Some(cure) = next_cure(&facts_of(name, &cures)) {
                cures.push(cure);
                assert!(cures.len() <= 4, "{name}: {cures:?}");
            }
            let well = facts_of(name, &cures);
            assert!(!has(&well) && well["faults"] == json!(0), "{name} {cures:?}: {well}");
            assert_eq!((&well["closed"], &well["oriented"]), (&json!(true), &json!(true)), "{name}");
            assert!(well["volume"].as_f64().unwrap() > 3.0, "{name}: {well}");
        }
    }

    fn next_cure(answer: &Value) -> Option<String> {
        answer["next"].as_str().map(str::to_owned)
    }
}
