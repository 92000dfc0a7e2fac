//! Image data of VTK: text, base64 and appended data, packed and plain, in one piece and several.
use super::{load, load_with, values};
use crate::common::{count, refuse};
use chordal_io::{FileLocation, Format, Limits};
use std::io::Write;

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(bytes).expect("packed");
    encoder.finish().expect("packed")
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for group in bytes.chunks(3) {
        let bits = group.iter().enumerate().fold(0_u32, |bits, (k, b)| bits | u32::from(*b) << (16 - 8 * k));
        for k in 0..4 {
            let letter = char::from(LETTERS[(bits >> (18 - 6 * k) & 63) as usize]);
            text.push(if k <= group.len() { letter } else { '=' });
        }
    }
    text
}

/// A block of LZ4 that holds up to fourteen bytes as they are.
fn lz4(bytes: &[u8]) -> Vec<u8> {
    [&[(bytes.len() as u8) << 4], bytes].concat()
}

const ZLIB: &str = "vtkZLibDataCompressor";
const LZ4: &str = "vtkLZ4DataCompressor";

/// How a file is written.
#[derive(Clone, Copy)]
struct Style {
    is_big: bool,
    is_wide: bool,
    compressor: &'static str,
    format: &'static str,
}

impl Style {
    fn number(self, n: usize) -> Vec<u8> {
        let mut bytes =
            if self.is_wide { (n as u64).to_le_bytes().to_vec() } else { (n as u32).to_le_bytes().to_vec() };
        if self.is_big {
            bytes.reverse();
        }
        bytes
    }

    /// The parts of an array that are encoded on their own.
    fn parts(self, data: &[u8]) -> Vec<Vec<u8>> {
        if self.compressor.is_empty() {
            return vec![[self.number(data.len()), data.to_vec()].concat()];
        }
        // Chosen so that the last block is smaller.
        let size = 10;
        let pack = if self.compressor == LZ4 { lz4 } else { zlib };
        let blocks: Vec<Vec<u8>> = data.chunks(size).map(pack).collect();
        let mut header = [blocks.len(), size, data.len() % size].map(|n| self.number(n)).concat();
        blocks.iter().for_each(|block| header.extend(self.number(block.len())));
        vec![header, blocks.concat()]
    }

    fn file(self, name: &str, data: &[u8]) -> Vec<u8> {
        let parts = self.parts(data);
        let text: String = parts.iter().map(|part| base64(part)).collect();
        let (inline, format, tail) = match self.format {
            "binary" => (format!("\n  {text}\n  "), "binary".to_owned(), Vec::new()),
            "raw" => {
                let data = [&b"x!<"[..], &parts.concat()].concat();
                let tail =
                    [&b"<AppendedData encoding=\"raw\">\n _"[..], &data, b"\n</AppendedData>\n"].concat();
                (String::new(), "appended\" offset=\"3".to_owned(), tail)
            }
            _ => {
                let tail = format!("<AppendedData encoding=\"base64\">_AAAA{text}</AppendedData>\n");
                (String::new(), "appended\" offset=\"4".to_owned(), tail.into_bytes())
            }
        };
        let order = if self.is_big { "BigEndian" } else { "LittleEndian" };
        let wide = if self.is_wide { "header_type=\"UInt64\"" } else { "" };
        let packed = if self.compressor.is_empty() {
            String::new()
        } else {
            format!("compressor=\"{}\"", self.compressor)
        };
        let head = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"{order}\" {wide} {packed}>\n\
             <ImageData WholeExtent=\"1 2 0 2 -1 0\" Origin=\"10 20 30\" Spacing=\"1 2 3\" \
             Direction=\"0 -1 0 1 0 0 0 0 1\"><Piece Extent=\"1 2 0 2 -1 0\"><PointData Scalars=\"a\">\n\
             <DataArray type=\"{name}\" Name=\"a\" format=\"{format}\">{inline}</DataArray></PointData>\
             <CellData></CellData></Piece></ImageData>\n"
        );
        [head.as_bytes(), &tail, b"</VTKFile>\n"].concat()
    }
}

fn styles() -> impl Iterator<Item = Style> {
    (0..36_usize).map(|k| Style {
        is_big: k & 1 == 1,
        is_wide: k & 2 == 2,
        compressor: ["", ZLIB, LZ4][k / 4 % 3],
        format: ["binary", "raw", "base64"][k / 12],
    })
}

fn counted() -> Vec<f64> {
    (0..12).map(f64::from).collect()
}

#[test]
fn every_type_and_style_is_exact() {
    fn check<const N: usize>(name: &str, number: impl Fn(u8) -> [u8; N]) {
        for style in styles() {
            let mut data = Vec::new();
            for i in 0..12 {
                let mut one = number(i);
                if style.is_big {
                    one.reverse();
                }
                data.extend(one);
            }
            let file = style.file(name, &data);
            assert_eq!(Format::sniff(&file), Some(Format::Vti));
            let (volume, warnings) = load(&file, Format::Vti);
            assert_eq!(values(&volume), counted(), "{name}");
            assert!(warnings.is_empty(), "{warnings:?}");
            // Index (1, 0, -1) of VTK comes first.
            let rows = [[0.0, -2.0, 0.0, 10.0], [1.0, 0.0, 0.0, 21.0], [0.0, 0.0, 3.0, 27.0]];
            assert_eq!(volume.grid.affine().rows(), rows);
            assert_eq!(volume.name, "a");
        }
    }
    check("Int8", |i| [i]);
    check("UInt8", |i| [i]);
    check("Int16", |i| i16::from(i).to_le_bytes());
    check("UInt16", |i| u16::from(i).to_le_bytes());
    check("Int32", |i| i32::from(i).to_le_bytes());
    check("UInt32", |i| u32::from(i).to_le_bytes());
    check("Int64", |i| i64::from(i).to_le_bytes());
    check("UInt64", |i| u64::from(i).to_le_bytes());
    check("Float32", |i| f32::from(i).to_le_bytes());
    check("Float64", |i| f64::from(i).to_le_bytes());
}

/// A file of text arrays; `pieces` stands below the image.
fn text(extent: &str, pieces: &str) -> String {
    format!(
        "<VTKFile type=\"ImageData\" byte_order=\"BigEndian\"><ImageData WholeExtent=\"{extent}\" Origin=\"0 0 0\" \
         Spacing=\"1 1 1\">{pieces}</ImageData></VTKFile>"
    )
}

fn array(name: &str, more: &str, numbers: &str) -> String {
    format!("<DataArray type=\"Int16\" Name=\"{name}\" {more} format=\"ascii\">{numbers}</DataArray>")
}

#[test]
fn pieces_are_put_together_and_must_fill_the_whole() {
    let piece = |extent: &str, numbers: &str| {
        format!("<Piece Extent=\"{extent}\"><PointData>{}</PointData></Piece>", array("a", "", numbers))
    };
    let left = piece("0 1 0 1 0 1", "0 1 3 4 6 7 9 10");
    let right = piece("1 2 0 1 0 1", "1 2 4 5 7 8 10 11");
    let (volume, _) = load(text("0 2 0 1 0 1", &(left.clone() + &right)).as_bytes(), Format::Vti);
    assert_eq!(values(&volume), counted());
    for pieces in [left.clone(), left.clone() + &left, right.clone() + &piece("1 3 0 1 0 1", "0")] {
        assert_eq!(refuse(text("0 2 0 1 0 1", &pieces).as_bytes(), Format::Vti).code, "bad-extent");
    }
    assert_eq!(refuse(text("0 2 0 1 0 1", "").as_bytes(), Format::Vti).code, "bad-header");
}

#[test]
fn arrays_are_chosen_by_scalars_or_index_and_cells_have_centres() {
    let numbers = "0 1 2 3 4 5 6 7";
    let points = |attributes: &str, arrays: &str| {
        text(
            "0 1 0 1 0 1",
            &format!("<Piece Extent=\"0 1 0 1 0 1\"><PointData {attributes}>{arrays}</PointData></Piece>"),
        )
    };
    let both = array("a", "", numbers) + &array("b", "", "7 6 5 4 3 2 1 0");
    let error = refuse(points("", &both).as_bytes(), Format::Vti);
    assert_eq!(error.code, "several-volumes");
    assert!(error.message.contains("'a', 'b': 'index' names one, from 0 to 1"), "{error}");
    let (volume, warnings) = load(points("Scalars=\"b\"", &both).as_bytes(), Format::Vti);
    assert_eq!((values(&volume)[0], count(&warnings, "arrays-ignored")), (7.0, 1));
    let limits = Limits { index: Some(0), ..Limits::default() };
    let (volume, _) = load_with(points("Scalars=\"b\"", &both).as_bytes(), Format::Vti, &limits);
    assert_eq!(values(&volume)[0], 0.0);
    let vectors = array("v", "NumberOfComponents=\"3\"", numbers);
    assert_eq!(refuse(points("", &vectors).as_bytes(), Format::Vti).code, "several-channels");
    let (_, warnings) = load(points("", &(vectors + &array("a", "", numbers))).as_bytes(), Format::Vti);
    assert_eq!(count(&warnings, "arrays-ignored"), 1);
    let cells =
        format!("<Piece Extent=\"0 2 0 2 0 2\"><CellData>{}</CellData></Piece>", array("a", "", numbers));
    let (volume, warnings) = load(text("0 2 0 2 0 2", &cells).as_bytes(), Format::Vti);
    assert_eq!((volume.grid.size(), count(&warnings, "cell-samples")), ([2; 3], 1));
    assert_eq!(volume.grid.affine().at([0.0; 3]), [0.5; 3]);
}

#[test]
fn files_that_lie_are_refused_at_their_place() {
    let style = Style { is_big: false, is_wide: false, compressor: "", format: "binary" };
    let bytes: Vec<u8> = (0..12).collect();
    let good = String::from_utf8(style.file("UInt8", &bytes)).unwrap();
    for (from, to, code) in [
        ("\"ImageData\"", "\"RectilinearGrid\"", "unsupported-data-set"),
        ("LittleEndian", "Middle", "unknown-value"),
        ("UInt8", "String", "unsupported-type"),
        ("UInt8", "Complex", "unknown-value"),
        ("UInt8", "UInt16", "size-mismatch"),
        ("format=\"binary\"", "format=\"appended\" offset=\"0\"", "no-appended-data"),
        ("format=\"binary\"", "format=\"zip\"", "unknown-value"),
        ("1 2 0 2 -1 0", "1 2 0 2 -1", "bad-header"),
        ("1 2 0 2 -1 0", "2 1 0 2 -1 0", "bad-header"),
        ("1 2 0 2 -1 0", "0 9223372036854775807 0 2 -1 0", "bad-header"),
        ("1 2 0 2 -1 0", "0 99999 0 99999 0 99999", "too-large"),
        ("1 2 0 2 -1 0", "1 2 0 2 0 0", "flat-volume"),
        ("Spacing=\"1 2 3\"", "Spacing=\"1 0 3\"", "singular"),
        ("Spacing=\"1 2 3\"", "Spacing=\"1 nan 3\"", "not-finite"),
        ("Spacing=\"1 2 3\"", "Spacing=\"1 2\"", "bad-header"),
        ("</Piece>", "", "not-xml"),
        ("<Piece", "<!DOCTYPE a><Piece", "dtd-not-allowed"),
        ("</VTKFile>", "", "not-xml"),
        ("version", "compressor=\"vtkLZMADataCompressor\" version", "unknown-value"),
        ("=</DataArray>", "!</DataArray>", "bad-base64"),
    ] {
        let file = good.replace("\n  </DataArray>", "</DataArray>");
        // Sixteen bytes in base64 end in two pads.
        assert!(file.contains(from), "{from}");
        let error = refuse(file.replace(from, to).as_bytes(), Format::Vti);
        assert_eq!(error.code, code, "{to}: {error}");
    }
    for style in styles() {
        let file = style.file("UInt8", &bytes);
        for (data, code) in [(&bytes[..11], "size-mismatch"), (&[0; 13][..], "size-mismatch")] {
            assert_eq!(refuse(&style.file("UInt8", data), Format::Vti).code, code);
        }
        for end in 0..file.len() - 30 {
            let error = refuse(&file[..end], Format::Vti);
            assert!(!error.message.is_empty());
        }
    }
    let style = Style { compressor: ZLIB, format: "raw", ..style };
    let mut file = style.file("UInt8", &bytes);
    let at = file.windows(2).position(|w| w == [0x78, 0x01]).unwrap();
    file[at + 5] ^= 0x55;
    let error = refuse(&file, Format::Vti);
    assert!(matches!(error.place, FileLocation::Byte(_)), "{error}");
    let numbers = "0 1 2 3 4 5 6 x";
    let piece =
        format!("<Piece Extent=\"0 1 0 1 0 1\"><PointData>{}</PointData></Piece>", array("a", "", numbers));
    let file = text("0 1 0 1 0 1", &piece);
    for (numbers, code) in [
        (numbers, "bad-number"),
        ("0 1", "truncated"),
        ("0 1 2 3 4 5 6 7 8", "trailing-bytes"),
        ("0 99999", "bad-number"),
    ] {
        let file = file.replace("0 1 2 3 4 5 6 x", numbers);
        assert_eq!(refuse(file.as_bytes(), Format::Vti).code, code, "{numbers}");
    }
}

#[test]
fn arrays_share_no_bytes_and_end_with_their_samples() {
    let piece = |extent: &str| {
        format!(
            "<Piece Extent=\"{extent}\"><PointData><DataArray type=\"UInt8\" Name=\"a\" format=\"appended\" \
             offset=\"0\"/></PointData></Piece>"
        )
    };
    // Both pieces name the same eight bytes.
    let pieces = piece("0 1 0 1 0 1") + &piece("0 1 0 1 1 2");
    let head = text("0 1 0 1 0 2", &pieces).replace("BigEndian", "LittleEndian").replace("</VTKFile>", "");
    let data = [&[8, 0, 0, 0][..], &[7; 8]].concat();
    let file = [head.as_bytes(), b"<AppendedData encoding=\"raw\">_", &data];
    // The tags that end a file would count as appended bytes, so they are left out.
    let error = refuse(&file.concat(), Format::Vti);
    assert_eq!(error.code, "overlapping-arrays", "{error}");
    for compressor in ["", ZLIB, LZ4] {
        let style = Style { is_big: false, is_wide: false, compressor, format: "binary" };
        let file = String::from_utf8(style.file("UInt8", &[1; 12])).unwrap();
        let file = file.replace("\n  </DataArray>", "\n AAAA</DataArray>");
        assert_eq!(refuse(file.as_bytes(), Format::Vti).code, "trailing-bytes", "{compressor}");
    }
}

#[test]
fn texts_are_no_samples_and_errors_in_text_have_a_line() {
    let numbers = array("a", "", "0 1 2 3 4 5 6 7");
    let names = "<Array type=\"String\" Name=\"s\" format=\"ascii\">65 0</Array>";
    let piece = |arrays: &str| {
        text("0 1 0 1 0 1", &format!("<Piece Extent=\"0 1 0 1 0 1\"><PointData>{arrays}</PointData></Piece>"))
    };
    let (volume, warnings) = load(piece(&(names.to_owned() + &numbers)).as_bytes(), Format::Vti);
    assert_eq!((values(&volume)[7], count(&warnings, "arrays-ignored")), (7.0, 1));
    let (_, warnings) = load(piece(&(numbers.clone() + &numbers)).as_bytes(), Format::Vti);
    assert_eq!(count(&warnings, "arrays-repeated"), 1);
    let error = refuse(piece(&numbers.replace("4 5", "4\n x")).as_bytes(), Format::Vti);
    assert_eq!(error.place, FileLocation::LineColumn { line: 2, column: 2 }, "{error}");
}
