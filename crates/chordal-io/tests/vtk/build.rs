//! Builds VTK files in every encoding, with an encoder of its own.
use std::io::Write;

/// Base64 as RFC 4648 has it, by its definition.
pub fn base64(bytes: &[u8]) -> String {
    let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let bits = three.iter().fold(0_u32, |bits, b| bits << 8 | u32::from(*b)) << (8 * (3 - three.len()));
        for k in 0..4 {
            let is_padding = k > three.len();
            let value = bits >> (18 - 6 * k) & 63;
            text.push(if is_padding { '=' } else { char::from(alphabet[value as usize]) });
        }
    }
    text
}

pub fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("packed");
    encoder.finish().expect("packed")
}

/// A block of LZ4 that holds the bytes as they are.
fn lz4(bytes: &[u8]) -> Vec<u8> {
    let mut block = Vec::new();
    if bytes.len() < 15 {
        block.push((bytes.len() as u8) << 4);
    } else {
        block.push(0xF0);
        block.extend(std::iter::repeat_n(255, (bytes.len() - 15) / 255));
        block.push(((bytes.len() - 15) % 255) as u8);
    }
    block.extend(bytes);
    block
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    Text,
    Inline,
    AppendedRaw,
    AppendedBase64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compressor {
    None,
    Zlib,
    Lz4,
}

#[derive(Clone, Copy, Debug)]
pub struct Encoding {
    pub form: Form,
    pub compressor: Compressor,
    pub is_big: bool,
    pub is_wide: bool,
}

impl Encoding {
    pub const TEXT: Self =
        Self { form: Form::Text, compressor: Compressor::None, is_big: false, is_wide: false };

    /// Every encoding.
    pub fn all() -> Vec<Self> {
        let mut all = vec![Self::TEXT];
        for form in [Form::Inline, Form::AppendedRaw, Form::AppendedBase64] {
            for compressor in [Compressor::None, Compressor::Zlib, Compressor::Lz4] {
                for bits in 0..4 {
                    all.push(Self { form, compressor, is_big: bits & 1 == 1, is_wide: bits & 2 == 2 });
                }
            }
        }
        all
    }

    fn length(&self, n: usize) -> Vec<u8> {
        match (self.is_wide, self.is_big) {
            (true, true) => (n as u64).to_be_bytes().to_vec(),
            (true, false) => (n as u64).to_le_bytes().to_vec(),
            (false, true) => (n as u32).to_be_bytes().to_vec(),
            (false, false) => (n as u32).to_le_bytes().to_vec(),
        }
    }

    /// The header and the packed bytes of an array.
    fn packed(&self, bytes: &[u8]) -> [Vec<u8>; 2] {
        /// Small, so that arrays have several blocks.
        const BLOCK: usize = 40;
        if self.compressor == Compressor::None {
            return [self.length(bytes.len()), bytes.to_vec()];
        }
        let pack = if self.compressor == Compressor::Zlib { zlib } else { lz4 };
        let blocks: Vec<Vec<u8>> = bytes.chunks(BLOCK).map(pack).collect();
        let mut header: Vec<u8> =
            [blocks.len(), BLOCK, bytes.len() % BLOCK].into_iter().flat_map(|n| self.length(n)).collect();
        blocks.iter().for_each(|block| header.extend(self.length(block.len())));
        [header, blocks.concat()]
    }
}

/// Numbers with the type that they are written in.
#[derive(Clone, Debug)]
pub enum Numbers {
    F32(Vec<f32>),
    F64(Vec<f64>),
    U8(Vec<u8>),
    I32(Vec<i32>),
    I64(Vec<i64>),
}

impl Numbers {
    fn kind(&self) -> &'static str {
        match self {
            Self::F32(_) => "Float32",
            Self::F64(_) => "Float64",
            Self::U8(_) => "UInt8",
            Self::I32(_) => "Int32",
            Self::I64(_) => "Int64",
        }
    }

    fn text(&self) -> String {
        let words: Vec<String> = match self {
            Self::F32(list) => list.iter().map(|x| f64::from(*x).to_string()).collect(),
            Self::F64(list) => list.iter().map(f64::to_string).collect(),
            Self::U8(list) => list.iter().map(u8::to_string).collect(),
            Self::I32(list) => list.iter().map(i32::to_string).collect(),
            Self::I64(list) => list.iter().map(i64::to_string).collect(),
        };
        words.join(" ")
    }

    pub fn bytes(&self, is_big: bool) -> Vec<u8> {
        macro_rules! all {
            ($list:expr) => {
                $list.iter().flat_map(|x| if is_big { x.to_be_bytes() } else { x.to_le_bytes() }).collect()
            };
        }
        match self {
            Self::F32(list) => all!(list),
            Self::F64(list) => all!(list),
            Self::U8(list) => list.clone(),
            Self::I32(list) => all!(list),
            Self::I64(list) => all!(list),
        }
    }
}

/// Makes a file.
pub struct Builder {
    encoding: Encoding,
    appended: Vec<u8>,
    text: String,
}

impl Builder {
    pub fn new(data_set: &str, encoding: Encoding) -> Self {
        let order = if encoding.is_big { "BigEndian" } else { "LittleEndian" };
        let header = if encoding.is_wide { "UInt64" } else { "UInt32" };
        let compressor = match encoding.compressor {
            Compressor::None => "",
            Compressor::Zlib => " compressor=\"vtkZLibDataCompressor\"",
            Compressor::Lz4 => " compressor=\"vtkLZ4DataCompressor\"",
        };
        let text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{data_set}\" version=\"1.0\" byte_order=\"{order}\" \
             header_type=\"{header}\"{compressor}>\n<{data_set}>\n"
        );
        Self { encoding, appended: Vec::new(), text }
    }

    pub fn put(&mut self, text: &str) -> &mut Self {
        self.text.push_str(text);
        self.text.push('\n');
        self
    }

    pub fn array(&mut self, name: &str, width: usize, numbers: &Numbers) -> &mut Self {
        let head =
            format!("<DataArray type=\"{}\" Name=\"{name}\" NumberOfComponents=\"{width}\"", numbers.kind());
        let [header, packed] = self.encoding.packed(&numbers.bytes(self.encoding.is_big));
        let is_packed = self.encoding.compressor != Compressor::None;
        let as_text = || {
            // The header of packed arrays is a run of its own.
            if is_packed { base64(&header) + &base64(&packed) } else { base64(&[&*header, &packed].concat()) }
        };
        let offset = self.appended.len();
        let line = match self.encoding.form {
            Form::Text => format!("{head} format=\"ascii\">\n {}\n</DataArray>", numbers.text()),
            Form::Inline => format!("{head} format=\"binary\">\n  {}\n</DataArray>", as_text()),
            Form::AppendedRaw => {
                self.appended.extend([&*header, &packed].concat());
                format!("{head} format=\"appended\" offset=\"{offset}\"/>")
            }
            Form::AppendedBase64 => {
                self.appended.extend(as_text().into_bytes());
                format!("{head} format=\"appended\" offset=\"{offset}\"/>")
            }
        };
        self.put(&line)
    }

    pub fn end(&self, data_set: &str) -> Vec<u8> {
        let mut bytes = format!("{}</{data_set}>\n", self.text).into_bytes();
        let encoding = if self.encoding.form == Form::AppendedRaw { "raw" } else { "base64" };
        if !self.appended.is_empty() {
            bytes.extend(format!("<AppendedData encoding=\"{encoding}\">\n_").as_bytes());
            bytes.extend(&self.appended);
            bytes.extend(b"\n</AppendedData>\n");
        }
        bytes.extend(b"</VTKFile>\n");
        bytes
    }
}

/// PolyData with cells of all four lists: points, lines, polygons, strips, of which the last two are surfaces.
pub fn poly_data(encoding: Encoding) -> Vec<u8> {
    let mut file = Builder::new("PolyData", encoding);
    file.put("<Piece NumberOfPoints=\"6\" NumberOfVerts=\"1\" NumberOfLines=\"1\" NumberOfStrips=\"1\" NumberOfPolys=\"2\">");
    file.put("<PointData Normals=\"n\">");
    file.array("n", 3, &Numbers::F32([0.0, 0.0, 1.0].repeat(6)));
    file.array("rgb", 3, &Numbers::U8((0..18).map(|i| i * 15).collect()));
    file.array("t &lt; 1", 1, &Numbers::F64((0..6).map(|i| f64::from(i) / 7.0).collect()));
    file.put("</PointData>\n<CellData>").array("id", 1, &Numbers::I64(vec![10, 11, 12, 13, 14]));
    file.put("</CellData>\n<Points>").array("Points", 3, &Numbers::F32(points().concat().to_vec()));
    file.put("</Points>\n<Verts>");
    file.array("connectivity", 1, &Numbers::I32(vec![5])).array("offsets", 1, &Numbers::I32(vec![1]));
    file.put("</Verts>\n<Lines>");
    file.array("connectivity", 1, &Numbers::I64(vec![0, 1])).array("offsets", 1, &Numbers::I64(vec![2]));
    file.put("</Lines>\n<Strips>");
    file.array("connectivity", 1, &Numbers::I32(vec![1, 4, 2, 5])).array(
        "offsets",
        1,
        &Numbers::I32(vec![4]),
    );
    file.put("</Strips>\n<Polys>");
    file.array("connectivity", 1, &Numbers::I32(vec![0, 1, 2, 3, 0, 1, 4]));
    file.array("offsets", 1, &Numbers::I32(vec![4, 7])).put("</Polys>\n</Piece>");
    file.end("PolyData")
}

/// The points of these files.
pub fn points() -> [[f32; 3]; 6] {
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.25], [1.0, 1.0, 0.0], [0.0, 1.0, -0.5], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0]]
}

/// An UnstructuredGrid of a triangle, a tetrahedron, a pixel and a quadratic triangle.
pub fn grid(encoding: Encoding) -> Vec<u8> {
    let mut file = Builder::new("UnstructuredGrid", encoding);
    file.put("<Piece NumberOfPoints=\"6\" NumberOfCells=\"4\">\n<Points>");
    file.array("Points", 3, &Numbers::F64(points().concat().iter().map(|x| f64::from(*x)).collect()));
    file.put("</Points>\n<Cells>");
    file.array("connectivity", 1, &Numbers::I64(vec![0, 1, 2, 0, 1, 2, 3, 0, 1, 3, 2, 1, 4, 5, 0, 2, 3]));
    file.array("offsets", 1, &Numbers::I64(vec![3, 7, 11, 17]));
    file.array("types", 1, &Numbers::U8(vec![5, 10, 8, 22])).put("</Cells>\n<CellData>");
    file.array("q", 2, &Numbers::F32(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]));
    file.put("</CellData>\n</Piece>");
    file.end("UnstructuredGrid")
}
