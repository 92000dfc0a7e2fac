//! Files read and written, timed. `file_speed make DIR` writes one mesh in every format; `file_speed read|write
//! PROGRAM THREADS FILE` prints a line of JSON with the least of five times, the bytes and the triangles.
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic, face_normal, vertex_normals};
use chordal_bench::torus;
use chordal_io::{Content, Format, Frame, Limits, Part, Scene, TextureOrigin, read_with, write, write_files};
use serde_json::json;
use std::fmt::Write as _;
use std::fs;
use std::hint::black_box;
use std::io::Cursor;
use std::path::Path;
use std::time::Instant;

/// A million triangles with normals and texture coordinates, in single precision and six decimals: what most
/// files hold.
fn million() -> Scene {
    let mesh = torus([1000, 500], 0.0, 0.1);
    let single = |x: f64| (x * 1e6).round() / 1e6;
    let positions: Vec<[f64; 3]> = mesh.positions().iter().map(|p| p.map(single)).collect();
    let normals = vertex_normals(&mesh).iter().flat_map(|n| n.map(single)).collect();
    let texcoords = (0..positions.len() as u32)
        .flat_map(|i| [f64::from(i / 500) / 1000.0, f64::from(i % 500) / 500.0].map(single))
        .collect();
    let vertex = |semantic, width, values| Attribute { semantic, domain: Domain::Vertex, width, values };
    let mesh = Mesh::new(positions, mesh.faces().to_vec())
        .and_then(|mesh| mesh.with_attribute(vertex(Semantic::Normal, 3, normals)))
        .and_then(|mesh| mesh.with_attribute(vertex(Semantic::TexCoord(0), 2, texcoords)))
        .expect("valid");
    let frame = Frame { texture_origin: Some(TextureOrigin::LowerLeft), ..Frame::default() };
    Scene::from_mesh("", mesh, frame)
}

/// Text PLY and text STL, which Chordal only reads.
fn text_ply(mesh: &Mesh) -> String {
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions().len(),
        mesh.faces().len()
    );
    let row = |semantic: &Semantic, i: usize| mesh.attribute(semantic).expect("there").row(i);
    for (i, p) in mesh.positions().iter().enumerate() {
        let all = p.iter().chain(row(&Semantic::Normal, i)).chain(row(&Semantic::TexCoord(0), i));
        let numbers: Vec<String> = all.map(|x| (*x as f32).to_string()).collect();
        writeln!(text, "{}", numbers.join(" ")).expect("a string");
    }
    for [a, b, c] in mesh.faces() {
        writeln!(text, "3 {a} {b} {c}").expect("a string");
    }
    text
}

fn text_stl(mesh: &Mesh) -> String {
    let mut text = "solid torus\n".to_owned();
    for face in 0..mesh.faces().len() {
        let corners = mesh.corners(face);
        let [x, y, z] = face_normal(corners).unwrap_or_default().map(|x| x as f32);
        writeln!(text, "  facet normal {x} {y} {z}\n    outer loop").expect("a string");
        for [x, y, z] in corners.map(|p| p.map(|x| x as f32)) {
            writeln!(text, "      vertex {x} {y} {z}").expect("a string");
        }
        text.push_str("    endloop\n  endfacet\n");
    }
    text.push_str("endsolid torus\n");
    text
}

/// The files, by their names.
const WRITTEN: [&str; 7] = ["mesh.obj", "mesh.ply", "mesh.stl", "mesh.glb", "mesh.off", "mesh.3mf", "mesh.vtp"];

fn format(path: &Path) -> Format {
    let extension = path.extension().and_then(|e| e.to_str()).expect("an extension");
    Format::from_packed_extension(extension).expect("a format")
}

fn make(folder: &Path) {
    fs::create_dir_all(folder).expect("writable");
    let scene = million();
    for name in WRITTEN {
        let mut file = Vec::new();
        write(&scene, None, format(Path::new(name)), &mut file).expect("held");
        fs::write(folder.join(name), file).expect("writable");
    }
    let files = write_files(&scene, None, Format::Gltf, "mesh").expect("held");
    fs::write(folder.join("mesh.gltf"), files.document).expect("writable");
    for beside in files.beside {
        fs::write(folder.join(beside.name), &*beside.bytes).expect("writable");
    }
    let mesh = &scene.parts[0].mesh;
    fs::write(folder.join("text.ply"), text_ply(mesh)).expect("writable");
    fs::write(folder.join("text.stl"), text_stl(mesh)).expect("writable");
}

/// The bytes of a file and of those beside it, and what is made of them.
struct Reading<'a> {
    path: &'a Path,
    bytes: Vec<u8>,
    threads: usize,
}

impl Reading<'_> {
    fn ours(&self) -> Scene {
        let folder = self.path.parent().expect("a folder");
        let mut open = |name: &str| fs::read(folder.join(name)).map_err(|error| error.to_string());
        let limits = Limits { threads: self.threads, ..Limits::default() };
        let read = read_with(&self.bytes, format(self.path), &mut open, &limits).expect("a file of ours");
        let Content::Scene(scene) = read.content else { panic!("triangles") };
        scene
    }

    /// The number of triangles that another crate reads.
    fn peer(&self, name: &str) -> usize {
        match name {
            "tobj" => {
                let options = tobj::LoadOptions { single_index: true, triangulate: true, ..Default::default() };
                let no_library = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
                let (models, _) = tobj::load_obj_buf(&mut Cursor::new(&self.bytes), &options, no_library).expect("OBJ");
                models.iter().map(|model| model.mesh.indices.len() / 3).sum()
            }
            "stl_io" => stl_io::read_stl(&mut Cursor::new(&self.bytes)).expect("STL").faces.len(),
            "gltf" => {
                let (document, buffers, _) = if format(self.path) == Format::Glb {
                    gltf::import_slice(&self.bytes).expect("GLB")
                } else {
                    gltf::import(self.path).expect("glTF")
                };
                let primitives = document.meshes().flat_map(|mesh| mesh.primitives());
                primitives
                    .map(|primitive| {
                        let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
                        let positions: Vec<[f32; 3]> = reader.read_positions().expect("there").collect();
                        let normals: Vec<[f32; 3]> = reader.read_normals().expect("there").collect();
                        let texcoords: Vec<[f32; 2]> =
                            reader.read_tex_coords(0).expect("there").into_f32().collect();
                        black_box((positions, normals, texcoords));
                        reader.read_indices().expect("there").into_u32().collect::<Vec<u32>>().len() / 3
                    })
                    .sum()
            }
            _ => panic!("no program is called {name}"),
        }
    }
}

fn triangles(parts: &[Part]) -> usize {
    parts.iter().map(|part| part.mesh.faces().len()).sum()
}

/// The least of five times, in seconds, and the last result: other work on the machine only adds to a time.
fn timed<T>(mut work: impl FnMut() -> T) -> (f64, T) {
    let mut least = f64::INFINITY;
    let mut last = None;
    for _ in 0..5 {
        drop(last.take());
        let start = Instant::now();
        let made = black_box(work());
        least = least.min(start.elapsed().as_secs_f64());
        last = Some(made);
    }
    (least, last.expect("five"))
}

/// The bytes of a file, and of the buffer that a `.gltf` names.
fn size(path: &Path) -> u64 {
    let length = |path: &Path| fs::metadata(path).map_or(0, |data| data.len());
    let beside = if format(path) == Format::Gltf { length(&path.with_extension("bin")) } else { 0 };
    length(path) + beside
}

pub fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    if let ["make", folder] = args[..] {
        return make(Path::new(folder));
    }
    let [verb, program, threads, file] = args[..] else { panic!("file_speed read|write PROGRAM THREADS FILE") };
    let path = Path::new(file);
    let bytes = fs::read(path).expect("a file that 'make' wrote");
    let reading = Reading { path, bytes, threads: threads.parse().expect("a number") };
    let (seconds, n_bytes, n_triangles) = match (verb, program) {
        ("read", "ours") => {
            let (seconds, scene) = timed(|| reading.ours());
            (seconds, size(path), triangles(&scene.parts))
        }
        ("read", peer) => {
            let (seconds, n) = timed(|| reading.peer(peer));
            (seconds, size(path), n)
        }
        ("write", "ours") => {
            let scene = reading.ours();
            let (seconds, n_bytes) = timed(|| {
                let files = write_files(&scene, None, format(path), "mesh").expect("held");
                let beside: usize = files.beside.iter().map(|file| file.bytes.len()).sum();
                (files.document.len() + beside) as u64
            });
            (seconds, n_bytes, triangles(&scene.parts))
        }
        _ => panic!("only Chordal writes here"),
    };
    println!("{}", json!({ "seconds": seconds, "bytes": n_bytes, "triangles": n_triangles }));
}
