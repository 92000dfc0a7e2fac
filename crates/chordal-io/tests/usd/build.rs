//! Makes files of USD's binary form: tables packed as plain literals, values behind them.

/// A file that is being made.
#[derive(Default)]
pub struct CrateFile {
    pub bytes: Vec<u8>,
    tokens: Vec<String>,
    fields: Vec<(u32, u64)>,
    sets: Vec<u32>,
    /// Paths: the parent, the token, whether it is a property.
    paths: Vec<(usize, u32, bool)>,
    specs: Vec<[u32; 3]>,
}

pub const ARRAY: u64 = 1 << 63;
pub const INLINED: u64 = 1 << 62;
pub const PACKED: u64 = 1 << 61;

/// A value of a type that is somewhere or in the value itself.
pub fn value(flags: u64, kind: u64, payload: u64) -> u64 {
    flags | kind << 48 | payload
}

impl CrateFile {
    pub fn new() -> Self {
        let mut file = Self { bytes: vec![0; 88], ..Self::default() };
        file.paths.push((0, 0, false));
        file.token("");
        file
    }

    pub fn token(&mut self, text: &str) -> u64 {
        if let Some(at) = self.tokens.iter().position(|known| known == text) {
            return at as u64;
        }
        self.tokens.push(text.to_owned());
        self.tokens.len() as u64 - 1
    }

    /// Appends bytes and returns where they are.
    pub fn put(&mut self, bytes: &[u8]) -> u64 {
        let at = self.bytes.len() as u64;
        self.bytes.extend_from_slice(bytes);
        at
    }

    /// A thing below a path, of a kind, with fields; returns its path.
    pub fn spec(&mut self, parent: usize, name: &str, kind: u32, fields: &[(&str, u64)]) -> usize {
        let path = if kind == 7 {
            0
        } else {
            let token = self.token(name) as u32;
            self.paths.push((parent, token, matches!(kind, 1 | 8)));
            self.paths.len() - 1
        };
        self.specs.push([path as u32, self.sets.len() as u32, kind]);
        for (name, value) in fields {
            let token = self.token(name) as u32;
            self.sets.push(self.fields.len() as u32);
            self.fields.push((token, *value));
        }
        self.sets.push(u32::MAX);
        path
    }

    /// A list of tokens.
    pub fn tokens(&mut self, names: &[&str]) -> u64 {
        let mut bytes = (names.len() as u64).to_le_bytes().to_vec();
        for name in names {
            bytes.extend_from_slice(&(self.token(name) as u32).to_le_bytes());
        }
        let at = self.put(&bytes);
        value(0, 41, at)
    }

    pub fn floats(&mut self, kind: u64, width: usize, values: &[f32]) -> u64 {
        let mut bytes = ((values.len() / width) as u64).to_le_bytes().to_vec();
        values.iter().for_each(|x| bytes.extend_from_slice(&x.to_le_bytes()));
        let at = self.put(&bytes);
        value(ARRAY, kind, at)
    }

    /// An array of integers, packed where it is long enough.
    pub fn integers(&mut self, values: &[i32]) -> u64 {
        let mut bytes = (values.len() as u64).to_le_bytes().to_vec();
        if values.len() < 16 {
            values.iter().for_each(|x| bytes.extend_from_slice(&x.to_le_bytes()));
            let at = self.put(&bytes);
            return value(ARRAY, 3, at);
        }
        bytes.extend_from_slice(&packed_integers(values));
        let at = self.put(&bytes);
        value(ARRAY | PACKED, 3, at)
    }

    /// The whole file.
    pub fn finish(mut self) -> Vec<u8> {
        let mut sections = Vec::new();
        let mut text = Vec::new();
        self.tokens.iter().for_each(|token| text.extend_from_slice(&[token.as_bytes(), &[0]].concat()));
        let count = |n: usize| (n as u64).to_le_bytes().to_vec();
        let numbers = |list: &mut dyn Iterator<Item = u32>| {
            packed_integers(&list.map(|x| x as i32).collect::<Vec<_>>())
        };
        sections.push(("TOKENS", [count(self.tokens.len()), count(text.len()), packed(&text)].concat()));
        sections.push((
            "STRINGS",
            [count(self.tokens.len()), (0..self.tokens.len() as u32).flat_map(u32::to_le_bytes).collect()]
                .concat(),
        ));
        let values: Vec<u8> = self.fields.iter().flat_map(|(_, value)| value.to_le_bytes()).collect();
        let names = numbers(&mut self.fields.iter().map(|(token, _)| *token));
        sections.push(("FIELDS", [count(self.fields.len()), names, packed(&values)].concat()));
        sections
            .push(("FIELDSETS", [count(self.sets.len()), numbers(&mut self.sets.iter().copied())].concat()));
        sections.push(("PATHS", self.path_section()));
        let column = |k: usize| numbers(&mut self.specs.iter().map(|spec| spec[k]));
        sections.push(("SPECS", [count(self.specs.len()), column(0), column(1), column(2)].concat()));
        let mut contents = (sections.len() as u64).to_le_bytes().to_vec();
        for (name, bytes) in sections {
            let at = self.put(&bytes);
            let mut padded = name.as_bytes().to_vec();
            padded.resize(16, 0);
            contents.extend_from_slice(
                &[padded, at.to_le_bytes().to_vec(), (bytes.len() as u64).to_le_bytes().to_vec()].concat(),
            );
        }
        let at = self.put(&contents);
        self.bytes[..8].copy_from_slice(b"PXR-USDC");
        self.bytes[8..11].copy_from_slice(&[0, 8, 0]);
        self.bytes[16..24].copy_from_slice(&at.to_le_bytes());
        self.bytes
    }

    /// The tree of paths, depth first.
    fn path_section(&self) -> Vec<u8> {
        let mut order = Vec::new();
        self.visit(0, false, &mut order);
        let n = (self.paths.len() as u64).to_le_bytes().to_vec();
        let columns =
            [0, 1, 2].map(|k| packed_integers(&order.iter().map(|row| row[k]).collect::<Vec<i32>>()));
        [n.clone(), n, columns.concat()].concat()
    }

    fn visit(&self, path: usize, has_sibling: bool, order: &mut Vec<[i32; 3]>) {
        let (_, token, is_property) = self.paths[path];
        let at = order.len();
        let token = token as i32;
        order.push([path as i32, if is_property { -token } else { token }, 0]);
        let children: Vec<usize> =
            (1..self.paths.len()).filter(|child| self.paths[*child].0 == path).collect();
        for (i, child) in children.iter().enumerate() {
            self.visit(*child, i + 1 < children.len(), order);
        }
        order[at][2] = match (children.is_empty(), has_sibling) {
            (true, true) => 0,
            (true, false) => -2,
            (false, true) => (order.len() - at) as i32,
            (false, false) => -1,
        };
    }
}

/// Bytes in one block of literals, after the packed size.
pub fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut block = vec![0];
    if bytes.len() < 15 {
        block.push((bytes.len() as u8) << 4);
    } else {
        block.push(0xF0);
        let mut rest = bytes.len() - 15;
        while rest >= 255 {
            block.push(255);
            rest -= 255;
        }
        block.push(rest as u8);
    }
    block.extend_from_slice(bytes);
    [(block.len() as u64).to_le_bytes().to_vec(), block].concat()
}

/// Integers whose differences all have four bytes.
pub fn packed_integers(values: &[i32]) -> Vec<u8> {
    let mut bytes = 0_i32.to_le_bytes().to_vec();
    bytes.resize(4 + values.len().div_ceil(4), 0xFF);
    let mut last = 0_i32;
    for value in values {
        bytes.extend_from_slice(&value.wrapping_sub(last).to_le_bytes());
        last = *value;
    }
    packed(&bytes)
}

/// A file with one mesh of quads, `n` by `n`, below a transform.
pub fn grid(n: i32) -> Vec<u8> {
    let mut file = CrateFile::new();
    let children = file.tokens(&["World"]);
    let z = file.token("Z");
    let unit = f32::to_bits(0.5).into();
    file.spec(
        0,
        "",
        7,
        &[
            ("primChildren", children),
            ("upAxis", value(INLINED, 11, z)),
            ("metersPerUnit", value(INLINED, 9, unit)),
        ],
    );
    let (xform, mesh, none) = (file.token("Xform"), file.token("Mesh"), file.token("none"));
    let children = file.tokens(&["Grid"]);
    let def = value(INLINED, 42, 0);
    let world = file.spec(
        0,
        "World",
        6,
        &[("specifier", def), ("typeName", value(INLINED, 11, xform)), ("primChildren", children)],
    );
    let name_of = |file: &mut CrateFile, name: &str| value(INLINED, 11, file.token(name));
    let order = {
        let token = file.token("xformOp:translate") as u32;
        let bytes = [1_u64.to_le_bytes().to_vec(), token.to_le_bytes().to_vec()].concat();
        let at = file.put(&bytes);
        value(ARRAY, 11, at)
    };
    let kind = name_of(&mut file, "token[]");
    file.spec(world, "xformOpOrder", 1, &[("typeName", kind), ("default", order)]);
    let kind = name_of(&mut file, "double3");
    // Three bytes with signs.
    file.spec(
        world,
        "xformOp:translate",
        1,
        &[("typeName", kind), ("default", value(INLINED, 23, 0x00FE_0201))],
    );
    let grid = file.spec(world, "Grid", 6, &[("specifier", def), ("typeName", value(INLINED, 11, mesh))]);
    let side = n + 1;
    let points: Vec<f32> =
        (0..side * side).flat_map(|i| [(i % side) as f32, (i / side) as f32, 0.25]).collect();
    let corners: Vec<i32> = (0..n * n)
        .flat_map(|i| {
            let a = i % n + i / n * side;
            [a, a + 1, a + side + 1, a + side]
        })
        .collect();
    let points = file.floats(24, 3, &points);
    let counts = file.integers(&vec![4; (n * n) as usize]);
    let corners = file.integers(&corners);
    for (name, kind, value) in [
        ("points", "point3f[]", points),
        ("faceVertexCounts", "int[]", counts),
        ("faceVertexIndices", "int[]", corners),
        ("subdivisionScheme", "token", value(INLINED, 11, none)),
    ] {
        let kind = name_of(&mut file, kind);
        file.spec(grid, name, 1, &[("typeName", kind), ("default", value)]);
    }
    file.finish()
}
