//! The files that the sweep changes: one or more of each format.
use super::{dicom_build, usd_build};
use chordal::Mesh;
use chordal::explicit::{Attribute, Domain, Semantic};
use chordal_io::{Format, Frame, Scene, obj, off, ply, stl, threemf, usd, vtk};
use std::io::Write;

pub(super) fn written(scene: &Scene, format: Format) -> Vec<u8> {
    let certificate = serde_json::json!({"bound": {"at_most": 0.1}});
    let mut bytes = Vec::new();
    match format {
        Format::Obj => obj::write(scene, Some(&certificate), &mut bytes),
        Format::Ply => ply::write(scene, Some(&certificate), &mut bytes),
        Format::Off => off::write(scene, Some(&certificate), &mut bytes),
        Format::ThreeMf => threemf::write(scene, Some(&certificate), &mut bytes),
        Format::Vtp => vtk::write(scene, Some(&certificate), &mut bytes),
        Format::Usda => usd::write(scene, Some(&certificate), &mut bytes),
        _ => stl::write(scene, None, &mut bytes),
    }
    .expect("written");
    bytes
}

/// Small files of every kind: some by the writers, some by hand.
pub(super) fn all() -> Vec<(Format, Vec<u8>)> {
    let plain = Mesh::new(
        vec![[0.0; 3], [1.5, 0.0, -2.0], [0.0, 1e-3, 0.0], [1.0, 1.0, 1.0]],
        vec![[0, 1, 2], [2, 1, 3]],
    )
    .unwrap();
    let vertex = |semantic, width: usize| Attribute {
        semantic,
        domain: Domain::Vertex,
        width,
        values: (0..4 * width).map(|i| i as f64 / 7.0).collect(),
    };
    let rich = plain
        .clone()
        .with_attribute(Attribute::vertex_normals(&[[0.0, 0.6, 0.8]; 4]))
        .and_then(|m| m.with_attribute(vertex(Semantic::TexCoord(0), 2)))
        .and_then(|m| m.with_attribute(vertex(Semantic::Color(0), 3)))
        .and_then(|m| m.with_position_id(vec![0, 1, 2, 3]))
        .unwrap();
    let mut seeds = Vec::new();
    for mesh in [plain, rich] {
        let formats =
            [Format::Obj, Format::Ply, Format::Stl, Format::Off, Format::ThreeMf, Format::Vtp, Format::Usda];
        for format in formats {
            seeds.push((format, written(&Scene::from_mesh("a b", mesh.clone(), Frame::default()), format)));
        }
    }
    let mut add = |format, text: &str| seeds.push((format, text.as_bytes().to_vec()));
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0\n";
    add(
        Format::Obj,
        &format!(
            "{square}vt 0 1\nvn 0 0 1\nusemtl a\ns 1\nf 1/1/1 2/1/1 3//1 4\nf -1 -2 -3\ng b c\nf 1 3 2 4 1 2\n"
        ),
    );
    add(
        Format::Obj,
        &format!("mtllib x\no q\n{square}f 1 2 \\\n3 4\r\nl 1 2\np 1\nt crease 2/1/0 0 1 2\ncurv 0 1\n"),
    );
    let xyz = "property float x\nproperty double y\nproperty short z\n";
    let list = "property list uchar int vertex_indices\n";
    add(
        Format::Ply,
        &format!(
            "ply\r\nformat ascii 1.0\ncomment x\nelement vertex 4\n{xyz}property uchar red\nelement face 2\n{list}property int f\nelement z 1\nproperty list int float q\nend_header\n0 0 0 1\n1 0 0 2\n1 1 0 3\n0 1 0 255\n3 0 1 2 9\n4 0 1 2 3 9\n2 0.5 1e9\n"
        ),
    );
    add(
        Format::Ply,
        &format!(
            "ply\nformat ascii 1.0\nelement tristrips 1\nproperty list int int vertex_indices\nelement vertex 4\n{xyz}end_header\n6 0 1 2 -1 3 2\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
        ),
    );
    let mut big = format!("ply\nformat binary_big_endian 1.0\nelement vertex 3\n{xyz}element other 2\nproperty list ushort uint64 k\nproperty char c\nelement face 1\n{list}end_header\n").into_bytes();
    for i in 0..3_i16 {
        big.extend(f32::from(i).to_be_bytes());
        big.extend(f64::from(i * i).to_be_bytes());
        big.extend(i.to_be_bytes());
    }
    big.extend([0, 1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 0, 1]);
    big.extend([3, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2]);
    seeds.push((Format::Ply, big));
    let mut add = |format, text: &str| seeds.push((format, text.as_bytes().to_vec()));
    add(
        Format::Off,
        "# x\nSTCN4nOFF\n2\n3 3 9\n0 0 2 0 0 1 1 1 0 0.5 1 # y\n1 0 1 0 0 1 9 9 9 9 0 0\n0 1 1 0 0 1 0 0 1 0 0\n3 0 1 2 3\n4 0 1 2 0 0.5 0 0 1\n2 0 1\n",
    );
    let mut big = b"COFF BINARY\n\0\0\0\x03\0\0\0\x02\0\0\0\0".to_vec();
    (0..21).for_each(|i| big.extend((i as f32 / 7.0).to_be_bytes()));
    for number in [3, 0, 1, 2, 3, 0, 0, 0, 3, 0, 2, 1, 0] {
        big.extend(i32::to_be_bytes(number));
    }
    seeds.push((Format::Off, big));
    let mut add = |format, text: &str| seeds.push((format, text.as_bytes().to_vec()));
    let facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 -0\nvertex 0 1 0\nendloop\nendfacet\n";
    add(Format::Stl, &format!("solid one\n{facet}{facet}endsolid one\nsolid two\n{facet}endsolid\n"));
    let points = "0.5 1 -2\n".repeat(16);
    add(
        Format::Bez,
        &format!(
            "# x\nBBP\n{points}\nCBEZ114_ST # y\n0 0 0 1 1 0 0 1\n0 1 0 1 2 2 0 2\n{}BEZ 2 1 3\n{}}} z\n",
            "0 ".repeat(24),
            "1 2 3\n".repeat(6)
        ),
    );
    add(Format::Bpt, &format!("2\n3 3\n{points}3 3\n{points}"));
    add(
        Format::Usda,
        "#usda 1.0\n(subLayers = [@a.usd@ (offset = 1)])\ndef Mesh \"m\" (inherits = </c> variants = { string v = \"x\" }) {\n\
         point3f[] points = [(0,0,0),(1,0,0),(0,1,0)] int[] faceVertexCounts = [3] int[] faceVertexIndices = [0,1,2]\n\
         int[] creaseIndices = [0,1] int[] creaseLengths = [2] float[] creaseSharpnesses = [2.5]\n\
         texCoord2f[] primvars:st = [(0,0)] (interpolation = \"constant\") quatf xformOp:orient = (1,0,0,1)\n\
         uniform token[] xformOpOrder = [\"!invert!xformOp:orient\"] rel material:binding = </M>\n\
         variantSet \"v\" = { \"x\" { token visibility.timeSamples = { 0: \"inherited\", } } } }\n\
         class \"c\" {} def Material \"M\" { token outputs:surface.connect = </M.inputs:a> }\n",
    );
    let row = "point3f[] points = [(0,0,0),(1,0,0.5),(2,0,0),(0,1,0),(1,1,1),(2,1,0)]";
    add(
        Format::Usda,
        &format!(
            "#usda 1.0\ndef BasisCurves \"b\" {{ {row} int[] curveVertexCounts = [3,3] uniform token wrap = \"pinned\" uniform token basis = \"catmullRom\" }}\n\
             def NurbsCurves \"n\" {{ {row} int[] curveVertexCounts = [6] int[] order = [3] double[] knots = [0,0,0,1,2,2.5,4,4,4] }}\n"
        ),
    );
    add(
        Format::Usda,
        &format!(
            "#usda 1.0\ndef NurbsPatch \"p\" {{ {row} int uVertexCount = 3 int vVertexCount = 2 int uOrder = 3 int vOrder = 2\n\
             double[] uKnots = [0,0,0,1,1,1] double[] vKnots = [0,0,1,1] double[] pointWeights = [1,0.5,1,1,2,1] int[] trimCurve:counts = [1] }}\n"
        ),
    );
    let indices = "1,2,3,4,4,3,2,1,1,2,3,4,4,3,2,1\n";
    add(Format::Teaset, &format!("2\n{indices}{indices}4\n0,0,0\n1.5,0,0\n0,1,0\n0,0,1e3\n"));
    add(
        Format::Json,
        &format!(
            "{{\"up\":\"z\",\"points\":[[0,0,0],[1,0.5,-2e1],[0,1,0],[0,0,1],[1,1,1]],\"patches\":[[{}]],\"x\":{{\"\\u00e9\":[true,null]}}}}",
            indices.trim()
        ),
    );
    let row = "[[0,0,0],[1,0,0],[2,0,0.25],[3,0,0]]";
    add(
        Format::Json,
        &format!("{{\"patches\": [[{row}, {row}, {row}, {row}]], \"metres_per_unit\": 0.001}}"),
    );
    add(
        Format::Json,
        "{\"curves\": [{\"control\": [[0,0],[1,0],[2,1],[3,1]], \"closed\": false, \"rule\": \"evenodd\"}]}",
    );
    add(
        Format::Json,
        "{\"polylines\": [{\"points\": [[0,0,1],[1,0,2.5]], \"closed\": true, \"source\": 0}], \"report\": {\"certificate\": {}}}",
    );
    add(
        Format::Svg,
        "<?xml version=\"1.0\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 9 9\" width=\"9mm\">\n\
         <style>.a{fill:none} #b{fill-rule:evenodd}</style>\n\
         <g transform=\"rotate(30 1 2) scale(2)\"><path id=\"b\" class=\"a\"\n\
         d=\"M0 0h1v2l1-1C1 2 3 4 5 6S7 8 9 1Q1 2 3 4T5 6A1 2 30 01.5.5z\"/></g>\n\
         <rect x=\"1\" width=\"10%\" height=\"3\" rx=\".5\"/><circle r=\"2\"/>\n\
         <symbol id=\"s\" viewBox=\"0 0 1 1\"><polygon points=\"0,0 1 0 1,1\"/></symbol>\n\
         <use href=\"#s\" x=\"3\" width=\"2\" height=\"1\"/><text>x</text>\n</svg>\n",
    );
    add(
        Format::Vm,
        "# a disc\n_x var-x\n_y var-y # up\n_0 const -2.5e-1\n_1 square _x\n_2 mul _y _y\r\n\n_3 add _1 _2\n\
         _4 sqrt _3\n_5 atan2 _4 _0\n_6 mod _5 _x\n_7 max _6 _0\n",
    );
    let points = "0 0 0 1 0 0 1 1 0 0 1 0";
    let array = |kind: &str, name: &str, numbers: &str| {
        format!("<DataArray type=\"{kind}\" Name=\"{name}\">{numbers}</DataArray>")
    };
    add(
        Format::Vtp,
        &format!(
            "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"4\" NumberOfStrips=\"1\" NumberOfPolys=\"1\">\n\
             <CellData>{}</CellData><Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">{points}</DataArray></Points>\n\
             <Strips>{}{}</Strips>\n<Polys>{}{}</Polys></Piece></PolyData></VTKFile>",
            array("UInt8", "u", "1 2"),
            array("Int32", "connectivity", "0 1 3 2"),
            array("Int8", "offsets", "4"),
            array("Int64", "connectivity", "0 1 2 3"),
            array("Int32", "offsets", "4"),
        ),
    );
    add(
        Format::Vtu,
        &format!(
            "<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt32\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"2\">\n\
             <PointData><DataArray type=\"UInt8\" Name=\"b\" format=\"binary\">BAAAAAECAwQ=</DataArray></PointData>\n\
             <Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">{points}</DataArray></Points>\n<Cells>{}{}{}</Cells>\n\
             </Piece></UnstructuredGrid></VTKFile>",
            array("Int32", "connectivity", "0 1 2 0 1 2 3"),
            array("Int32", "offsets", "3 7"),
            array("UInt8", "types", "5 10"),
        ),
    );
    add(
        Format::Vtk,
        &format!(
            "# vtk DataFile Version 5.1\nx\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n{points}\nPOLYGONS 2 4\nOFFSETS vtktypeint64\n0 4\n\
             CONNECTIVITY vtktypeint64\n0 1 2 3\nCELL_DATA 1\nFIELD f 1\nq 2 1 int\n7 8\nPOINT_DATA 4\nSCALARS s float 1\n\
             LOOKUP_TABLE default\n1 2 3 4\nCOLOR_SCALARS c 3\n{points}\n"
        ),
    );
    add(
        Format::Vtk,
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nSPACING 1 2 3\nORIGIN 0 0 1\n\
         POINT_DATA 8\nSCALARS s short 1\nLOOKUP_TABLE default\n1 2 3 4 -5 6 7 8\nFIELD f 1\nq 1 8 float\n1 2 3 4 5 6 7 8.5\n",
    );
    let gifti = |intent: &str, kind: &str, data: &str, encoding: &str| {
        format!(
            "<DataArray Intent=\"NIFTI_INTENT_{intent}\" DataType=\"NIFTI_TYPE_{kind}\" Dimensionality=\"2\" Dim0=\"3\" \
             Dim1=\"3\" Encoding=\"{encoding}\" Endian=\"LittleEndian\"><Data>{data}</Data></DataArray>\n"
        )
    };
    let corners = gifti("TRIANGLE", "UINT8", "AAECAgEAAAIB", "Base64Binary");
    add(
        Format::Gii,
        &format!(
            "<?xml version=\"1.0\"?>\n<!DOCTYPE GIFTI SYSTEM \"x.dtd\">\n<GIFTI>{}{corners}</GIFTI>",
            gifti("POINTSET", "FLOAT32", "0 0 0 1 0 0 0 1.5 0", "ASCII")
        ),
    );
    let vertex = "<vertex><coordinates><x>1</x><y>2</y><z>0</z></coordinates></vertex>\n";
    add(
        Format::Amf,
        &format!(
            "<amf unit=\"inch\"><object id=\"1\"><mesh><vertices>{}</vertices><volume materialid=\"2\">\n\
             <triangle><v1>0</v1><v2>1</v2><v3>2</v3><color><r>1</r><g>0.5</g></color></triangle></volume></mesh></object>\n\
             <material id=\"2\"><color><b>1</b></color></material>\n\
             <constellation id=\"3\"><instance objectid=\"1\"><rx>45</rx><deltax>2</deltax></instance></constellation></amf>",
            vertex.repeat(3)
        ),
    );
    add(
        Format::Dae,
        &format!(
            "<COLLADA><asset><up_axis>X_UP</up_axis></asset><library_geometries><geometry id=\"g\"><mesh>\n\
             <source id=\"p\"><float_array>{points}</float_array><technique_common><accessor count=\"4\" stride=\"3\"/></technique_common></source>\n\
             <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/><input semantic=\"NORMAL\" source=\"#p\"/></vertices>\n\
             <polylist material=\"m\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><vcount>4 3</vcount><p>0 1 2 3 0 1 2</p></polylist>\n\
             </mesh></geometry></library_geometries><library_visual_scenes><visual_scene id=\"s\"><node id=\"n\">\n\
             <rotate>0 0 1 30</rotate><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>\n\
             <scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>"
        ),
    );
    seeds.extend(volumes());
    seeds.push((Format::Cmpt, old_tile()));
    seeds.push((Format::Usdc, usd_build::grid(1)));
    seeds
}

/// A tile of two instances, in a composite.
fn old_tile() -> Vec<u8> {
    let word = |n: usize| (n as u32).to_le_bytes();
    let json = concat!(
        "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primi",
        "tives\":[{\"attributes\":{\"POSITION\":0}}]}],\"buffers\":[{\"byteLength\":36}],\"bufferViews\":[{\"buffer\":0,\"b",
        "yteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0",
        ",0],\"max\":[1,1,0]}]}",
    );
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes).concat();
    let chunks = [&word(json.len())[..], b"JSON", json.as_bytes(), &word(36), b"BIN\0", &corners].concat();
    let model = [&b"glTF"[..], &word(2), &word(12 + chunks.len()), &chunks].concat();
    let table = b"{\"INSTANCES_LENGTH\":2,\"POSITION\":{\"byteOffset\":0},\"RTC_CENTER\":[1,2,3]}";
    let body = [&word(1)[..], table, &[0; 24], &model].concat();
    let head =
        [&b"i3dm"[..], &word(1), &word(28 + body.len()), &word(table.len()), &word(24), &[0; 8]].concat();
    let tile = [head, body].concat();
    [&b"cmpt"[..], &word(1), &word(16 + tile.len()), &word(1), &tile].concat()
}

/// Small volumes by hand.
pub(super) fn volumes() -> Vec<(Format, Vec<u8>)> {
    let samples: Vec<u8> = (0..16).collect();
    let npy = |descr: &str| {
        let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': (2, 2, 2), }}\n");
        let length = (header.len() as u16).to_le_bytes();
        [b"\x93NUMPY\x01\0", &length[..], header.as_bytes(), &samples].concat()
    };
    let head = "NRRD0004\n# x\ntype: short\ndimension: 3\nsizes: 2 2 2\nendian: big\nspace: LPS\n\
                space directions: (1,0,0) (0,-2.5,0) (0,0.1,3)\nspace origin: (1,2,3)\nspace units: \"mm\" \"mm\" \"mm\"\n";
    let nrrd = |encoding: &str, data: &[u8]| {
        [head.as_bytes(), format!("encoding: {encoding}\n\n").as_bytes(), data].concat()
    };
    let lists = b"NRRD0005\ntype: uchar\ndimension: 4\nsizes: 1 2 2 2\nkinds: vector space space space\n\
                  encoding: raw\nbyte skip: -1\nspacings: nan 1 1 2\nkey:=value\n\n123456789";
    let nii = |version: u8| {
        let mut header = if version == 1 { vec![0; 352] } else { vec![0; 544] };
        let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
        let one = 1.0_f32.to_le_bytes();
        if version == 1 {
            put(0, &348_i32.to_le_bytes());
            put(40, &[4, 0, 2, 0, 2, 0, 2, 0, 1, 0]);
            put(70, &[4, 0, 16, 0]);
            put(76, &[one, one, one, one].concat());
            put(108, &352.0_f32.to_le_bytes());
            put(112, &[2.0_f32.to_le_bytes(), one].concat());
            put(252, &[1, 0, 0, 0]);
            put(344, b"n+1\0");
        } else {
            let one = 1.0_f64.to_le_bytes();
            put(0, &540_i32.to_le_bytes());
            put(4, b"n+2\0\r\n\x1a\n");
            put(12, &[4, 0, 16, 0]);
            (0..4).for_each(|k| put(16 + 8 * k, &[if k == 0 { 3 } else { 2 }]));
            put(168, &544_i64.to_le_bytes());
            put(348, &[1]);
            [400, 440, 480].into_iter().for_each(|at| put(at, &one));
        }
        [&header[..], &samples].concat()
    };
    vec![
        (Format::Npy, npy("<i2")),
        (Format::Npy, npy(">f2")),
        (Format::Nrrd, nrrd("raw", &samples)),
        (Format::Nrrd, nrrd("gzip", &packed(&samples))),
        (Format::Nrrd, nrrd("text", b"0 1 -2 3\n4,5 6 7\n")),
        (Format::Nrrd, lists.to_vec()),
        (Format::Nii, nii(1)),
        (Format::Nii, nii(2)),
        (Format::Nii, packed(&nii(1))),
        (Format::MetaImage, meta("False", &samples)),
        (Format::MetaImage, meta("True", &zlib(&samples))),
        (Format::Npz, npz(&npy("<i2"))),
        (Format::Slc, b"11111\n2 2 2 8\n1 1 2.5\n1 2 0 1\n1 1 XRGB3 X\x04\x07\x006 X\x84abcd\x00".to_vec()),
        (Format::Vti, vti(&samples, "")),
        (Format::Vti, vti(&samples, "compressor=\"vtkZLibDataCompressor\"")),
        (Format::Vti, VTI_TEXT.to_vec()),
        (Format::Obj, packed(b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")),
    ]
    .into_iter()
    .chain(dicom_files())
    .collect()
}

/// Files of DICOM with two frames each: plain, masks, and one of each packing.
fn dicom_files() -> Vec<(Format, Vec<u8>)> {
    let plain = dicom_build::Frames::at(&[0.0, 1.0]);
    let masks = dicom_build::masks(&[(0.0, 1, [1, 1]), (1.0, 2, [1, 1])], "1");
    let mut files = vec![plain.bytes(), dicom_build::Frames { is_defined: false, ..masks }.bytes()];
    let mut syntaxes = std::collections::BTreeSet::new();
    for frame in dicom_build::packed_frames().iter().filter(|frame| frame["bits"] == 12) {
        let syntax = frame["syntax"].as_str().expect("a syntax").to_owned();
        if syntaxes.insert(syntax.clone()) {
            let stream = dicom_build::stream_of(frame);
            let pixels = dicom_build::in_pieces(&[], &[stream.clone(), stream]);
            let bits = [16, 12, 11, 0];
            files.push(dicom_build::Frames { syntax, size: [5, 8], bits, pixels, ..plain.clone() }.bytes());
        }
    }
    files.into_iter().map(|bytes| (Format::Dicom, bytes)).collect()
}

/// A MetaImage of eight numbers of 16 bits.
pub(super) fn meta(is_packed: &str, data: &[u8]) -> Vec<u8> {
    let head = format!(
        "ObjectType = Image\nNDims = 3\nBinaryDataByteOrderMSB = False\nCompressedData = {is_packed}\n\
         TransformMatrix = 1 0 0 0 1 0 0 0 -1\nOffset = -1.5 2 3\nAnatomicalOrientation = RAS\n\
         ElementSpacing = 1 2 3\nDimSize = 2 2 2\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"
    );
    [head.as_bytes(), data].concat()
}

/// A zip file of one stored array.
pub(super) fn npz(array: &[u8]) -> Vec<u8> {
    let mut crc = flate2::Crc::new();
    crc.update(array);
    let n = (array.len() as u32).to_le_bytes();
    let common = [&[20, 0, 0, 0, 0, 0, 0, 0, 0, 0][..], &crc.sum().to_le_bytes(), &n, &n, &[5, 0]].concat();
    let local = [&b"PK\x03\x04"[..], &common, &[0, 0], b"a.npy", array].concat();
    let row = [&b"PK\x01\x02\x14\0"[..], &common, &[0; 16], b"a.npy"].concat();
    let ends = [(row.len() as u32).to_le_bytes(), (local.len() as u32).to_le_bytes()].concat();
    [&local[..], &row, b"PK\x05\x06\0\0\0\0\x01\0\x01\0", &ends, &[0, 0]].concat()
}

/// Image data of eight numbers of 16 bits, appended raw.
pub(super) fn vti(samples: &[u8], compressor: &str) -> Vec<u8> {
    let number = |n: usize| (n as u32).to_le_bytes();
    let data = if compressor.is_empty() {
        [&number(samples.len())[..], samples].concat()
    } else {
        let block = zlib(samples);
        let sizes = [1, samples.len(), 0, block.len()].map(number).concat();
        [sizes, block].concat()
    };
    let head = format!(
        "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\" {compressor}>\n<ImageData \
         WholeExtent=\"0 1 0 1 0 1\" Origin=\"1 2 3\" Spacing=\"1 2 3\"><Piece Extent=\"0 1 0 1 0 1\">\
         <PointData><DataArray type=\"Int16\" Name=\"a\" format=\"appended\" offset=\"0\"/></PointData>\
         </Piece></ImageData>\n<AppendedData encoding=\"raw\">_"
    );
    [head.as_bytes(), &data, b"</AppendedData></VTKFile>"].concat()
}

/// The same of bytes, in two pieces, as base64.
pub(super) const VTI_TEXT: &[u8] = b"<VTKFile type=\"ImageData\" header_type=\"UInt64\"><ImageData WholeExtent=\"0 1 0 1 0 2\">\n\
    <Piece Extent=\"0 1 0 1 0 1\"><PointData Scalars=\"a\"><DataArray type=\"UInt8\" Name=\"a\" format=\"binary\">\
    CAAAAAAAAAAAAQIDBAUGBw==</DataArray><DataArray type=\"Float32\" Name=\"b\">1 2</DataArray></PointData></Piece>\
    <Piece Extent=\"0 1 0 1 1 2\"><PointData><DataArray type=\"UInt8\" Name=\"a\" format=\"binary\">\
    CAAAAAAAAAAAAQIDBAUGBw==</DataArray></PointData></Piece></ImageData></VTKFile>";

pub(super) fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("packed");
    encoder.finish().expect("packed")
}

pub(super) fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("packed");
    encoder.finish().expect("packed")
}
