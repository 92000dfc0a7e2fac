//! Large hostile files stay within the promised memory.
use super::{held_by, measured, promised, seeds, threemf_build, usd_build};
use chordal_io::{Content, Format, Limits, ReadOutcome, tiles};
use chordal_testkit::{Random, is_long};

#[test]
fn large_hostile_files_stay_within_the_promised_memory() {
    let n = if is_long() { 1_000_000 } else { 300_000 };
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let groups = |i: usize| format!("usemtl {i}\ng {i}\no {i}\ns {i}\n");
    let texcoords: String = (0..n / 4).map(|_| "vt 1\n").collect();
    let splits: String = (1..=n / 4).map(|i| format!(" 1/{i}")).collect();
    let xyz = "property uchar x\nproperty uchar y\nproperty uchar z\n";
    let ply = |format: &str, elements: &str, body: &[u8]| {
        [format!("ply\nformat {format} 1.0\n{elements}end_header\n").as_bytes(), body].concat()
    };
    let binary = "binary_little_endian";
    let vertices = format!("element vertex 4\n{xyz}");
    let corners: [u8; 12] = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0];
    let face = "property list uchar uchar vertex_indices\n";
    let solids: String = (0..n / 4).map(|i| format!("solid {i}\nendsolid\n")).collect();
    let vtk = "# vtk DataFile Version 3.0\nx\n";
    let files: Vec<(&str, Format, Vec<u8>)> = vec![
        ("positions", Format::Obj, "v 1 1 1\n".repeat(n).into_bytes()),
        ("colours", Format::Obj, "v 1 1 1 1 1 1\n".repeat(n / 2).into_bytes()),
        ("triangles", Format::Obj, format!("{square}{}", "f 1 2 3\n".repeat(n)).into_bytes()),
        ("one polygon", Format::Obj, format!("{square}f{}\n", " 1 2 3 4".repeat(n / 2)).into_bytes()),
        ("quads", Format::Obj, format!("{square}{}", "f 1 2 3 4\n".repeat(n)).into_bytes()),
        ("splits", Format::Obj, format!("{square}{texcoords}f{splits}\n").into_bytes()),
        (
            "a cage with a crease",
            Format::Obj,
            format!("{square}{}t crease 2/1/0 0 1 1\n", "f 1 2 3\n".repeat(n)).into_bytes(),
        ),
        (
            "a cage of quads",
            Format::Obj,
            format!("{square}vt 0\n{}t hole 0/0/0\n", "f 1/1 2/1 3/1 4/1\n".repeat(n / 2)).into_bytes(),
        ),
        (
            "creases",
            Format::Obj,
            format!("{square}f 1 2 3\n{}", "t crease 2/1/0 0 1 1\n".repeat(n / 4)).into_bytes(),
        ),
        (
            "a tag of creases",
            Format::Obj,
            format!("{square}f 1 2 3\nt crease {}/1/0{} 1\n", 2 * n, " 0 1".repeat(n)).into_bytes(),
        ),
        (
            "a tag of holes",
            Format::Obj,
            format!("{square}f 1 2 3\nt hole {}/0/0{}\n", 2 * n, " 0 0".repeat(n)).into_bytes(),
        ),
        (
            "a tag of corners",
            Format::Obj,
            format!("{square}f 1 2 3\nt corner {n}/{n}/0{}{}\n", " 0".repeat(n), " 1".repeat(n)).into_bytes(),
        ),
        (
            "groups",
            Format::Obj,
            (0..n / 8).fold(square.to_owned(), |t, i| t + &groups(i) + "f 1 2 3\n").into_bytes(),
        ),
        (
            "rows of one byte",
            Format::Ply,
            ply(binary, &format!("element vertex {n}\n{xyz}"), &vec![1; 3 * n]),
        ),
        (
            "bytes as values",
            Format::Ply,
            ply(binary, &format!("element vertex {n}\n{xyz}property uchar q\n"), &vec![1; 4 * n]),
        ),
        (
            "faces of four bytes",
            Format::Ply,
            ply(
                binary,
                &format!("{vertices}element face {n}\n{face}"),
                &[&corners[..], &[3, 0, 1, 2].repeat(n)].concat(),
            ),
        ),
        (
            "text faces",
            Format::Ply,
            ply(
                "ascii",
                &format!("{vertices}element face {n}\n{face}"),
                format!("0 0 0\n1 0 0\n1 1 0\n0 1 0\n{}", "3 0 1 2\n".repeat(n)).as_bytes(),
            ),
        ),
        (
            "coloured faces",
            Format::Off,
            format!("OFF\n3 {n} 0\n0 0 0\n1 0 0\n0 1 0\n{}", "3 0 1 2 1 1 1\n".repeat(n)).into_bytes(),
        ),
        ("flat vertices", Format::Off, format!("nOFF 2\n{n} 1\n{}3 0 1 2\n", "1 1\n".repeat(n)).into_bytes()),
        (
            "coloured vertices",
            Format::Off,
            format!("CNOFF\n{n} 1\n{}3 0 1 2\n", "1 1 1 1 1 1 1 1 1\n".repeat(n)).into_bytes(),
        ),
        (
            "faces without corners",
            Format::Off,
            format!("OFF\n1 {n} 0\n0 0 0\n{}", "0\n".repeat(n)).into_bytes(),
        ),
        ("prims", Format::Usda, format!("#usda 1.0\n{}", "def \"a\"{}".repeat(n / 4)).into_bytes()),
        ("xforms", Format::Usda, format!("#usda 1.0\n{}", "def Xform \"a\"{}".repeat(n / 4)).into_bytes()),
        (
            "values of a prim",
            Format::Usda,
            format!("#usda 1.0\ndef Mesh \"m\" {{ {} }}", "int primvars:a\nint primvars:b\n".repeat(n / 16))
                .into_bytes(),
        ),
        (
            "corners of a mesh",
            Format::Usda,
            format!(
                "#usda 1.0\ndef Mesh \"m\" {{ uniform token subdivisionScheme = \"none\" point3f[] points = [{}]\n\
                 int[] faceVertexCounts = [{}] int[] faceVertexIndices = [{}] }}",
                "(0,0,0),".repeat(3),
                "3,".repeat(n / 4),
                "0,1,2,".repeat(n / 4)
            )
            .into_bytes(),
        ),
        (
            "corners of a cage",
            Format::Usda,
            format!(
                "#usda 1.0\ndef Mesh \"m\" {{ point3f[] points = [{}]\n\
                 int[] faceVertexCounts = [{}] int[] faceVertexIndices = [{}] }}",
                "(0,0,0),".repeat(3),
                "3,".repeat(n / 4),
                "0,1,2,".repeat(n / 4)
            )
            .into_bytes(),
        ),
        ("a binary grid", Format::Usdc, usd_build::grid(500)),
        ("facets", Format::Stl, {
            let mut bytes = vec![0; 84 + 50 * n / 4];
            bytes[80..84].copy_from_slice(&(n as u32 / 4).to_le_bytes());
            let mut random = Random::new(3);
            for facet in bytes[84..].chunks_exact_mut(50) {
                facet
                    .chunks_exact_mut(4)
                    .for_each(|c| c.copy_from_slice(&(random.unit() as f32).to_le_bytes()));
            }
            bytes
        }),
        ("solids", Format::Stl, solids.into_bytes()),
        (
            "patches",
            Format::Json,
            format!(
                "{{\"points\":[[0,0,0]],\"patches\":[{}[{}0]]}}",
                format!("[{}0],", "0,".repeat(15)).repeat(n / 8),
                "0,".repeat(15)
            )
            .into_bytes(),
        ),
        (
            "points",
            Format::Json,
            format!("{{\"points\":[{}[0,0,0]],\"patches\":[]}}", "[0,0,0],".repeat(n)).into_bytes(),
        ),
        (
            "points of polylines",
            Format::Json,
            format!("{{\"polylines\":[{{\"points\":[{}[0,0]]}}]}}", "[0.25,-0.75],".repeat(n)).into_bytes(),
        ),
        ("elements", Format::Svg, format!("<svg>{}</svg>", "<g/>".repeat(n)).into_bytes()),
        (
            "shapes",
            Format::Svg,
            format!("<svg>{}</svg>", "<circle cx='1' cy='2' r='1'/>".repeat(n / 8)).into_bytes(),
        ),
        (
            "styles",
            Format::Svg,
            format!("<svg><style>{}</style></svg>", ".a{fill:red}".repeat(n / 8)).into_bytes(),
        ),
        ("text", Format::Svg, format!("<svg><style>{}</style></svg>", "x".repeat(n)).into_bytes()),
        (
            "steps",
            Format::Vm,
            (0..n / 2).fold("0 var-x\n".to_owned(), |t, i| t + &format!("{:x} neg 0\n", i + 1)).into_bytes(),
        ),
        (
            "points of VTK",
            Format::Vtk,
            format!("{vtk}ASCII\nDATASET POLYDATA\nPOINTS {n} char\n{}", "1 1 1\n".repeat(n)).into_bytes(),
        ),
        (
            "cells of VTK",
            Format::Vtk,
            format!(
                "{vtk}ASCII\nDATASET POLYDATA\nPOINTS 3 char\n0 0 0 1 0 0 0 1 0\nPOLYGONS {n} {}\n{}",
                4 * n,
                "3 0 1 2\n".repeat(n)
            )
            .into_bytes(),
        ),
        (
            "bytes of points of VTK",
            Format::Vtk,
            [
                format!("{vtk}BINARY\nDATASET POLYDATA\nPOINTS {n} char\n").as_bytes(),
                &vec![1; 3 * n],
                format!("\nPOINT_DATA {n}\nSCALARS s unsigned_char 4\n").as_bytes(),
                &vec![1; 4 * n],
            ]
            .concat(),
        ),
        (
            "cells of a grid",
            Format::Vtu,
            format!(
                "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"3\" NumberOfCells=\"{n}\"><Points>\
                 <DataArray type=\"Int8\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0</DataArray></Points><Cells>\
                 <DataArray type=\"Int32\" Name=\"connectivity\">{}</DataArray><DataArray type=\"Int32\" Name=\"offsets\">{}</DataArray>\
                 <DataArray type=\"Int8\" Name=\"types\">{}</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>",
                "0 1 2 ".repeat(n),
                (1..=n).map(|i| format!("{} ", 3 * i)).collect::<String>(),
                "5 ".repeat(n)
            )
            .into_bytes(),
        ),
        (
            "data arrays",
            Format::Vtp,
            format!(
                "<VTKFile type=\"PolyData\"><PolyData>{}</PolyData></VTKFile>",
                "<Piece NumberOfPoints=\"1\"><Points><DataArray type=\"Int8\" NumberOfComponents=\"3\">0 0 0</DataArray></Points></Piece>"
                    .repeat(n / 50)
            )
            .into_bytes(),
        ),
        (
            "triangles of AMF",
            Format::Amf,
            format!(
                "<amf><object id=\"1\"><mesh><vertices>{}</vertices><volume><color><r>1</r></color>{}</volume></mesh></object></amf>",
                "<vertex><coordinates><x>1</x><y>1</y><z>1</z></coordinates></vertex>".repeat(3),
                "<triangle><v1>0</v1><v2>1</v2><v3>2</v3></triangle>".repeat(n / 8)
            )
            .into_bytes(),
        ),
        (
            "triangles of Collada",
            Format::Dae,
            format!(
                "<COLLADA><library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array>1 0 0</float_array>\
                 <technique_common><accessor count=\"1\" stride=\"3\"/></technique_common></source><vertices id=\"v\">\
                 <input semantic=\"POSITION\" source=\"#p\"/></vertices><triangles><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>\
                 <input semantic=\"NORMAL\" source=\"#p\" offset=\"1\"/><p>{}</p></triangles></mesh></geometry></library_geometries></COLLADA>",
                "0 0 0 0 0 0 ".repeat(n / 4)
            )
            .into_bytes(),
        ),
        (
            "indices",
            Format::Teaset,
            format!("{}\n{}1\n0,0,0\n", n / 8, format!("{}1\n", "1,".repeat(15)).repeat(n / 8)).into_bytes(),
        ),
    ];
    for (name, format, bytes) in files {
        let (result, most) = measured(&bytes, format);
        let size = bytes.len() as u64;
        let outcome = result.as_ref().map_or_else(|e| e.to_string(), |_| "loads".to_owned());
        println!("{name}: {size} bytes, held {most} ({:.1} x): {outcome}", most as f64 / size as f64);
        // Without the 64 MiB: what holds for files of this size must hold for larger ones.
        assert!(most <= (1 << 20) + 16 * size, "{name}: {most} bytes for {size}");
    }
}

/// Bézier patches in text are packed more tightly than surfaces with knots and weights can be. What is promised for
/// them counts the control points: of patches that are halved, those of their halves.
#[test]
fn packed_patches_stay_within_the_promise_for_their_control_points() {
    let n = 20_000_u64;
    let straight = "0 0 0 1 0 0 0 1 0 1 1 0 ";
    // Half a circle along u and a quarter of one along v, whose weights vanish in the middle.
    let halved = "1 0 0 1 0 1 0 0 -1 0 0 1 0 0 1 0 0 0 0 0 0 0 1 0 -1 0 0 1 0 1 0 0 1 0 0 1 ";
    for (keyword, patch, n_points) in [("BEZ113", straight, 4), ("BEZ224", halved, 25)] {
        let bytes = format!("{keyword} {}", patch.repeat(n as usize)).into_bytes();
        let (result, most) = measured(&bytes, Format::Bez);
        let Ok(ReadOutcome { content: Content::Surfaces(surfaces, _), .. }) = result else {
            panic!("{result:?}")
        };
        assert_eq!((surfaces.len() as u64, surfaces[0].surface().control().len()), (n, n_points));
        println!("{keyword}: {} bytes, held {most}", bytes.len());
        assert!(most <= (1 << 20) + 16 * 32 * n * n_points as u64, "{keyword}: {most}");
    }
}

/// Strips and polygons of one-byte indices are packed more tightly than triangles can be: twelve bytes for
/// each byte of the file. What is promised for them counts the triangles.
#[test]
fn packed_faces_stay_within_the_promise_for_what_they_decode_to() {
    let rows = 20_000_u64;
    let header = |element: &str| {
        format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty uchar x\nproperty uchar y\nproperty uchar z\nelement {element} {rows}\nproperty list uchar uchar vertex_indices\nend_header\n"
        )
    };
    for element in ["face", "tristrips"] {
        let mut bytes = header(element).into_bytes();
        bytes.extend([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]);
        for _ in 0..rows {
            bytes.push(255);
            bytes.extend((0..255).map(|i| (i % 4) as u8));
        }
        let (result, most) = measured(&bytes, Format::Ply);
        let Ok(ReadOutcome { content: Content::Scene(scene), .. }) = result else { panic!("loads") };
        let triangles = scene.parts[0].mesh.faces().len() as u64;
        assert_eq!(triangles, 253 * rows);
        println!("{element}: {} bytes, held {most} ({:.1} x)", bytes.len(), most as f64 / bytes.len() as f64);
        assert!(most <= promised(12 * triangles), "{element}: {most} bytes for {triangles} triangles");
    }
}

/// Gzip packs samples as tightly as it likes. What is promised counts what they unpack to, and what a header
/// declares beyond that counts nothing.
#[test]
fn h62_packed_volumes_stay_within_the_promise_for_what_they_unpack_to() {
    let n = 128_usize;
    let head = |sizes: &str, kind: &str| {
        format!("NRRD0004\ntype: {kind}\ndimension: 3\nsizes: {sizes}\nendian: big\nencoding: gzip\n\n")
    };
    for (kind, width) in [("uchar", 1), ("short", 2), ("float", 4), ("longlong", 8)] {
        let size = format!("{n} {n} {n}");
        let unpacked = (n * n * n * width) as u64;
        let file = [head(&size, kind).as_bytes(), &seeds::packed(&vec![0; unpacked as usize])].concat();
        let (result, most) = measured(&file, Format::Nrrd);
        assert!(result.is_ok());
        println!("{kind}: {} bytes, {unpacked} unpacked, held {most}", file.len());
        assert!(most <= (1 << 20) + 4 * unpacked, "{kind}: {most} bytes for {unpacked}");
        // What may be a volume that is cut off, and what can be none.
        let sparse = format!("{} 1000 1000", 2000 / width);
        for (sizes, code) in [("250 250 250", "truncated"), (&*sparse, "too-dense")] {
            let file = [head(sizes, kind).as_bytes(), &seeds::packed(&vec![0; 1000])].concat();
            let (result, most) = measured(&file, Format::Nrrd);
            assert_eq!(result.unwrap_err().code, code);
            assert!(most <= 1 << 20, "{kind}: {most} bytes for 1000");
        }
    }
}

/// A path packs a point into as little as two bytes. What is promised counts 16 bytes for each point.
#[test]
fn h77_packed_paths_stay_within_the_promise_for_what_they_decode_to() {
    let n = if is_long() { 1_000_000_u64 } else { 300_000 };
    let paths = [
        ("h1", 1),
        ("l1 1", 1),
        ("t1 1", 1),
        ("zh1", 1),
        ("M0 0h1", 1),
        ("c0 0 0 0 1 1", 3),
        ("a1 1 0 01 1 1", 1),
    ];
    for (step, points) in paths {
        let text = format!("<svg><path d='M0 0{}'/></svg>", step.repeat(n as usize));
        let (result, most) = measured(text.as_bytes(), Format::Svg);
        assert!(result.is_ok());
        println!("{step}: {} bytes, held {most}, {:.0} a piece", text.len(), most as f64 / n as f64);
        let decoded = if step.starts_with(['z', 'M']) { 2 * n } else { points * n };
        assert!(most <= promised(text.len() as u64).max(promised(16 * decoded)), "{step}: {most} bytes");
    }
    // A circle without a place is two points in 15 bytes.
    let text = format!("<svg>{}</svg>", "<circle r='1'/>".repeat(n as usize / 8));
    let (result, most) = measured(text.as_bytes(), Format::Svg);
    assert!(result.is_ok() && most <= (1 << 20) + 16 * 16 * (n / 4), "{most} bytes for {} circles", n / 8);
    let text = format!("{{\"polylines\":[{{\"points\":[{}[0,0]]}}]}}", "[0,0],".repeat(n as usize));
    let (result, most) = measured(text.as_bytes(), Format::Json);
    assert!(result.is_ok() && most <= promised(16 * n), "{most}");
}

#[test]
fn h75_tilesets_stay_within_the_promise() {
    let n = if is_long() { 400_000 } else { 120_000 };
    let tile = |more: &str| {
        format!(r#"{{"boundingVolume":{{"box":[0,0,0,1,0,0,0,1,0,0,0,1]}},"geometricError":0{more}}}"#)
    };
    let list = |child: &str| {
        let children = vec![child; n].join(",");
        let root = tile(&format!(r#","refine":"ADD","children":[{children}]"#));
        format!(r#"{{"asset":{{"version":"1.1"}},"geometricError":1,"root":{root}}}"#)
    };
    let nested = tile(&format!(r#","children":[{}]"#, tile(r#","content":{"uri":"a"}"#)));
    let several = tile(r#","contents":[{"uri":"a"},{"uri":"b"},{"uri":"c"}]"#);
    let extras = tile(r#","extras":[0,0,0,0,0,0,0,0]"#);
    let ball = r#"{"boundingVolume":{"sphere":[0,0,0,0]},"geometricError":0}"#.to_owned();
    for (name, child) in [("flat", ball), ("nested", nested), ("several", several), ("extras", extras)] {
        let text = list(&child);
        let read = || tiles::read(text.as_bytes(), &mut |_| Err(String::new()), &Limits::default());
        let (result, most) = held_by(read);
        assert_eq!(result.expect("read").0.root.children.len(), n);
        println!("{name}: {} bytes, held {most}, {:.1} a byte", text.len(), most as f64 / text.len() as f64);
        // The allowance for extras aside, what a tile takes stays below 16 times its text.
        assert!(most <= (18 << 20) + 16 * text.len() as u64, "{name}: {most} bytes for {}", text.len());
    }
}

/// A model packs what nodes take into as little as 20 bytes of text. What is promised counts the text.
#[test]
fn h51_models_stay_within_the_promise_for_what_they_unpack_to() {
    use threemf_build::{Zipped, body, model, package, tetrahedron, zip_of};
    let n = 100_000;
    let of = |row: &dyn Fn(usize) -> String| (2..n + 2).map(row).collect::<String>();
    let one = body(1, "");
    let components = "<component objectid=\"1\"/>".repeat(n);
    let vertices = "<vertex x=\"1\" y=\"2\" z=\"3\"/>".repeat(n);
    let triangles = |more: &str| format!("<triangle v1=\"0\" v2=\"1\" v3=\"2\"{more}/>").repeat(n);
    let colors = "<m:colorgroup id=\"5\"><m:color color=\"#336699\"/></m:colorgroup>";
    let mesh = |vertices: &str, triangles: &str| {
        let mesh = tetrahedron([""; 4]).replacen("</vertices>", &format!("{vertices}</vertices>"), 1);
        format!(
            "<object id=\"1\">{}</object>",
            mesh.replacen("</triangles>", &format!("{triangles}</triangles>"), 1)
        )
    };
    let shown = "<item objectid=\"1\"/>";
    let models = [
        ("items", model(&one, &shown.repeat(n))),
        (
            "components",
            model(
                &format!("{one}<object id=\"2\"><components>{components}</components></object>"),
                "<item objectid=\"2\"/>",
            ),
        ),
        ("objects", model(&of(&|id| format!("<object id=\"{id}\"><mesh/></object>")), "")),
        (
            "holders",
            model(&(one.clone() + &of(&|id| format!("<object id=\"{id}\"><components/></object>"))), ""),
        ),
        ("groups", model(&of(&|id| format!("<m:colorgroup id=\"{id}\"/>")), "")),
        (
            "colours",
            model(
                &colors.replace("<m:color c", &("<m:color color=\"#336699\"/>".repeat(n) + "<m:color c")),
                "",
            ),
        ),
        (
            "materials",
            model(
                &format!(
                    "<basematerials id=\"5\">{}</basematerials>",
                    "<base name=\"\" displaycolor=\"#336699\"/>".repeat(n)
                ),
                "",
            ),
        ),
        ("vertices", model(&mesh(&vertices, ""), shown)),
        ("triangles", model(&mesh("", &triangles("")), shown)),
        (
            "triangles in colour",
            model(&(colors.to_owned() + &mesh("", &triangles(" pid=\"5\" p1=\"0\""))), shown),
        ),
    ];
    for (name, text) in models {
        let (result, most) = measured(&package(&text), Format::ThreeMf);
        let size = text.len() as u64;
        let outcome = result.as_ref().map_or_else(|e| e.to_string(), |_| "loads".to_owned());
        println!(
            "{name}: {size} bytes unpacked, held {most} ({:.1} x): {outcome}",
            most as f64 / size as f64
        );
        assert!(result.is_ok() && most <= (1 << 20) + 16 * size, "{name}: {most} bytes for {size}");
    }
    // A bomb holds no more than its limit, whatever it would unpack to.
    let bomb = zip_of(&[
        Zipped::stored("_rels/.rels", threemf_build::relationships(&[threemf_build::TO_MODEL]).as_bytes()),
        Zipped::deflated("3D/3dmodel.model", &vec![b' '; 1 << 28]),
    ]);
    let (result, most) = measured(&bomb, Format::ThreeMf);
    assert_eq!(result.unwrap_err().code, "too-dense");
    assert!(most <= promised(bomb.len() as u64), "{most}");
}

#[test]
fn material_libraries_stay_within_the_promise_for_all_files_together() {
    let n = if is_long() { 300_000 } else { 100_000 };
    let used: String = (0..n).map(|i| format!("usemtl {i}\n")).collect();
    let obj = |libraries: &str| format!("{libraries}\nv 0 0 0\nv 1 0 0\nv 0 1 0\n{used}f 1 2 3\n");
    let bare: String = (0..n).map(|i| format!("newmtl {i}\n")).collect();
    let full: String = (0..n / 8)
        .map(|i| {
            format!("newmtl {i}\nKa 1\nKs 1\nNs 1\nNi 1\nd 0\nmap_Kd {i}a\nmap_Ke {i}b\nnorm {i}c\nrefl d\n")
        })
        .collect();
    let one = format!("newmtl 0\n{}", "Ka 1 1 1\nmap_Kd -mm 0 1 a.png\nfoo 1\nKd x\n".repeat(n));
    let unused: String = (0..n).map(|i| format!("newmtl x{i}\nKd 1 1 1\n")).collect();
    let wide = format!("newmtl 0\nKd {}\nmap_Kd {}\n", "1 ".repeat(n), "-s 1 ".repeat(n));
    let many: String = (0..n).map(|i| format!("mtllib {i}\n")).collect();
    let line = format!("mtllib {}", "a.mtl b ".repeat(n));
    let few = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl 0\nf 1 2 3\n".to_owned();
    for (name, obj, library) in [
        ("bare materials", obj("mtllib a.mtl"), bare),
        ("full materials", obj("mtllib a.mtl"), full),
        ("materials that are missing", obj("mtllib a.mtl"), "newmtl x".to_owned()),
        ("one material", few.clone(), one),
        ("unused materials", few.clone(), unused),
        ("long lines", few, wide),
        ("many libraries", obj(&many), String::new()),
        ("one line of libraries", obj(&line), String::new()),
    ] {
        let mut open = |path: &str| match path {
            "a.mtl" => Ok(library.clone().into_bytes()),
            // Every third picture is there.
            _ if path.ends_with('a') => Ok(b"\x89PNG\r\n\x1a\n".to_vec()),
            _ => Err("it is gone".to_owned()),
        };
        let limits = Limits::default();
        let (result, most) =
            held_by(|| chordal_io::read_with(obj.as_bytes(), Format::Obj, &mut open, &limits));
        let n_bytes = (obj.len() + library.len()) as u64;
        assert!(most <= promised(n_bytes), "{name}: {most} bytes for {n_bytes}");
        assert!(matches!(result, Ok(ReadOutcome { content: Content::Scene(_), .. })), "{name}");
    }
}

/// Objects that say nothing take three bytes of a file. What is promised holds for the hundreds of thousands of
/// them that an exporter may write.
#[test]
fn h39_hundreds_of_thousands_of_empty_objects_stay_within_the_promise() {
    let n = 300_000;
    let all = |item: &str| vec![item; n].join(",");
    let roots = (0..n).map(|i| i.to_string()).collect::<Vec<_>>().join(",");
    let files = [
        ("nodes", format!("\"nodes\":[{}]", all("{}"))),
        ("nodes of a scene", format!("\"nodes\":[{}],\"scenes\":[{{\"nodes\":[{roots}]}}]", all("{}"))),
        ("named nodes", format!("\"nodes\":[{}]", all("{\"name\":\"a\"}"))),
        ("materials", format!("\"materials\":[{}]", all("{}"))),
        ("textures", format!("\"textures\":[{}]", all("{}"))),
        ("samplers", format!("\"samplers\":[{}]", all("{}"))),
        ("scenes", format!("\"scenes\":[{}]", all("{}"))),
    ];
    for (name, list) in files {
        let text = format!("{{\"asset\":{{\"version\":\"2.0\"}},{list}}}");
        let (result, most) = measured(text.as_bytes(), Format::Gltf);
        assert!(result.is_ok(), "{name}: {}", result.unwrap_err());
        let size = text.len() as u64;
        println!("{name}: {size} bytes, held {most}");
        // The file itself is held too.
        assert!(most + size <= promised(size), "{name}: {most} bytes for {size}");
    }
}
