//! Packages: stored files, of which the first is the shape.
use super::build::grid;
use super::{codes, file, triangle};
use chordal_io::{Content, Format, Limits, usd};

/// A zip file of stored files.
fn package(files: &[(&str, &[u8])]) -> Vec<u8> {
    let (mut out, mut rows) = (Vec::new(), Vec::new());
    for (name, bytes) in files {
        let crc = checksum(bytes);
        let at = out.len() as u32;
        let mut head = vec![20, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        head.extend_from_slice(&crc.to_le_bytes());
        head.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
        head.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
        head.extend_from_slice(&(name.len() as u16).to_le_bytes());
        head.extend_from_slice(&[0, 0]);
        out.extend_from_slice(b"PK\x03\x04");
        out.extend_from_slice(&head);
        out.extend_from_slice(name.as_bytes());
        out.extend_from_slice(bytes);
        rows.extend_from_slice(b"PK\x01\x02\x14\x00");
        rows.extend_from_slice(&head);
        rows.extend_from_slice(&[0; 10]);
        rows.extend_from_slice(&at.to_le_bytes());
        rows.extend_from_slice(name.as_bytes());
    }
    let (n, at) = (files.len() as u16, out.len() as u32);
    out.extend_from_slice(&rows);
    out.extend_from_slice(b"PK\x05\x06\0\0\0\0");
    out.extend_from_slice(&[n.to_le_bytes(), n.to_le_bytes()].concat());
    out.extend_from_slice(&(rows.len() as u32).to_le_bytes());
    out.extend_from_slice(&at.to_le_bytes());
    out.extend_from_slice(&[0, 0]);
    out
}

/// The checksum of a zip file (polynomial 0xEDB88320, reflected).
fn checksum(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |crc, byte| {
        (0..8).fold(
            crc ^ u32::from(*byte),
            |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 },
        )
    })
}

#[test]
fn the_first_file_is_the_shape_and_names_others_of_the_package() {
    let text =
        file("def Xform \"a\" (references = @./sub/grid.usdc@</World>) {} def \"b\" (payload = @c.usda@) {}");
    let other = file(&triangle("m")).replace("upAxis", "defaultPrim = \"m\" upAxis");
    let bytes =
        package(&[("a.usda", text.as_bytes()), ("sub/grid.usdc", &grid(2)), ("c.usda", other.as_bytes())]);
    assert_eq!(Format::sniff(&bytes), Some(Format::Usdz));
    let outcome = usd::read(&bytes, &Limits::default()).unwrap();
    let Content::Scene(scene) = outcome.content else { panic!("a scene") };
    assert_eq!(scene.parts.iter().map(|part| &*part.name).collect::<Vec<_>>(), ["Grid", "b"]);
    assert_eq!(scene.nodes[0].matrix[12..15], [1.0, 2.0, -2.0]);
}

/// OpenUSD, "LayerStack": a layer is followed by all that it includes, before the next layer of the same list.
#[test]
fn what_a_sublayer_includes_is_stronger_than_the_sublayer_after_it() {
    let layer = |below: &str, x: u32| {
        let prims = format!("over \"a\" {{ double3 xformOp:translate = ({x}, 0, 0) }}");
        file(&prims).replace("upAxis", &format!("subLayers = [{below}] upAxis"))
    };
    let order = "uniform token[] xformOpOrder = [\"xformOp:translate\"]";
    let prims = format!("def Xform \"a\" {{ {order} {} }}", triangle("m"));
    let shape = file(&prims).replace("upAxis", "subLayers = [@first.usda@, @second.usda@] upAxis");
    let empty = file("").replace("upAxis", "subLayers = [@third.usda@] upAxis");
    let [second, third] = [layer("", 2), layer("", 3)];
    let bytes = package(&[
        ("a.usda", shape.as_bytes()),
        ("first.usda", empty.as_bytes()),
        ("second.usda", second.as_bytes()),
        ("third.usda", third.as_bytes()),
    ]);
    let Content::Scene(scene) = usd::read(&bytes, &Limits::default()).unwrap().content else {
        panic!("a scene")
    };
    assert_eq!(scene.nodes[0].matrix[12..15], [3.0, 0.0, 0.0]);
}

#[test]
fn a_package_without_usd_or_with_damage_is_refused() {
    let code = |bytes: &[u8]| usd::read(bytes, &Limits::default()).unwrap_err().code;
    assert_eq!(code(&package(&[("a.txt", b"x")])), "not-usdz");
    assert_eq!(code(&package(&[("../a.usda", b"x")])), "unsafe-name");
    assert_eq!(code(&package(&[("a.usda", b"x")])), "not-usd");
    let whole = package(&[("a.usda", file(&triangle("m")).as_bytes())]);
    for at in 0..whole.len() {
        let _ = usd::read(&whole[..at], &Limits::default());
        let mut bytes = whole.clone();
        bytes[at] ^= 0x40;
        let _ = usd::read(&bytes, &Limits::default());
    }
    // What the package does not hold is named.
    assert_eq!(codes(&file(&(triangle("m") + "def \"x\" (references = @no.usda@) {}"))), ["layer-missing"]);
}
