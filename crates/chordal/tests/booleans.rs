//! Booleans of meshes against closed forms, volumes, and winding numbers by rays of another making.
use chordal::boolean::provenance::{BooleanError, BooleanMethod};
use chordal::boolean::{BooleanMesh, BooleanOp, BooleanStep, boolean, boolean_unchecked};
use chordal::budget::{Failure, JobError, Metric, RefusalCode};
use chordal::check::findings::measure;
use chordal::check::validity;
use chordal::explicit::{Attribute, Domain, Semantic, Topology};
use chordal::{Evidence, Job, Mesh, Tolerance};
use chordal_testkit::{Random, is_long};

const OPS: [BooleanOp; 3] = [BooleanOp::Union, BooleanOp::Difference, BooleanOp::Intersection];

/// A box by its two corners.
fn cuboid(low: [f64; 3], high: [f64; 3]) -> Mesh {
    let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 1 { high[k] } else { low[k] });
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new((0..8).map(corner).collect(), faces).expect("a box is a mesh")
}

/// A sphere of 4ⁿ · 8 triangles, from an octahedron.
fn sphere(centre: [f64; 3], radius: f64, rounds: usize) -> Mesh {
    let mut points: Vec<[f64; 3]> =
        [[1., 0., 0.], [0., 1., 0.], [-1., 0., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]].to_vec();
    let mut faces: Vec<[u32; 3]> =
        (0..4_u32).flat_map(|i| [[i, (i + 1) % 4, 4], [(i + 1) % 4, i, 5]]).collect();
    for _ in 0..rounds {
        let mut middles = std::collections::BTreeMap::new();
        let mut finer = Vec::new();
        for [a, b, c] in faces {
            let [x, y, z] = [[a, b], [b, c], [c, a]].map(|[p, q]| {
                *middles.entry([p.min(q), p.max(q)]).or_insert_with(|| {
                    let sum: [f64; 3] =
                        std::array::from_fn(|k| points[p as usize][k] + points[q as usize][k]);
                    let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
                    points.push(sum.map(|x| x / length));
                    points.len() as u32 - 1
                })
            });
            finer.extend([[a, x, z], [x, b, y], [z, y, c], [x, y, z]]);
        }
        faces = finer;
    }
    let place = |p: [f64; 3]| std::array::from_fn(|k| centre[k] + radius * p[k]);
    Mesh::new(points.into_iter().map(place).collect(), faces).expect("a sphere is a mesh")
}

fn joined(meshes: &[&Mesh]) -> Mesh {
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let first = points.len() as u32;
        points.extend_from_slice(mesh.positions());
        faces.extend(mesh.faces().iter().map(|face| face.map(|row| row + first)));
    }
    Mesh::new(points, faces).expect("parts of meshes are a mesh")
}

fn turned(mesh: &Mesh) -> Mesh {
    let faces = mesh.faces().iter().map(|[a, b, c]| [*a, *c, *b]).collect();
    Mesh::new(mesh.positions().to_vec(), faces).expect("a turned mesh is one")
}

fn combined(a: &Mesh, op: BooleanOp, b: &Mesh) -> BooleanMesh {
    boolean(a, &[BooleanStep { op, mesh: b }], &Job::default()).expect("solids combine")
}

fn volume(mesh: &Mesh) -> f64 {
    measure(mesh).signed_volume
}

/// What holds of every result: closed, manifold, oriented, and proved under its one promise.
fn judge(made: &BooleanMesh, what: &str) {
    let bound = &made.bound;
    assert!(
        matches!(bound.evidence(), Evidence::ProvedIf(promises) if promises.len() == 1),
        "{what}: {bound}"
    );
    assert_eq!(made.sources.len(), made.mesh.faces().len());
    if !made.mesh.faces().is_empty() {
        let found = validity(&made.mesh, Topology::Indices);
        assert!(found.closed && found.edge_manifold && found.vertex_manifold && found.oriented, "{what}");
    }
}

/// The winding number of triangles around a point by the solid angles of all of them, rounded.
fn winding(mesh: &Mesh, p: [f64; 3]) -> i32 {
    let sum: f64 = (0..mesh.faces().len())
        .map(|face| {
            let [a, b, c] = mesh.corners(face).map(|q| [q[0] - p[0], q[1] - p[1], q[2] - p[2]]);
            let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
            let size = |u: [f64; 3]| dot(u, u).sqrt();
            let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
            let below =
                size(a) * size(b) * size(c) + dot(a, b) * size(c) + dot(b, c) * size(a) + dot(c, a) * size(b);
            2.0 * dot(a, cross).atan2(below)
        })
        .sum();
    (sum / (4.0 * std::f64::consts::PI)).round() as i32
}

#[test]
fn boxes_on_a_lattice_combine_exactly_whatever_they_share() {
    // Corners on a small lattice, so that faces, edges and corners coincide, touch and cross in every way.
    let mut random = Random::new(11);
    let n_rounds = if is_long() { 1000 } else { 150 };
    for round in 0..n_rounds {
        let mut cell = || -> [[f64; 3]; 2] {
            let sides = [0, 1, 2].map(|_| (random.below(4) as f64, (1 + random.below(3)) as f64));
            [sides.map(|(low, _)| low), sides.map(|(low, size)| low + size)]
        };
        let [p, q] = [cell(), cell()];
        let (a, b) = (cuboid(p[0], p[1]), cuboid(q[0], q[1]));
        let common: f64 = (0..3).map(|k| (p[1][k].min(q[1][k]) - p[0][k].max(q[0][k])).max(0.0)).product();
        let wanted = [volume(&a) + volume(&b) - common, volume(&a) - common, common];
        for (op, wanted) in OPS.into_iter().zip(wanted) {
            let what = format!("round {round}: {p:?} {} {q:?}", op.as_str());
            let made = combined(&a, op, &b);
            judge(&made, &what);
            assert!((volume(&made.mesh) - wanted).abs() <= 1e-9, "{what}: {} {wanted}", volume(&made.mesh));
            assert!(made.bound.at_most().is_some_and(|most| most <= 1e-13), "{what}: {}", made.bound);
        }
    }
}

#[test]
fn volumes_add_and_sides_are_those_of_all_solid_angles() {
    let mut random = Random::new(5);
    let n_rounds = if is_long() { 200 } else { 20 };
    for round in 0..n_rounds {
        let mut ball = || {
            let centre = [random.signed(), random.signed(), random.signed()];
            sphere(centre, 0.4 + random.unit(), 2 + random.below(2))
        };
        let (a, b) = (ball(), ball());
        let [union, difference, intersection] = OPS.map(|op| combined(&a, op, &b));
        for made in [&union, &difference, &intersection] {
            judge(made, &format!("round {round}"));
        }
        let sum = volume(&a) + volume(&b);
        assert!(
            (volume(&union.mesh) + volume(&intersection.mesh) - sum).abs() <= 1e-9 * sum,
            "round {round}"
        );
        let left = volume(&a) - volume(&intersection.mesh);
        assert!((volume(&difference.mesh) - left).abs() <= 1e-9 * sum, "round {round}");
        for _ in 0..40 {
            let p = [random.signed(), random.signed(), random.signed()].map(|x| 2.0 * x);
            let (in_a, in_b) = (winding(&a, p) > 0, winding(&b, p) > 0);
            let wanted = [in_a || in_b, in_a && !in_b, in_a && in_b];
            let found = [&union, &difference, &intersection].map(|made| winding(&made.mesh, p) == 1);
            assert_eq!(found, wanted, "round {round}, {p:?}");
        }
    }
}

#[test]
fn a_shape_without_itself_is_nothing_and_with_itself_is_itself() {
    let mesh = sphere([0.1, 0.2, 0.3], 1.5, 3);
    let nothing = combined(&mesh, BooleanOp::Difference, &mesh);
    assert!(nothing.mesh.faces().is_empty());
    assert_eq!((nothing.bound.at_most(), nothing.bound.metric), (Some(0.0), Metric::Solid));
    for op in [BooleanOp::Union, BooleanOp::Intersection] {
        let same = combined(&mesh, op, &mesh);
        judge(&same, op.as_str());
        assert!((volume(&same.mesh) - volume(&mesh)).abs() < 1e-12);
        assert_eq!((same.bound.at_most(), same.bound.metric), (Some(0.0), Metric::Solid));
    }
}

#[test]
fn solids_inside_each_other_leave_cavities() {
    let (outer, inner) = (cuboid([0.0; 3], [4.0; 3]), cuboid([1.0; 3], [2.0; 3]));
    let hollow = combined(&outer, BooleanOp::Difference, &inner);
    judge(&hollow, "hollow");
    assert_eq!((volume(&hollow.mesh), hollow.bound.at_most()), (63.0, Some(0.0)));
    // A shell in the cavity, and one that fills a corner of it.
    let core = cuboid([1.25; 3], [1.75; 3]);
    let again = combined(&hollow.mesh, BooleanOp::Union, &core);
    assert_eq!((again.method, volume(&again.mesh)), (BooleanMethod::FloatingPoint, 63.125));
    // A solid within a solid in one operand, both wound outward, is no cavity.
    let nested = joined(&[&outer, &inner]);
    let corner = cuboid([3.0; 3], [5.0; 3]);
    let cut = combined(&nested, BooleanOp::Difference, &corner);
    assert_eq!((cut.method, volume(&cut.mesh)), (BooleanMethod::Rational, 63.0));
    judge(&cut, "nested");
}

#[test]
fn what_crosses_itself_is_inside_where_it_winds() {
    // Two boxes in one operand that overlap, and one that is wound inside out, which holds nothing.
    let (a, b) = (cuboid([0.0; 3], [2.0; 3]), cuboid([1.0; 3], [3.0; 3]));
    let both = joined(&[&a, &b]);
    let (lid, away) = (cuboid([-1.0, -1.0, 2.5], [4.0, 4.0, 4.0]), turned(&cuboid([9.0; 3], [10.0; 3])));
    let cut = combined(&joined(&[&both, &away]), BooleanOp::Difference, &lid);
    judge(&cut, "overlap");
    assert_eq!(cut.method, BooleanMethod::Rational);
    assert!((volume(&cut.mesh) - (8.0 + 7.0 - 2.0)).abs() < 1e-12, "{}", volume(&cut.mesh));
}

#[test]
fn steps_go_from_left_to_right() {
    let boxes = [[0.0, 4.0], [1.0, 3.0], [2.0, 5.0]].map(|[low, high]| cuboid([low; 3], [high; 3]));
    let steps = [
        BooleanStep { op: BooleanOp::Difference, mesh: &boxes[1] },
        BooleanStep { op: BooleanOp::Union, mesh: &boxes[2] },
    ];
    let made = boolean(&boxes[0], &steps, &Job::default()).expect("boxes combine");
    judge(&made, "steps");
    // 64 − 8, and of the 27 of the last box what is not there yet: 27 − (8 − 1).
    assert!((volume(&made.mesh) - (56.0 + 27.0 - 7.0)).abs() < 1e-9, "{}", volume(&made.mesh));
    let operands: std::collections::BTreeSet<u32> =
        made.sources.iter().map(|source| source.operand).collect();
    assert_eq!(operands.into_iter().collect::<Vec<_>>(), [0, 1, 2]);
}

#[test]
fn faces_lie_on_the_faces_that_they_name() {
    let (a, b) = (sphere([0.0; 3], 1.0, 3), sphere([0.5, 0.25, 0.125], 0.75, 3));
    for op in OPS {
        let made = combined(&a, op, &b);
        let most = made.bound.at_most().expect("it is bounded");
        assert!(most < 1e-14 && made.bound.metric == Metric::Solid, "{}", made.bound);
        for (face, source) in made.sources.iter().enumerate() {
            let own = [&a, &b][source.operand as usize].corners(source.face as usize);
            let normal = chordal::explicit::face_normal(own).expect("spheres have no flat faces");
            for p in made.mesh.corners(face) {
                let height: f64 = (0..3).map(|k| normal[k] * (p[k] - own[0][k])).sum();
                assert!(height.abs() <= most + 1e-15, "{height} {most}");
            }
        }
    }
}

#[test]
fn attributes_are_those_of_the_source() {
    // Position as an attribute: wherever a face is cut, it must come back as the position itself.
    let (a, b) = (sphere([0.0; 3], 1.0, 2), cuboid([0.1, -2.0, -2.0], [2.0; 3]));
    let made = combined(&a, BooleanOp::Difference, &b);
    let own = joined(&[&a, &b]);
    let (values, groups) = (own.positions().as_flattened().to_vec(), own.faces().len());
    let carrier = own
        .clone()
        .with_attribute(Attribute {
            semantic: Semantic::Custom("place".into()),
            domain: Domain::Vertex,
            width: 3,
            values,
        })
        .and_then(|mesh| {
            let values = (0..groups).map(|face| f64::from(u8::from(face >= a.faces().len()))).collect();
            let semantic = Semantic::Group("material".into());
            mesh.with_attribute(Attribute { semantic, domain: Domain::Face, width: 1, values })
        })
        .and_then(|mesh| {
            let normals = chordal::explicit::vertex_normals(&mesh);
            mesh.with_attribute(Attribute::vertex_normals(&normals))
        })
        .expect("attributes fit");
    let mesh = made.with_attributes(&carrier, &[0, a.faces().len() as u32]).expect("attributes fit");
    let place = mesh.attribute(&Semantic::Custom("place".into())).expect("it is carried");
    let normals = mesh.attribute(&Semantic::Normal).expect("they are carried");
    let group = mesh.attribute(&Semantic::Group("material".into())).expect("it is carried");
    assert_eq!(group.domain, Domain::Face);
    let mut n_walls = 0;
    for face in 0..mesh.faces().len() {
        let corners = mesh.corners(face);
        let is_wall = made.sources[face].operand == 1;
        n_walls += usize::from(is_wall);
        assert_eq!(group.row(face), [f64::from(u8::from(is_wall))]);
        let front = chordal::explicit::face_normal(corners);
        for (k, p) in corners.iter().enumerate() {
            let row = place.row(3 * face + k);
            assert!((0..3).all(|i| (row[i] - p[i]).abs() < 1e-12), "{row:?} {p:?}");
            let normal = normals.row(3 * face + k);
            let Some(front) = front else { continue };
            let along: f64 = (0..3).map(|i| normal[i] * front[i]).sum();
            assert!(along > 0.0, "the inner wall of a cut is turned");
        }
    }
    assert!(n_walls > 0);
}

#[test]
fn open_meshes_are_refused_by_number() {
    let whole = cuboid([0.0; 3], [1.0; 3]);
    let open = Mesh::new(whole.positions().to_vec(), whole.faces()[1..].to_vec()).expect("a part is a mesh");
    let step = BooleanStep { op: BooleanOp::Union, mesh: &open };
    let found = boolean(&whole, &[step], &Job::default());
    assert_eq!(found, Err(BooleanError::NotClosed { operand: 1, boundary_edges: 3 }));
    assert!(found.unwrap_err().to_string().starts_with("operand 1 bounds no solid: 3 edges"));
}

#[test]
fn limits_and_cancellation_stop_it() {
    let (a, b) = (sphere([0.0; 3], 1.0, 3), sphere([0.5; 3], 1.0, 3));
    let step = [BooleanStep { op: BooleanOp::Union, mesh: &b }];
    let code = |job: &Job| match boolean(&a, &step, job) {
        Err(BooleanError::Stopped(JobError::Refused(refusal))) => Some(refusal.code),
        _ => None,
    };
    let (mut small, mut few) = (Job::default(), Job::default());
    (small.memory_limit, few.triangle_limit) = (1000, 10);
    assert_eq!(code(&small), Some(RefusalCode::TooMuchMemory));
    assert_eq!(code(&few), Some(RefusalCode::TooManyTriangles));
    let job = Job::default();
    job.cancel();
    assert_eq!(boolean(&a, &step, &job), Err(BooleanError::Stopped(JobError::Cancelled)));
}

#[test]
fn nothing_combines_with_anything() {
    let (none, some) = (Mesh::default(), cuboid([0.0; 3], [1.0; 3]));
    let volumes = |a: &Mesh, b: &Mesh| OPS.map(|op| volume(&combined(a, op, b).mesh));
    assert_eq!(volumes(&none, &some), [1.0, 0.0, 0.0]);
    assert_eq!(volumes(&some, &none), [1.0, 1.0, 0.0]);
    assert_eq!(volumes(&none, &none), [0.0; 3]);
}

#[test]
fn cuts_without_checks_are_those_with_them() {
    let (ball, block) = (sphere([0.3, 0.2, 0.1], 1.0, 3), cuboid([-0.7; 3], [0.8, 0.9, 1.0]));
    for op in OPS {
        let steps = [BooleanStep { op, mesh: &block }];
        let checked = boolean(&ball, &steps, &Job::default()).unwrap().mesh;
        for flat in [None, Some(Tolerance::new(1e-9).unwrap())] {
            let made = boolean_unchecked(&ball, &steps, flat, &Job::default()).unwrap();
            let found = validity(&made, Topology::Indices);
            assert!(found.closed && found.manifold() && found.oriented, "{op:?}: {found:?}");
            let [own, other] = [&made, &checked].map(|mesh| measure(mesh).signed_volume);
            assert!((own - other).abs() < 1e-7, "{op:?}: {own} for {other}");
        }
    }
    // What is left of two blocks that are flush is one block.
    let (low, high) = (cuboid([0.0; 3], [1.0; 3]), cuboid([1.0, 0.0, 0.0], [3.0, 1.0, 1.0]));
    let steps = [BooleanStep { op: BooleanOp::Union, mesh: &high }];
    let made = boolean_unchecked(&low, &steps, Some(Tolerance::new(1e-9).unwrap()), &Job::default()).unwrap();
    assert_eq!((made.faces().len(), measure(&made).signed_volume), (12, 3.0));
}

#[test]
fn cuts_without_checks_heed_the_job() {
    let (ball, block) = (sphere([0.0; 3], 1.0, 3), cuboid([-0.7; 3], [0.7; 3]));
    let steps = [BooleanStep { op: BooleanOp::Union, mesh: &block }];
    let mut job = Job::default();
    job.memory_limit = 1 << 16;
    let refused = boolean_unchecked(&ball, &steps, None, &job);
    assert!(matches!(refused, Err(Failure::Refused(why)) if why.code == RefusalCode::TooMuchMemory));
    let job = Job::default();
    job.finish();
    assert!(matches!(boolean_unchecked(&ball, &steps, None, &job), Err(Failure::Cancelled)));
    let open = Mesh::new(block.positions().to_vec(), block.faces()[1..].to_vec()).unwrap();
    let steps = [BooleanStep { op: BooleanOp::Union, mesh: &open }];
    let refused = boolean_unchecked(&ball, &steps, None, &Job::default());
    assert!(matches!(refused, Err(Failure::Refused(why)) if why.code == RefusalCode::Unsupported));
}
