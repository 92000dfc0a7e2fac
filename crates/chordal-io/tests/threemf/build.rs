//! Makes 3MF files by hand, byte by byte, without the library's writer.
use std::io::Write;

/// An entry of a zip file, honest or not.
#[derive(Clone)]
pub struct Zipped {
    pub name: String,
    pub method: u16,
    pub flags: u16,
    pub packed: Vec<u8>,
    pub crc: u32,
    pub n_unpacked: u64,
    /// Bits of a Unix mode, or 0.
    pub mode: u32,
    /// Whether the sizes stand in 64 bits in an extra field.
    pub is_64: bool,
}

impl Zipped {
    pub fn stored(name: &str, content: &[u8]) -> Self {
        let mut crc = flate2::Crc::new();
        crc.update(content);
        Self {
            name: name.to_owned(),
            method: 0,
            flags: 0,
            packed: content.to_vec(),
            crc: crc.sum(),
            n_unpacked: content.len() as u64,
            mode: 0,
            is_64: false,
        }
    }

    pub fn deflated(name: &str, content: &[u8]) -> Self {
        let mut encoder = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(content).expect("packed");
        Self { method: 8, packed: encoder.finish().expect("packed"), ..Self::stored(name, content) }
    }
}

/// A zip file of entries.
pub fn zip_of(entries: &[Zipped]) -> Vec<u8> {
    let (mut file, mut directory) = (Vec::new(), Vec::new());
    for entry in entries {
        let at = file.len() as u32;
        let n_packed = entry.packed.len() as u64;
        let extra: Vec<u8> = if entry.is_64 {
            [&[1, 0, 16, 0], &entry.n_unpacked.to_le_bytes()[..], &n_packed.to_le_bytes()].concat()
        } else {
            Vec::new()
        };
        let sizes = if entry.is_64 { [u32::MAX; 2] } else { [n_packed as u32, entry.n_unpacked as u32] };
        let head = |sizes: [u32; 2]| {
            let mut head = Vec::new();
            [20, entry.flags, entry.method, 0, 33].iter().for_each(|x: &u16| head.extend(x.to_le_bytes()));
            [entry.crc, sizes[0], sizes[1]].iter().for_each(|x| head.extend(x.to_le_bytes()));
            head.extend((entry.name.len() as u16).to_le_bytes());
            head
        };
        // With bit 3 of the flags the sizes come after the data, and the header has none.
        let local_sizes = if entry.flags & 8 == 8 { [0, 0] } else { sizes };
        file.extend(b"PK\x03\x04");
        file.extend(head(local_sizes));
        file.extend([0, 0]);
        file.extend(entry.name.as_bytes());
        file.extend(&entry.packed);
        directory.extend(b"PK\x01\x02");
        directory.extend(if entry.mode == 0 { [20, 0] } else { [20, 3] });
        directory.extend(head(sizes));
        directory.extend((extra.len() as u16).to_le_bytes());
        directory.extend([0; 6]);
        directory.extend((entry.mode << 16).to_le_bytes());
        directory.extend(at.to_le_bytes());
        directory.extend(entry.name.as_bytes());
        directory.extend(&extra);
    }
    let n = (entries.len() as u16).to_le_bytes();
    let at = (file.len() as u32).to_le_bytes();
    let n_directory = (directory.len() as u32).to_le_bytes();
    [&file[..], &directory, b"PK\x05\x06\0\0\0\0", &n, &n, &n_directory, &at, &[0, 0]].concat()
}

pub const TYPES: &str = "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">\
    <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
    <Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/></Types>";

/// Relationships of a package, each an element's attributes.
pub fn relationships(all: &[&str]) -> String {
    let all: String = all.iter().map(|one| format!("<Relationship Id=\"r\" {one}/>")).collect();
    format!(
        "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">{all}</Relationships>"
    )
}

pub const TO_MODEL: &str =
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\" Target=\"/3D/3dmodel.model\"";

/// A package of a root model and other parts.
pub fn package_with(model: &str, others: &[(&str, &str)]) -> Vec<u8> {
    let mut entries = vec![
        Zipped::deflated("[Content_Types].xml", TYPES.as_bytes()),
        Zipped::deflated("_rels/.rels", relationships(&[TO_MODEL]).as_bytes()),
        Zipped::deflated("3D/3dmodel.model", model.as_bytes()),
    ];
    entries.extend(others.iter().map(|(name, content)| Zipped::deflated(name, content.as_bytes())));
    zip_of(&entries)
}

/// A package of a root model.
pub fn package(model: &str) -> Vec<u8> {
    package_with(model, &[])
}

/// A model with these attributes, resources and items.
pub fn model_with(attributes: &str, resources: &str, items: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <model xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
         xmlns:m=\"http://schemas.microsoft.com/3dmanufacturing/material/2015/02\" \
         xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\" {attributes}>\n\
         <resources>\n{resources}</resources>\n<build>{items}</build>\n</model>\n"
    )
}

pub fn model(resources: &str, items: &str) -> String {
    model_with("unit=\"millimeter\"", resources, items)
}

/// A tetrahedron as a mesh, its triangles with attributes of their own.
pub fn tetrahedron(triangles: [&str; 4]) -> String {
    let [a, b, c, d] = triangles;
    format!(
        "<mesh><vertices>\n<vertex x=\"0\" y=\"0\" z=\"0\"/>\n<vertex x=\"1\" y=\"0\" z=\"0\"/>\n\
         <vertex x=\"0\" y=\"1.5\" z=\"0\"/>\n<vertex x=\"0\" y=\"0\" z=\"-2e-3\"/>\n</vertices><triangles>\n\
         <triangle v1=\"0\" v2=\"1\" v3=\"2\" {a}/>\n<triangle v1=\"0\" v2=\"2\" v3=\"3\" {b}/>\n\
         <triangle v1=\"0\" v2=\"3\" v3=\"1\" {c}/>\n<triangle v1=\"1\" v2=\"3\" v3=\"2\" {d}/>\n\
         </triangles></mesh>"
    )
}

/// An object of a plain tetrahedron.
pub fn body(id: u32, attributes: &str) -> String {
    format!("<object id=\"{id}\" {attributes}>{}</object>\n", tetrahedron([""; 4]))
}
