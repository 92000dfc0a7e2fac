//! Texture coordinates of cages: by OpenSubdiv's numbers, and by laws that need none.
use super::corpus::{cage as corpus_cage, cages};
use chordal::explicit::subdivision::{Boundary, CornerTexcoords, LinearTexcoords, Scheme};
use chordal::explicit::{Cage, InvalidCage, Semantic, Topology};
use chordal::{Budget, Job, Mesh, Tolerance, check, convert};
use chordal_testkit::{Random, cases};

const NONE: u32 = CornerTexcoords::NONE;

/// A sheet of 3 × 3 quads with a seam that ends within (at vertex 5), one that parts a single face (6), three
/// pieces (9), and two of which one is creased (10).
const SHEET: &str = "\
v 0 0 0
v 1 0 0.75
v 2 0 0.5
v 3 0 0.25
v 0 1 0.25
v 1 1 0.25
v 2 1 0.25
v 3 1 0.25
v 0 2 0.5
v 1 2 0.75
v 2 2 0
v 3 2 0.25
v 0 3 0.75
v 1 3 0.25
v 2 3 0.75
v 3 3 0.25
vt 0.0 0.0
vt 0.75 0.46875
vt 0.015625 0.265625
vt 0.421875 0.515625
vt 0.484375 0.546875
vt 0.234375 0.015625
vt 0.5 0.8125
vt 0.390625 0.734375
vt 0.140625 0.203125
vt 0.40625 0.0
vt 0.8125 0.25
vt 0.90625 0.9375
vt 0.3125 0.1875
vt 0.234375 0.765625
vt 0.296875 0.796875
vt 0.5625 0.59375
vt 0.625 0.625
vt 0.375 0.09375
vt 0.640625 0.890625
vt 0.046875 0.140625
vt 0.109375 0.171875
vt 0.859375 0.640625
vt 0.125 0.4375
vt 0.53125 0.6875
vt 0.765625 0.828125
vt 0.03125 0.625
f 1/1 2/2 6/3 5/4
f 2/5 3/6 7/7 6/3
f 3/8 4/9 8/10 7/11
f 5/4 6/3 10/12 9/13
f 6/3 7/7 11/14 10/12
f 7/7 8/15 12/16 11/14
f 9/17 10/18 14/19 13/20
f 10/21 11/22 15/23 14/24
f 11/22 12/25 16/26 15/23
t interpolateboundary 1/0/0 1
t crease 2/1/0 10 14 1.5
t crease 2/1/0 9 5 0.75
t corner 1/1/0 6 1.25
";

/// For each rule u + 3v where the corners of the faces are after two rounds, as OpenSubdiv 3.5.0 has it
/// (`Far::PrimvarRefinerReal<double>::InterpolateFaceVarying`), in the order of the faces.
const OPENSUBDIV: [[f64; 36]; 6] = [
    [
        0.0000000, 1.6093750, 1.0407715, 1.4902344, 1.6318359, 0.9843750, 2.8012695, 1.0407715, 2.1445312,
        0.7500000, 0.6406250, 1.5566406, 1.4902344, 1.0407715, 3.3723145, 1.4902344, 1.0407715, 2.8012695,
        2.6875000, 3.3723145, 2.8012695, 2.6728516, 2.4267578, 2.6875000, 1.8945312, 1.3593750, 2.4531250,
        0.4687500, 1.2695312, 2.7285156, 1.4882812, 2.1054688, 2.7285156, 2.9667969, 1.9062500, 1.4882812,
    ],
    [
        0.0000000, 2.1562500, 1.0407715, 1.4902344, 2.1250000, 0.2812500, 2.8012695, 1.0407715, 2.5937500,
        0.7500000, 0.4062500, 1.5625000, 1.4902344, 1.0407715, 3.3723145, 0.8750000, 1.0407715, 2.8012695,
        2.6875000, 3.3723145, 2.8012695, 2.6875000, 2.3437500, 2.6875000, 2.5000000, 0.6562500, 3.3125000,
        0.4687500, 0.6250000, 2.7285156, 1.4882812, 2.5937500, 2.7285156, 3.2500000, 1.9062500, 1.4882812,
    ],
    [
        0.0000000, 2.1562500, 1.0407715, 1.4902344, 2.1250000, 0.2812500, 2.8012695, 1.0407715, 2.5937500,
        0.7500000, 0.4062500, 1.5625000, 1.4902344, 1.0407715, 3.7187500, 0.8750000, 1.0407715, 2.8012695,
        2.5625000, 3.7187500, 2.8012695, 2.6875000, 2.3437500, 2.5625000, 2.5000000, 0.6562500, 3.3125000,
        0.4687500, 0.6250000, 2.7285156, 1.4882812, 2.5937500, 2.7285156, 3.2500000, 1.9062500, 1.4882812,
    ],
    [
        0.0000000, 2.1562500, 0.8125000, 1.4902344, 2.1250000, 0.2812500, 2.9375000, 0.8125000, 2.5937500,
        0.7500000, 0.4062500, 1.5625000, 1.4902344, 0.8125000, 3.7187500, 0.8750000, 0.8125000, 2.9375000,
        2.5625000, 3.7187500, 2.9375000, 2.6875000, 2.3437500, 2.5625000, 2.5000000, 0.6562500, 3.3125000,
        0.4687500, 0.6250000, 2.7285156, 1.4882812, 2.5937500, 2.7285156, 3.2500000, 1.9062500, 1.4882812,
    ],
    [
        0.0000000, 2.1562500, 0.8125000, 1.9687500, 2.1250000, 0.2812500, 2.9375000, 0.8125000, 2.5937500,
        0.7500000, 0.4062500, 1.5625000, 1.9687500, 0.8125000, 3.7187500, 0.8750000, 0.8125000, 2.9375000,
        2.5312500, 3.7187500, 2.9375000, 2.6875000, 2.3437500, 2.5312500, 2.5000000, 0.6562500, 3.3125000,
        0.4687500, 0.6250000, 2.7812500, 1.4375000, 2.5937500, 2.7812500, 3.2500000, 1.9062500, 1.4375000,
    ],
    [
        0.0000000, 2.1562500, 0.8125000, 1.9687500, 2.1250000, 0.2812500, 2.9375000, 0.8125000, 2.5937500,
        0.7500000, 0.4062500, 1.5625000, 1.9687500, 0.8125000, 3.7187500, 0.8750000, 0.8125000, 2.9375000,
        2.5312500, 3.7187500, 2.9375000, 2.6875000, 2.3437500, 2.5312500, 2.5000000, 0.6562500, 3.3125000,
        0.4687500, 0.6250000, 2.7812500, 1.4375000, 2.5937500, 2.7812500, 3.2500000, 1.9062500, 1.4375000,
    ],
];

/// Rows of texture coordinates of a file, and of each corner.
fn texcoords(text: &str, linear: LinearTexcoords) -> CornerTexcoords {
    let (mut values, mut corners) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("vt") => {
                let mut next = || words.next().unwrap().parse().unwrap();
                values.push([next(), next()]);
            }
            Some("f") => corners.extend(words.map(|word| {
                let row = word.split('/').nth(1).and_then(|row| row.parse::<u32>().ok());
                row.map_or(NONE, |row| row - 1)
            })),
            _ => {}
        }
    }
    CornerTexcoords { values, corners, linear }
}

fn textured(name: &str, text: &str, linear: LinearTexcoords) -> Cage {
    corpus_cage(name, text).unwrap().with_texcoords(texcoords(text, linear)).unwrap()
}

/// Cages of the corpus that have texture coordinates and are quick to refine.
fn corpus() -> Vec<(String, String)> {
    let Some(folder) = chordal_testkit::corpus::find("subdiv") else { return Vec::new() };
    let all = cages().into_iter().filter(|(_, cage)| cage.n_faces() < 100);
    let texts = all.map(|(name, _)| {
        let text = std::fs::read_to_string(folder.join("cages").join(format!("{name}.obj"))).unwrap();
        (name, text)
    });
    texts.filter(|(_, text)| text.lines().any(|line| line.starts_with("vt"))).collect()
}

/// What stands at a corner of a cage, counted over all faces.
fn at_corner(cage: &Cage, corner: usize) -> Option<[f64; 2]> {
    let of = cage.texcoords().unwrap();
    of.values.get(of.corners[corner] as usize).copied()
}

fn is_near(a: [f64; 2], b: [f64; 2], off: f64) -> bool {
    (0..2).all(|k| (a[k] - b[k]).abs() <= off)
}

#[test]
fn every_rule_is_that_of_opensubdiv() {
    for (linear, expected) in LinearTexcoords::ALL.into_iter().zip(&OPENSUBDIV) {
        let twice = textured("catmark_sheet", SHEET, linear).refined_times(2).unwrap();
        for (corner, expected) in expected.iter().enumerate() {
            // Each corner is that of four quads in a row.
            let [u, v] = at_corner(&twice, 16 * corner).unwrap();
            assert!((u + 3.0 * v - expected).abs() < 1e-6, "{linear:?} {corner}: {u} {v} {expected}");
        }
    }
}

/// A round of a round is the second round: its quads are the same, in rows instead of around corners.
#[test]
fn a_round_of_a_round_is_the_second() {
    let mut texts = corpus();
    texts.push(("catmark_sheet".into(), SHEET.into()));
    for (name, text) in texts {
        let is_chaikin = text.contains("chaikin");
        if name.starts_with("loop") || is_chaikin {
            continue;
        }
        for linear in LinearTexcoords::ALL {
            let cage = textured(&name, &text, linear);
            let (twice, again) = (cage.refined_times(2).unwrap(), cage.refined().unwrap().refined().unwrap());
            for face in 0..twice.n_faces() {
                let (quad, part) = (face / 4, face % 4);
                for k in 0..4 {
                    let own = at_corner(&again, 4 * face + k);
                    let in_rows = 4 * (4 * quad + [0, 1, 3, 2][part]) + (k + part) % 4;
                    match (own, at_corner(&twice, in_rows)) {
                        // Some roundings of numbers around 1.
                        (Some(a), Some(b)) => {
                            assert!(is_near(a, b, 1e-12), "{name} {linear:?} {face} {k}: {a:?} {b:?}")
                        }
                        (a, b) => assert_eq!(a, b, "{name} {linear:?}"),
                    }
                }
            }
        }
    }
}

/// Where textures have no seams and the same rules, an affine map of the positions stays one; so do its
/// limits.
#[test]
fn an_affine_map_of_the_positions_stays_one() {
    let pairs = [
        (Boundary::EdgeOnly, LinearTexcoords::None),
        (Boundary::EdgeAndCorner, LinearTexcoords::CornersOnly),
        (Boundary::EdgeAndCorner, LinearTexcoords::None),
    ];
    let map = |p: [f64; 3]| [0.3 * p[0] - 0.2 * p[1] + 0.7 * p[2] + 0.1, 0.5 * p[1] + 0.25 * p[0] - p[2]];
    for (name, cage) in cages().into_iter().filter(|(_, cage)| cage.n_faces() < 100) {
        for (boundary, linear) in pairs {
            let cage = cage.clone().with_boundary(boundary);
            let values = cage.positions().iter().map(|p| map(*p)).collect();
            let corners = cage.faces().flatten().copied().collect();
            let cage = cage.with_texcoords(CornerTexcoords { values, corners, linear }).unwrap();
            let size = cage.positions().as_flattened().iter().fold(1.0, |m: f64, x| m.max(x.abs()));
            for refined in [cage.refined().unwrap(), cage.refined_times(3).unwrap()] {
                for (corner, vertex) in refined.faces().flatten().enumerate() {
                    let (found, expected) =
                        (at_corner(&refined, corner).unwrap(), map(refined.positions()[*vertex as usize]));
                    // Rounding, around poles of hundreds of faces.
                    assert!(
                        is_near(found, expected, 1e-11 * size),
                        "{name} {linear:?}: {found:?} {expected:?}"
                    );
                }
            }
            let chart = cage.chart().unwrap();
            let (Ok(limit), Ok(flat)) = (cage.limit(), chart.cage().limit()) else { continue };
            assert_eq!(limit.n_sheets(), flat.n_sheets(), "{name}");
            for sheet in 0..limit.n_sheets() {
                for (u, v) in [(0.0, 0.0), (0.3, 0.6), (1.0, 0.5)] {
                    let expected = map(limit.sheet(sheet).unwrap().at(u, v).unwrap().point);
                    let found = flat.sheet(sheet).unwrap().at(u, v).unwrap().point;
                    assert!(is_near([found[0], found[1]], expected, 1e-10 * size), "{name} {sheet} {u} {v}");
                }
            }
        }
    }
}

/// A vertex of the chart goes where many rounds take it, and stays there where a rule keeps it.
#[test]
fn limits_are_what_many_rounds_come_to() {
    for linear in LinearTexcoords::ALL {
        let cage = textured("catmark_sheet", SHEET, linear);
        let chart = cage.chart().unwrap();
        let limit = chart.cage().limit().unwrap();
        let far = cage.refined_times(7).unwrap();
        let each = 4_usize.pow(7);
        let mut worst = 0.0_f64;
        for sheet in 0..limit.n_sheets() {
            let at = |u, v| limit.sheet(sheet).unwrap().at(u, v).unwrap().point;
            let ends = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
            for (k, (u, v)) in ends.into_iter().enumerate() {
                let (p, q) = (at(u, v), at_corner(&far, (4 * sheet + k) * each).unwrap());
                worst = worst.max((p[0] - q[0]).abs()).max((p[1] - q[1]).abs());
            }
        }
        // A quarter as far after each round, of differences around 1: 4⁻⁷ = 6e-5.
        assert!(worst < 1e-4, "{linear:?}: {worst}");
    }
}

#[test]
fn borders_and_corners_stay_where_the_rule_says_so() {
    for linear in LinearTexcoords::ALL {
        let cage = textured("catmark_sheet", SHEET, linear);
        let refined = cage.refined_times(3).unwrap();
        for (corner, vertex) in cage.faces().flatten().enumerate() {
            let stays = at_corner(&refined, 64 * corner) == at_corner(&cage, corner);
            let expected = match (linear, *vertex) {
                // All are on the border of the sheet or on a seam.
                (LinearTexcoords::All | LinearTexcoords::Boundaries, _) => true,
                // The corners of the sheet are corners of the cage.
                (_, 0 | 3 | 12 | 15) => true,
                (LinearTexcoords::None, _) => false,
                // What a single face has.
                (_, 6) if (8..12).contains(&corner) => true,
                (LinearTexcoords::CornersPlus1 | LinearTexcoords::CornersPlus2, 9) => true,
                (LinearTexcoords::CornersPlus2, 5 | 6) => true,
                _ => continue,
            };
            assert_eq!(stays, expected, "{linear:?} {corner} of {vertex}");
        }
    }
}

/// How many pieces the texture of a cage comes in.
fn n_pieces(cage: &Cage) -> usize {
    let chart = cage.chart().unwrap();
    let mut piece: Vec<usize> = (0..chart.cage().positions().len()).collect();
    let find = |piece: &mut Vec<usize>, mut k: usize| {
        while piece[k] != k {
            piece[k] = piece[piece[k]];
            k = piece[k];
        }
        k
    };
    for face in chart.cage().faces() {
        for pair in face.windows(2) {
            let (a, b) = (find(&mut piece, pair[0] as usize), find(&mut piece, pair[1] as usize));
            piece[a] = b;
        }
    }
    (0..piece.len()).filter(|k| piece[*k] == *k).count()
}

#[test]
fn seams_stay_seams() {
    for (name, text) in corpus() {
        let cage = textured(&name, &text, LinearTexcoords::CornersPlus1);
        let expected = n_pieces(&cage);
        for rounds in 1..4 {
            let refined = cage.refined_times(rounds).unwrap();
            assert_eq!(n_pieces(&refined), expected, "{name} {rounds}");
            let of = refined.texcoords().unwrap();
            assert!(of.corners.iter().all(|row| (*row as usize) < of.values.len()), "{name}");
        }
    }
}

/// A torus with a texture around it both ways, `n` by `n` quads, each as large in the texture.
fn torus(n: u32, linear: LinearTexcoords) -> Cage {
    let turn = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(n);
    let point = |k: u32| {
        let (u, v) = (turn(k % n), turn(k / n));
        [(3.0 + v.cos()) * u.cos(), (3.0 + v.cos()) * u.sin(), v.sin()]
    };
    let quads = |wide: u32| {
        (0..n * n).map(move |k| {
            [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(i, j)| ((k % n + i) % wide, (k / n + j) % wide, wide))
        })
    };
    let faces = quads(n).map(|of| of.map(|(i, j, wide)| j * wide + i));
    let corners = quads(n + 1).flatten().map(|(i, j, wide)| j * wide + i).collect();
    let share = |k: u32| f64::from(k) / f64::from(n);
    let values = (0..(n + 1) * (n + 1)).map(|k| [share(k % (n + 1)), share(k / (n + 1))]).collect();
    let cage = Cage::new((0..n * n).map(point).collect(), faces).unwrap();
    cage.with_texcoords(CornerTexcoords { values, corners, linear }).unwrap()
}

#[test]
fn a_wrapped_texture_stays_even_and_keeps_its_seam() {
    for linear in [LinearTexcoords::CornersOnly, LinearTexcoords::Boundaries, LinearTexcoords::All] {
        let cage = torus(8, linear);
        let refined = cage.refined_times(2).unwrap();
        for (face, part) in (0..refined.n_faces()).map(|face| (face / 16, face % 16)) {
            let first = at_corner(&refined, 4 * (16 * face + part)).unwrap();
            let begin = at_corner(&refined, 64 * face).unwrap();
            // No value is beyond the end of its own quad: nothing wraps.
            assert!((0..2).all(|k| (first[k] - begin[k]).abs() <= 0.126), "{first:?} {begin:?}");
        }
        let values = &refined.texcoords().unwrap().values;
        assert_eq!(values.len(), 33 * 33);
        for [u, v] in values {
            let is_even = |x: f64| (32.0 * x - (32.0 * x).round()).abs() < 1e-12; // rounding
            assert!(is_even(*u) && is_even(*v), "{u} {v}");
        }
    }
}

fn meshed(cage: &Cage, tolerance: f64) -> Mesh {
    let budget = Budget::length(Tolerance::new(tolerance).unwrap());
    convert::cage_to_mesh(cage, &budget, &Job::default()).unwrap().shape
}

fn rows_of(mesh: &Mesh) -> Vec<[f64; 2]> {
    mesh.attribute(&Semantic::TexCoord(0)).unwrap().values.as_chunks::<2>().0.to_vec()
}

#[test]
fn a_mesh_is_split_along_the_seam_and_stays_closed() {
    let cage = torus(8, LinearTexcoords::Boundaries);
    let mesh = meshed(&cage, 0.01);
    let found = check::validity(&mesh, Topology::Indices);
    assert!(found.closed && found.edge_manifold && found.oriented);
    let bare = Cage::new(cage.positions().to_vec(), cage.faces()).unwrap();
    let plain = meshed(&bare, 0.01);
    assert_eq!(mesh.positions()[..plain.positions().len()], plain.positions()[..]);
    assert_eq!(mesh.n_positions(), plain.n_positions());
    let rows = rows_of(&mesh);
    // No triangle reaches around.
    for face in mesh.faces() {
        let of = face.map(|vertex| rows[vertex as usize]);
        for of in [of.map(|[u, _]| u), of.map(|[_, v]| v)] {
            let (low, high) = (of[0].min(of[1]).min(of[2]), of[0].max(of[1]).max(of[2]));
            assert!(low >= -1e-12 && high <= 1.0 + 1e-12 && high - low <= 0.126, "{of:?}");
        }
    }
    // Rows at one position differ by a whole turn, and there are some along both seams.
    let mut n_split = 0;
    for vertex in plain.positions().len()..mesh.positions().len() {
        let (a, b) = (rows[vertex], rows[mesh.position_of(vertex as u32) as usize]);
        let is_turn = |k: usize| (a[k] - b[k]).abs() < 1e-9 || ((a[k] - b[k]).abs() - 1.0).abs() < 1e-9;
        assert!(is_turn(0) && is_turn(1) && a != b, "{a:?} {b:?}");
        n_split += 1;
    }
    assert!(n_split > 2 * 8, "{n_split}");
}

#[test]
fn texture_coordinates_of_a_mesh_are_those_of_its_places() {
    let map = |p: [f64; 3]| [0.3 * p[0] - 0.2 * p[1] + 0.7 * p[2] + 0.1, 0.5 * p[1] + 0.25 * p[0] - p[2]];
    for (name, cage) in cages() {
        let is_wanted =
            cage.scheme() != Scheme::Loop && cage.n_faces() < 60 && cage.boundary() != Boundary::None;
        if !is_wanted {
            continue;
        }
        let values = cage.positions().iter().map(|p| map(*p)).collect();
        let corners = cage.faces().flatten().copied().collect();
        let cage =
            cage.with_texcoords(CornerTexcoords { values, corners, linear: LinearTexcoords::None }).unwrap();
        let size = cage.positions().as_flattened().iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        let mesh = meshed(&cage, 0.01 * size);
        for (p, row) in mesh.positions().iter().zip(rows_of(&mesh)) {
            assert!(is_near(map(*p), row, 1e-9 * size), "{name}: {p:?} {row:?}");
        }
    }
}

#[test]
fn faces_without_rows_stay_without() {
    let points = (0..6).map(|k| [f64::from(k % 3), f64::from(k / 3), 0.0]).collect();
    let cage = Cage::new(points, [[0_u32, 1, 4, 3], [1, 2, 5, 4]]).unwrap();
    let values = vec![[5.0, 5.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let corners = vec![1, 2, 3, 4, 2, NONE, NONE, 3];
    let linear = LinearTexcoords::CornersOnly;
    let cage = cage.with_texcoords(CornerTexcoords { values, corners, linear }).unwrap();
    for refined in [cage.refined().unwrap(), cage.refined_times(3).unwrap()] {
        let of = refined.texcoords().unwrap();
        let (first, second) = of.corners.split_at(of.corners.len() / 2);
        assert!(second.iter().all(|row| *row == NONE) && !first.contains(&NONE));
        // The second face does not shape the first, and rows that nothing names are gone.
        let mut named = first.to_vec();
        named.sort_unstable();
        named.dedup();
        assert_eq!(named.len(), of.values.len());
        assert!(of.values.iter().flatten().all(|x| (0.0..=1.0).contains(x)));
    }
    let chart = cage.chart().unwrap();
    assert!(chart.has_face(0) && !chart.has_face(1));
    assert_eq!(rows_of(&meshed(&cage, 0.1)).iter().filter(|row| row.iter().any(|x| *x > 1.0)).count(), 0);
}

#[test]
fn wrong_rows_are_refused_by_name() {
    let square = || Cage::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], [[0_u32, 1, 2]]).unwrap();
    let with = |values: Vec<[f64; 2]>, corners: Vec<u32>| {
        square().with_texcoords(CornerTexcoords { values, corners, linear: LinearTexcoords::None })
    };
    let wrong = InvalidCage::WrongCorners { expected: 3, found: 2 };
    assert_eq!(with(vec![[0.0; 2]], vec![0, 0]).unwrap_err(), wrong);
    assert_eq!(with(vec![[0.0; 2]], vec![0, NONE, 1]).unwrap_err(), InvalidCage::NoSuchTexcoord { row: 1 });
    let nan = with(vec![[0.0; 2], [f64::NAN, 0.0]], vec![0, 0, 0]);
    assert_eq!(nan.unwrap_err(), InvalidCage::TexcoordNotFinite { row: 1 });
    // The sum of two overflows before it is halved.
    let large = with(vec![[f64::MAX; 2]], vec![0; 3]).unwrap();
    assert!(matches!(large.refined_times(3), Err(InvalidCage::TexcoordNotFinite { .. })));
}

/// Any faces over few vertices, with any rows: rounds and meshes of them never panic, and what is the same at
/// all corners stays so.
#[test]
fn any_faces_with_any_rows_are_refined() {
    for seed in 1..=cases(60) as u64 {
        let mut random = Random::new(seed);
        let mut below = |n: u32| random.below(n as usize) as u32;
        let n = 4 + below(6);
        let mut faces = Vec::new();
        for _ in 0..1 + below(8) {
            let mut all: Vec<u32> = (0..n).collect();
            let size = 3 + below(n.min(5) - 2);
            faces.push(
                (0..size).map(|_| all.swap_remove(below(all.len() as u32) as usize)).collect::<Vec<_>>(),
            );
        }
        let points = (0..n).map(|_| [0; 3].map(|_| f64::from(below(16)))).collect();
        let mut cage = Cage::new(points, &faces).unwrap();
        let edges: Vec<_> =
            faces.iter().map(|face| ([face[0], face[1]], f64::from(below(5)) * 0.75)).collect();
        cage = cage.with_creases(&edges).unwrap().with_sharp_vertices(&[(0, 1.5)]).unwrap();
        if faces.iter().all(|face| face.len() == 3) && below(2) == 0 {
            cage = cage.with_scheme(Scheme::Loop).unwrap();
        }
        let n_corners: usize = faces.iter().map(Vec::len).sum();
        let linear = LinearTexcoords::ALL[below(6) as usize];
        let rows: Vec<u32> = (0..n_corners).map(|_| below(12)).collect();
        let rows: Vec<u32> =
            rows.into_iter().map(|row| if row == 11 && seed % 3 == 0 { NONE } else { row }).collect();
        let values = (0..12).map(|_| [0; 2].map(|_| f64::from(below(9)) / 8.0)).collect();
        let cage = cage.with_texcoords(CornerTexcoords { values, corners: rows.clone(), linear }).unwrap();
        for rounds in 0..4 {
            let refined = cage.refined_times(rounds).unwrap();
            let of = refined.texcoords().unwrap();
            assert_eq!(of.corners.len(), refined.faces().map(<[u32]>::len).sum::<usize>(), "seed {seed}");
            let in_hull = |x: &f64| (-1e-12..=1.0 + 1e-12).contains(x); // rounding
            assert!(of.values.as_flattened().iter().all(in_hull), "seed {seed}");
        }
        let same = CornerTexcoords { values: vec![[0.75, -2.0]; 12], corners: rows, linear };
        let same = cage.clone().with_texcoords(same).unwrap().refined_times(3).unwrap();
        let is_same = |p: &[f64; 2]| is_near(*p, [0.75, -2.0], 1e-13); // shares add up to 1, but for rounding
        assert!(same.texcoords().unwrap().values.iter().all(is_same), "seed {seed}");
        if cage.scheme() != Scheme::Loop {
            let budget = Budget::length(Tolerance::new(2.0).unwrap());
            if let Ok(mesh) = convert::cage_to_mesh(&cage, &budget, &Job::default()) {
                assert_eq!(rows_of(&mesh.shape).len(), mesh.shape.positions().len(), "seed {seed}");
            }
        }
    }
}
