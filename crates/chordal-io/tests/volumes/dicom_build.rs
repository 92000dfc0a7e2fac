//! Files of DICOM, byte by byte: elements, packed pixels, and files with many frames.
use serde_json::Value;

/// Appends an element; `style` says whether it is explicit, and whether it is big-endian.
pub fn element(
    file: &mut Vec<u8>,
    tag: [u16; 2],
    kind: &[u8; 2],
    value: &[u8],
    [is_explicit, is_big]: [bool; 2],
) {
    let short = |n: u16| if is_big { n.to_be_bytes() } else { n.to_le_bytes() };
    let long = |n: usize| if is_big { (n as u32).to_be_bytes() } else { (n as u32).to_le_bytes() };
    let pad = value.len() % 2;
    file.extend([short(tag[0]), short(tag[1])].concat());
    match (is_explicit, kind) {
        (false, _) => file.extend(long(value.len() + pad)),
        (true, b"OW") => file.extend([&b"OW\0\0"[..], &long(value.len() + pad)].concat()),
        (true, _) => file.extend([&kind[..], &short((value.len() + pad) as u16)].concat()),
    }
    file.extend(value);
    file.extend(&b" "[..pad]);
}

/// Packed pixels: a table of offsets and pieces, each padded to an even length.
pub fn in_pieces(table: &[u32], pieces: &[Vec<u8>]) -> Vec<u8> {
    let item = |number: u16, n: usize| {
        [&0xFFFE_u16.to_le_bytes()[..], &number.to_le_bytes(), &(n as u32).to_le_bytes()].concat()
    };
    let mut element = [&0x7FE0_u16.to_le_bytes()[..], &0x10_u16.to_le_bytes(), b"OB\0\0", &[255; 4]].concat();
    let table = table.iter().flat_map(|offset| offset.to_le_bytes()).collect::<Vec<_>>();
    for mut bytes in std::iter::once(table).chain(pieces.iter().cloned()) {
        bytes.extend(vec![0; bytes.len() % 2]);
        element.extend(item(0xE000, bytes.len()));
        element.extend(bytes);
    }
    element.extend(item(0xE0DD, 0));
    element
}

/// Packed frames that other programs wrote, with their samples.
pub fn packed_frames() -> Vec<Value> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/dicom_frames.json");
    let text = std::fs::read_to_string(path).expect("the frames are there");
    let all: Value = serde_json::from_str(&text).expect("JSON");
    all["frames"].as_array().expect("a list").clone()
}

/// The bytes of a packed frame.
pub fn stream_of(frame: &Value) -> Vec<u8> {
    let hex = frame["stream"].as_str().expect("hex");
    (0..hex.len() / 2).map(|k| u8::from_str_radix(&hex[2 * k..2 * k + 2], 16).expect("hex")).collect()
}

/// A file with several frames.
#[derive(Clone)]
pub struct Frames {
    pub syntax: String,
    pub size: [u16; 2],
    pub bits: [u16; 4],
    pub frames: String,
    /// Whether sequences and items state their lengths.
    pub is_defined: bool,
    pub shared: Vec<Vec<u8>>,
    /// The groups of each frame.
    pub groups: Vec<Vec<Vec<u8>>>,
    pub segments: Vec<u8>,
    pub pixels: Vec<u8>,
}

/// Elements that state their types, in little-endian order.
const PLAIN: [bool; 2] = [true, false];

pub fn text(tag: [u16; 2], kind: &[u8; 2], value: &str) -> Vec<u8> {
    let mut file = Vec::new();
    element(&mut file, tag, kind, value.as_bytes(), PLAIN);
    file
}

pub fn short(tag: [u16; 2], value: u16) -> Vec<u8> {
    let mut file = Vec::new();
    element(&mut file, tag, b"US", &value.to_le_bytes(), PLAIN);
    file
}

/// A sequence with items.
pub fn sequence(tag: [u16; 2], items: &[Vec<u8>], is_defined: bool) -> Vec<u8> {
    let head = |tag: [u16; 2], n: Option<usize>| {
        let n = n.map_or(u32::MAX, |n| n as u32);
        [&tag[0].to_le_bytes()[..], &tag[1].to_le_bytes(), &n.to_le_bytes()].concat()
    };
    let mut body = Vec::new();
    for item in items {
        body.extend(head([0xFFFE, 0xE000], is_defined.then_some(item.len())));
        body.extend(item);
        if !is_defined {
            body.extend(head([0xFFFE, 0xE00D], Some(0)));
        }
    }
    let start = [&tag[0].to_le_bytes()[..], &tag[1].to_le_bytes(), b"SQ\0\0"].concat();
    let n = if is_defined { body.len() as u32 } else { u32::MAX };
    if !is_defined {
        body.extend(head([0xFFFE, 0xE0DD], Some(0)));
    }
    [start, n.to_le_bytes().to_vec(), body].concat()
}

pub fn place(z: f64) -> Vec<u8> {
    let position = text([0x20, 0x32], b"DS", &format!("1\\2\\{z}"));
    sequence([0x20, 0x9113], &[position], true)
}

pub fn scale(slope: &str, intercept: &str) -> Vec<u8> {
    let item = [text([0x28, 0x1052], b"DS", intercept), text([0x28, 0x1053], b"DS", slope)].concat();
    sequence([0x28, 0x9145], &[item], false)
}

pub fn stack(id: &str, time: u32) -> Vec<u8> {
    let mut item = text([0x20, 0x9056], b"SH", id);
    element(&mut item, [0x20, 0x9128], b"UL", &time.to_le_bytes(), PLAIN);
    sequence([0x20, 0x9111], &[item], true)
}

pub fn segment(number: u16) -> Vec<u8> {
    sequence([0x62, 0xA], &[short([0x62, 0xB], number)], true)
}

impl Frames {
    /// Frames of 3 by 2 samples at heights, with samples that count.
    pub fn at(heights: &[f64]) -> Self {
        let orientation = text([0x20, 0x37], b"DS", "1\\0\\0\\0\\1\\0");
        let measures = text([0x28, 0x30], b"DS", "2\\0.5");
        Self {
            syntax: "1.2.840.10008.1.2.1".to_owned(),
            size: [2, 3],
            bits: [16, 16, 15, 1],
            frames: heights.len().to_string(),
            is_defined: true,
            shared: vec![
                sequence([0x20, 0x9116], &[orientation], true),
                sequence([0x28, 0x9110], &[measures], false),
            ],
            groups: heights.iter().map(|z| vec![place(*z)]).collect(),
            segments: Vec::new(),
            pixels: {
                let mut pixels = Vec::new();
                let samples = (0..6 * heights.len() as i16).flat_map(i16::to_le_bytes).collect::<Vec<_>>();
                element(&mut pixels, [0x7FE0, 0x10], b"OW", &samples, PLAIN);
                pixels
            },
        }
    }

    pub fn bytes(&self) -> Vec<u8> {
        let mut file = [&[0; 128][..], b"DICM"].concat();
        file.extend(text([2, 0x10], b"UI", &self.syntax));
        file.extend(text([8, 0x103E], b"LO", "knee"));
        file.extend(text([0x20, 0xE], b"UI", "1.2.3"));
        file.extend(short([0x28, 2], 1));
        file.extend(text([0x28, 8], b"IS", &self.frames));
        file.extend(short([0x28, 0x10], self.size[0]));
        file.extend(short([0x28, 0x11], self.size[1]));
        for (number, value) in [0x100, 0x101, 0x102, 0x103].into_iter().zip(self.bits) {
            file.extend(short([0x28, number], value));
        }
        file.extend(&self.segments);
        file.extend(sequence([0x5200, 0x9229], &[self.shared.concat()], self.is_defined));
        let groups: Vec<Vec<u8>> = self.groups.iter().map(|groups| groups.concat()).collect();
        file.extend(sequence([0x5200, 0x9230], &groups, self.is_defined));
        file.extend(&self.pixels);
        file
    }
}

/// Masks of 8 by 2 samples: for each its height, its segment and its bytes.
pub fn masks(rows: &[(f64, u16, [u8; 2])], between: &str) -> Frames {
    let bits: Vec<u8> = rows.iter().flat_map(|row| row.2).collect();
    let mut pixels = Vec::new();
    element(&mut pixels, [0x7FE0, 0x10], b"OW", &bits, PLAIN);
    let look = |number: u16, name: &str, color: [u16; 3]| {
        let mut item = [short([0x62, 4], number), text([0x62, 5], b"LO", name)].concat();
        element(&mut item, [0x62, 0xD], b"US", &color.map(u16::to_le_bytes).concat(), PLAIN);
        item
    };
    // Red and white: L*a*b* of D65, scaled as the standard says.
    let looks = [look(1, "bone", [34885, 53485, 50171]), look(7, "skin ", [65535, 32896, 32896])];
    let segments = [text([0x62, 1], b"CS", "BINARY"), sequence([0x62, 2], &looks, false)].concat();
    let mut frames = Frames {
        size: [2, 8],
        bits: [1, 1, 0, 0],
        segments,
        pixels,
        ..Frames::at(&rows.iter().map(|row| row.0).collect::<Vec<_>>())
    };
    let measures = [text([0x18, 0x88], b"DS", between), text([0x28, 0x30], b"DS", "1\\1")].concat();
    frames.shared[1] = sequence([0x28, 0x9110], &[measures], true);
    for (group, row) in frames.groups.iter_mut().zip(rows) {
        group.push(segment(row.1));
    }
    frames
}
