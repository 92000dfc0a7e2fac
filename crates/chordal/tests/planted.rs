//! Planted defects: a healthy torus is spoilt in known places, and exactly those are found.
use chordal::check::findings::{Finding, MeshConnectivity, MeshLocation};
use chordal::check::{Defect, inside_out, self_intersections};
use chordal::explicit::Topology;
use chordal::{Job, Mesh};
use chordal_testkit::Random;
use std::collections::BTreeSet;

const NU: usize = 48;
const NV: usize = 24;

/// `count` different numbers below `n`, no two of which are nearer than `apart`.
fn spread(random: &mut Random, count: usize, n: usize, apart: usize) -> Vec<usize> {
    let mut found: Vec<usize> = Vec::new();
    while found.len() < count {
        let new = random.below(n);
        if found.iter().all(|old| old.abs_diff(new) >= apart && old.abs_diff(new) <= n - apart) {
            found.push(new);
        }
    }
    found
}

struct Patient {
    positions: Vec<[f64; 3]>,
    faces: Vec<[u32; 3]>,
}

impl Patient {
    /// A torus whose coordinates are multiples of 2⁻²⁰.
    fn torus() -> Self {
        let angle = |i: usize, n: usize| i as f64 * std::f64::consts::TAU / n as f64;
        let point = |v: usize| {
            let (a, b) = (angle(v / NV, NU), angle(v % NV, NV));
            [(2.0 + b.cos()) * a.cos(), (2.0 + b.cos()) * a.sin(), b.sin()]
                .map(|x| (x * 1_048_576.0).round() / 1_048_576.0)
        };
        let at = |i: usize, j: usize| ((i % NU) * NV + j % NV) as u32;
        let square =
            |i, j| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]];
        Self {
            positions: (0..NU * NV).map(point).collect(),
            faces: (0..NU * NV).flat_map(|q| square(q / NV, q % NV)).collect(),
        }
    }

    fn mesh(&self) -> Mesh {
        Mesh::new(self.positions.clone(), self.faces.clone()).unwrap()
    }

    fn corner(&self, face: usize, k: usize) -> [f64; 3] {
        self.positions[self.faces[face][k] as usize]
    }
}

/// Every defect with its count, without those that were not met.
fn diagnosis(mesh: &Mesh) -> Vec<(Defect, u64)> {
    let surface = MeshConnectivity::new(mesh, Topology::Indices);
    let (v, both) = (surface.validity(), MeshConnectivity::by_indices_and_positions(mesh));
    let crossing = self_intersections(mesh, &Job::default()).unwrap();
    let turned = inside_out(mesh, &surface.components());
    let count = |defect: Defect| {
        let finding: &Finding = match defect {
            Defect::BoundaryEdges => &v.boundary_edges,
            Defect::NonManifoldEdges => &v.non_manifold_edges,
            Defect::NonManifoldVertices => &v.non_manifold_vertices,
            Defect::TJunctions => &surface.t_junctions(None),
            Defect::InconsistentEdges => &v.inconsistent_edges,
            Defect::InsideOut => &turned,
            Defect::SelfIntersections => &crossing,
            Defect::DuplicateFaces => &v.duplicate_faces,
            Defect::DuplicateVertices => &both.duplicate_vertices,
            Defect::CollapsedFaces => &v.collapsed_faces,
            Defect::ZeroAreaFaces => &v.zero_area_faces,
            Defect::Slivers => &v.slivers,
            Defect::UnusedVertices => &v.unused_vertices,
        };
        assert_eq!(finding.witnesses.len() as u64, finding.count.min(10), "{defect:?}");
        finding.count
    };
    Defect::ALL.iter().map(|defect| (*defect, count(*defect))).filter(|(_, count)| *count > 0).collect()
}

/// The faces that witnesses name.
fn named(finding: &Finding) -> BTreeSet<usize> {
    let faces = finding.witnesses.iter().map(|witness| match &witness.place {
        MeshLocation::Face(face) | MeshLocation::Repeated { face, .. } => vec![*face as usize],
        MeshLocation::Edge { faces, .. } => faces.iter().map(|face| *face as usize).collect(),
        MeshLocation::Faces(faces) => faces.map(|face| face as usize).to_vec(),
        _ => Vec::new(),
    });
    faces.flatten().collect()
}

#[test]
fn a_healthy_torus_has_no_finding() {
    assert_eq!(diagnosis(&Patient::torus().mesh()), []);
}

#[test]
fn removed_faces_are_holes_of_three_edges_each() {
    for seed in 0..8 {
        let (mut random, mut patient) = (Random::new(seed), Patient::torus());
        let k = 1 + random.below(9);
        let mut gone = spread(&mut random, k, patient.faces.len(), 2 * NV + 6);
        gone.sort_unstable();
        gone.iter().rev().for_each(|face| {
            patient.faces.remove(*face);
        });
        let mesh = patient.mesh();
        assert_eq!(diagnosis(&mesh), [(Defect::BoundaryEdges, 3 * k as u64)], "seed {seed}");
        let v = MeshConnectivity::new(&mesh, Topology::Indices).validity();
        assert_eq!((v.boundary_loops, v.genus), (k as u64, Some(1)), "seed {seed}");
    }
}

#[test]
fn turned_faces_are_named_by_their_three_edges() {
    for seed in 0..8 {
        let (mut random, mut patient) = (Random::new(seed ^ 77), Patient::torus());
        let turned = spread(&mut random, 3, patient.faces.len(), 2 * NV + 6);
        turned.iter().for_each(|face| patient.faces[*face].swap(0, 1));
        let mesh = patient.mesh();
        assert_eq!(diagnosis(&mesh), [(Defect::InconsistentEdges, 9)], "seed {seed}");
        let v = MeshConnectivity::new(&mesh, Topology::Indices).validity();
        assert!(v.orientable);
        assert!(turned.iter().all(|face| named(&v.inconsistent_edges).contains(face)), "seed {seed}");
    }
}

#[test]
fn a_torus_turned_as_a_whole_is_inside_out() {
    let mut patient = Patient::torus();
    patient.faces.iter_mut().for_each(|face| face.swap(0, 1));
    assert_eq!(diagnosis(&patient.mesh()), [(Defect::InsideOut, 1)]);
}

#[test]
fn repeated_collapsed_and_unused_are_counted_and_named() {
    for seed in 0..8 {
        let (mut random, mut patient) = (Random::new(seed ^ 99), Patient::torus());
        let n = patient.faces.len();
        // Collapsed faces and lonely vertices hang on nothing and change nothing else.
        let (collapsed, lonely) = (1 + random.below(5), 1 + random.below(5));
        for _ in 0..collapsed {
            let [a, b, _] = patient.faces[random.below(n)];
            patient.faces.push([a, b, b]);
        }
        patient.positions.extend((0..lonely).map(|i| [9.0 + i as f64, 0.0, 0.0]));
        let expected = [
            (Defect::CollapsedFaces, collapsed as u64),
            (Defect::ZeroAreaFaces, collapsed as u64),
            (Defect::UnusedVertices, lonely as u64),
        ];
        assert_eq!(diagnosis(&patient.mesh()), expected, "seed {seed}");
        // A repeated face puts three faces on each of its edges, and a fan of its own at each corner.
        let face = random.below(n);
        patient.faces.push(patient.faces[face]);
        let mesh = patient.mesh();
        let found = diagnosis(&mesh);
        assert!(
            found.contains(&(Defect::DuplicateFaces, 1)) && found.contains(&(Defect::NonManifoldEdges, 3))
        );
        assert!(
            !found.iter().any(|(defect, _)| *defect == Defect::SelfIntersections),
            "a duplicate is no crossing"
        );
        let v = MeshConnectivity::new(&mesh, Topology::Indices).validity();
        let place = MeshLocation::Repeated { face: (patient.faces.len() - 1) as u32, of: face as u32 };
        assert_eq!(v.duplicate_faces.witnesses[0].place, place, "seed {seed}");
    }
}

#[test]
fn cut_corners_are_duplicate_vertices_and_open_the_surface_by_index_only() {
    for seed in 0..8 {
        let (mut random, mut patient) = (Random::new(seed ^ 5), Patient::torus());
        let k = 1 + random.below(6);
        for face in spread(&mut random, k, patient.faces.len(), 2 * NV + 6) {
            let corner = patient.corner(face, 0);
            patient.faces[face][0] = patient.positions.len() as u32;
            patient.positions.push(corner);
        }
        let mesh = patient.mesh();
        // Each corner that is cut off opens the two edges at it, on both sides.
        let k = k as u64;
        assert_eq!(
            diagnosis(&mesh),
            [(Defect::BoundaryEdges, 4 * k), (Defect::DuplicateVertices, k)],
            "seed {seed}"
        );
        let by_positions = MeshConnectivity::by_indices_and_positions(&mesh).by_positions.unwrap().validity();
        assert!(by_positions.closed && by_positions.genus == Some(1));
    }
}

#[test]
fn halved_edges_are_t_junctions_and_touch() {
    for seed in 0..8 {
        let (mut random, mut patient) = (Random::new(seed ^ 31), Patient::torus());
        let k = 1 + random.below(5);
        let halved = spread(&mut random, k, patient.faces.len(), 2 * NV + 6);
        for &face in &halved {
            let [a, b, c] = patient.faces[face];
            let [p, q] = [a, b].map(|i| patient.positions[i as usize]);
            let middle = patient.positions.len() as u32;
            // Exact: the coordinates are multiples of 2⁻²⁰.
            patient.positions.push([0, 1, 2].map(|k| 0.5 * p[k] + 0.5 * q[k]));
            patient.faces[face] = [a, middle, c];
            patient.faces.push([middle, b, c]);
        }
        let mesh = patient.mesh();
        let k = k as u64;
        // Both halves touch the neighbour across the edge, beyond the corner that they share with it.
        let expected =
            [(Defect::SelfIntersections, 2 * k), (Defect::TJunctions, k), (Defect::BoundaryEdges, 3 * k)];
        assert_eq!(diagnosis(&mesh), expected, "seed {seed}");
    }
}

#[test]
fn spikes_through_the_surface_are_found_with_the_faces_that_they_pierce() {
    for seed in 0..8 {
        let (mut random, mut patient) = (Random::new(seed ^ 63), Patient::torus());
        let k = 1 + random.below(5);
        let pierced = spread(&mut random, k, patient.faces.len(), 2 * NV + 6);
        for &face in &pierced {
            let corners = [0, 1, 2].map(|k| glam::DVec3::from(patient.corner(face, k)));
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
            let along = (corners[1] - corners[0]).normalize();
            // A small triangle that stands across the face, in the middle, and touches no other.
            let first = patient.positions.len() as u32;
            let spike =
                [middle + normal * 0.004, middle - normal * 0.004, middle + normal * 0.004 + along * 0.004];
            patient.positions.extend(spike.map(|p| p.to_array()));
            patient.faces.push([first, first + 1, first + 2]);
        }
        let mesh = patient.mesh();
        let expected = [(Defect::SelfIntersections, k as u64), (Defect::BoundaryEdges, 3 * k as u64)];
        assert_eq!(diagnosis(&mesh), expected, "seed {seed}");
        let found = self_intersections(&mesh, &Job::default()).unwrap();
        let faces = named(&found);
        assert!(pierced.iter().all(|face| faces.contains(face)), "seed {seed}");
    }
}
