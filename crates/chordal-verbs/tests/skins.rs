//! Skins and morph targets: bounds, boxes and formats are of the rest pose that viewers show. The tests pose what is in the
//! bytes of the files by code of their own.
use chordal::budget::attributes::AttributeLimits;
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal::{Job, Mesh, View};
use chordal_io::{Format, Frame, Limits, Node, PackedAccessor, Part, Scene, glb};
use chordal_testkit::sampler::{Triangles, on};
use chordal_testkit::{is_long, some};
use chordal_verbs::{
    BudgetSpec, ClaimVerdict, ConvertedShape, FormatHint, Input, LodParts, LodSpec, Normals, TileErrors,
    convert, inspect, load, lod, mesh, verify,
};
use serde_json::{Value, json};

type Matrix = [f64; 16];
type Triangle = [[f64; 3]; 3];

const ONE: Matrix = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

fn scale(s: f64) -> Matrix {
    std::array::from_fn(|k| if k == 15 { 1.0 } else { s * ONE[k] })
}

fn shift(x: f64, y: f64, z: f64) -> Matrix {
    let mut m = ONE;
    (m[12], m[13], m[14]) = (x, y, z);
    m
}

/// About z, by an angle in degrees.
fn turn(degrees: f64) -> Matrix {
    let (s, c) = degrees.to_radians().sin_cos();
    let mut m = ONE;
    (m[0], m[1], m[4], m[5]) = (c, s, -s, c);
    m
}

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| (0..4).map(|k| a[4 * k + i % 4] * b[i / 4 * 4 + k]).sum())
}

fn apply(m: &Matrix, p: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|r| m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r])
}

/// A figure: a tube with ripples along y from 0 to 2 that follows one joint below and another above.
struct Figure {
    /// The transform of the node of the mesh, which counts for nothing.
    node: Matrix,
    /// Above both joints.
    armature: Matrix,
    /// Of the upper joint, beside its place at y = 1.
    upper: Matrix,
    binds: [Matrix; 2],
    /// What the weights of a vertex sum to.
    sum: f64,
    /// Of a morph target that moves the upper half aside.
    morph: f64,
    /// Whether the mesh is shown once more by a node without a skin.
    twice: bool,
}

impl Default for Figure {
    fn default() -> Self {
        let binds = [ONE, shift(0.0, -1.0, 0.0)];
        Self { node: ONE, armature: ONE, upper: ONE, binds, sum: 1.0, morph: 0.0, twice: false }
    }
}

const AROUND: u32 = 24;
const ALONG: u32 = 40;

impl Figure {
    fn mesh(&self) -> Mesh {
        let n = AROUND * (ALONG + 1);
        let at = |v: u32| {
            let (a, t) =
                (f64::from(v % AROUND) / f64::from(AROUND), f64::from(v / AROUND) / f64::from(ALONG));
            let angle = a * std::f64::consts::TAU;
            let r = 0.25 + 0.02 * (9.0 * t).sin() * (2.0 * angle).cos();
            [r * angle.cos(), 2.0 * t, r * angle.sin()]
        };
        let positions: Vec<[f64; 3]> = (0..n).map(at).map(|p| p.map(|x| f64::from(x as f32))).collect();
        let quads = (0..ALONG).flat_map(|y| (0..AROUND).map(move |x| (x, y)));
        let faces = quads.flat_map(|(x, y)| {
            let (a, b) = (y * AROUND + x, y * AROUND + (x + 1) % AROUND);
            [[a, a + AROUND, b], [b, a + AROUND, b + AROUND]]
        });
        let bent = |y: f64| ((y - 0.7) / 0.6).clamp(0.0, 1.0);
        let weights = positions.iter().flat_map(|p| [1.0 - bent(p[1]), bent(p[1])].map(|w| w * self.sum));
        let weights = Attribute {
            semantic: Semantic::Blended("weights of joints 0 to 1, 4 a vertex".to_owned()),
            domain: Domain::Vertex,
            width: 2,
            values: weights.collect(),
        };
        let moves = Attribute {
            semantic: Semantic::Blended("morph target 0 POSITION".to_owned()),
            domain: Domain::Vertex,
            width: 3,
            values: positions.iter().flat_map(|p| [0.3 * bent(p[1]) * p[1] * p[1], 0.0, 0.0]).collect(),
        };
        let mesh = Mesh::new(positions.clone(), faces.collect()).unwrap().with_attribute(weights).unwrap();
        if self.morph == 0.0 { mesh } else { mesh.with_attribute(moves).unwrap() }
    }

    /// The bytes of a GLB of it.
    fn glb(&self) -> Vec<u8> {
        let node = |matrix: Matrix| Node { matrix: matrix.into(), ..Node::default() };
        let mut shown = Node { part: Some(0), ..node(self.node) };
        shown.properties.insert("skin".to_owned(), json!(0));
        if self.morph != 0.0 {
            shown.properties.insert("weights".to_owned(), json!([self.morph]));
        }
        let upper = times(&shift(0.0, 1.0, 0.0), &self.upper);
        let armature = Node { children: vec![2], ..node(self.armature) };
        let lower = Node { children: vec![3], ..Node::default() };
        let again = Node { part: Some(0), ..node(shift(3.0, 0.0, 0.0)) };
        let mut scene = Scene {
            parts: vec![Part {
                name: "tube".to_owned(),
                mesh: self.mesh(),
                indexed: false,
                ..Part::default()
            }],
            nodes: vec![shown, armature, lower, node(upper)],
            roots: if self.twice { vec![0, 1, 4] } else { vec![0, 1] },
            frame: Frame::default(),
            ..Scene::default()
        };
        if self.twice {
            scene.nodes.push(again);
        }
        let bytes: Vec<u8> = self.binds.iter().flatten().flat_map(|x| (*x as f32).to_le_bytes()).collect();
        let properties = json!({ "componentType": 5126, "type": "MAT4", "count": 2 });
        let properties = properties.as_object().unwrap().clone();
        scene.assets.accessors = vec![PackedAccessor { properties, bytes: bytes.into() }];
        scene.assets.skins = vec![json!({ "joints": [2, 3], "inverseBindMatrices": 0 })];
        let mut out = Vec::new();
        glb::write(&scene, None, &mut out).expect("written");
        out
    }
}

fn read(bytes: &[u8], name: &str) -> Input {
    load(bytes, FormatHint { name: Some(name), ..FormatHint::default() }, &Limits::default()).expect("read")
}

/// A GLB taken apart.
struct File {
    json: Value,
    bin: Vec<u8>,
}

impl File {
    fn new(bytes: &[u8]) -> Self {
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        let end = 20 + word(12);
        let bin = if bytes.len() > end { bytes[end + 8..end + 8 + word(end)].to_vec() } else { Vec::new() };
        Self { json: serde_json::from_slice(&bytes[20..end]).unwrap(), bin }
    }

    fn rows(&self, accessor: &Value) -> Vec<Vec<f64>> {
        let a = &self.json["accessors"][accessor.as_u64().unwrap() as usize];
        let view = &self.json["bufferViews"][a["bufferView"].as_u64().unwrap() as usize];
        let width = match a["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            "VEC4" => 4,
            "MAT4" => 16,
            other => panic!("{other}"),
        };
        let (kind, most) = (a["componentType"].as_u64().unwrap(), a["normalized"] == true);
        let size = match kind {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            _ => 4,
        };
        let offset = |of: &Value| of["byteOffset"].as_u64().unwrap_or(0) as usize;
        let stride = view["byteStride"].as_u64().map_or(size * width, |s| s as usize);
        let first = offset(view) + offset(a);
        let number = |at: usize| match kind {
            5121 => f64::from(self.bin[at]),
            5123 => f64::from(u16::from_le_bytes([self.bin[at], self.bin[at + 1]])),
            5125 => f64::from(u32::from_le_bytes(self.bin[at..at + 4].try_into().unwrap())),
            5126 => f64::from(f32::from_le_bytes(self.bin[at..at + 4].try_into().unwrap())),
            other => panic!("{other}"),
        };
        let share = match (most, kind) {
            (true, 5121) => 255.0,
            (true, 5123) => 65535.0,
            _ => 1.0,
        };
        let row = |i: usize| (0..width).map(|k| number(first + i * stride + k * size) / share).collect();
        (0..a["count"].as_u64().unwrap() as usize).map(row).collect()
    }

    fn local(&self, node: usize) -> Matrix {
        let node = &self.json["nodes"][node];
        let list = |key: &str| -> Option<Vec<f64>> {
            node[key].as_array().map(|all| all.iter().map(|x| x.as_f64().unwrap()).collect())
        };
        if let Some(m) = list("matrix") {
            return m.try_into().unwrap();
        }
        let t = list("translation").unwrap_or(vec![0.0; 3]);
        let q = list("rotation").unwrap_or(vec![0.0, 0.0, 0.0, 1.0]);
        let s = list("scale").unwrap_or(vec![1.0; 3]);
        let [x, y, z, w] = [q[0], q[1], q[2], q[3]];
        let r = [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
            [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
            [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
        ];
        std::array::from_fn(|k| match (k / 4, k % 4) {
            (3, 3) => 1.0,
            (_, 3) => 0.0,
            (3, row) => t[row],
            (column, row) => r[column][row] * s[column],
        })
    }

    fn global(&self, node: usize) -> Matrix {
        let is_child = |parent: &Value| {
            parent["children"].as_array().is_some_and(|all| all.iter().any(|c| *c == json!(node)))
        };
        let parent = self.json["nodes"].as_array().unwrap().iter().position(is_child);
        let local = self.local(node);
        parent.map_or(local, |parent| times(&self.global(parent), &local))
    }

    /// The triangles that a viewer shows: of each node, posed.
    fn shown(&self) -> Vec<Triangle> {
        let mut all = Vec::new();
        for (n, node) in self.json["nodes"].as_array().unwrap().iter().enumerate() {
            let Some(mesh) = node["mesh"].as_u64() else { continue };
            let mesh = &self.json["meshes"][mesh as usize];
            let shares =
                node["weights"].as_array().or(mesh["weights"].as_array()).cloned().unwrap_or_default();
            for primitive in mesh["primitives"].as_array().unwrap() {
                let mut points = self.rows(&primitive["attributes"]["POSITION"]);
                for (target, share) in primitive["targets"].as_array().into_iter().flatten().zip(&shares) {
                    let moves = self.rows(&target["POSITION"]);
                    for (p, d) in points.iter_mut().zip(moves) {
                        (0..3).for_each(|k| p[k] += share.as_f64().unwrap() * d[k]);
                    }
                }
                let at = |p: &[f64]| [p[0], p[1], p[2]];
                let posed: Vec<[f64; 3]> = if let Some(skin) = node["skin"].as_u64() {
                    let skin = &self.json["skins"][skin as usize];
                    let joints: Vec<usize> = skin["joints"]
                        .as_array()
                        .unwrap()
                        .iter()
                        .map(|j| j.as_u64().unwrap() as usize)
                        .collect();
                    let binds = self.rows(&skin["inverseBindMatrices"]);
                    let maps: Vec<Matrix> = joints
                        .iter()
                        .zip(binds)
                        .map(|(joint, bind)| times(&self.global(*joint), &bind.try_into().unwrap()))
                        .collect();
                    let follows = self.rows(&primitive["attributes"]["JOINTS_0"]);
                    let weights = self.rows(&primitive["attributes"]["WEIGHTS_0"]);
                    let rows = points.iter().zip(follows.iter().zip(weights));
                    rows.map(|(p, (joints, weights))| {
                        let total: f64 = weights.iter().sum();
                        let mut m = [0.0; 16];
                        for (joint, weight) in joints.iter().zip(&weights) {
                            (0..16).for_each(|k| m[k] += weight / total * maps[*joint as usize][k]);
                        }
                        apply(&m, at(p))
                    })
                    .collect()
                } else {
                    points.iter().map(|p| apply(&self.global(n), at(p))).collect()
                };
                let indices: Vec<usize> =
                    self.rows(&primitive["indices"]).iter().map(|row| row[0] as usize).collect();
                all.extend(indices.chunks_exact(3).map(|f| [posed[f[0]], posed[f[1]], posed[f[2]]]));
            }
        }
        all
    }
}

fn triangles(all: &[Triangle]) -> Triangles {
    let positions: Vec<[f64; 3]> = all.iter().flatten().copied().collect();
    let faces: Vec<[u32; 3]> = (0..all.len() as u32).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
    Triangles::new(&positions, &faces)
}

/// The farthest that a dense set of points of either is from the other.
fn apart(a: &[Triangle], b: &[Triangle]) -> f64 {
    let one = |from: &[Triangle], to: &[Triangle]| {
        let tree = triangles(to);
        // Lattices with a thousand points in all at least on few triangles.
        let n = if from.len() > 1000 { 2 } else { 8 };
        let lattice = (0..=n).flat_map(|i| (0..=n - i).map(move |j| (i, j)));
        let weights: Vec<[f64; 3]> =
            lattice.map(|(i, j)| [i, j, n - i - j].map(|k| f64::from(k) / f64::from(n))).collect();
        let points = from.iter().flat_map(|t| weights.iter().map(|w| on(*t, *w)));
        points.map(|p| tree.distance(p)).fold(0.0, f64::max)
    };
    one(a, b).max(one(b, a))
}

fn extent(all: &[Triangle]) -> [f64; 2] {
    let ys = || all.iter().flatten().map(|p| p[1]);
    [ys().fold(f64::INFINITY, f64::min), ys().fold(f64::NEG_INFINITY, f64::max)]
}

/// A figure of each kind, with its name.
fn figures() -> Vec<(&'static str, Figure)> {
    let plain = Figure::default;
    let bent = || Figure { upper: turn(50.0), ..plain() };
    vec![
        ("at its bind pose", plain()),
        ("under a node of scale 0.01", Figure { node: scale(0.01), ..plain() }),
        ("with joints of scale 100", Figure { armature: scale(100.0), ..plain() }),
        (
            "bound at another scale",
            Figure {
                node: scale(0.01),
                binds: [scale(100.0), times(&scale(100.0), &shift(0.0, -1.0, 0.0))],
                ..plain()
            },
        ),
        ("bent", bent()),
        ("with a larger head", Figure { upper: scale(3.0), ..plain() }),
        ("bent, with weights that sum to a half", Figure { sum: 0.5, ..bent() }),
        ("bent, with a morph target", Figure { morph: 0.8, ..bent() }),
        ("bent, and shown once more as it is", Figure { twice: true, ..bent() }),
        ("of a mirrored head", Figure { upper: times(&scale(-1.0), &turn(20.0)), ..plain() }),
    ]
}

#[test]
fn bounds_of_simplified_figures_hold_where_a_viewer_shows_them() {
    let mut unchanged = Vec::new();
    // By default those between the ones whose levels are looked at.
    let (first, step) = if is_long() { (0, 1) } else { (1, 2) };
    for (name, figure) in figures().into_iter().skip(first).step_by(step) {
        let bytes = figure.glb();
        let before = File::new(&bytes).shown();
        let [low, high] = extent(&before);
        let length = 0.004 * (high - low);
        let spec = BudgetSpec { length: Some(length.to_string().parse().unwrap()), ..BudgetSpec::default() };
        let made = mesh(read(&bytes, "a.glb"), &spec, Format::Glb, &Job::default())
            .unwrap_or_else(|failure| panic!("{name}: {failure}"));
        let most = made.bound.at_most().expect("a bound");
        let mut out = Vec::new();
        made.write(&mut out).unwrap();
        let after = File::new(&out).shown();
        let seen = apart(&after, &before);
        assert!(seen <= most && most <= length, "{name}: {seen} seen, {most} proved, {length} allowed");
        // Where no length that was tried holds in the pose, the part stays as it was.
        if after.len() == before.len() {
            unchanged.push(name);
            continue;
        }
        assert!(4 * after.len() < 3 * before.len(), "{name}: {} of {}", after.len(), before.len());
        assert!(seen > 0.01 * most, "{name}: {seen} seen and {most} proved, which says little");
        let notes: Vec<String> = made.certificate.notes.iter().map(ToString::to_string).collect();
        assert!(notes.iter().any(|note| note.contains("rest pose")), "{name}: {notes:?}");
        let found = verify(&read(&out, "b.glb"), None, &[read(&bytes, "a.glb")], &Job::default()).unwrap();
        assert_eq!(found.verdict, ClaimVerdict::Proved, "{name}: {:?}", found.worst());
    }
    assert!(unchanged.len() <= 1, "{unchanged:?}");
}

#[test]
fn a_figure_is_as_large_as_it_is_shown() {
    for (name, figure) in figures() {
        let bytes = figure.glb();
        let shown = File::new(&bytes).shown();
        let input = read(&bytes, "a.glb");
        let bounds = input.shape.bounds().unwrap();
        let [low, high] = extent(&shown);
        let size = high - low;
        assert!((bounds.min[1] - low).abs() < 1e-6 * size, "{name}: {bounds:?} {low}");
        assert!((bounds.max[1] - high).abs() < 1e-6 * size, "{name}: {bounds:?} {high}");
        assert!(inspect(&input).certificate.output.is_some());
    }
}

#[test]
fn formats_without_skins_get_the_rest_pose() {
    for (number, (name, figure)) in figures().into_iter().enumerate() {
        let bytes = figure.glb();
        let shown = File::new(&bytes).shown();
        let formats = [Format::Obj, Format::Stl, Format::Usda, Format::ThreeMf, Format::Ply];
        // By default each figure in two formats at most, and each format of several figures.
        let step = if is_long() { 1 } else { 3 };
        for to in formats.into_iter().skip(number % step).step_by(step) {
            let made = convert(read(&bytes, "a.glb"), to).unwrap_or_else(|f| panic!("{name} to {to}: {f}"));
            let ConvertedShape::Triangles(scene) = &made.made else { panic!("{name} to {to}") };
            let mut found = Vec::new();
            for (_, mesh) in scene.world_meshes().unwrap() {
                found.extend((0..mesh.faces().len()).map(|face| mesh.corners(face)));
            }
            let [low, high] = extent(&shown);
            assert_eq!(found.len(), shown.len(), "{name} to {to}");
            assert!(apart(&found, &shown) < 1e-6 * (high - low), "{name} to {to}");
        }
    }
}

fn levels_of(length: &str) -> LodSpec {
    let View::MinDistance(lens) = "1920x1080 fov=60 dist=1".parse().unwrap() else { unreachable!() };
    LodSpec {
        pixels: "1px".parse().unwrap(),
        lens,
        nearest: None,
        length: Some(length.parse().unwrap()),
        distances: Vec::new(),
        normals: Normals::Auto,
        attributes: AttributeLimits::default(),
        errors: TileErrors::Plain,
        tile_triangles: None,
        parts: LodParts::Separate,
        place: None,
        packing: glb::GltfPacking::default(),
    }
}

#[test]
fn levels_of_figures_hold_where_a_viewer_shows_them() {
    for (name, figure) in some(figures(), 5) {
        let bytes = figure.glb();
        let shown = File::new(&bytes).shown();
        let [low, high] = extent(&shown);
        let length = 0.002 * (high - low);
        let spec = levels_of(&length.to_string());
        let made =
            lod(read(&bytes, "a.glb"), &spec, &Job::default()).unwrap_or_else(|f| panic!("{name}: {f}"));
        for k in 0.. {
            let Some((level, bound)) = made.level(k) else { break };
            let mut out = Vec::new();
            glb::write(&level, None, &mut out).unwrap();
            let seen = apart(&File::new(&out).shown(), &shown);
            let most = bound.at_most().unwrap();
            assert!(seen <= most, "{name}, level {k}: {seen} seen, {most} proved");
        }
    }
}

#[test]
fn a_skin_without_its_matrices_is_said_to_be_left_out() {
    let file = File::new(&Figure { node: scale(0.5), ..Figure::default() }.glb());
    let mut json = file.json.clone();
    // The matrices are those of one joint alone.
    let at = json["skins"][0]["inverseBindMatrices"].as_u64().unwrap() as usize;
    json["accessors"][at]["count"] = json!(1);
    let text = json.to_string();
    let text = format!("{text}{}", " ".repeat((4 - text.len() % 4) % 4));
    let mut bytes = b"glTF".to_vec();
    let length = |n: usize| (n as u32).to_le_bytes();
    bytes.extend([2, 0, 0, 0]);
    bytes.extend(length(28 + text.len() + file.bin.len()));
    bytes.extend(length(text.len()));
    bytes.extend(b"JSON");
    bytes.extend(text.as_bytes());
    bytes.extend(length(file.bin.len()));
    bytes.extend(b"BIN\0");
    bytes.extend(&file.bin);
    let found = load(&bytes, FormatHint { name: Some("a.glb"), ..FormatHint::default() }, &Limits::default());
    // Refused, or read with what is missing named.
    if let Ok(input) = found {
        let spec = BudgetSpec { length: Some("0.01".parse().unwrap()), ..BudgetSpec::default() };
        let made = mesh(input, &spec, Format::Glb, &Job::default()).unwrap();
        let notes: Vec<String> = made.certificate.notes.iter().map(ToString::to_string).collect();
        assert!(notes.iter().any(|note| note.contains("a skin lacks")), "{notes:?}");
    }
}
