//! Files of volumes, byte by byte.

/// A `.npy` file of version 1.
pub fn npy(descr: &str, order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    npy_of(1, &format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}"), data)
}

/// A `.npy` file of a version and with a header of any kind.
pub fn npy_of(version: u8, header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY".to_vec();
    bytes.extend([version, 0]);
    let text = format!("{header:<117}\n");
    match version {
        1 => bytes.extend((text.len() as u16).to_le_bytes()),
        _ => bytes.extend((text.len() as u32).to_le_bytes()),
    }
    bytes.extend(text.bytes());
    bytes.extend(data);
    bytes
}

/// What a NIfTI file says.
#[derive(Clone)]
pub struct Nii {
    pub is_big: bool,
    pub version: u8,
    pub dim: [i64; 8],
    pub datatype: i16,
    pub bitpix: i16,
    pub pixdim: [f64; 8],
    pub offset: f64,
    pub slope: f64,
    pub inter: f64,
    pub units: u8,
    pub qform: i16,
    pub sform: i16,
    pub quaternion: [f64; 6],
    pub rows: [[f64; 4]; 3],
    pub data: Vec<u8>,
}

impl Default for Nii {
    fn default() -> Self {
        Self {
            is_big: false,
            version: 1,
            dim: [3, 2, 3, 2, 1, 1, 1, 1],
            datatype: 2,
            bitpix: 8,
            pixdim: [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
            offset: 352.0,
            slope: 0.0,
            inter: 0.0,
            units: 2,
            qform: 0,
            sform: 2,
            quaternion: [0.0; 6],
            rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
            data: (0..12).collect(),
        }
    }
}

impl Nii {
    /// The bytes of the file.
    pub fn bytes(&self) -> Vec<u8> {
        let mut f = File { bytes: vec![0; if self.version == 1 { 352 } else { 544 }], is_big: self.is_big };
        if self.version == 1 {
            self.first(&mut f)
        } else {
            self.second(&mut f)
        }
        f.bytes.extend(&self.data);
        f.bytes
    }

    /// The same, packed.
    pub fn packed(&self) -> Vec<u8> {
        pack(&self.bytes())
    }

    fn first(&self, f: &mut File) {
        f.put(0, &348_i32.to_le_bytes());
        (0..8).for_each(|k| f.put(40 + 2 * k, &(self.dim[k] as i16).to_le_bytes()));
        f.put(70, &self.datatype.to_le_bytes());
        f.put(72, &self.bitpix.to_le_bytes());
        (0..8).for_each(|k| f.put(76 + 4 * k, &(self.pixdim[k] as f32).to_le_bytes()));
        f.put(108, &(self.offset as f32).to_le_bytes());
        f.put(112, &(self.slope as f32).to_le_bytes());
        f.put(116, &(self.inter as f32).to_le_bytes());
        f.bytes[123] = self.units;
        f.bytes[148..153].copy_from_slice(b"brain");
        f.put(252, &self.qform.to_le_bytes());
        f.put(254, &self.sform.to_le_bytes());
        (0..6).for_each(|k| f.put(256 + 4 * k, &(self.quaternion[k] as f32).to_le_bytes()));
        for (k, x) in self.rows.as_flattened().iter().enumerate() {
            f.put(280 + 4 * k, &(*x as f32).to_le_bytes());
        }
        f.bytes[344..348].copy_from_slice(b"n+1\0");
    }

    fn second(&self, f: &mut File) {
        f.put(0, &540_i32.to_le_bytes());
        f.bytes[4..12].copy_from_slice(b"n+2\0\r\n\x1a\n");
        f.put(12, &self.datatype.to_le_bytes());
        f.put(14, &self.bitpix.to_le_bytes());
        (0..8).for_each(|k| f.put(16 + 8 * k, &self.dim[k].to_le_bytes()));
        (0..8).for_each(|k| f.put(104 + 8 * k, &self.pixdim[k].to_le_bytes()));
        f.put(168, &(self.offset as i64).to_le_bytes());
        f.put(176, &self.slope.to_le_bytes());
        f.put(184, &self.inter.to_le_bytes());
        f.bytes[240..245].copy_from_slice(b"brain");
        f.put(344, &i32::from(self.qform).to_le_bytes());
        f.put(348, &i32::from(self.sform).to_le_bytes());
        (0..6).for_each(|k| f.put(352 + 8 * k, &self.quaternion[k].to_le_bytes()));
        for (k, x) in self.rows.as_flattened().iter().enumerate() {
            f.put(400 + 8 * k, &x.to_le_bytes());
        }
        f.put(500, &i32::from(self.units).to_le_bytes());
    }
}

struct File {
    bytes: Vec<u8>,
    is_big: bool,
}

impl File {
    fn put(&mut self, at: usize, little: &[u8]) {
        let place = &mut self.bytes[at..at + little.len()];
        place.copy_from_slice(little);
        if self.is_big {
            place.reverse();
        }
    }
}

/// Bytes packed by gzip.
pub fn pack(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut encoder, bytes).expect("packed");
    encoder.finish().expect("packed")
}

/// A `.nrrd` file of three axes of 2, 3 and 2 samples.
pub fn nrrd(fields: &str, data: &[u8]) -> Vec<u8> {
    let head = "NRRD0004\n# by hand\ndimension: 3\nsizes: 2 3 2\n";
    [head.as_bytes(), fields.as_bytes(), b"\n", data].concat()
}
